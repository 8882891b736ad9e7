#pragma once

#include <rayloom/accel/part_builder.h>

namespace rayloom::accel {

/// The binary tree over the pieces of all parts, split by surface area.
class PieceTree {
 public:
  /// One piece or more; they must outlive the tree. Where splits by area would make the structure deeper than
  /// max_depth, pieces are halved instead; throws InputError where that is too deep as well.
  PieceTree(std::vector<const Piece*> pieces, bool reinserts);

  const BinaryTree& tree() const { return tree_; }
  /// Of a leaf.
  const Piece& piece(uint32_t slot) const { return *pieces_[refs_[tree_[slot].first].primitive]; }
  /// Asks for the bytes of a piece some leaves behind this one: other threads may have written them.
  void ask_ahead(uint32_t slot) const;
  /// Of the whole structure, if binary nodes were wide ones: no less than what it will be.
  uint32_t depth() const { return depth_below(0); }

 private:
  uint32_t depth_below(uint32_t slot) const;
  void build_balanced();

  std::vector<const Piece*> pieces_;
  PrimitiveRefs refs_;
  BinaryTree tree_;
};

}  // namespace rayloom::accel
