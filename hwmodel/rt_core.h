#pragma once

// One RT core: a buffer of warps whose rays walk the structure on their own. Each ray is a small state machine; a
// scheduler hands the node port the address of the oldest warp that has a ray ready, all rays of that warp with the
// same address share the fetch, and each then needs its own slot of the box or triangle pipe.
//
// The rays compute: see RayMachine.

#include <rayloom/hwmodel/engine.h>
#include <rayloom/hwmodel/l1_cache.h>
#include <rayloom/hwmodel/memory.h>
#include <rayloom/hwmodel/ray_machine.h>
#include <rayloom/hwmodel/simt.h>
#include <rayloom/hwmodel/stats.h>

#include <cstdint>
#include <deque>
#include <vector>

namespace rayloom::hwmodel {

/// What a ray slot is doing; every slot is in one state at every clock.
enum class RaySlotState : uint8_t {
  free,           ///< no warp in the entry
  no_ray,         ///< the entry's warp has no ray for this lane
  load_ray,       ///< the rays of the entry are read in
  wait_schedule,  ///< has an address, not yet picked
  issue,          ///< picked: on its way to the L1
  wait_l1,        ///< fetch hit in the L1
  wait_l2,        ///< fetch missed the L1, hit the L2
  wait_dram,
  wait_mshr,  ///< fetch had to wait for a free MSHR of the L1
  wait_port,  ///< the fetched node comes in over several clocks
  wait_box,   ///< the box pipe is taken
  in_box,
  wait_triangle,
  in_triangle,
  wait_transform,
  in_transform,
  pop,            ///< stack entries beyond the closest hit are dropped
  wait_callback,  ///< any-hit or intersection shader on the SM
  wait_siblings,  ///< finished, another ray of the warp is not
  wait_return,
  count
};
const char* state_name(RaySlotState state);

/// Where an RT core hands its results: the SM it belongs to.
class RtClient {
 public:
  virtual ~RtClient() = default;
  /// The trace of the warp in `slot` has begun: it has an entry.
  virtual void trace_accepted(uint32_t slot) = 0;
  /// A lane's ray is done after `cycles` clocks in its entry.
  virtual void ray_done(uint32_t slot, uint32_t lane, Cycle cycles) = 0;
};

class RtCore : public Component {
 public:
  enum Scheduler : uint32_t { oldest = 0, round_robin = 1 };

  struct Config {
    uint32_t warp_entries = 4;
    uint32_t scheduler = oldest;
    uint32_t schedule_latency = 1;  ///< picked to L1 access
    uint32_t ray_bytes = 32;        ///< read from the SM per ray
    uint32_t accept_bytes_per_cycle = 128;
    uint32_t fetch_bytes_per_cycle = 64;
    uint32_t box_width = 8;  ///< boxes per operation
    uint32_t box_interval = 1;
    uint32_t box_latency = 10;
    uint32_t triangle_rate = 1;  ///< tests begun per clock
    uint32_t triangle_latency = 22;
    uint32_t transform_interval = 4;
    uint32_t transform_latency = 5;
    uint32_t pop_cycles = 1;         ///< per dropped stack entry
    uint32_t callback_latency = 10;  ///< to the SM, and the same back
    uint32_t return_interval = 1;    ///< between warps
    uint32_t return_latency = 4;
  };

  struct Stats {
    uint64_t rays = 0, rays_returned = 0;
    uint64_t warps = 0;
    uint64_t nodes = 0, triangle_leaves = 0, procedural_leaves = 0, instances = 0, callbacks = 0;
    uint64_t box_tests = 0, triangle_tests = 0, culled_pops = 0;
    uint64_t fetches = 0, fetches_wanted = 0;  ///< accesses made; rays that needed one
    uint64_t port_busy = 0, box_busy = 0, triangle_busy = 0, transform_busy = 0, accept_busy = 0, return_busy = 0;
    uint64_t ray_residence = 0;         ///< clocks between a ray's entry loaded or begun and its return, summed
    uint64_t occupied_slot_cycles = 0;  ///< integral over time of slots that hold a ray: must equal ray_residence
    StateTable<RaySlotState> slots;

    template <class F>
    static void fields(F&& f);
  };

  RtCore(Engine& engine, uint32_t sm, const Config& config, L1Cache& l1, uint32_t warp_size);
  void connect(const Component& sm, RtClient& client) { sm_ = &sm, client_ = &client; }

