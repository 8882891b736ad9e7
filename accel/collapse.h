#pragma once

#include <rayloom/accel/binary_tree.h>

#include <array>

namespace rayloom::accel {

inline constexpr uint32_t node_width = 8;

/// Which binary nodes become the children of a wide node. Starts as {}; a scratch array of them does not.
struct ChildList {
  uint32_t count;
  std::array<uint32_t, node_width> slot;
  void push(uint32_t child) { slot[count++] = child; }
};

/// Chooses the wide tree with the least expected number of node visits, by dynamic programming over the binary tree
/// (Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017,
/// section 3.2).
class Collapse {
 public:
  explicit Collapse(const BinaryTree& tree);

  /// Children of the wide node made from the inner binary node `slot`: inner nodes before leaves, then by rising area;
  /// any-hit rays visit them from the last to the first. A child is never left standing that would fit into its
  /// parent; node_bound() in sizes.h counts on that.
  ChildList children(uint32_t slot) const;
  /// The children as planned, from left to right; some may fit into their parent where choices were equal.
  ChildList planned(uint32_t slot) const;

 private:
  /// For a subtree that may fill up to j slots of its parent, j = 1..7: the least summed area of wide nodes, and how
  /// many of the j slots its left child gets; 0: as good with fewer. left_share[0] is for the 8 slots of a node of its
  /// own.
  struct Plan {
    std::array<float, node_width - 1> cost;
    std::array<uint8_t, node_width - 1> left_share;
  };
  struct Share {
    float cost;
    uint8_t left;
  };

  void solve(uint32_t slot);
  static Share best_share(const Plan& left, const Plan& right, uint32_t slots);
  void place(uint32_t slot, uint32_t slots, ChildList& list) const;
  void absorb(ChildList& list) const;

  const BinaryTree& tree_;
  double area_scale_;
  ScratchVector<Plan> plans_;
};

}  // namespace rayloom::accel
