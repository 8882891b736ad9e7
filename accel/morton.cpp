#include <rayloom/accel/chunks.h>
#include <rayloom/accel/morton.h>
#include <rayloom/accel/radix_sort.h>

#include <algorithm>
#include <iterator>

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

/// Sorts keys of one upper code by the lower 31 bits, in place of the upper ones while it lasts.
void sort_run(std::span<MortonKey> run, const KeyDetails& details) {
  const uint32_t upper = run[0].code;
  for_each_chunk(run.size(), [&](size_t, size_t begin, size_t end) {
    for (MortonKey& key : run.subspan(begin, end - begin))
      key.code = static_cast<uint32_t>(details.code(key.index)) & 0x7FFFFFFFu;
  });
  const auto less = [&](const MortonKey& a, const MortonKey& b) {
    return a.code != b.code ? a.code < b.code : details.name(a.index) < details.name(b.index);
  };
  if (run.size() > chunk_size) {
    ScratchVector<MortonKey> keys(run.begin(), run.end());
    radix_sort(keys, [](std::span<MortonKey>) {});
    std::copy(keys.begin(), keys.end(), run.begin());
  }
  if (!std::is_sorted(run.begin(), run.end(), less)) std::sort(run.begin(), run.end(), less);
  for (MortonKey& key : run) key.code = upper;
}

/// The keys around place `i` that have its code.
std::span<MortonKey> run_around(std::span<MortonKey> keys, size_t i) {
  const auto other = [code = keys[i].code](const MortonKey& key) { return key.code != code; };
  const auto here = keys.begin() + static_cast<ptrdiff_t>(i);
  return {std::find_if(std::reverse_iterator(here), keys.rend(), other).base(), std::find_if(here, keys.end(), other)};
}

/// Sorts the runs of more than `longest` keys of one code: each has two places that are multiples of half as many.
void sort_runs(std::span<MortonKey> keys, size_t longest, const KeyDetails& details) {
  const size_t step = (longest + 1) / 2;
  for (size_t i = step; i < keys.size(); i += step) {
    if (keys[i].code != keys[i - step].code) continue;
    const auto run = run_around(keys, i);
    if (run.size() > longest) sort_run(run, details);
    i += static_cast<size_t>(run.data() + run.size() - &keys[i]) / step * step;
  }
}

}  // namespace

uint64_t morton_code(uint32_t x, uint32_t y, uint32_t z) { return spread(x) << 2 | spread(y) << 1 | spread(z); }

MortonCurve::MortonCurve(const Box& centres)
    : low_{}, upper_scale_{}, extent_(std::max({centres.extent(0), centres.extent(1), centres.extent(2)})) {
  scale_ = extent_ > 0 ? (1 - 0x1p-30) * (1 << axis_bits) / extent_ : 0;
  if (!centres.empty()) low_ = Double4{centres.min[0], centres.min[1], centres.min[2], 0};
  upper_scale_ = scale_ * Double4{0x1p-10, 0x1p-10, 0x1p-11, 0};
}

uint64_t MortonCurve::code(Float4 centre) const {
  return morton_code(cell(centre, 0), cell(centre, 1), cell(centre, 2));
}

void sort_keys(ScratchVector<MortonKey>& keys, size_t longest_run, const KeyDetails& details) {
  radix_sort(keys, [&](std::span<MortonKey> sorted) { sort_runs(sorted, longest_run, details); });
}

ScratchVector<MortonKey> sorted_keys(const MortonCurve& curve, std::span<const PrimitiveRef> refs) {
  ScratchVector<MortonKey> keys(refs.size());
  for_each_chunk(refs.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) keys[i] = {curve.upper_code(refs[i]), static_cast<uint32_t>(i)};
  });
  const auto name = [&](uint32_t index) { return uint64_t{refs[index].geometry} << 32 | refs[index].primitive; };
  sort_keys(keys, 1, {[&](uint32_t index) { return curve.code(refs[index]); }, name});
  return keys;
}

}  // namespace rayloom::accel
