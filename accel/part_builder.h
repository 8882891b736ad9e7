#pragma once

// One part of a structure that is built in parts (structure_in_parts.h).

#include <rayloom/accel/curve_tree.h>
#include <rayloom/accel/loose_wide.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/accel/triangle_curve.h>
#include <rayloom/accel/triangle_leaf.h>

#include <optional>

namespace rayloom::accel {

/// How a builder makes parts and what lies above them.
struct PartRecipe {
  uint32_t size;         ///< most triangles of a part
  uint32_t binned_size;  ///< subtrees of at most so many triangles are split by binned SAH, others on the curve
  bool reinserts_top;    ///< whether the tree over all parts is improved by reinsertion
};
PartRecipe part_recipe(Builder builder);

/// A subtree without a place for its root.
struct Piece {
  Box box;
  LooseWide wide;
};
using Pieces = std::vector<Piece>;
inline constexpr size_t most_pieces = node_width;  ///< of a part

/// A part's nodes and leaves.
class PartBytes {
 public:
  /// They are to be written to memory of their own.
  void start_apart(const Subtree& part);
  /// They are to be written at `granule` of the block.
  void start_in_place(std::byte* block, uint32_t granule) { wide.start(block, granule); }

  /// Copies what was written apart to `granule` of the block, for the bytes that come in place; `pieces` then lie
  /// there.
  void move_to(std::byte* block, uint32_t granule);

  WideBytes wide;
  Pieces pieces;

 private:
  ScratchVector<std::byte> memory_;
};

/// Builds parts one after another in the same memory.
class PartBuilder {
 public:
  PartBuilder(const TriangleCurve& order, const TreeInput& input);

  /// Makes the tree of a part; then write() or write_alone() follows.
  void plan(const Subtree& part);
  /// Writes nodes and leaves where `out` was told to start.
  void write(PartBytes& out);
  /// The same as a tree with a root, whose reference is returned.
  uint32_t write_alone(PartBytes& out);

 private:
  uint32_t write_leaf(uint32_t slot, LooseWide& node, WideBytes& wide);
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
  std::optional<Collapse> collapse_;
};

}  // namespace rayloom::accel
