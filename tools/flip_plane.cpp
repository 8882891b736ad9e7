#include <rayloom/tools/flip_plane.h>

#include <rayloom/base/parallel.h>

#include <algorithm>

namespace rayloom::tools::flip {
namespace {

constexpr uint64_t rows_per_chunk = 16;

void add_scaled(float* out, const float* in, float weight, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i) out[i] += weight * in[i];
}

/// Calls f(y) for every row, from several threads.
template <class Function>
void for_each_row(uint32_t height, Function&& f) {
  parallel_for(height, rows_per_chunk, [&](uint64_t begin, uint64_t end) {
    for (uint64_t y = begin; y < end; ++y) f(static_cast<uint32_t>(y));
  });
}

/// A row with `radius` copies of its first and last value on either side.
std::vector<float> extend_row(const float* row, uint32_t width, size_t radius) {
  std::vector<float> extended(width + 2 * radius, row[0]);
  std::copy_n(row, width, extended.begin() + static_cast<std::ptrdiff_t>(radius));
  std::fill_n(extended.end() - static_cast<std::ptrdiff_t>(radius), radius, row[width - 1]);
  return extended;
}

}  // namespace

Plane convolve_rows(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  for_each_row(in.height, [&](uint32_t y) {
    const std::vector<float> extended = extend_row(in.row(y), in.width, kernel.size() / 2);
    for (size_t k = 0; k < kernel.size(); ++k) add_scaled(out.row(y), extended.data() + k, kernel[k], in.width);
  });
  return out;
}

Plane convolve_columns(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  const int64_t radius = static_cast<int64_t>(kernel.size() / 2);
  for_each_row(in.height, [&](uint32_t y) {
    for (size_t k = 0; k < kernel.size(); ++k) {
      const int64_t other = std::clamp<int64_t>(y + static_cast<int64_t>(k) - radius, 0, int64_t{in.height} - 1);
      add_scaled(out.row(y), in.row(static_cast<uint32_t>(other)), kernel[k], in.width);
    }
  });
  return out;
}

Kernel normalize(const std::vector<double>& weights) {
  double positive = 0, negative = 0;
  for (const double weight : weights) (weight > 0 ? positive : negative) += weight;
  Kernel kernel;
  for (const double weight : weights) {
    kernel.push_back(weight == 0 ? 0 : static_cast<float>(weight > 0 ? weight / positive : weight / -negative));
  }
  return kernel;
}

}  // namespace rayloom::tools::flip
