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

  /// Traces what goes together of the `wanted` rays from `start` on. Returns those that are left.
  uint32_t trace(const PencilRays::InInstance& rays, uint32_t wanted, const std::byte* block, uint32_t start,
                 const InstanceRules& rules) {
    while (wanted != 0) {
      const uint32_t taken = load(rays, wanted, block, rules);
      if (taken == 0) break;
      begin(start);
      while (!done()) step();
      wanted &= ~taken;
    }
    return wanted;
  }

  /// The same in steps, of rays that go together at once. Returns those; 0: there is nothing to do.
  template <class Rays>
  HWY_INLINE uint32_t load(const Rays& rays, uint32_t wanted, const std::byte* block, const InstanceRules& rules) {
    rules_ = rules;
    prepared_ = 0;
    return walk_.load(rays, wanted, block, 1);
  }
  const PencilRays& rays() const { return walk_.rays(); }
  HWY_INLINE void begin(uint32_t start) { walk_.begin(start, results_); }
  bool done() const { return walk_.done(); }
  HWY_INLINE void step() { walk_.step(results_, *this); }

  HWY_INLINE bool visit(const std::byte* address, uint32_t rays) {
    const auto& leaf = *reinterpret_cast<const TriangleLeaf*>(address);
    uint32_t committed = 0;
    CertainRays certain[rows];
    PacketLeaf packet_leaf;
    for (uint32_t left = packet_leaf.load(walk_.rays(), leaf, walk_.deepest()); left != 0; left &= left - 1) {
      const auto lane = static_cast<uint32_t>(std::countr_zero(left));
      for (size_t r = 0; r < rows; ++r)
        committed |= visit(r, PencilRays::part_of(rays, r), leaf, packet_leaf, lane, certain[r]);
    }
    for (size_t r = 0; r < rows; ++r)
      if (certain[r].rays != 0) committed |= commit(r, leaf, certain[r]);
    return committed != 0;
  }

  /// Finishes a subtree ray by ray.
  HWY_NOINLINE void finish(uint32_t ref, uint32_t rays) {
    for (; rays != 0; rays &= rays - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
      const Ray alone = walk_.rays().ray(ray);
      Search search(shared_, alone, results_.hit(ray));
      Level& level = level_of(ray, search);
      Visitor none;
      level.shorten(search);
      traverse_subtree<Order::distance>(level, ref, TriangleLeaves{rules_}, search, none);
      results_.set(ray, search.hit());
    }
  }

 private:
  /// Rays that hit a triangle of a leaf for certain, and which one.
  struct CertainRays {
    uint32_t rays, lanes;
    PacketWordVector lane;

    HWY_INLINE CertainRays() : rays(0), lanes(0), lane(hn::Zero(PacketWords())) {}
    HWY_INLINE void add(uint32_t more, uint32_t of) {
      const PacketWords w;
      if (more == 0) return;
      lane = hn::IfThenElse(hn::RebindMask(w, packet_mask(more)), hn::Set(w, of), lane);
      rays |= more;
      lanes |= 1u << of;
    }
  };

  /// One triangle and the rays of a row. Not 0: some have found something.
  HWY_INLINE uint32_t visit(size_t r, uint32_t rays, const TriangleLeaf& leaf, const PacketLeaf& packet_leaf,
                            uint32_t lane, CertainRays& certain) {
    if (rays == 0) return 0;
    const PacketMasks masks = test_triangle(walk_.rays(), r, packet_leaf, lane, rays, results_.t(r));
    if ((masks.certain | masks.undecided) == 0) return 0;
    if (rules_.outcome_of(leaf.geometry_of(lane)) == Outcome::cull) return 0;
    uint32_t committed = 0;
    if (HWY_UNLIKELY(masks.undecided != 0)) committed = offer_alone(r, masks.undecided, leaf, lane, false);
    if (HWY_UNLIKELY((certain.rays & masks.certain) != 0)) committed |= commit(r, leaf, certain);
    certain.add(masks.certain, lane);
    return committed;
  }

  /// Returns the rays of a row of which these have become the closest hits, and forgets them. Not inlined: once for
  /// every row and caller it is 24 KB of code.
  HWY_NOINLINE uint32_t commit(size_t r, const TriangleLeaf& leaf, CertainRays& certain) {
    const uint32_t lanes = certain.lanes, rays = certain.rays;
    const PacketWordVector lane = certain.lane;
    certain = CertainRays();
    if ((lanes & (lanes - 1)) != 0) return commit(r, leaf, lane, rays, OwnCorners(leaf, lane));
    return commit(r, leaf, lane, rays, CommonCorners(leaf, static_cast<uint32_t>(std::countr_zero(lanes))));
  }

  template <class Corners>
  HWY_INLINE uint32_t commit(size_t r, const TriangleLeaf& leaf, PacketWordVector lane, uint32_t certain,
                             const Corners& corners) {
    const PacketHits hits = hit_triangles(walk_.rays(), r, corners, certain);
    const uint32_t front = rules_.hits.swap_facing ? ~hits.front & all_rays : hits.front;
    const PacketMask finite = hn::Le(hits.t, splat(std::numeric_limits<float>::max()));
    const PacketMask in_range = hn::And(hn::Gt(hits.t, walk_.rays().row[r].t_min), finite);
    uint32_t offered = certain & hits.known & packet_bits(in_range);
    if (rules_.hits.culled_facing[true]) offered &= ~front;
    if (rules_.hits.culled_facing[false]) offered &= front;
    uint32_t committed = results_.commit(r, hits, offered, front, names_of(leaf, lane));
    const uint32_t unknown = certain & ~hits.known;
    if (HWY_UNLIKELY(unknown != 0)) committed |= offer_alone(r, unknown, leaf, lane);
    return committed;
  }

  HWY_INLINE PacketNames names_of(const TriangleLeaf& leaf, PacketWordVector lane) const {
    const PacketWords w;
    const Words words;
    PacketWordVector geometry = hn::Set(w, leaf.geometry);
    if (leaf.mixed) geometry = look_up_eight(hn::LoadU(words, reinterpret_cast<const uint32_t*>(leaf.row(3))), lane);
    return {rules_.instance_index, hn::And(geometry, hn::Set(w, 0xFFFFFFu)),
            look_up_eight(hn::LoadU(words, leaf.primitive), lane)};
  }

  HWY_NOINLINE uint32_t offer_alone(size_t r, uint32_t rays, const TriangleLeaf& leaf, PacketWordVector lanes) {
    alignas(64) uint32_t lane[packet_size];
    hn::Store(lanes, PacketWords(), lane);
    uint32_t committed = 0;
    for (; rays != 0; rays &= rays - 1)
      committed |= offer_alone(r, rays & -rays, leaf, lane[std::countr_zero(rays)], true);
    return committed;
  }

  /// Offers a triangle to rays of a row one by one.
  HWY_NOINLINE uint32_t offer_alone(size_t r, uint32_t rays, const TriangleLeaf& leaf, uint32_t lane, bool certain) {
    uint32_t committed = 0;
    for (; rays != 0; rays &= rays - 1) {
      const auto ray = static_cast<uint32_t>(r * packet_size) + static_cast<uint32_t>(std::countr_zero(rays));
      const Ray alone = walk_.rays().ray(ray);
      Search search(shared_, alone, results_.hit(ray));
      Visitor none;
      const auto hit = TriangleLeaves::intersect(level_of(ray, search).ray, leaf, lane, certain, search.t());
      if (!hit) continue;
      const uint32_t primitive = leaf.primitive[lane];
      if (search.offer_triangle(rules_, leaf.geometry_of(lane), primitive, *hit, none) == Offer::rejected) continue;
      results_.set(ray, search.hit());
      committed |= rays & -rays;
    }
    return committed;
  }

  Level& level_of(uint32_t ray, const Search& search) {
    if ((prepared_ >> ray & 1) == 0) std::construct_at(&levels_[ray], walk_.block(), search.ray(), 1.0f, search);
    prepared_ |= 1u << ray;
    return levels_[ray];
  }

  static constexpr size_t rows = PencilRays::rows;

  const TraceRequest& shared_;
  PacketResults& results_;
  InstanceRules rules_;
  PacketWalk walk_;
  uint32_t prepared_;  ///< rays whose level has been made
  Level levels_[PencilRays::size];
};

/// A packet on its way through a structure of triangles, for PacketsInTurn.
class TrianglePacket {
 public:
  using Result = Hit;
  static constexpr size_t size = PencilRays::size;
  static constexpr size_t most = 4, groups_each = 8;

  TrianglePacket(AddressSpace, const TraceRequest& shared)
      : block_(shared.structure), rules_(shared.ray_flags), triangles_(shared, results_) {}

  HWY_INLINE uint32_t load(const RayRun& group, uint32_t wanted) {
    const uint32_t taken = triangles_.load(group, wanted, block_, rules_);
    if (taken == 0) return 0;
    results_.start(triangles_.rays());
    triangles_.begin(header_of(block_).root);
    return taken;
  }
  bool done() const { return triangles_.done(); }
  HWY_INLINE void step() { triangles_.step(); }
  void write(uint32_t rays, Hit* hits) const { results_.write(rays, hits); }

 private:
  const std::byte* block_;
  InstanceRules rules_;
  PacketResults results_;
  PacketTriangles triangles_;
};

}  // namespace rayloom::accel::HWY_NAMESPACE
#endif  // target

HWY_AFTER_NAMESPACE();

#endif  // once a target
