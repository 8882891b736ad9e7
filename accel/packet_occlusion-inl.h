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

#include <memory>

HWY_BEFORE_NAMESPACE();

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::HWY_NAMESPACE {

/// A packet on its way.
struct alignas(64) OcclusionTask {
  struct Entry {
    uint32_t ref, rays;
  };

  /// Takes on what goes together of the `wanted` rays of a group; returns those rays, 0 if too few do.
  HWY_INLINE uint32_t load(const RayRun& from, uint32_t wanted, const StructureHeader& header) {
    group = from;
    open = taken = rays.load(group, wanted, header);
    if (taken == 0) return 0;
    t_near = rays.near_limit();
    t_far = rays.far_limit(rays.t_max);
    first_near = hn::Set(Floats(), hn::GetLane(hn::MinOfLanes(PacketFloats(), t_near)));
    last_far = hn::Set(Floats(), hn::GetLane(hn::MaxOfLanes(PacketFloats(), t_far)));
    size = 0;
    push(header.root, taken);
    return taken;
  }

  /// Without a branch: there may be no rays.
  HWY_INLINE void push(uint32_t ref, uint32_t with) {
    refs[size] = ref;
    masks[size] = with;
    size += with != 0;
  }
  HWY_INLINE Entry pop() {
    --size;
    return {refs[size], masks[size]};
  }

  RayRun group;
  uint32_t taken;                   ///< rays of the group
  uint32_t open;                    ///< those that have hit nothing yet
  uint32_t size;                    ///< of the stack
  PacketVector t_near, t_far;       ///< limits of each ray, in box space
  FloatLanes first_near, last_far;  ///< of all of them
  BundleRays rays;
  uint32_t refs[stack_entries], masks[stack_entries];
};

/// Traces packets of rays that have no candidate function through a structure of triangles, several packets in turn:
/// while the bytes that one needs next are on their way, the others take their steps.
class OcclusionPackets {
 public:
  OcclusionPackets(const RayRun& rays, uint8_t* results)
      : run_(rays),
        results_(results),
        width_(std::min(most, rays.count / packet_size)),
        tasks_(new OcclusionTask[width_]) {}

  /// `leave(begin, count)` is told of rays that do not go together.
  template <class Leave>
  void run(const Leave& leave) {
    OcclusionTask* active[most];
    size_t count = 0;
    while (count < width_ && start(tasks_[count], leave)) active[count] = &tasks_[count], ++count;
    while (count != 0) {
      for (size_t i = 0; i < count; ++i) {
        OcclusionTask& task = *active[i];
        visit(task.pop(), task);
        if (HWY_LIKELY(task.size != 0)) {
          Prefetch{block_}(task.refs[task.size - 1]);
        } else {
          write_results(task);
          if (!start(task, leave)) active[i--] = active[--count];
        }
      }
    }
  }

 private:
  static constexpr size_t most = 8;  ///< packets under way
  static constexpr size_t most_skipped = 15;

  /// Gives the task the next rays that go together; false if there are none. Where rays do not, fewer and fewer groups
  /// are asked.
  template <class Leave>
  bool start(OcclusionTask& task, const Leave& leave) {
    while (next_ + packet_size <= run_.count) {
      const RayRun group = run_.part(next_, packet_size);
      const uint32_t taken = task.load(group, wanted_, header_of(block_));
      wanted_ &= ~taken;
      if (taken != 0) {
        skipped_ = 0;
        if (wanted_ == 0) begin_next(packet_size);
        return true;
      }
      if (wanted_ == all_rays) {
        const size_t count = std::min(run_.count - next_, packet_size * (1 + skipped_));
        leave(next_, count);
        begin_next(count);
        skipped_ = std::min(2 * skipped_ + 1, most_skipped);
      } else {
        for (; wanted_ != 0; wanted_ &= wanted_ - 1) leave(next_ + static_cast<size_t>(std::countr_zero(wanted_)), 1);
        begin_next(packet_size);
      }
    }
    if (next_ < run_.count) leave(next_, run_.count - next_);
    next_ = run_.count;
    return false;
  }

  void begin_next(size_t count) {
    next_ += count;
    wanted_ = all_rays;
  }

  HWY_INLINE void visit(const OcclusionTask::Entry& entry, OcclusionTask& task) const {
    const uint32_t rays = entry.rays & task.open;
    if (rays == 0) return;
    const std::byte* const address = block_ + node_ref::offset(entry.ref);
    if (node_ref::is_leaf(entry.ref))
      task.open &= ~hits_in_leaf(*reinterpret_cast<const TriangleLeaf*>(address), rays, task);
    else
      visit_node(*reinterpret_cast<const Node8*>(address), rays, task);
  }

  static HWY_INLINE void visit_node(const Node8& node, uint32_t rays, OcclusionTask& task) {
    const PacketBoxHits hits = test_boxes(task.rays, node, task.first_near, task.last_far);
    for (uint32_t left = hits.mask; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      task.push(node.child[lane], rays & test_child(task.rays, node, lane, task.t_near, task.t_far));
    }
  }

  HWY_INLINE uint32_t hits_in_leaf(const TriangleLeaf& leaf, uint32_t rays, const OcclusionTask& task) const {
    const LeafTriangles triangles = load_triangles(leaf, task.rays.axes());
    uint32_t hits = 0;
    for (; rays != 0; rays &= rays - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
      const LeafMasks masks = test_triangles(task.rays.lanes(ray), triangles, task.rays.depths(ray));
      bool hit = rules_.hits.accepts_all & ((masks.certain & masks.inside) != 0);
      if (HWY_UNLIKELY(!hit & (masks.possible != 0))) hit = hits_alone(task.group[ray], leaf, masks);
      hits |= uint32_t{hit} << ray;
    }
    return hits;
  }

  HWY_NOINLINE bool hits_alone(const Ray& ray, const TriangleLeaf& leaf, const LeafMasks& masks) const {
    Search search(*run_.shared, ray);
    Visitor none;
    const Level level(block_, ray, 1, search);
    return TriangleLeaves{rules_}.offer_lanes(level, &leaf, masks, search, none) == Offer::ended;
  }

  void write_results(const OcclusionTask& task) {
    uint8_t* const results = results_ + run_.index_of(task.group);
    for (uint32_t left = task.taken; left != 0; left &= left - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(left));
      results[ray] = (task.open >> ray & 1) == 0;
    }
  }

  RayRun run_;
  uint8_t* results_;
  const std::byte* block_ = run_.shared->structure;
  InstanceRules rules_{0, 0, run_.shared->ray_flags, nullptr};
  size_t next_ = 0;
  uint32_t wanted_ = all_rays;  ///< of the group at next_
  size_t skipped_ = 0;          ///< groups left unasked after the last that did not go together
  size_t width_;
  std::unique_ptr<OcclusionTask[]> tasks_;
};

}  // namespace rayloom::accel::HWY_NAMESPACE
#endif  // target

HWY_AFTER_NAMESPACE();

#endif  // once a target
