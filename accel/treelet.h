#pragma once

// Restructuring of small pieces of a tree: Karras and Aila, "Fast Parallel Construction of High-Quality Bounding Volume
// Hierarchies" (2013).

#include <rayloom/accel/box_area.h>

#include <cstdint>
#include <span>

namespace rayloom::accel {

/// A node of a tree that is being restructured; leaves keep left == right == 0.
struct LooseNode {
  Box4 box;
  uint32_t left = 0, right = 0;
  uint32_t first = 0, count = 0;  ///< primitives; `first` counts for leaves only
  float area = 0;
  float cost = 0;  ///< least surface area cost of the subtree

  bool is_leaf() const { return right == 0; }
};

/// Cost of visiting a binary node, in visits of a leaf: wide nodes each stand for about five of them.
inline constexpr float inner_cost = 0.25f;

/// Whether a subtree of this many primitives costs less as one leaf than `split_cost`.
inline bool better_as_leaf(float area, uint32_t count, float split_cost, uint32_t leaf_size) {
  return count <= leaf_size && area <= split_cost;
}

inline constexpr uint32_t treelet_leaves = 7;

/// Rearranges the treelet of up to seven leaves below `root`, formed by opening the largest nodes, into the tree of
/// least cost, by dynamic programming over all subsets of its leaves.
void restructure_treelet(std::span<LooseNode> nodes, uint32_t root, const BoxArea& area, uint32_t leaf_size);

}  // namespace rayloom::accel
