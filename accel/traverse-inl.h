// The traversal: one template for closest-hit and any-hit rays, top and bottom levels, plain and recording kernels.
//
// Included once for each set of lane tests, like a Highway -inl header: without Highway it takes those of
// simd/lanes_scalar.h, inside a foreach_target pass those of simd/lanes-inl.h for that target. What it visits, and in
// which order, is the same for all of them.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_TRAVERSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_TRAVERSE_INL_H
#undef RAYLOOM_ACCEL_TRAVERSE_INL_H
#else
#define RAYLOOM_ACCEL_TRAVERSE_INL_H
#endif
// clang-format on

#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/prefetch.h>
#include <rayloom/accel/search.h>
#include <rayloom/accel/structure.h>
#include <rayloom/accel/traversal_stack.h>

#include <bit>
#include <optional>
#include <utility>

#ifdef HWY_TARGET_INCLUDE
#include <rayloom/accel/simd/lanes-inl.h>
HWY_BEFORE_NAMESPACE();
#define RAYLOOM_LANES HWY_NAMESPACE
#else
#include <rayloom/accel/simd/lanes_scalar.h>
#define RAYLOOM_LANES scalar
#endif

#if !defined(HWY_TARGET_INCLUDE) || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::RAYLOOM_LANES {

/// A structure as one ray sees it. Distances are in the box space of this level's prepared ray.
struct Level {
  /// pad_scale: see prepare_ray(). Nothing may be traced if ray.valid is false.
  Level(const std::byte* structure, const Ray& unprepared, float pad_scale, const Search& search)
      : block(structure),
        ray(prepare_ray(unprepared, header().bounds_min, header().bounds_max, pad_scale)),
        lanes(ray),
        t_near(ray.near_limit(ray.t_min)) {
    shorten(search);
  }
  void shorten(const Search& search) { t_far = ray.far_limit(search.t()); }
  const StructureHeader& header() const { return header_of(block); }

  const std::byte* block;
  const PreparedRay ray;
  const RayLanes lanes;
  float t_near, t_far;
};

using Child = TraversalStack::Entry;

/// Stacks all children of `mask` but the first, which it returns: each goes straight to the place that its rank gives.
[[gnu::always_inline]] inline Child rank_children(const Node8& node, uint32_t mask, const float (&near)[8],
                                                  bool in_order, Prefetch prefetch, TraversalStack& stack) {
  const auto others = static_cast<uint32_t>(std::popcount(mask)) - 1;
  Child first{};
  for (uint32_t left = mask; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const Child child{node.child[lane], near[lane]};
    prefetch(child.ref);
    const uint32_t before = mask & (in_order ? (1u << lane) - 1 : lanes_before(near, lane));
    if (before == 0) first = child;
    stack.place(others - static_cast<uint32_t>(std::popcount(before)), child);
  }
  stack.grow(others);
  return first;
}

/// The child to visit next of those that the ray meets, at least one; the others go on the stack. Nearest first, equals
/// by lane; in stored order for rays that take any hit, for which Collapse has put the most promising child first.
[[gnu::always_inline]] inline Child first_child(const Node8& node, uint32_t mask, const float (&near)[8], bool in_order,
                                                Prefetch prefetch, TraversalStack& stack) {
  const int lane = std::countr_zero(mask);
  Child first{node.child[lane], near[lane]};
  const uint32_t others = mask & (mask - 1);
  if ((others & (others - 1)) != 0) return rank_children(node, mask, near, in_order, prefetch, stack);
  prefetch(first.ref);
  if (others == 0) return first;
  const int other_lane = std::countr_zero(others);
  Child second{node.child[other_lane], near[other_lane]};
  prefetch(second.ref);
  if (!in_order && second.near < first.near) std::swap(first, second);
  stack.push(second.ref, second.near);
  return first;
}

/// From `ref` down through first children, to a leaf. False where a node has no child that the ray meets.
template <class Visitor>
[[gnu::always_inline]] inline bool descend(const Level& level, bool in_order, uint32_t& ref, TraversalStack& stack,
                                           Visitor& visitor) {
  while (!node_ref::is_leaf(ref)) {
    const auto* node = reinterpret_cast<const Node8*>(level.block + node_ref::offset(ref));
    alignas(32) float near[8];
    const uint32_t mask = test_node(level.lanes, *node, level.t_near, level.t_far, near);
    visitor.on_node(node, mask, near);
    if (mask == 0) return false;
    const Child next = first_child(*node, mask, near, in_order, Prefetch{level.block}, stack);
    ref = next.ref;
    visitor.on_pop(ref, next.near, false);
  }
  return true;
}

/// Depth first over one structure. `leaves.visit(level, address, search, visitor)` tests a leaf. True: search ended.
template <class Leaves, class Visitor>
bool traverse_level(Level& level, const Leaves& leaves, Search& search, Visitor& visitor) {
  const bool in_order = search.request().ray_flags & ray_flag::accept_first_hit_and_end_search;
  TraversalStack stack;
  stack.push(level.header().root, level.t_near);
  while (!stack.empty()) {
    auto [ref, near] = stack.pop();
    const bool culled = near > level.t_far;
    visitor.on_pop(ref, near, culled);
    if (culled || !descend(level, in_order, ref, stack, visitor)) continue;
    const Offer offer = leaves.visit(level, level.block + node_ref::offset(ref), search, visitor);
    if (offer == Offer::ended) return true;
    if (offer == Offer::committed) level.shorten(search);
  }
  return false;
}

