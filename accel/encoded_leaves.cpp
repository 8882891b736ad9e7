#include <rayloom/accel/encoded_leaves.h>
#include <rayloom/base/parallel.h>

#include <algorithm>

namespace rayloom::accel {
namespace {

/// Slots a task encodes, into memory of its own that stays in the cache.
constexpr size_t task_slots = 256;
/// How many leaves ahead their indices and vertices are asked for.
constexpr size_t indices_ahead = 6, vertices_ahead = 3;
constexpr size_t most_task_bytes = task_slots * sizeof(PlainTriangleLeaf);

/// What most trees' leaves take in all, and as large as an array of references that the builder has just given back.
size_t arena_block(size_t references) { return std::max(most_task_bytes, references * sizeof(PrimitiveRef)); }

}  // namespace

std::byte* ScratchArena::allocate(size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (used_ + bytes > block_bytes_) {
    blocks_.emplace_back(block_bytes_);
    used_ = 0;
  }
  std::byte* const piece = blocks_.back().data() + used_;
  used_ += bytes;
  return piece;
}

EncodedLeaves::EncodedLeaves(const BinaryTree& tree, std::span<const PrimitiveRef> refs,
                             const TriangleLeafWriter& writer)
    : tree_(tree),
      refs_(refs),
      writer_(writer),
      arena_(arena_block(refs.size())),
      granules_(tree.size()),
      leaf_(tree.size()) {
  parallel_for(tree.size(), task_slots, [this](uint64_t begin, uint64_t end) { encode_slots(begin, end); });
}

void EncodedLeaves::encode_slots(size_t begin, size_t end) {
  uint32_t leaves[task_slots];
  size_t count = 0;
  for (size_t slot = begin; slot < end; ++slot)
    if (tree_[slot].is_leaf() && tree_[slot].count > 0) leaves[count++] = static_cast<uint32_t>(slot);
  if (count == 0) return;
  alignas(granule_bytes) std::byte bytes[most_task_bytes];
  size_t used = 0;
  for (size_t i = 0; i < count; ++i) {
    if (i + indices_ahead < count) writer_.prefetch_indices(refs_of(leaves[i + indices_ahead]));
    if (i + vertices_ahead < count) writer_.prefetch_vertices(refs_of(leaves[i + vertices_ahead]));
    const uint64_t written = writer_.write(refs_of(leaves[i]), bytes + used);
    granules_[leaves[i]] = static_cast<uint16_t>(written / granule_bytes);
    used += written;
  }
  const std::byte* stored = std::copy_n(bytes, used, arena_.allocate(used)) - used;
  for (size_t i = 0; i < count; ++i) {
    leaf_[leaves[i]] = stored;
    stored += size_t{granules_[leaves[i]]} * granule_bytes;
  }
}

}  // namespace rayloom::accel
