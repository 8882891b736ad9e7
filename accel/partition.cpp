#include <rayloom/accel/chunks.h>
#include <rayloom/accel/partition.h>

#include <algorithm>

namespace rayloom::accel {
namespace {

/// Counts, prefix sums, scatter, copy back: one pass each, every chunk on its own.
size_t partition_chunks(std::span<PrimitiveRef> refs, std::span<PrimitiveRef> scratch, const Split& split) {
  const auto goes_left = [&](const PrimitiveRef& ref) { return split.goes_left(ref); };
  std::vector<size_t> left_begin(chunk_count(refs.size()) + 1, 0);
  for_each_chunk(refs.size(), [&](size_t chunk, size_t begin, size_t end) {
    left_begin[chunk + 1] = static_cast<size_t>(std::count_if(refs.data() + begin, refs.data() + end, goes_left));
  });
  for (size_t chunk = 1; chunk < left_begin.size(); ++chunk) left_begin[chunk] += left_begin[chunk - 1];
  const size_t left_count = left_begin.back();
  for_each_chunk(refs.size(), [&](size_t chunk, size_t begin, size_t end) {
    PrimitiveRef* left = scratch.data() + left_begin[chunk];
    PrimitiveRef* right = scratch.data() + left_count + (begin - left_begin[chunk]);
    std::partition_copy(refs.data() + begin, refs.data() + end, left, right, goes_left);
  });
  for_each_chunk(refs.size(), [&](size_t, size_t begin, size_t end) {
    std::copy(scratch.data() + begin, scratch.data() + end, refs.data() + begin);
  });
  return left_count;
}

/// Writes each reference to both sides and keeps one: no branch to guess wrong. Leaves the same order as
/// partition_chunks.
size_t partition_in_order(std::span<PrimitiveRef> refs, std::span<PrimitiveRef> scratch, const Split& split) {
  PrimitiveRef *left = refs.data(), *right = scratch.data();
  for (const PrimitiveRef& from : refs) {
    const PrimitiveRef ref = from;
    const bool goes_left = split.goes_left(ref);
    *left = *right = ref;
    left += goes_left;
    right += !goes_left;
  }
  std::copy(scratch.data(), right, left);
  return static_cast<size_t>(left - refs.data());
}

int longest_axis(const Box& box) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (box.extent(k) > box.extent(axis)) axis = k;
  return axis;
}

}  // namespace

size_t partition_by_split(std::span<PrimitiveRef> refs, std::span<PrimitiveRef> scratch, const Split& split) {
  if (refs.size() > chunk_size && thread_limit() > 1) return partition_chunks(refs, scratch, split);
  return partition_in_order(refs, scratch, split);
}

size_t partition_by_median(std::span<PrimitiveRef> refs, const Box& centres, uint32_t leaf_size) {
  const int axis = longest_axis(centres);
  const size_t left_count = (blocks_for(refs.size(), leaf_size) / 2) * leaf_size;
  std::nth_element(refs.begin(), refs.begin() + static_cast<std::ptrdiff_t>(left_count), refs.end(),
                   [axis](const PrimitiveRef& a, const PrimitiveRef& b) {
                     const float x = a.centre(axis), y = b.centre(axis);
                     return x != y ? x < y : name_less(a, b);
                   });
  return left_count;
}

}  // namespace rayloom::accel
