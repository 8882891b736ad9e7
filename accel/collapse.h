#pragma once

#include <rayloom/accel/collapse_plan.h>

namespace rayloom::accel {

struct BuildKernel;

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
  /// `memory` is that of an earlier one.
  explicit Collapse(const BinaryTree& tree, ScratchVector<CollapsePlan> memory = {});
  ScratchVector<CollapsePlan> take_memory() { return std::move(plans_); }

  /// Children of the wide node made from the inner binary node `slot`: inner nodes before leaves, then by rising area;
  /// any-hit rays visit them from the last to the first. A child is never left standing that would fit into its
  /// parent; node_bound() in sizes.h counts on that.
  ChildList children(uint32_t slot) const;
  /// The children as planned, from left to right; some may fit into their parent where choices were equal.
  ChildList planned(uint32_t slot) const;

 private:
  struct Share {
    float cost;
    uint8_t left;
  };

  void solve(uint32_t slot);
  static Share best_share(const CollapsePlan& left, const CollapsePlan& right, uint32_t slots);
  void place(uint32_t slot, uint32_t slots, ChildList& list) const;
  void absorb(ChildList& list) const;

  const BinaryTree& tree_;
  double area_scale_;
  const BuildKernel* kernel_;
  ScratchVector<CollapsePlan> plans_;
};

}  // namespace rayloom::accel
