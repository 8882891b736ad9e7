// The traversal: one template for closest-hit and any-hit rays, top and bottom levels, plain and recording kernels.
//
// Included once for each set of lane tests, like a Highway -inl header: without Highway it takes those of
// simd/lanes_scalar.h, inside a foreach_target pass those of simd/lanes-inl.h for that target. What it visits, and in
// which order, is the same for all of them, but for a leaf's triangles where nobody sees their order.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_TRAVERSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_TRAVERSE_INL_H
#undef RAYLOOM_ACCEL_TRAVERSE_INL_H
#else
#define RAYLOOM_ACCEL_TRAVERSE_INL_H
#endif
// clang-format on

#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/lazy_part.h>
#include <rayloom/accel/prefetch.h>
#include <rayloom/accel/ray_run.h>
#include <rayloom/accel/traversal_stack.h>
#include <rayloom/accel/triangle_leaves-inl.h>

#include <bit>
#include <utility>

#ifdef HWY_TARGET_INCLUDE
#include <rayloom/accel/simd/children-inl.h>
HWY_BEFORE_NAMESPACE();
#define RAYLOOM_LANES HWY_NAMESPACE
#else
#include <rayloom/accel/simd/children_scalar.h>
#define RAYLOOM_LANES scalar
#endif

#if !defined(HWY_TARGET_INCLUDE) || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::RAYLOOM_LANES {

using Child = TraversalStack::Entry;

/// The order in which a ray visits children: promising first for rays that take any hit, else nearest first.
enum class Order : uint8_t { stored, distance };

template <Order order>
[[gnu::always_inline]] inline void push_children(const NodeHits& hits, const Node8& node, TraversalStack& stack) {
  if constexpr (order == Order::stored)
    push_in_order(hits, node, stack);
  else
    push_by_distance(hits, node, stack);
}

/// Pushes all children met but the one to visit next, which it returns.
template <Order order>
[[gnu::always_inline]] inline Child push_others(const NodeHits& hits, const Node8& node, TraversalStack& stack) {
  if constexpr (order == Order::stored) {
    push_in_order(hits, node, stack);
    return stack.pop();
  } else {
    const Child first = nearest_child(hits, node);
    push_by_distance(hits, node, stack);
    stack.pop();
    return first;
  }
}

[[gnu::always_inline]] inline void prefetch_children(uint32_t mask, const Node8& node, Prefetch prefetch) {
  for (uint32_t left = mask; left != 0; left &= left - 1) prefetch(node.child[std::countr_zero(left)]);
}

/// The child to visit next of those that the ray meets, at least one; the others go on the stack. What push_children()
/// and a pop do, without the stack for one child and without sorting for two.
template <Order order>
[[gnu::always_inline]] inline Child first_child(const NodeHits& hits, const Node8& node, const float (&near)[8],
                                                Prefetch prefetch, TraversalStack& stack) {
  if (hits.mask == 0) __builtin_unreachable();
  prefetch_children(hits.mask, node, prefetch);
  const int lane = std::countr_zero(hits.mask);
  Child first{node.child[lane], near[lane]};
  const uint32_t others = hits.mask & (hits.mask - 1);
  if (others == 0) return first;
  if ((others & (others - 1)) != 0) return push_others<order>(hits, node, stack);
  const int other_lane = std::countr_zero(others);
  Child second{node.child[other_lane], near[other_lane]};
  if (order == Order::stored || second.near < first.near) std::swap(first, second);
  stack.push(second.ref, second.near);
  return first;
}

/// From `ref` down through first children, to a leaf. False where a node has no child that the ray meets.
template <Order order, class Visitor>
[[gnu::always_inline]] inline bool descend(const Level& level, const BoxLanes& lanes, uint32_t& ref,
                                           TraversalStack& stack, Visitor& visitor) {
  while (!node_ref::is_leaf(ref)) {
    const Node8& node = level.node(ref);
    const NodeHits hits = test_node(lanes, node, level.t_near, level.t_far);
    alignas(32) float near[8];
    hits.store_near(near);
    visitor.on_node(&node, hits.mask, near);
    if (hits.mask == 0) return false;
    const Child next = first_child<order>(hits, node, near, Prefetch{level.block}, stack);
    ref = next.ref;
    visitor.on_pop(ref, next.near, false);
  }
  return true;
}

