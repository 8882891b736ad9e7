#include <rayloom/accel/encoded_leaves.h>
#include <rayloom/base/parallel.h>

namespace rayloom::accel {
namespace {

/// Slots a task encodes, into memory of its own that stays in the cache.
constexpr size_t task_slots = 256;
/// How many leaves ahead their indices and vertices are asked for.
constexpr size_t indices_ahead = 6, vertices_ahead = 3;

}  // namespace

std::byte* ScratchArena::allocate(size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (used_ + bytes > block_bytes) {
    blocks_.emplace_back(block_bytes);
    used_ = 0;
  }
  std::byte* const piece = blocks_.back().data() + used_;
  used_ += bytes;
  return piece;
}

EncodedLeaves::EncodedLeaves(const BinaryTree& tree, std::span<const PrimitiveRef> refs,
                             const TriangleLeafWriter& writer)
    : tree_(tree), refs_(refs), writer_(writer), granules_(tree.size()), leaf_(tree.size()) {
  parallel_for(tree.size(), task_slots, [this](uint64_t begin, uint64_t end) { encode_slots(begin, end); });
}

void EncodedLeaves::encode_slots(size_t begin, size_t end) {
  uint32_t leaves[task_slots];
  size_t count = 0;
  for (size_t slot = begin; slot < end; ++slot)
    if (tree_[slot].is_leaf() && tree_[slot].count > 0) leaves[count++] = static_cast<uint32_t>(slot);
  if (count == 0) return;
  alignas(granule_bytes) std::byte bytes[task_slots * sizeof(PlainTriangleLeaf)];
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
