// Coherent closest-hit rays of one origin, many at once through a structure of triangles: a node is fetched and its
// children are ordered once for all of them. What a packet visits differs from what its rays would visit alone; what it
// finds does not, because hits are exact and totally ordered (G1, G3b). Only for targets with vectors; re-included once
// per target as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_INL_H
#undef RAYLOOM_ACCEL_PACKET_INL_H
#else
#define RAYLOOM_ACCEL_PACKET_INL_H
#endif
// clang-format on

#include <rayloom/accel/packet_walk-inl.h>
#include <rayloom/accel/visitor.h>

HWY_BEFORE_NAMESPACE();

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::HWY_NAMESPACE {

/// Takes packets through bottom levels of triangles.
class PacketTriangles {
 public:
  HWY_INLINE PacketTriangles(const TraceRequest& shared, PacketResults& results) : shared_(shared), results_(results) {}

  /// Traces what goes together of the `wanted` rays of a group, which are in the structure's space, from `start` on.
  /// Returns those that are left.
  uint32_t trace(const RayRun& group, uint32_t wanted, const std::byte* block, uint32_t start,
                 const InstanceRules& rules) {
    group_ = group;
    rules_ = rules;
    while (wanted != 0) {
      const uint32_t taken = walk_.load(group, wanted, block, 1);
      if (taken == 0) break;
      prepared_ = 0;
      walk_.run(start, results_, *this);
      wanted &= ~taken;
    }
    return wanted;
  }

  HWY_INLINE bool visit(const std::byte* address, uint32_t rays) {
    const auto& leaf = *reinterpret_cast<const TriangleLeaf*>(address);
    uint32_t committed = 0;
    PacketLeaf packet_leaf;
    for (uint32_t left = packet_leaf.load(walk_.rays(), leaf, walk_.deepest()); left != 0; left &= left - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(left));
      const PacketMasks masks = test_triangle(walk_.rays(), packet_leaf, lane, rays, results_.t());
      if ((masks.certain | masks.undecided) == 0) continue;
      if (rules_.outcome_of(leaf.geometry_of(lane)) == Outcome::cull) continue;
      committed |= visit_triangle(leaf, lane, masks);
    }
    return committed != 0;
  }

  /// Finishes a subtree ray by ray.
  HWY_NOINLINE void finish(uint32_t ref, uint32_t rays) {
    for (; rays != 0; rays &= rays - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
      Search search(shared_, group_[ray], results_.hit(ray));
      Level& level = level_of(ray, search);
      Visitor none;
      level.shorten(search);
      traverse_subtree<Order::distance>(level, ref, TriangleLeaves{rules_}, search, none);
      results_.set(ray, search.hit());
    }
  }

 private:
  /// Returns the rays of which it has become the closest hit.
  HWY_INLINE uint32_t visit_triangle(const TriangleLeaf& leaf, uint32_t lane, const PacketMasks& masks) {
    uint32_t committed = 0, one_by_one = masks.undecided;
    if (HWY_LIKELY(masks.certain != 0)) {
      const PencilRays& rays = walk_.rays();
      const PacketHits hits = hit_triangle(rays, PacketCorners(leaf, lane), masks.certain);
      one_by_one |= masks.certain & ~hits.known;
      const uint32_t front = rules_.hits.swap_facing ? ~hits.front & all_rays : hits.front;
      const PacketMask finite = hn::Le(hits.t, splat(std::numeric_limits<float>::max()));
      uint32_t offered = masks.certain & hits.known & packet_bits(hn::And(hn::Gt(hits.t, rays.t_min), finite));
      if (rules_.hits.culled_facing[true]) offered &= ~front;
      if (rules_.hits.culled_facing[false]) offered &= front;
      const HitName name{rules_.instance_index, geometry_index(leaf.geometry_of(lane)), leaf.primitive[lane]};
      committed = results_.commit(hits, offered, front, name);
    }
    for (; HWY_UNLIKELY(one_by_one != 0); one_by_one &= one_by_one - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(one_by_one));
      committed |= uint32_t{offer_alone(ray, leaf, lane, masks.certain >> ray & 1)} << ray;
    }
    return committed;
  }

  HWY_NOINLINE bool offer_alone(uint32_t ray, const TriangleLeaf& leaf, uint32_t lane, bool certain) {
    Search search(shared_, group_[ray], results_.hit(ray));
    Visitor none;
    const PreparedRay& prepared = level_of(ray, search).ray;
    const auto hit = TriangleLeaves::intersect(prepared, leaf, lane, certain, search.t());
    if (!hit) return false;
    if (search.offer_triangle(rules_, leaf.geometry_of(lane), leaf.primitive[lane], *hit, none) == Offer::rejected)
      return false;
    results_.set(ray, search.hit());
    return true;
  }

  Level& level_of(uint32_t ray, const Search& search) {
    if ((prepared_ >> ray & 1) == 0) std::construct_at(&levels_[ray], walk_.block(), group_[ray], 1.0f, search);
    prepared_ |= 1u << ray;
    return levels_[ray];
  }

  const TraceRequest& shared_;
  PacketResults& results_;
  RayRun group_;  ///< where the rays are
  InstanceRules rules_;
  PacketWalk walk_;
  uint32_t prepared_;  ///< rays whose level has been made
  Level levels_[packet_size];
};

/// Traces packets of a run of rays that have no candidate function, want the closest hit and may find something in a
/// structure of triangles.
class TrianglePackets {
 public:
  TrianglePackets(AddressSpace, const RayRun& rays) : run_(rays), triangles_(*rays.shared, results_) {}

  /// Traces what goes together of the packet_size rays from `first` on. Returns those that are left.
  uint32_t trace(size_t first, Hit* hits) {
    const RayRun group = run_.part(first, packet_size);
    const std::byte* const block = run_.shared->structure;
    results_.start(group);
    const uint32_t left = triangles_.trace(group, all_rays, block, header_of(block).root, rules_);
    results_.write(all_rays & ~left, hits);
    return left;
  }

 private:
  RayRun run_;
  InstanceRules rules_{0, 0, run_.shared->ray_flags, nullptr};
  PacketResults results_;
  PacketTriangles triangles_;
};

}  // namespace rayloom::accel::HWY_NAMESPACE
#endif  // target

HWY_AFTER_NAMESPACE();

#endif  // once a target
