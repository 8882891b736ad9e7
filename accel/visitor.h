#pragma once

#include <rayloom/accel/layout.h>
#include <rayloom/accel/trace.h>

#include <type_traits>

namespace rayloom::accel {

/// The hooks, all empty. A visitor derives from it and hides the ones it wants; unused ones cost nothing.
/// Pointers lead into the structures (subtract AddressSpace::base for simulated addresses) and live as long as those.
struct Visitor {
  /// A reference taken from the stack; `near`: entry distance in the level's box space. Culled ones are not visited.
  void on_pop(uint32_t /*ref*/, float /*near*/, bool /*culled*/) {}
  /// A node after its box test; near[i] has a meaning for the children of `hit_mask` only.
  void on_node(const Node8*, uint32_t /*hit_mask*/, const float (&/*near*/)[8]) {}
  /// A leaf after its triangles. possible_mask: lanes the float filter could not rule out; hit_mask: lanes hit in
  /// (t_min, t], t the closest so far, whatever opacity, culling and the candidate function made of them.
  void on_triangle_leaf(const TriangleLeaf*, uint32_t /*possible_mask*/, uint32_t /*hit_mask*/) {}
  /// box_mask: lanes whose box was met on entry; offered_mask: those still met when their turn came.
  void on_procedural_leaf(const ProceduralLeaf8*, uint32_t /*box_mask*/, uint32_t /*offered_mask*/) {}
  /// An instance that passes mask and SKIP flags; `object_ray` is what its bottom level is traced with.
  void on_enter_instance(const InstanceRecord*, const Ray& /*object_ray*/) {}
  void on_leave_instance(const InstanceRecord*) {}
  /// After the candidate function has answered; leaf hooks come after those of their candidates.
  void on_candidate(const Candidate&, const Verdict&) {}
};

/// Whether a visitor has a hook for triangles of its own. If not, nobody sees in which order a leaf's come.
template <class V>
concept SeesTriangles = !requires {
  requires std::is_same_v<decltype(&V::on_triangle_leaf), decltype(&Visitor::on_triangle_leaf)>;
};

}  // namespace rayloom::accel
