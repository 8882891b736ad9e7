// Rays of neighbouring points that only want to know whether they hit anything, many at once: shadow rays. The answer
// depends on no order, so what they visit may differ from what single rays would. Not for top levels: in instances so
// few rays stay together that one at a time is quicker (docs/performance.md). Only for targets with vectors;
// re-included once per target as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_OCCLUSION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_OCCLUSION_INL_H
#undef RAYLOOM_ACCEL_PACKET_OCCLUSION_INL_H
#else
#define RAYLOOM_ACCEL_PACKET_OCCLUSION_INL_H
#endif
// clang-format on

#include <rayloom/accel/simd/bundle_rays-inl.h>
#include <rayloom/accel/traverse-inl.h>
#include <rayloom/accel/visitor.h>

HWY_BEFORE_NAMESPACE();

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::HWY_NAMESPACE {

/// A packet on its way through a structure of triangles, for PacketsInTurn.
class OcclusionPacket {
 public:
  using Result = uint8_t;
  static constexpr size_t size = BundleRays::size;
  static constexpr size_t most = 8, groups_each = 1;

  OcclusionPacket(AddressSpace, const TraceRequest& shared)
      : shared_(shared), block_(shared.structure), rules_(shared.ray_flags) {}

  HWY_INLINE uint32_t load(const RayRun& group, uint32_t wanted) {
    group_ = group;
    open_ = rays_.load(group, wanted, header_of(block_));
    if (open_ == 0) return 0;
    t_near_ = rays_.near_limit(0);
    t_far_ = rays_.far_limit(rays_.row[0].t_max);
    first_near_ = hn::Set(Floats(), hn::GetLane(hn::MinOfLanes(PacketFloats(), t_near_)));
    last_far_ = hn::Set(Floats(), hn::GetLane(hn::MaxOfLanes(PacketFloats(), t_far_)));
    push(header_of(block_).root, open_);
    return open_;
  }

  bool done() const { return size_ == 0; }

  HWY_INLINE void step() {
    --size_;
    const uint32_t ref = refs_[size_], rays = masks_[size_] & open_;
    if (rays == 0) return;
    const std::byte* const address = block_ + node_ref::offset(ref);
    if (node_ref::is_leaf(ref))
      open_ &= ~hits_in_leaf(*reinterpret_cast<const TriangleLeaf*>(address), rays);
    else
      visit_node(*reinterpret_cast<const Node8*>(address), rays);
    Prefetch{block_}(refs_[size_ - (size_ != 0)]);
  }

  void write(uint32_t rays, uint8_t* results) const {
    for (; rays != 0; rays &= rays - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
      results[ray] = (open_ >> ray & 1) == 0;
    }
  }

 private:
  /// Without a branch: there may be no rays.
  HWY_INLINE void push(uint32_t ref, uint32_t rays) {
    refs_[size_] = ref;
    masks_[size_] = rays;
    size_ += rays != 0;
  }

  HWY_INLINE void visit_node(const Node8& node, uint32_t rays) {
    const PacketBoxHits hits = test_boxes(rays_, node, first_near_, last_far_);
    for (uint32_t left = hits.mask; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      push(node.child[lane], rays & test_child(rays_, rays_.row[0], node, lane, t_near_, t_far_));
    }
  }

  HWY_INLINE uint32_t hits_in_leaf(const TriangleLeaf& leaf, uint32_t rays) const {
    const LeafTriangles triangles = load_triangles(leaf, rays_.axes());
    uint32_t hits = 0;
    for (; rays != 0; rays &= rays - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
      const LeafMasks masks = test_triangles(rays_.lanes(ray), triangles, rays_.depths(ray));
      bool hit = rules_.hits.accepts_all & ((masks.certain & masks.inside) != 0);
      if (HWY_UNLIKELY(!hit & (masks.possible != 0))) hit = hits_alone(group_[ray], leaf, masks);
      hits |= uint32_t{hit} << ray;
    }
    return hits;
  }

  HWY_NOINLINE bool hits_alone(const Ray& ray, const TriangleLeaf& leaf, const LeafMasks& masks) const {
    Search search(shared_, ray);
    Visitor none;
    const Level level(block_, ray, 1, search);
    return TriangleLeaves{rules_}.offer_lanes(level, &leaf, masks.possible, masks.certain, search, none) ==
           Offer::ended;
  }

  const TraceRequest& shared_;
  const std::byte* block_;
  InstanceRules rules_;
  RayRun group_;
  uint32_t open_;                     ///< rays that have hit nothing yet
  uint32_t size_ = 0;                 ///< of the stack
  PacketVector t_near_, t_far_;       ///< limits of each ray, in box space
  FloatLanes first_near_, last_far_;  ///< of all of them
  BundleRays rays_;
  uint32_t refs_[stack_entries], masks_[stack_entries];
};

}  // namespace rayloom::accel::HWY_NAMESPACE
#endif  // target

HWY_AFTER_NAMESPACE();

#endif  // once a target
