// How a ray tests the triangles of a leaf and what it makes of those that it hits. Included once for each set of lane
// tests, as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_TRIANGLE_LEAVES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_TRIANGLE_LEAVES_INL_H
#undef RAYLOOM_ACCEL_TRIANGLE_LEAVES_INL_H
#else
#define RAYLOOM_ACCEL_TRIANGLE_LEAVES_INL_H
#endif
// clang-format on

#include <rayloom/accel/level-inl.h>
#include <rayloom/accel/visitor.h>

#include <algorithm>
#include <bit>
#include <optional>

#ifdef HWY_TARGET_INCLUDE
#include <rayloom/accel/simd/lane_hit-inl.h>
HWY_BEFORE_NAMESPACE();
#define RAYLOOM_LANES HWY_NAMESPACE
#else
#define RAYLOOM_LANES scalar
#endif

#if !defined(HWY_TARGET_INCLUDE) || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::RAYLOOM_LANES {

struct TriangleLeaves {
  const InstanceRules& rules;

  [[gnu::always_inline]] static std::optional<TriangleHit> intersect(const PreparedRay& ray, const TriangleLeaf& leaf,
                                                                     uint32_t lane, bool certain, float t_far) {
    if (certain) return hit_lane(ray, leaf, lane, t_far);
    float v[3][3];
    for (uint32_t vertex = 0; vertex < 3; ++vertex)
      for (uint32_t axis = 0; axis < 3; ++axis) v[vertex][axis] = leaf.coordinate(vertex, axis, lane);
    return intersect_triangle(ray, v[0], v[1], v[2], t_far);
  }

  template <class Visitor>
  [[gnu::always_inline]] Offer visit(const Level& level, const std::byte* address, Search& search,
                                     Visitor& visitor) const {
    const auto* leaf = reinterpret_cast<const TriangleLeaf*>(address);
    LeafDepths found;
    const LeafMasks masks = test_triangles(TriangleLanes(level.ray), *leaf, level.depths, found);
    if (masks.possible == 0) {
      visitor.on_triangle_leaf(leaf, 0, 0);
      return Offer::rejected;
    }
    if constexpr (!SeesTriangles<Visitor>)
      if (takes_nearest(search.request())) return offer_nearest_first(level, *leaf, masks, found, search);
    return offer_lanes(level, leaf, masks.possible, masks.certain, search, visitor);
  }

  /// Whether the nearest of all triangles is what the ray finds, in whatever order they are offered.
  bool takes_nearest(const TraceRequest& request) const {
    const bool takes_first = request.ray_flags & ray_flag::accept_first_hit_and_end_search;
    return rules.hits.accepts_all & !request.candidate & !takes_first;
  }

  /// A hit may save those behind it the computation of their exact t.
  [[gnu::always_inline]] Offer offer_nearest_first(const Level& level, const TriangleLeaf& leaf, LeafMasks masks,
                                                   const LeafDepths& found, Search& search) const {
    if ((masks.possible & (masks.possible - 1)) == 0) return offer_one(level, leaf, masks, search);
    const LeafDepths in_memory{found};  // or all rays would store `found`, whose address would be passed on
    return offer_several(level, leaf, masks, in_memory, search);
  }

  [[gnu::always_inline]] Offer offer_lane(const Level& level, const TriangleLeaf& leaf, uint32_t lane, bool certain,
                                          Search& search) const {
    const auto hit = intersect(level.ray, leaf, lane, certain, search.t());
    return hit ? search.offer_accepted(rules, leaf.geometry_of(lane), leaf.primitive[lane], *hit) : Offer::rejected;
  }

  [[gnu::noinline]] Offer offer_one(const Level& level, const TriangleLeaf& leaf, LeafMasks masks,
                                    Search& search) const {
    return offer_lane(level, leaf, static_cast<uint32_t>(std::countr_zero(masks.possible)), masks.certain != 0, search);
  }

  [[gnu::noinline]] Offer offer_several(const Level& level, const TriangleLeaf& leaf, LeafMasks masks,
                                        const LeafDepths& found, Search& search) const {
    float nearest[8];
    store_nearest(found, nearest);
    DepthInterval interval = level.depths;
    Offer result = Offer::rejected;
    for (uint32_t left = masks.possible; left != 0;) {
      const uint32_t lane = least_of(left, nearest);
      left &= ~(1u << lane);
      const Offer offer = offer_lane(level, leaf, lane, masks.certain >> lane & 1, search);
      if (offer == Offer::rejected) continue;
      result = offer;
      interval.shorten(search.t());
      left &= ~(masks.certain & depths_beyond(found, interval.outer_far));
    }
    return result;
  }

  static uint32_t least_of(uint32_t lanes, const float (&values)[8]) {
    auto least = static_cast<uint32_t>(std::countr_zero(lanes));
    for (uint32_t left = lanes & (lanes - 1); left != 0; left &= left - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(left));
      if (values[lane] < values[least]) least = lane;
    }
    return least;
  }

  template <class Visitor>
  [[gnu::noinline]] Offer offer_lanes(const Level& level, const TriangleLeaf* leaf, uint32_t possible, uint32_t certain,
                                      Search& search, Visitor& visitor) const {
    uint32_t accepted = 0;
    Offer result = Offer::rejected;
    for (uint32_t left = possible; left != 0 && result != Offer::ended; left &= left - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(left));
      const auto hit = intersect(level.ray, *leaf, lane, certain >> lane & 1, search.t());
      if (!hit) continue;
      accepted |= 1u << lane;
      const Offer offer = search.offer_triangle(rules, leaf->geometry_of(lane), leaf->primitive[lane], *hit, visitor);
      result = std::max(result, offer);
    }
    visitor.on_triangle_leaf(leaf, possible, accepted);
    return result;
  }
};

}  // namespace rayloom::accel::RAYLOOM_LANES
#endif  // target

#undef RAYLOOM_LANES
#ifdef HWY_TARGET_INCLUDE
HWY_AFTER_NAMESPACE();
#endif

#endif  // once a target
