#pragma once

// Leaves of triangles as bytes before it is known where they go: how large a leaf is follows from encoding it, and
// doing that once is what a build has time for.

#include <rayloom/accel/triangle_leaf.h>
#include <rayloom/accel/wide_tree.h>

#include <cstring>
#include <mutex>

namespace rayloom::accel {

/// Memory handed out to several threads in pieces of at most `block_bytes`; all is kept until the end.
class ScratchArena {
 public:
  explicit ScratchArena(size_t block_bytes) : block_bytes_(block_bytes), used_(block_bytes) {}
  std::byte* allocate(size_t bytes);

 private:
  size_t block_bytes_;
  size_t used_;  ///< of the last block
  std::mutex mutex_;
  std::vector<ScratchVector<std::byte>> blocks_;
};

class EncodedLeaves {
 public:
  EncodedLeaves(const BinaryTree& tree, std::span<const PrimitiveRef> refs, const TriangleLeafWriter& writer);

  const LeafBytes& sizes() const { return granules_; }
  void write(uint32_t slot, std::byte* address) const {
    std::memcpy(address, leaf_[slot], size_t{granules_[slot]} * granule_bytes);
  }

 private:
  void encode_slots(size_t begin, size_t end);
  std::span<const PrimitiveRef> refs_of(uint32_t slot) const {
    return refs_.subspan(tree_[slot].first, tree_[slot].count);
  }

  const BinaryTree& tree_;
  std::span<const PrimitiveRef> refs_;
  const TriangleLeafWriter& writer_;
  ScratchArena arena_;
  LeafBytes granules_;
  ScratchVector<const std::byte*> leaf_;  ///< by slot, set for leaves
};

}  // namespace rayloom::accel