/// Takes from the stack until something is not beyond what has been found. False: nothing is left.
template <Order order, class Visitor>
[[gnu::always_inline]] inline bool pop_near(const Level& level, TraversalStack& stack, uint32_t& ref,
                                            Visitor& visitor) {
  while (!stack.empty()) {
    const TraversalStack::Entry top = stack.pop();
    const bool culled = order == Order::distance && top.near > level.t_far;
    visitor.on_pop(top.ref, top.near, culled);
    ref = top.ref;
    if (!culled) return true;
  }
  return false;
}

/// The next leaf that the ray meets. False: there is none.
template <Order order, class Visitor>
[[gnu::always_inline]] inline bool next_leaf(const Level& level, TraversalStack& stack, uint32_t& leaf,
                                             Visitor& visitor) {
  if (!pop_near<order>(level, stack, leaf, visitor)) return false;
  if (node_ref::is_leaf(leaf)) return true;
  const BoxLanes lanes(level.ray);
  do {
    if (descend<order>(level, lanes, leaf, stack, visitor)) return true;
  } while (pop_near<order>(level, stack, leaf, visitor));
  return false;
}

/// Depth first from a node or leaf of one structure. `leaves.visit(level, address, search, visitor)` tests a
/// leaf. True: search ended.
template <Order order, class Leaves, class Visitor>
bool traverse_subtree(Level& level, uint32_t from, const Leaves& leaves, Search& search, Visitor& visitor) {
  TraversalStack stack;
  stack.push(from, level.t_near);
  for (uint32_t leaf; next_leaf<order>(level, stack, leaf, visitor);) {
    const Offer offer = leaves.visit(level, level.block + node_ref::offset(leaf), search, visitor);
    if (offer == Offer::ended) return true;
    if (offer == Offer::committed) level.shorten(search);
  }
  return false;
}

/// The same with the order that the ray's flags ask for.
template <class Leaves, class Visitor>
bool traverse_ordered(Level& level, uint32_t start, const Leaves& leaves, Search& search, Visitor& visitor) {
  if (search.request().ray_flags & ray_flag::accept_first_hit_and_end_search)
    return traverse_subtree<Order::stored>(level, start, leaves, search, visitor);
  return traverse_subtree<Order::distance>(level, start, leaves, search, visitor);
}

struct ProceduralLeaves {
  const InstanceRules& rules;

  template <class Visitor>
  Offer visit(Level& level, const std::byte* address, Search& search, Visitor& visitor) const {
    const auto* leaf = reinterpret_cast<const ProceduralLeaf8*>(address);
    const BoxLanes lanes(level.ray);
    const uint32_t met = test_boxes(lanes, *leaf, level.t_near, level.t_far);
    uint32_t asked = 0;
    Offer result = Offer::rejected;
    for (uint32_t left = met; left != 0 && result != Offer::ended; left &= left - 1) {
      const int lane = std::countr_zero(left);
      asked |= 1u << lane;
      const Offer offer = search.offer_procedural(rules, leaf->geometry[lane], leaf->primitive[lane], visitor);
      result = std::max(result, offer);
      if (offer != Offer::committed) continue;
      level.shorten(search);
      left &= test_boxes(lanes, *leaf, level.t_near, level.t_far) | 1u << lane;
    }
    visitor.on_procedural_leaf(leaf, met, asked);
    return result;
  }
};

/// Leaves of the tree above the parts of a lazy structure.
struct LazyLeaves {
  const InstanceRules& rules;

  template <class Visitor>
  Offer visit(Level& level, const std::byte* stub, Search& search, Visitor& visitor) const {
    const uint32_t root = lazy_part_root(level.block, stub);
    const bool ended = traverse_ordered(level, root, TriangleLeaves{rules}, search, visitor);
    return ended ? Offer::ended : Offer::committed;
  }
};

/// Where rays start. `lazy`: kernels that also enter lazy structures; others take them for empty ones.
template <bool lazy>
inline uint32_t start_of(const StructureHeader& header) {
  return lazy ? root_of(header) : header.root;
}

/// Whether the ray may find anything in a bottom level of this kind (RF-14, RF-15).
template <bool lazy = false>
inline bool wants(const TraceRequest& request, const StructureHeader& header) {
  if (start_of<lazy>(header) == no_index) return false;
  if (header.kind == StructureKind::triangles) return !(request.ray_flags & ray_flag::skip_triangles);
  return !(request.ray_flags & ray_flag::skip_procedural_primitives) && request.candidate;
}

