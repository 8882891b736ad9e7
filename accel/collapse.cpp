#include <rayloom/accel/collapse.h>
#include <rayloom/accel/simd/build_kernel.h>
#include <rayloom/base/parallel.h>

#include <algorithm>

namespace rayloom::accel {
namespace {
constexpr uint32_t parallel_threshold = 16384;
}

/// Areas count relative to the root's, so that their sums fit a float.
Collapse::Collapse(const BinaryTree& tree, ScratchVector<CollapsePlan> memory)
    : tree_(tree), kernel_(build_kernel()), plans_(std::move(memory)) {
  plans_.resize(tree.size());
  const double area = tree[0].box.half_area();
  area_scale_ = area > 0 ? 1 / area : 0;
  solve(0);
}

void Collapse::solve(uint32_t slot) {
  const BinaryNode& node = tree_[slot];
  CollapsePlan& plan = plans_[slot];
  if (kernel_ && node.count < parallel_threshold)
    return kernel_->plan_collapse(tree_.data(), slot, area_scale_, plans_.data());
  if (node.is_leaf()) {
    plan = {};
    return;
  }
  const uint32_t left = slot + 1, right = node.right;
  if (node.count < parallel_threshold) {
    solve(left);
    solve(right);
  } else {
    parallel_invoke([this, left] { solve(left); }, [this, right] { solve(right); });
  }
  const bool left_is_leaf = tree_[left].is_leaf(), right_is_leaf = tree_[right].is_leaf();
  const auto share = [&](uint32_t slots) {  // for a leaf more than one slot gains nothing
    if (left_is_leaf) return Share{plans_[right].cost[slots - 2], 1};
    if (right_is_leaf) return Share{plans_[left].cost[slots - 2], static_cast<uint8_t>(slots - 1)};
    return best_share(plans_[left], plans_[right], slots);
  };
  const Share own = share(node_width);
  plan.cost[0] = own.cost + static_cast<float>(node.box.half_area() * area_scale_);
  plan.cost[node_width - 1] = Box::infinity;
  plan.left_share[0] = 0;
  plan.left_share[node_width - 1] = own.left;
  for (uint32_t slots = 2; slots < node_width; ++slots) {
    const Share open = share(slots);
    const bool better = open.cost <= plan.cost[slots - 2];
    plan.cost[slots - 1] = better ? open.cost : plan.cost[slots - 2];
    plan.left_share[slots - 1] = better ? open.left : uint8_t{0};
  }
}

Collapse::Share Collapse::best_share(const CollapsePlan& left, const CollapsePlan& right, uint32_t slots) {
  Share best{left.cost[0] + right.cost[slots - 2], 1};
  for (uint32_t k = 2; k < slots; ++k) {
    const float cost = left.cost[k - 1] + right.cost[slots - k - 1];
    best.left = cost < best.cost ? static_cast<uint8_t>(k) : best.left;
    best.cost = std::min(best.cost, cost);
  }
  return best;
}

/// Adds the children that stand for the subtree `slot` when it may fill up to `slots` slots.
void Collapse::place(uint32_t slot, uint32_t slots, ChildList& list) const {
  const CollapsePlan& plan = plans_[slot];
  while (slots > 1 && plan.left_share[slots - 1] == 0) --slots;  // a leaf's shares are all 0
  if (slots == 1) return list.push(slot);
  const uint32_t left = plan.left_share[slots - 1];
  place(slot + 1, left, list);
  place(tree_[slot].right, slots - left, list);
}

ChildList Collapse::planned(uint32_t slot) const {
  ChildList list{};
  const uint32_t left = plans_[slot].left_share[node_width - 1];
  place(slot + 1, left, list);
  place(tree_[slot].right, node_width - left, list);
  return list;
}

/// The plan leaves room unused only where rounding made the choices look equal.
void Collapse::absorb(ChildList& list) const {
  for (uint32_t i = 0; i < list.count && list.count < node_width;) {
    const uint32_t slot = list.slot[i];
    const ChildList inner = tree_[slot].is_leaf() ? ChildList{} : planned(slot);
    if (inner.count == 0 || list.count - 1 + inner.count > node_width) {
      ++i;
      continue;
    }
    list.slot[i] = inner.slot[0];
    for (uint32_t k = 1; k < inner.count; ++k) list.push(inner.slot[k]);
  }
}

ChildList Collapse::children(uint32_t slot) const {
  ChildList list = planned(slot);
  absorb(list);
  const auto before = [&](uint32_t a, uint32_t b) {
    if (tree_[a].is_leaf() != tree_[b].is_leaf()) return tree_[b].is_leaf();
    const double x = tree_[a].box.half_area(), y = tree_[b].box.half_area();
    return x != y ? x < y : a < b;
  };
  std::sort(list.slot.begin(), list.slot.begin() + list.count, before);
  return list;
}

}  // namespace rayloom::accel
