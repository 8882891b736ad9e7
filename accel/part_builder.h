#pragma once

// One part of a structure that is built in parts (structure_in_parts.h).

#include <rayloom/accel/curve_tree.h>
#include <rayloom/accel/loose_wide.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/accel/triangle_curve.h>
#include <rayloom/accel/triangle_leaf.h>

namespace rayloom::accel {

/// How a builder makes parts and what lies above them.
struct PartRecipe {
  uint32_t size;         ///< most triangles of a part
  uint32_t binned_size;  ///< subtrees of at most so many triangles are split by binned SAH, others on the curve
  bool reinserts_top;    ///< whether the tree over all parts is improved by reinsertion
};
PartRecipe part_recipe(Builder builder);

/// A subtree without a place for its root. A part has up to eight.
struct Piece {
  Box box;
  LooseWide wide;
};
using Pieces = std::vector<Piece>;

/// Builds parts one after another in the same memory.
class PartBuilder {
 public:
  PartBuilder(const TriangleCurve& order, const TreeInput& input);

  /// Builds into memory of its own.
  void build(const Subtree& part);
  /// Copies what was built to `granule` of the block and returns the part's pieces.
  Pieces move_to(std::byte* block, uint32_t granule) const;

  /// Builds at `granule` of the block. The bytes are those that the other two give.
  void build_in_place(const Subtree& part, std::byte* block, uint32_t granule);
  Pieces take_pieces() { return std::move(pieces_); }

  /// Builds into memory of its own, as a tree with a root. Returns the root's reference, from where move_to() counts.
  uint32_t build_alone(const Subtree& part);

  const WideBytes& wide() const { return wide_; }

 private:
  void reserve(const Subtree& part);
  void build_tree(const Subtree& part);
  void write_pieces();
  uint32_t write_leaf(uint32_t slot, LooseWide& node);
  /// Whether leaves are made of rows, if the triangles can be had as such: where their order stays that of the curve.
  bool wants_rows() const;
  TriangleRows rows();

  const TriangleCurve* order_;
  const TreeInput* input_;
  TriangleLeafWriter leaves_;
  PrimitiveRefs scratch_;
  ScratchVector<uint32_t> rows_;
  bool has_rows_ = false;
  BuiltTree built_;
  ScratchVector<std::byte> bytes_;
  WideBytes wide_;
  Pieces pieces_;
};

}  // namespace rayloom::accel