struct TriangleLeaves {
  const InstanceRules& rules;

  static std::optional<TriangleHit> intersect(const PreparedRay& ray, const TriangleLeaf8& leaf, int lane, bool certain,
                                              float t_far) {
    float v[3][3];
    for (int vertex = 0; vertex < 3; ++vertex)
      for (int axis = 0; axis < 3; ++axis) v[vertex][axis] = leaf.vertex[vertex][axis][lane];
    return certain ? finish_triangle(ray, v[0], v[1], v[2], t_far) : intersect_triangle(ray, v[0], v[1], v[2], t_far);
  }

  template <class Visitor>
  Offer visit(Level& level, const std::byte* address, Search& search, Visitor& visitor) const {
    const auto* leaf = reinterpret_cast<const TriangleLeaf8*>(address);
    const LeafMasks masks = test_triangles(level.lanes, *leaf);
    uint32_t accepted = 0;
    Offer result = Offer::rejected;
    for (uint32_t left = masks.possible; left != 0 && result != Offer::ended; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const auto hit = intersect(level.ray, *leaf, lane, masks.certain >> lane & 1, search.t());
      if (!hit) continue;
      accepted |= 1u << lane;
      const Offer offer = search.offer_triangle(rules, leaf->geometry[lane], leaf->primitive[lane], *hit, visitor);
      result = std::max(result, offer);
    }
    visitor.on_triangle_leaf(leaf, masks.possible, accepted);
    return result;
  }
};

struct ProceduralLeaves {
  const InstanceRules& rules;

  template <class Visitor>
  Offer visit(Level& level, const std::byte* address, Search& search, Visitor& visitor) const {
    const auto* leaf = reinterpret_cast<const ProceduralLeaf8*>(address);
    const uint32_t met = test_boxes(level.lanes, *leaf, level.t_near, level.t_far);
    uint32_t asked = 0;
    Offer result = Offer::rejected;
    for (uint32_t left = met; left != 0 && result != Offer::ended; left &= left - 1) {
      const int lane = std::countr_zero(left);
      asked |= 1u << lane;
      const Offer offer = search.offer_procedural(rules, leaf->geometry[lane], leaf->primitive[lane], visitor);
      result = std::max(result, offer);
      if (offer != Offer::committed) continue;
      level.shorten(search);
      left &= test_boxes(level.lanes, *leaf, level.t_near, level.t_far) | 1u << lane;
    }
    visitor.on_procedural_leaf(leaf, met, asked);
    return result;
  }
};

/// Whether the ray may find anything in a bottom level of this kind (RF-14, RF-15).
inline bool wants(const TraceRequest& request, const StructureHeader& header) {
  if (header.root == no_index) return false;
  if (header.kind == StructureKind::triangles) return !(request.ray_flags & ray_flag::skip_triangles);
  return !(request.ray_flags & ray_flag::skip_procedural_primitives) && request.candidate;
}

template <class Visitor>
bool traverse_bottom(const std::byte* block, const Ray& ray, const InstanceRules& rules, Search& search,
                     Visitor& visitor) {
  Level level(block, ray, 1, search);
  if (!level.ray.valid) return false;
  if (level.header().kind == StructureKind::triangles)
    return traverse_level(level, TriangleLeaves{rules}, search, visitor);
  return traverse_level(level, ProceduralLeaves{rules}, search, visitor);
}

struct InstanceLeaves {
  AddressSpace addresses;

  template <class Visitor>
  Offer visit(Level&, const std::byte* address, Search& search, Visitor& visitor) const {
    const auto* instance = reinterpret_cast<const InstanceRecord*>(address);
    const TraceRequest& request = search.request();
    const std::byte* block = addresses.host(instance->bottom_level_address);
    if ((instance->id_and_mask >> 24 & request.instance_mask) == 0 || !wants(request, header_of(block)))
      return Offer::rejected;
    const Ray ray = object_ray(*instance, request.ray);
    const InstanceRules rules(instance->instance_index, instance->contribution_and_flags >> 24, request.ray_flags,
                              address);
    visitor.on_enter_instance(instance, ray);
    const bool ended = traverse_bottom(block, ray, rules, search, visitor);
    visitor.on_leave_instance(instance);
    return ended ? Offer::ended : Offer::committed;
  }
};

template <class Visitor>
Hit traverse(AddressSpace addresses, const TraceRequest& request, Visitor& visitor) {
  Search search(request);
  if (!request.structure) return search.hit();
  const StructureHeader& header = header_of(request.structure);
  if (header.root == no_index) return search.hit();
  if (header.kind != StructureKind::instances) {
    const InstanceRules rules(0, 0, request.ray_flags, nullptr);
    if (wants(request, header)) traverse_bottom(request.structure, request.ray, rules, search, visitor);
    return search.hit();
  }
  Level level(request.structure, request.ray, header.pad_scale, search);
  if (level.ray.valid) traverse_level(level, InstanceLeaves{addresses}, search, visitor);
  return search.hit();
}

}  // namespace rayloom::accel::RAYLOOM_LANES
#endif  // target

#undef RAYLOOM_LANES
#ifdef HWY_TARGET_INCLUDE
HWY_AFTER_NAMESPACE();
#endif

#endif  // once a target
