// What packets of closest-hit rays of one origin share on their way through any structure: what they have found, what
// they have still to visit, and the step through a node. Only for targets with vectors; re-included once per target as
// traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_WALK_INL_H
#undef RAYLOOM_ACCEL_PACKET_WALK_INL_H
#else
#define RAYLOOM_ACCEL_PACKET_WALK_INL_H
#endif
// clang-format on

#include <rayloom/accel/simd/packet_triangle-inl.h>
#include <rayloom/accel/traverse-inl.h>

HWY_BEFORE_NAMESPACE();

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::HWY_NAMESPACE {

/// What each ray may hit.
struct PacketNames {
  uint32_t instance;
  PacketWordVector geometry, primitive;
};

/// The closest hits of a packet's rays so far. Rays without one have t = t_max and kind 0.
class PacketResults {
 public:
  HWY_INLINE void start(const PencilRays& rays) {
    const PacketWords w;
    for (size_t r = 0; r < PencilRays::rows; ++r) {
      hn::Store(rays.row[r].t_max, PacketFloats(), t_ + r * packet_size);
      for (uint32_t* words : {instance_, geometry_, primitive_, kind_})
        hn::Store(hn::Zero(w), w, words + r * packet_size);
    }
  }

  HWY_INLINE PacketVector t(size_t r) const { return hn::Load(PacketFloats(), t_ + r * packet_size); }

  Hit hit(uint32_t ray) const {
    if (kind_[ray] == 0) return {.t = t_[ray]};
    return {t_[ray], u_[ray], v_[ray], instance_[ray], geometry_[ray], primitive_[ray], kind_[ray], HitType::triangle};
  }
  void write(uint32_t rays, Hit* hits) const {
    for (; rays != 0; rays &= rays - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
      hits[ray] = hit(ray);
    }
  }
  void set(uint32_t ray, const Hit& hit) {
    t_[ray] = hit.t;
    if (!hit) return;
    u_[ray] = hit.u;
    v_[ray] = hit.v;
    instance_[ray] = hit.instance_index;
    geometry_[ray] = hit.geometry_index;
    primitive_[ray] = hit.primitive_index;
    kind_[ray] = hit.hit_kind;
  }

  /// Commits the hits of the rays `offered` of row r that come before what these have found, as
  /// Search::offer_triangle() would; returns those rays. `front`: rays that meet the triangle's front.
  HWY_INLINE uint32_t commit(size_t r, const PacketHits& hits, uint32_t offered, uint32_t front,
                             const PacketNames& names) {
    const PacketVector t = this->t(r);
    uint32_t nearer = offered & packet_bits(hn::Lt(hits.t, t));
    const uint32_t equal = offered & packet_bits(hn::Eq(hits.t, t));
    if (HWY_UNLIKELY(equal != 0)) nearer |= equal & tie_winners(r, names);
    if (nearer == 0) return 0;
    const PacketMask mask = packet_mask(nearer);
    replace(r, t_, hits.t, mask);
    replace(r, u_, hits.u, mask);
    replace(r, v_, hits.v, mask);
    const PacketWords w;
    replace(r, instance_, hn::Set(w, names.instance), mask);
    replace(r, geometry_, names.geometry, mask);
    replace(r, primitive_, names.primitive, mask);
    const auto fronts = hn::RebindMask(w, packet_mask(front));
    replace(r, kind_,
            hn::IfThenElse(fronts, hn::Set(w, hit_kind_triangle_front_face), hn::Set(w, hit_kind_triangle_back_face)),
            mask);
    return nearer;
  }

 private:
  /// A masked store would make the next load wait until it is done.
  template <class T, class V>
  static HWY_INLINE void replace(size_t r, T* values, V by, PacketMask mask) {
    const hn::DFromV<V> d;
    T* const row = values + r * packet_size;
    hn::Store(hn::IfThenElse(hn::RebindMask(d, mask), by, hn::Load(d, row)), d, row);
  }

  /// Rays of a row that have a hit of a larger name.
  HWY_NOINLINE uint32_t tie_winners(size_t r, const PacketNames& names) const {
    const PacketWords w;
    alignas(64) uint32_t geometry[packet_size], primitive[packet_size];
    hn::Store(names.geometry, w, geometry);
    hn::Store(names.primitive, w, primitive);
    uint32_t winners = 0;
    for (uint32_t lane = 0; lane < packet_size; ++lane) {
      const size_t ray = r * packet_size + lane;
      const HitName name{names.instance, geometry[lane], primitive[lane]};
      const bool smaller = name < HitName{instance_[ray], geometry_[ray], primitive_[ray]};
      winners |= uint32_t{kind_[ray] != 0 && smaller} << lane;
    }
    return winners;
  }

  static constexpr size_t size = PencilRays::size;
  alignas(64) float t_[size], u_[size], v_[size];
  alignas(64) uint32_t instance_[size], geometry_[size], primitive_[size], kind_[size];
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

/// A packet on its way through one structure.
class PacketWalk {
 public:
  /// PencilRays::load(): takes on what goes together of the `wanted` rays; returns those rays, 0 if too few do.
  template <class Rays>
  HWY_INLINE uint32_t load(const Rays& rays, uint32_t wanted, const std::byte* block, float pad_scale) {
    block_ = block;
    taken_ = rays_.load(rays, wanted, header_of(block), pad_scale);
    return taken_;
  }

  /// Begins at `start`.
  HWY_INLINE void begin(uint32_t start, const PacketResults& results) {
    for (size_t r = 0; r < rows; ++r) t_near_[r] = rays_.near_limit(r);
    PacketVector first = t_near_[0];
    for (size_t r = 1; r < rows; ++r) first = hn::Min(first, t_near_[r]);
    first_near_ = hn::Set(Floats(), hn::GetLane(hn::MinOfLanes(PacketFloats(), first)));
    shorten(results);
    stack_.insert(0, {start, taken_, 0});
  }
  bool done() const { return stack_.empty(); }

  /// Visits what is nearest of what is left. `leaves.visit(address, rays)` tells whether some ray has found something,
  /// `leaves.finish(ref, rays)` takes few rays through a subtree one by one.
  template <class Leaves>
  HWY_INLINE void step(const PacketResults& results, Leaves& leaves) {
    const PacketStack::Entry entry = stack_.pop();
    const uint32_t rays = entry.rays & rays_beyond(entry.near);
    if (rays == 0) return;
    if (node_ref::is_leaf(entry.ref)) {
      if (leaves.visit(block_ + node_ref::offset(entry.ref), rays)) shorten(results);
    } else if (std::popcount(rays) <= alone) {
      leaves.finish(entry.ref, rays);
      shorten(results);
    } else {
      visit_node(*reinterpret_cast<const Node8*>(block_ + node_ref::offset(entry.ref)), rays);
    }
  }

  template <class Leaves>
  HWY_INLINE void run(uint32_t start, const PacketResults& results, Leaves& leaves) {
    begin(start, results);
    while (!done()) step(results, leaves);
  }

  const std::byte* block() const { return block_; }
  const PencilRays& rays() const { return rays_; }
  FloatLanes deepest() const { return deepest_; }

 private:
  static constexpr size_t rows = PencilRays::rows;
  static constexpr int alone = 1;  ///< so few rays are traced ray by ray

  HWY_INLINE void shorten(const PacketResults& results) {
    for (size_t r = 0; r < rows; ++r)
      t_far_[r] = rays_.far_limit(hn::IfThenElseZero(packet_mask(PencilRays::part_of(taken_, r)), results.t(r)));
    PacketVector farthest = t_far_[0];
    for (size_t r = 1; r < rows; ++r) farthest = hn::Max(farthest, t_far_[r]);
    const float last = hn::GetLane(hn::MaxOfLanes(PacketFloats(), farthest));
    last_far_ = hn::Set(Floats(), last);
    deepest_ = hn::Set(Floats(), last * rays_.depth_scale);
  }

  /// Those that have not hit anything before `near`.
  HWY_INLINE uint32_t rays_beyond(float near) const {
    uint32_t rays = 0;
    for (size_t r = 0; r < rows; ++r) rays |= packet_bits(hn::Le(splat(near), t_far_[r])) << (r * packet_size);
    return rays;
  }

  HWY_INLINE uint32_t rays_inside(const Node8& node, int lane) const {
    uint32_t rays = 0;
    for (size_t r = 0; r < rows; ++r)
      rays |= test_child(rays_, rays_.row[r], node, lane, t_near_[r], t_far_[r]) << (r * packet_size);
    return rays;
  }

  HWY_INLINE void visit_node(const Node8& node, uint32_t rays) {
    const PacketBoxHits hits = test_boxes(rays_, node, first_near_, last_far_);
    alignas(32) float near[8];
    hn::Store(hits.entry, Floats(), near);
    const uint32_t base = stack_.size();
    for (uint32_t left = hits.mask; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const uint32_t inside = rays & rays_inside(node, lane);
      if (inside == 0) continue;
      Prefetch{block_}(node.child[lane]);
      stack_.insert(base, {node.child[lane], inside, near[lane]});
    }
  }

  const std::byte* block_;
  uint32_t taken_;
  PencilRays rays_;
  PacketVector t_near_[rows], t_far_[rows];  ///< limits of each ray, in box space
  FloatLanes first_near_, last_far_;         ///< of all of them
  FloatLanes deepest_;                       ///< no hit in the interval has a larger depth along the dominant axis
  PacketStack stack_;
};

}  // namespace rayloom::accel::HWY_NAMESPACE
#endif  // target

HWY_AFTER_NAMESPACE();

#endif  // once a target