template <bool lazy = false, class Visitor>
bool traverse_bottom(const std::byte* block, uint32_t start, const Ray& ray, const InstanceRules& rules, Search& search,
                     Visitor& visitor) {
  Level level;
  level.start(block, BoundsLanes(header_of(block), 1), ray, search);
  if (!level.ray.valid) return false;
  if (lazy && is_lazy(level.header())) return traverse_ordered(level, start, LazyLeaves{rules}, search, visitor);
  if (level.header().kind == StructureKind::triangles)
    return traverse_ordered(level, start, TriangleLeaves{rules}, search, visitor);
  return traverse_ordered(level, start, ProceduralLeaves{rules}, search, visitor);
}

template <bool lazy = false>
inline bool passes(const InstanceRecord& instance, const TraceRequest& request, const StructureHeader& bottom_level) {
  return (instance.id_and_mask >> 24 & request.instance_mask) != 0 && wants<lazy>(request, bottom_level);
}

template <bool lazy = false>
inline uint32_t entry_of(const InstanceRecord& instance, const StructureHeader& bottom_level) {
  return instance.entry != 0 ? instance.entry : start_of<lazy>(bottom_level);
}

/// Makes the rules in an instance, in place. `plain`: those in one without flags.
inline void set_rules(InstanceRules& rules, const InstanceRecord& instance, const TraceRequest& request,
                      const HitRules& plain) {
  const uint32_t flags = instance.contribution_and_flags >> 24;
  rules.hits = flags == 0 ? plain : HitRules(flags, request.ray_flags);
  rules.instance_index = instance.instance_index;
  rules.instance = reinterpret_cast<const std::byte*>(&instance);
}

template <bool lazy>
struct InstanceLeavesOf {
  AddressSpace addresses;
  InstanceRules plain;  ///< of instances without flags

  template <class Visitor>
  Offer visit(const Level&, const std::byte* address, Search& search, Visitor& visitor) const {
    const auto* instance = reinterpret_cast<const InstanceRecord*>(address);
    const TraceRequest& request = search.request();
    const std::byte* block = addresses.host(instance->bottom_level_address);
    if (!passes<lazy>(*instance, request, header_of(block))) return Offer::rejected;
    Ray ray;
    object_ray_lanes(*instance, search.ray(), ray);
    InstanceRules rules;
    set_rules(rules, *instance, request, plain.hits);
    visitor.on_enter_instance(instance, ray);
    const uint32_t start = entry_of<lazy>(*instance, header_of(block));
    const bool ended = traverse_bottom<lazy>(block, start, ray, rules, search, visitor);
    visitor.on_leave_instance(instance);
    return ended ? Offer::ended : Offer::committed;
  }
};

using InstanceLeaves = InstanceLeavesOf<false>;

/// In simd/lazy_highway.cpp and lazy_scalar.cpp, apart from the kernels for ordinary structures: compiled together,
/// each would make the other slower.
Hit trace_lazily(AddressSpace addresses, const TraceRequest& request);
void trace_lazily(AddressSpace addresses, const RayRun& rays, Hit* hits);
void occlude_lazily(AddressSpace addresses, const RayRun& rays, uint8_t* results);

template <bool lazy = false, class Visitor>
Hit traverse(AddressSpace addresses, const TraceRequest& request, Visitor& visitor) {
  Search search(request);
  if (!request.structure) return search.hit();
  const StructureHeader& header = header_of(request.structure);
  const uint32_t start = start_of<lazy>(header);
  if (start == no_index) return !lazy && is_lazy(header) ? trace_lazily(addresses, request) : search.hit();
  const InstanceRules rules(request.ray_flags);
  if (header.kind != StructureKind::instances) {
    if (wants<lazy>(request, header))
      traverse_bottom<lazy>(request.structure, start, request.ray, rules, search, visitor);
    return search.hit();
  }
  Level level(request.structure, request.ray, header.pad_scale, search);
  if (level.ray.valid) traverse_ordered(level, start, InstanceLeavesOf<lazy>{addresses, rules}, search, visitor);
  return search.hit();
}

}  // namespace rayloom::accel::RAYLOOM_LANES
#endif  // target

#undef RAYLOOM_LANES
#ifdef HWY_TARGET_INCLUDE
HWY_AFTER_NAMESPACE();
#endif

#endif  // once a target
