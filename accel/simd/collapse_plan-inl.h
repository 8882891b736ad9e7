// Plans of wide nodes for all slots at once, re-included once per target by Highway's foreach_target.h. The bits are
// those of Collapse::solve.

// clang-format off: the guard flips for each target, and highway.h must come after foreach_target.h.
#if defined(RAYLOOM_ACCEL_COLLAPSE_PLAN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_COLLAPSE_PLAN_INL_H_
#undef RAYLOOM_ACCEL_COLLAPSE_PLAN_INL_H_
#else
#define RAYLOOM_ACCEL_COLLAPSE_PLAN_INL_H_
#endif
// clang-format on

#include <rayloom/accel/box.h>
#include <rayloom/accel/collapse_plan.h>
#include <rayloom/accel/simd/lanes-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// Lane i is of i + 1 slots.
struct ShareLanes {
  FloatLanes cost;
  WordLanes left;
};

/// Moves lanes up by `by`; below them comes the last lane, the infinite one.
HWY_INLINE FloatLanes shifted(FloatLanes lanes, uint32_t by) {
  alignas(32) static constexpr int32_t from[15] = {7, 7, 7, 7, 7, 7, 7, 0, 1, 2, 3, 4, 5, 6, 7};
  const Floats d;
  return hn::TableLookupLanes(lanes, hn::IndicesFromVec(d, hn::LoadU(Ints(), from + 7 - by)));
}

HWY_INLINE ShareLanes best_shares(const CollapsePlan& left, const CollapsePlan& right) {
  const Floats d;
  const FloatLanes of_right = hn::LoadU(d, right.cost.data());
  ShareLanes best{hn::Add(hn::Set(d, left.cost[0]), shifted(of_right, 1)), hn::Set(Words(), 1)};
  for (uint32_t k = 2; k < node_width; ++k) {
    const FloatLanes cost = hn::Add(hn::Set(d, left.cost[k - 1]), shifted(of_right, k));
    const LaneMask less = hn::Lt(cost, best.cost);
    best.cost = hn::IfThenElse(less, cost, best.cost);
    best.left = hn::IfThenElse(hn::RebindMask(Words(), less), hn::Set(Words(), k), best.left);
  }
  return best;
}

class CollapsePlanner {
 public:
  CollapsePlanner(const BinaryNode* tree, double area_scale, CollapsePlan* plans)
      : tree_(tree), area_scale_(area_scale), plans_(plans) {}

  void solve(uint32_t slot) const {
    const BinaryNode& node = tree_[slot];
    const uint32_t left = slot + 1, right = node.right;
    if (node.is_leaf()) return store_leaf(slot);
    const float area = static_cast<float>(node.box.half_area() * area_scale_);
    const bool left_is_leaf = tree_[left].is_leaf(), right_is_leaf = tree_[right].is_leaf();
    left_is_leaf ? store_leaf(left) : solve(left);
    right_is_leaf ? store_leaf(right) : solve(right);
    if (left_is_leaf && right_is_leaf) return store_pair(area, plans_[slot]);
    if (left_is_leaf) return combine({open_alone(plans_[right]), hn::Set(Words(), 1)}, area, plans_[slot]);
    if (right_is_leaf) return combine({open_alone(plans_[left]), hn::Iota(Words(), 0)}, area, plans_[slot]);
    combine(best_shares(plans_[left], plans_[right]), area, plans_[slot]);
  }

 private:
  HWY_INLINE void store_leaf(uint32_t slot) const {
    hn::StoreU(hn::Zero(Floats()), Floats(), plans_[slot].cost.data());
    plans_[slot].left_share = {};
  }

  /// The parent of two leaves.
  HWY_INLINE static void store_pair(float area, CollapsePlan& plan) {
    const Floats d;
    alignas(32) static constexpr float others[node_width] = {0, 0, 0, 0, 0, 0, 0, Box::infinity};
    const FloatLanes first = hn::IfThenElseZero(hn::FirstN(d, 1), hn::Set(d, area));
    hn::StoreU(hn::Or(hn::Load(d, others), first), d, plan.cost.data());
    plan.left_share = {0, 1, 1, 1, 1, 1, 1, 1};
  }

  /// With one slot for a leaf, which gains nothing from more.
  HWY_INLINE static FloatLanes open_alone(const CollapsePlan& inner) {
    return shifted(hn::LoadU(Floats(), inner.cost.data()), 1);
  }

  /// Costs fall with slots, so a node of its own is either better than all that are open or worse.
  HWY_INLINE static void combine(const ShareLanes& open, float area, CollapsePlan& plan) {
    const Floats d;
    const auto last = hn::Set(Ints(), node_width - 1);
    const FloatLanes all = hn::TableLookupLanes(open.cost, hn::IndicesFromVec(d, last));
    const FloatLanes own = hn::Add(all, hn::Set(d, area));
    const LaneMask first_lane = hn::FirstN(d, 1), last_lane = hn::Not(hn::FirstN(d, node_width - 1));
    const LaneMask is_open = hn::And(hn::Le(open.cost, own), hn::Not(first_lane));
    const FloatLanes cost = hn::IfThenElse(is_open, open.cost, own);
    const WordLanes left = hn::IfThenElseZero(hn::RebindMask(Words(), hn::Or(is_open, last_lane)), open.left);
    store(hn::IfThenElse(last_lane, hn::Set(d, Box::infinity), cost), left, plan);
  }

  HWY_INLINE static void store(FloatLanes cost, WordLanes left, CollapsePlan& plan) {
    hn::StoreU(cost, Floats(), plan.cost.data());
    const hn::FixedTag<uint8_t, 8> bytes;
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(Ints(), left)), bytes, plan.left_share.data());
  }

  const BinaryNode* tree_;
  double area_scale_;
  CollapsePlan* plans_;
};

void plan_collapse(const BinaryNode* tree, uint32_t slot, double area_scale, CollapsePlan* plans) {
  CollapsePlanner(tree, area_scale, plans).solve(slot);
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // RAYLOOM_ACCEL_COLLAPSE_PLAN_INL_H_
