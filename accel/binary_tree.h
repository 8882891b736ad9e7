#pragma once

// The one intermediate every builder produces and every node format is made from.

#include <rayloom/accel/float4.h>
#include <rayloom/accel/primitive_ref.h>

#include <span>

namespace rayloom::accel {

/// The left child lies in the next slot, the right one in slot `right`.
struct BinaryNode {
  Box box;
  uint32_t first = 0, count = 0;  ///< the range of primitives below
  uint32_t right = 0;             ///< 0: a leaf

  bool is_leaf() const { return right == 0; }
};

/// Stores a node in vectors, of which each overwrites what the one before had too much.
inline void store(const Box4& box, uint32_t first, uint32_t count, uint32_t right, BinaryNode& node) {
  auto* const bytes = reinterpret_cast<std::byte*>(&node);
  std::memcpy(bytes, &box.min, sizeof(box.min));
  std::memcpy(bytes + offsetof(BinaryNode, box.max), &box.max, sizeof(box.max));
  node.first = first;
  node.count = count;
  node.right = right;
}

/// Slot 0 is the root. Slots are numbered by position, so some stay unused (count 0).
using BinaryTree = ScratchVector<BinaryNode>;

struct BinaryBuildOptions {
  uint32_t leaf_size = 8;    ///< a range of at most this many primitives is one leaf
  uint64_t leaf_budget = 1;  ///< the tree has at most this many leaves; at least primitives / leaf_size, rounded up
};

/// Splits by binned SAH, and in halves where depth or the budget leaves no choice. Reorders `refs` (not empty, at most
/// 2^29) so that each leaf is a range of them, sorted by name. Every decision depends on the set of primitives in a
/// range, never on their order, hence the result not on the number of threads.
BinaryTree build_binary_tree(std::span<PrimitiveRef> refs, const BinaryBuildOptions& options);

struct Subtree;
/// The same for one subtree of a tree over `refs`. `scratch` is as long as `refs`.
void build_binary_subtree(std::span<PrimitiveRef> refs, std::span<PrimitiveRef> scratch, uint32_t leaf_size,
                          const Subtree& subtree, BinaryTree& tree);

}  // namespace rayloom::accel