  /// The warp in the SM's `slot` traces: lane l of `lanes` its ray rays[l] (index into WarpCapture::rays).
  void submit(uint32_t slot, const Capture& capture, uint64_t warp, LaneMask lanes, const uint32_t* rays);
  /// The SM has run the shader that `lane` of `entry` waits for.
  void answer_callback(uint32_t entry, uint32_t lane);

  void handle(const Event& event) override;
  void describe_waiting(std::vector<std::string>& lines) const override;

  /// Closes the books at the end of a run that took `cycles`.
  void finish(Cycle cycles);
  const Stats& stats() const { return stats_; }

 private:
  struct Ray {
    RayMachine machine;
    RayStep step;
    Cycle since = 0;  // of the present state
    bool done = false;
  };
  struct Trace {
    uint32_t slot = 0;
    const Capture* capture = nullptr;
    uint64_t warp = 0;
    LaneMask lanes = 0;
    uint32_t rays[max_warp_size] = {};
  };
  struct Entry {
    bool used = false;
    Trace trace;
    Cycle begun = 0, free_since = 0;
    LaneMask ready = 0;  // rays that wait for the scheduler
    uint32_t unfinished = 0;
    std::vector<Ray> rays;
  };
  struct Fetch {
    uint32_t entry = 0;
    LaneMask lanes = 0;
    uint64_t address = 0;
    uint32_t bytes = 0;
    RequestClass request_class{};
    uint32_t extra_beats = 0;
  };

  void begin(uint32_t entry, const Trace& trace);
  void entry_loaded(uint32_t entry);
  void proceed(uint32_t entry, uint32_t lane);
  void take_step(uint32_t entry, uint32_t lane);
  void wake_scheduler();
  void schedule_fetch();
  uint32_t pick_entry() const;
  void start_fetch(uint32_t entry, LaneMask lanes);
  void issue_fetch(uint32_t token);
  void fetch_returned(const Event& event);
  void enter_pipe(uint32_t entry, uint32_t lane, Cycle ready);
  void ask_shader(uint32_t entry, uint32_t lane);
  void finish_ray(uint32_t entry, uint32_t lane);
  void return_entry(uint32_t entry);
  void entry_returned(uint32_t entry);
  void charge(Ray& ray, RaySlotState state, Cycle until);
  void count_occupied(Cycle until);
  uint32_t new_fetch();

  Config config_;
  L1Cache& l1_;
  const Component* sm_ = nullptr;
  RtClient* client_ = nullptr;
  uint32_t warp_size_;
  std::vector<Entry> entries_;
  std::vector<uint32_t> age_;  // used entries, oldest first
  std::deque<Trace> waiting_;
  std::vector<Fetch> fetches_;
  std::vector<uint32_t> free_fetches_;
  std::vector<LineRequest> lines_;
  Port accept_port_, fetch_port_, box_pipe_, triangle_pipe_, transform_pipe_, return_port_;
  bool tick_scheduled_ = false;
  uint32_t last_picked_ = 0;
  uint64_t occupied_ = 0;
  Cycle occupied_since_ = 0;
  Stats stats_;
};

template <class F>
void RtCore::Stats::fields(F&& f) {
  f("rays", &Stats::rays);
  f("rays_returned", &Stats::rays_returned);
  f("warps", &Stats::warps);
  f("nodes", &Stats::nodes);
  f("triangle_leaves", &Stats::triangle_leaves);
  f("procedural_leaves", &Stats::procedural_leaves);
  f("instances", &Stats::instances);
  f("callbacks", &Stats::callbacks);
  f("box_tests", &Stats::box_tests);
  f("triangle_tests", &Stats::triangle_tests);
  f("culled_pops", &Stats::culled_pops);
  f("fetches", &Stats::fetches);
  f("fetches_wanted", &Stats::fetches_wanted);
  f("port_busy", &Stats::port_busy);
  f("box_busy", &Stats::box_busy);
  f("triangle_busy", &Stats::triangle_busy);
  f("transform_busy", &Stats::transform_busy);
  f("accept_busy", &Stats::accept_busy);
  f("return_busy", &Stats::return_busy);
  f("ray_residence", &Stats::ray_residence);
  f("occupied_slot_cycles", &Stats::occupied_slot_cycles);
  f("slots", &Stats::slots);
}

}  // namespace rayloom::hwmodel
