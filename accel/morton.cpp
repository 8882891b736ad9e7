#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/chunks.h>
#include <rayloom/accel/morton.h>
#include <rayloom/accel/radix_sort.h>

namespace rayloom::accel {
namespace {

constexpr int axis_bits = 21;
constexpr int code_bits = 3 * axis_bits;
/// Bits that are sorted for all keys; the rest only where these are equal, which is rare.
constexpr int first_bits = 33;

/// Two zero bits after each of the low 21 bits of x.
uint64_t spread(uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFFu;
  x = (x | x << 16) & 0x001F0000FF0000FFu;
  x = (x | x << 8) & 0x100F00F00F00F00Fu;
  x = (x | x << 4) & 0x10C30C30C30C30C3u;
  return (x | x << 2) & 0x1249249249249249u;
}

/// A cubic grid of 2^21 cells an axis. In double every float centre falls into the cell it lies in, to 2^-31 of a cell.
class Grid {
 public:
  explicit Grid(const Box& centres) {
    const double extent = std::max({centres.extent(0), centres.extent(1), centres.extent(2)});
    scale_ = extent > 0 ? (1 - 0x1p-30) * (1 << axis_bits) / extent : 0;
    for (int k = 0; k < 3; ++k) low_[k] = double{centres.min[k]};
  }
  uint64_t code(const PrimitiveRef& ref) const { return morton_code(cell(ref, 0), cell(ref, 1), cell(ref, 2)); }

 private:
  uint32_t cell(const PrimitiveRef& ref, int axis) const {
    return static_cast<uint32_t>(static_cast<int32_t>((double{ref.centre(axis)} - low_[axis]) * scale_));
  }
  double low_[3], scale_;
};

uint64_t first_part(const MortonKey& key) { return key.code >> (code_bits - first_bits); }

struct Run {
  size_t begin, count;
};

/// The runs of several keys that agree in their first bits and begin in [begin, end).
std::vector<Run> runs_of(std::span<const MortonKey> keys, size_t begin, size_t end) {
  std::vector<Run> runs;
  while (begin < end && begin > 0 && first_part(keys[begin]) == first_part(keys[begin - 1])) ++begin;
  while (begin < end) {
    size_t last = begin + 1;
    while (last < keys.size() && first_part(keys[last]) == first_part(keys[begin])) ++last;
    if (last - begin > 1) runs.push_back({begin, last - begin});
    begin = last;
  }
  return runs;
}

void sort_run(std::span<MortonKey> run, std::span<const PrimitiveRef> refs) {
  const auto less = [&](const MortonKey& a, const MortonKey& b) {
    return a.code != b.code ? a.code < b.code : name_less(refs[a.index], refs[b.index]);
  };
  if (run.size() > chunk_size) radix_sort(run, 0, code_bits - first_bits);
  if (!std::is_sorted(run.begin(), run.end(), less)) std::sort(run.begin(), run.end(), less);
}

}  // namespace

uint64_t morton_code(uint32_t x, uint32_t y, uint32_t z) { return spread(x) << 2 | spread(y) << 1 | spread(z); }

ScratchVector<MortonKey> morton_keys(std::span<const PrimitiveRef> refs) {
  const Grid grid(bounds_of(refs).centres);
  ScratchVector<MortonKey> keys(refs.size());
  for_each_chunk(refs.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) keys[i] = {grid.code(refs[i]), static_cast<uint32_t>(i)};
  });
  return keys;
}

void sort_keys(ScratchVector<MortonKey>& keys, std::span<const PrimitiveRef> refs) {
  radix_sort(keys, code_bits - first_bits, code_bits);
  std::vector<std::vector<Run>> runs(chunk_count(keys.size()));
  for_each_chunk(keys.size(), [&](size_t chunk, size_t begin, size_t end) { runs[chunk] = runs_of(keys, begin, end); });
  for_each_chunk(keys.size(), [&](size_t chunk, size_t, size_t) {
    for (const Run& run : runs[chunk]) sort_run(std::span(keys).subspan(run.begin, run.count), refs);
  });
}

}  // namespace rayloom::accel
