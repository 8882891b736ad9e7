#include <rayloom/hwmodel/replay.h>

#include <stdexcept>

namespace rayloom::hwmodel {

namespace {

void equal(uint64_t a, uint64_t b, const std::string& what) {
  if (a != b)
    throw std::logic_error("hwmodel: the books do not balance: " + what + ": " + std::to_string(a) + " and " +
                           std::to_string(b));
}

void at_most(uint64_t a, uint64_t b, const std::string& what) {
  if (a > b)
    throw std::logic_error("hwmodel: the books do not balance: " + what + ": " + std::to_string(a) + " exceeds " +
                           std::to_string(b));
}

void check_tables(const GpuStats& stats) {
  const GpuConfig& config = stats.config;
  const uint64_t sm_cycles = stats.cycles * config.sm.count;
  equal(stats.sm.slots.total(), sm_cycles * config.sm.warp_slots, "warp slot clocks by cause, slots times clocks");
  equal(stats.sm.issue.total(), sm_cycles * config.sm.sub_partitions, "issue slot clocks by cause, slots times clocks");
  equal(stats.rt.slots.total(), sm_cycles * config.rt.warp_entries * stats.warp_size,
        "ray slot clocks by cause, slots times clocks");
  equal(stats.sm.issue[IssueState::issuing], stats.sm.issued_cycles, "clocks issuing, clocks issued");
  equal(stats.sm.lane_busy_cycles + stats.sm.lane_idle_cycles + stats.sm.lane_absent_cycles,
        stats.sm.warp_residence * stats.warp_size, "lane clocks by cause, warp size times warp residence");
}

// Little: what is in the system, integrated over time, is what each that passed through spent there.
void check_residence(const GpuStats& stats) {
  equal(stats.rt.ray_residence, stats.rt.occupied_slot_cycles, "residence of rays, occupied ray slots over time");
  equal(stats.sm.warp_residence, stats.sm.occupied_slot_cycles, "residence of warps, occupied warp slots over time");
  equal(stats.rt.slots.total() - stats.rt.slots[RaySlotState::free] - stats.rt.slots[RaySlotState::no_ray],
        stats.rt.ray_residence, "ray slot clocks with a ray, residence of rays");
}

void check_work(const GpuStats& stats) {
  equal(stats.dispatcher.warps, stats.capture.warps, "warps dispatched, warps captured");
  equal(stats.sm.warps, stats.capture.warps, "warps run, warps captured");
  equal(stats.rt.rays, stats.capture.rays, "rays traced, rays captured");
  equal(stats.rt.rays_returned, stats.rt.rays, "rays out, rays in");
  equal(stats.rt.nodes, stats.capture.nodes, "nodes tested, nodes captured");
  equal(stats.rt.triangle_leaves, stats.capture.triangle_leaves, "triangle leaves tested, captured");
  equal(stats.rt.procedural_leaves, stats.capture.procedural_leaves, "procedural leaves tested, captured");
  equal(stats.rt.instances, stats.capture.instances, "instances entered, captured");
  equal(stats.rt.callbacks, stats.sm.callbacks, "callbacks asked, callbacks run");
}

void check_level(const CacheStats& level, const std::string& name) {
  for (size_t i = 0; i < request_class_count; ++i) {
    const auto c = static_cast<RequestClass>(i);
    equal(level.accesses[c], level.hits[c] + level.half_misses[c] + level.misses[c],
          name + ": sectors asked for, hits + half misses + misses, " + request_class_name(c));
  }
}

void check_memory(const GpuStats& stats) {
  check_level(stats.l1, "L1");
  check_level(stats.l2, "L2");
  for (size_t i = 0; i < request_class_count; ++i) {
    const auto c = static_cast<RequestClass>(i);
    equal(stats.l1.misses[c], stats.l2.accesses[c],
          std::string("misses of L1, requests of L2, ") + request_class_name(c));
    equal(stats.l1.stores[c], stats.l2.stores[c], std::string("stores of L1 and L2, ") + request_class_name(c));
    equal(stats.l2.misses[c], stats.dram.read_sectors[c],
          std::string("misses of L2, reads of DRAM, ") + request_class_name(c));
  }
}

void check_busy(const GpuStats& stats) {
  const GpuConfig& config = stats.config;
  const uint64_t sm_cycles = stats.cycles * config.sm.count;
  at_most(stats.rt.port_busy, sm_cycles, "RT core: node port busy");
  at_most(stats.rt.box_busy, sm_cycles, "RT core: box pipe busy");
  at_most(stats.rt.triangle_busy, sm_cycles, "RT core: triangle pipe busy");
  at_most(stats.rt.transform_busy, sm_cycles, "RT core: transform unit busy");
  at_most(stats.rt.accept_busy, sm_cycles, "RT core: accept port busy");
  at_most(stats.rt.return_busy, sm_cycles, "RT core: return port busy");
  at_most(stats.l1_port_busy, sm_cycles, "L1 port busy");
  at_most(stats.l2_port_busy, stats.cycles * config.l2.slices, "L2 ports busy");
  at_most(stats.dram_busy, stats.cycles * config.dram.channels, "DRAM channels busy");
  at_most(stats.sm.lane_operations, stats.sm.warp_operations * stats.warp_size, "lane operations");
}

}  // namespace

void check_books(const GpuStats& stats) {
  check_tables(stats);
  check_residence(stats);
  check_work(stats);
  check_memory(stats);
  check_busy(stats);
}

}  // namespace rayloom::hwmodel
