// Coherent closest-hit rays, many at once through one structure of triangles: a node is fetched and its children are
// ordered once for all of them. What a packet visits differs from what its rays would visit alone; what it finds does
// not, because hits are exact and totally ordered (G1, G3b). Only for targets with vectors; re-included once per target
// as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_INL_H
#undef RAYLOOM_ACCEL_PACKET_INL_H
#else
#define RAYLOOM_ACCEL_PACKET_INL_H
#endif
// clang-format on

#include <rayloom/accel/simd/packet_triangle-inl.h>
#include <rayloom/accel/traverse-inl.h>
#include <rayloom/accel/visitor.h>

HWY_BEFORE_NAMESPACE();

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::HWY_NAMESPACE {

/// The closest hits of a packet's rays so far. Rays without one have t = t_max and kind 0.
class PacketResults {
 public:
  HWY_INLINE void start(const PacketRays& rays) {
    const PacketWords w;
    hn::Store(rays.t_max, PacketFloats(), t_);
    for (uint32_t* words : {geometry_, primitive_, kind_}) hn::Store(hn::Zero(w), w, words);
  }

  HWY_INLINE PacketVector t() const { return hn::Load(PacketFloats(), t_); }

  Hit hit(uint32_t ray) const {
    if (kind_[ray] == 0) return {.t = t_[ray]};
    return {t_[ray], u_[ray], v_[ray], 0, geometry_[ray], primitive_[ray], kind_[ray], HitType::triangle};
  }
  void set(uint32_t ray, const Hit& hit) {
    t_[ray] = hit.t;
    if (!hit) return;
    u_[ray] = hit.u;
    v_[ray] = hit.v;
    geometry_[ray] = hit.geometry_index;
    primitive_[ray] = hit.primitive_index;
    kind_[ray] = hit.hit_kind;
  }

  /// Commits the hits of the rays `offered` that come before what these have found, as Search::offer_triangle() would;
  /// returns those rays.
  HWY_INLINE uint32_t commit(const PacketHits& hits, uint32_t offered, uint32_t geometry, uint32_t primitive) {
    const PacketFloats d;
    const PacketVector t = this->t();
    uint32_t nearer = offered & packet_bits(hn::Lt(hits.t, t));
    const uint32_t equal = offered & packet_bits(hn::Eq(hits.t, t));
    if (HWY_UNLIKELY(equal != 0)) nearer |= equal & tie_winners(geometry, primitive);
    if (nearer == 0) return 0;
    const PacketMask mask = packet_mask(nearer);
    replace(t_, hits.t, mask);
    replace(u_, hits.u, mask);
    replace(v_, hits.v, mask);
    const PacketWords w;
    replace(geometry_, hn::Set(w, geometry), mask);
    replace(primitive_, hn::Set(w, primitive), mask);
    const auto front = hn::RebindMask(w, packet_mask(hits.front));
    replace(kind_,
            hn::IfThenElse(front, hn::Set(w, hit_kind_triangle_front_face), hn::Set(w, hit_kind_triangle_back_face)),
            mask);
    return nearer;
  }

 private:
  /// A masked store would make the next load wait until it is done.
  template <class T, class V>
  static HWY_INLINE void replace(T* values, V by, PacketMask mask) {
    const hn::DFromV<V> d;
    hn::Store(hn::IfThenElse(hn::RebindMask(d, mask), by, hn::Load(d, values)), d, values);
  }

  /// Rays that have a hit of a larger name.
  uint32_t tie_winners(uint32_t geometry, uint32_t primitive) const {
    uint32_t winners = 0;
    for (uint32_t ray = 0; ray < packet_size; ++ray) {
      const bool smaller = geometry < geometry_[ray] || (geometry == geometry_[ray] && primitive < primitive_[ray]);
      winners |= uint32_t{kind_[ray] != 0 && smaller} << ray;
    }
    return winners;
  }

  alignas(64) float t_[packet_size], u_[packet_size], v_[packet_size];
  alignas(64) uint32_t geometry_[packet_size], primitive_[packet_size], kind_[packet_size];
};

/// What a packet has still to visit, the nearest on top. The members of entries lie apart, since a load of several
/// would wait for the stores of each.
class PacketStack {
 public:
  struct Entry {
    uint32_t ref, rays;
    float near;
  };
  bool empty() const { return size_ == 0; }
  uint32_t size() const { return size_; }
  HWY_INLINE Entry pop() {
    --size_;
    return {refs_[size_], rays_[size_], nears_[size_]};
  }
  /// Above `base`, below the nearer ones.
  HWY_INLINE void insert(uint32_t base, const Entry& entry) {
    uint32_t i = size_++;
    for (; i > base && nears_[i - 1] < entry.near; --i) {
      refs_[i] = refs_[i - 1];
      rays_[i] = rays_[i - 1];
      nears_[i] = nears_[i - 1];
    }
    refs_[i] = entry.ref;
    rays_[i] = entry.rays;
    nears_[i] = entry.near;
  }

 private:
  uint32_t size_ = 0;
  uint32_t refs_[stack_entries], rays_[stack_entries];
  float nears_[stack_entries];
};

/// Traces packets of a run of rays, one after another.
class PacketTask {
 public:
  /// The rays have no candidate function, want the closest hit and may find something in a structure of triangles.
  HWY_INLINE explicit PacketTask(const RayRun& rays)
      : run_(rays), block_(rays.shared->structure), rules_(0, 0, rays.shared->ray_flags, nullptr) {}

  /// Traces what goes together of the packet_size rays from `first` on. Returns those that are left.
  uint32_t trace(size_t first, Hit* hits) {
    group_ = run_.part(first, packet_size);
    uint32_t left = all_rays;
    while (left != 0) {
      const uint32_t taken = rays_.load(group_, left, header_of(block_));
      if (taken == 0) break;
      start(taken);
      run();
      for (uint32_t rays = taken; rays != 0; rays &= rays - 1) {
        const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
        hits[ray] = results_.hit(ray);
      }
      left &= ~taken;
    }
    return left;
  }

 private:
  static constexpr int alone = 1;  ///< so few rays are traced ray by ray

  void start(uint32_t taken) {
    prepared_ = 0;
    results_.start(rays_);
    t_near_ = rays_.near_limit();
    first_near_ = hn::Set(Floats(), hn::GetLane(hn::MinOfLanes(PacketFloats(), t_near_)));
    shorten();
    stack_.insert(0, {header_of(block_).root, taken, 0});
  }

  void run() {
    while (!stack_.empty()) {
      const PacketStack::Entry entry = stack_.pop();
      const uint32_t rays = entry.rays & packet_bits(hn::Le(splat(entry.near), t_far_));
      if (rays == 0) continue;
      if (node_ref::is_leaf(entry.ref))
        visit_leaf(*reinterpret_cast<const TriangleLeaf*>(address(entry.ref)), rays);
      else if (std::popcount(rays) <= alone)
        finish_alone(entry.ref, rays);
      else
        visit_node(*reinterpret_cast<const Node8*>(address(entry.ref)), rays);
    }
  }

  const std::byte* address(uint32_t ref) const { return block_ + node_ref::offset(ref); }

  HWY_INLINE void shorten() {
    t_far_ = rays_.far_limit(results_.t());
    const float last = hn::GetLane(hn::MaxOfLanes(PacketFloats(), t_far_));
    last_far_ = hn::Set(Floats(), last);
    deepest_ = hn::Set(Floats(), last * rays_.depth_scale);
  }

  HWY_INLINE void visit_node(const Node8& node, uint32_t rays) {
    const PacketBoxHits hits = test_boxes(rays_, node, first_near_, last_far_);
    alignas(32) float near[8];
    hn::Store(hits.entry, Floats(), near);
    const uint32_t base = stack_.size();
    for (uint32_t left = hits.mask; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const uint32_t inside = rays & test_child(rays_, node, lane, t_near_, t_far_);
      if (inside == 0) continue;
      if (node_ref::is_leaf(node.child[lane])) Prefetch{block_}(node.child[lane]);
      stack_.insert(base, {node.child[lane], inside, near[lane]});
    }
  }

  HWY_INLINE void visit_leaf(const TriangleLeaf& leaf, uint32_t rays) {
    uint32_t committed = 0;
    PacketLeaf packet_leaf;
    for (uint32_t left = packet_leaf.load(rays_, leaf, deepest_); left != 0; left &= left - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(left));
      const PacketMasks masks = test_triangle(rays_, packet_leaf, lane, rays, results_.t());
      if ((masks.certain | masks.undecided) == 0) continue;
      if (rules_.outcome_of(leaf.geometry_of(lane)) == Outcome::cull) continue;
      committed |= visit_triangle(leaf, lane, masks);
    }
    if (committed != 0) shorten();
  }

  /// Returns the rays of which it has become the closest hit.
  HWY_INLINE uint32_t visit_triangle(const TriangleLeaf& leaf, uint32_t lane, const PacketMasks& masks) {
    uint32_t committed = 0, one_by_one = masks.undecided;
    if (HWY_LIKELY(masks.certain != 0)) {
      const PacketHits hits = hit_triangle(rays_, PacketCorners(leaf, lane), masks.certain);
      one_by_one |= masks.certain & ~hits.known;
      const PacketMask finite = hn::Le(hits.t, splat(std::numeric_limits<float>::max()));
      uint32_t offered = masks.certain & hits.known & packet_bits(hn::And(hn::Gt(hits.t, rays_.t_min), finite));
      if (rules_.culled_facing[true]) offered &= ~hits.front;
      if (rules_.culled_facing[false]) offered &= hits.front;
      committed = results_.commit(hits, offered, geometry_index(leaf.geometry_of(lane)), leaf.primitive[lane]);
    }
    for (; HWY_UNLIKELY(one_by_one != 0); one_by_one &= one_by_one - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(one_by_one));
      committed |= uint32_t{offer_alone(ray, leaf, lane, masks.certain >> ray & 1)} << ray;
    }
    return committed;
  }

  HWY_NOINLINE bool offer_alone(uint32_t ray, const TriangleLeaf& leaf, uint32_t lane, bool certain) {
    Search search(*run_.shared, group_[ray], results_.hit(ray));
    Visitor none;
    const PreparedRay& prepared = level_of(ray, search).ray;
    const auto hit = TriangleLeaves::intersect(prepared, leaf, lane, certain, search.t());
    if (!hit) return false;
    if (search.offer_triangle(rules_, leaf.geometry_of(lane), leaf.primitive[lane], *hit, none) == Offer::rejected)
      return false;
    results_.set(ray, search.hit());
    return true;
  }

  /// Finishes a subtree ray by ray.
  HWY_NOINLINE void finish_alone(uint32_t ref, uint32_t rays) {
    for (; rays != 0; rays &= rays - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
      Search search(*run_.shared, group_[ray], results_.hit(ray));
      Level& level = level_of(ray, search);
      Visitor none;
      level.shorten(search);
      traverse_subtree<Order::distance>(level, ref, TriangleLeaves{rules_}, search, none);
      results_.set(ray, search.hit());
    }
    shorten();
  }

  Level& level_of(uint32_t ray, const Search& search) {
    if ((prepared_ >> ray & 1) == 0) std::construct_at(&levels_[ray], block_, group_[ray], 1.0f, search);
    prepared_ |= 1u << ray;
    return levels_[ray];
  }

  RayRun run_;
  const std::byte* block_;
  InstanceRules rules_;

  RayRun group_;  ///< where the packet's rays are
  PacketRays rays_;
  PacketResults results_;
  PacketVector t_near_, t_far_;       ///< limits of each ray, in box space
  FloatLanes first_near_, last_far_;  ///< of all of them
  FloatLanes deepest_;                ///< no hit in the interval has a larger depth along the dominant axis
  uint32_t prepared_;                 ///< rays whose level has been made
  Level levels_[packet_size];
  PacketStack stack_;
};

}  // namespace rayloom::accel::HWY_NAMESPACE
#endif  // target

HWY_AFTER_NAMESPACE();

#endif  // once a target
