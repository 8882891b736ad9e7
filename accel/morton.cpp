#include <rayloom/accel/chunks.h>
#include <rayloom/accel/morton.h>
#include <rayloom/accel/radix_sort.h>

namespace rayloom::accel {
namespace {

constexpr int axis_bits = 21;

/// Two zero bits after each of the low 21 bits of x.
uint64_t spread(uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFFu;
  x = (x | x << 16) & 0x001F0000FF0000FFu;
  x = (x | x << 8) & 0x100F00F00F00F00Fu;
  x = (x | x << 4) & 0x10C30C30C30C30C3u;
  return (x | x << 2) & 0x1249249249249249u;
}

/// The same for 11 bits.
uint32_t spread11(uint32_t x) {
  x = (x | x << 16) & 0x070000FFu;
  x = (x | x << 8) & 0x0700F00Fu;
  x = (x | x << 4) & 0x430C30C3u;
  return (x | x << 2) & 0x49249249u;
}

struct Run {
  size_t begin, count;
};

/// The runs of several keys of one code that begin in [begin, end).
std::vector<Run> runs_of(std::span<const MortonKey> keys, size_t begin, size_t end) {
  std::vector<Run> runs;
  while (begin < end && begin > 0 && keys[begin].code == keys[begin - 1].code) ++begin;
  while (begin < end) {
    size_t last = begin + 1;
    while (last < keys.size() && keys[last].code == keys[begin].code) ++last;
    if (last - begin > 1) runs.push_back({begin, last - begin});
    begin = last;
  }
  return runs;
}

/// Sorts keys of one upper code by the lower 31 bits, in place of the upper ones while it lasts.
void sort_run(std::span<MortonKey> run, const MortonCurve& curve, std::span<const PrimitiveRef> refs) {
  const uint32_t upper = run[0].code;
  for_each_chunk(run.size(), [&](size_t, size_t begin, size_t end) {
    for (MortonKey& key : run.subspan(begin, end - begin))
      key.code = static_cast<uint32_t>(curve.code(refs[key.index])) & 0x7FFFFFFFu;
  });
  const auto less = [&](const MortonKey& a, const MortonKey& b) {
    return a.code != b.code ? a.code < b.code : name_less(refs[a.index], refs[b.index]);
  };
  if (run.size() > chunk_size) radix_sort(run);
  if (!std::is_sorted(run.begin(), run.end(), less)) std::sort(run.begin(), run.end(), less);
  for (MortonKey& key : run) key.code = upper;
}

}  // namespace

uint64_t morton_code(uint32_t x, uint32_t y, uint32_t z) { return spread(x) << 2 | spread(y) << 1 | spread(z); }

MortonCurve::MortonCurve(const Box& centres) {
  const double extent = std::max({centres.extent(0), centres.extent(1), centres.extent(2)});
  scale_ = extent > 0 ? (1 - 0x1p-30) * (1 << axis_bits) / extent : 0;
  for (int k = 0; k < 3; ++k) low_[k] = double{centres.min[k]};
}

uint64_t MortonCurve::code(const PrimitiveRef& ref) const {
  return morton_code(cell(ref, 0), cell(ref, 1), cell(ref, 2));
}

/// 32 bits are 11 of x, 11 of y and 10 of z.
uint32_t MortonCurve::upper_code(const PrimitiveRef& ref) const {
  return spread11(cell(ref, 0) >> 10) << 1 | spread11(cell(ref, 1) >> 10) | spread11(cell(ref, 2) >> 11) << 2;
}

ScratchVector<MortonKey> sorted_keys(const MortonCurve& curve, std::span<const PrimitiveRef> refs) {
  ScratchVector<MortonKey> keys(refs.size());
  for_each_chunk(refs.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) keys[i] = {curve.upper_code(refs[i]), static_cast<uint32_t>(i)};
  });
  radix_sort(keys);
  std::vector<std::vector<Run>> runs(chunk_count(keys.size()));
  for_each_chunk(keys.size(), [&](size_t chunk, size_t begin, size_t end) { runs[chunk] = runs_of(keys, begin, end); });
  for_each_chunk(keys.size(), [&](size_t chunk, size_t, size_t) {
    for (const Run& run : runs[chunk]) sort_run(std::span(keys).subspan(run.begin, run.count), curve, refs);
  });
  return keys;
}

}  // namespace rayloom::accel
