// Packets through top levels: at an instance the rays are taken to its space together and go on as packets there. Only
// for targets with vectors; re-included once per target as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_PACKET_INSTANCES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_PACKET_INSTANCES_INL_H
#undef RAYLOOM_ACCEL_PACKET_INSTANCES_INL_H
#else
#define RAYLOOM_ACCEL_PACKET_INSTANCES_INL_H
#endif
// clang-format on

#include <rayloom/accel/instance_transform.h>
#include <rayloom/accel/packet-inl.h>
#include <rayloom/accel/visitor.h>

#include <cstring>

HWY_BEFORE_NAMESPACE();

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::HWY_NAMESPACE {

/// TrianglePacket for a top level.
class InstancePacket {
 public:
  using Result = Hit;
  static constexpr size_t size = PencilRays::size;
  static constexpr size_t most = 1, groups_each = 1;  ///< a step goes through a whole instance

  InstancePacket(AddressSpace addresses, const TraceRequest& shared)
      : addresses_(addresses),
        shared_(shared),
        bounds_(header_of(shared.structure), header_of(shared.structure).pad_scale),
        triangles_(shared, results_) {}

  uint32_t load(const RayRun& group, uint32_t wanted) {
    const uint32_t taken = walk_.load(group, wanted, shared_.structure, bounds_.pad_scale);
    if (taken == 0) return 0;
    results_.start(walk_.rays());
    walk_.begin(header_of(shared_.structure).root, results_);
    return taken;
  }
  bool done() const { return walk_.done(); }
  void step() { walk_.step(results_, *this); }
  void write(uint32_t rays, Hit* hits) const { results_.write(rays, hits); }

  /// True: rays may have found something.
  HWY_NOINLINE bool visit(const std::byte* address, uint32_t rays) {
    const auto& instance = *reinterpret_cast<const InstanceRecord*>(address);
    const std::byte* const block = addresses_.host(instance.bottom_level_address);
    const StructureHeader& header = header_of(block);
    if (!passes(instance, shared_, header)) return false;
    InstanceRules rules;
    set_rules(rules, instance, shared_, plain_.hits);
    const uint32_t start = entry_of(instance, header);
    const PencilRays::InInstance inside{walk_.rays(), is_identity(instance) ? nullptr : &instance};
    uint32_t left = triangles_.trace(inside, rays, block, start, rules);
    for (; left != 0; left &= left - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(left));
      const Ray alone = walk_.rays().ray(ray);
      Search search(shared_, alone, results_.hit(ray));
      Visitor none;
      traverse_bottom(block, start, in_instance(inside.instance, alone), rules, search, none);
      results_.set(ray, search.hit());
    }
    return true;
  }

  HWY_NOINLINE void finish(uint32_t ref, uint32_t rays) {
    for (; rays != 0; rays &= rays - 1) {
      const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
      const Ray alone = walk_.rays().ray(ray);
      Search search(shared_, alone, results_.hit(ray));
      Level level(shared_.structure, bounds_, alone, search);
      Visitor none;
      traverse_subtree<Order::distance>(level, ref, InstanceLeaves{addresses_, plain_}, search, none);
      results_.set(ray, search.hit());
    }
  }

 private:
  static bool is_identity(const InstanceRecord& instance) {
    static constexpr float identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    return std::memcmp(instance.object_to_world, identity, sizeof(identity)) == 0;
  }

  static Ray in_instance(const InstanceRecord* instance, const Ray& ray) {
    Ray inside = ray;
    if (instance) object_ray_lanes(*instance, ray, inside);
    return inside;
  }

  AddressSpace addresses_;
  const TraceRequest& shared_;
  BoundsLanes bounds_;
  InstanceRules plain_{shared_.ray_flags};
  PacketResults results_;
  PacketTriangles triangles_;
  PacketWalk walk_;
};

}  // namespace rayloom::accel::HWY_NAMESPACE
#endif  // target

HWY_AFTER_NAMESPACE();

#endif  // once a target
