#pragma once

// A streaming multiprocessor: warp slots shared out to sub-partitions, each of which issues one warp instruction a
// clock. A warp runs its lane groups in bundles of instructions, waits for its loads at the end of a group, and waits
// for the RT core at a trace, where it also runs its rays' any-hit and intersection shaders.

#include <rayloom/hwmodel/engine.h>
#include <rayloom/hwmodel/l1_cache.h>
#include <rayloom/hwmodel/rt_core.h>
#include <rayloom/hwmodel/shadow_memory.h>
#include <rayloom/hwmodel/simt.h>
#include <rayloom/hwmodel/stats.h>

#include <cstdint>
#include <deque>
#include <vector>

namespace rayloom::hwmodel {

/// What a warp slot is doing; every slot is in one state at every clock.
enum class WarpSlotState : uint8_t {
  before_first_warp,
  between_warps,
  after_last_warp,
  wait_issue,  ///< ready, another warp of the sub-partition issues
  issuing,
  dependency,  ///< the next instruction needs a result not there yet
  memory_l1,   ///< loads on their way, by the level that served the last of them
  memory_l2,
  memory_dram,
  memory_mshr,
  rt_buffer_full,  ///< a trace waits for an entry of the RT core
  rt_trace,        ///< rays in the RT core, no shader of theirs to run
  count
};
const char* state_name(WarpSlotState state);

/// What a sub-partition's issue slot is doing: issuing, or the first reason below that holds for one of its warps.
enum class IssueState : uint8_t { issuing, dependency, memory, rt_buffer_full, rt_trace, no_warp, count };
const char* state_name(IssueState state);

/// Warp instructions of one shader.
struct ShaderStats {
  uint64_t invocations = 0;
  uint64_t warp_operations = 0;  ///< issued: sum over groups of the maximum over lanes
  uint64_t lane_operations = 0;  ///< wanted: sum over lanes

  template <class F>
  static void fields(F&& f) {
    f("invocations", &ShaderStats::invocations);
    f("warp_operations", &ShaderStats::warp_operations);
    f("lane_operations", &ShaderStats::lane_operations);
  }
};

/// One launch as the components of a run share it.
struct LaunchRun {
  const Capture* capture = nullptr;
  std::vector<uint64_t> lane_cycles;  ///< clocks a lane did or awaited its own work; lane l of warp w at w * size + l
};

class Sm : public Component, public RtClient {
 public:
  struct Config {
    uint32_t count = 1;
    uint32_t sub_partitions = 4;
    uint32_t warp_slots = 32;
    uint32_t bundle = 16;             ///< instructions issued together
    uint32_t dependency_latency = 4;  ///< clocks from one instruction of a warp to the next
    uint32_t special_interval = 4;    ///< issue clocks of a transcendental or division
    uint32_t memory_interval = 4;     ///< issue clocks of a load or store
    uint32_t trace_call_operations = 8;
    uint32_t shader_call_operations = 4;
  };

  struct Stats {
    uint64_t warps = 0, lanes = 0;
    uint64_t warp_operations = 0, lane_operations = 0;  ///< of shaders, as declared
    uint64_t call_operations = 0;                       ///< warp instructions of traces and calls, on top
    uint64_t memory_instructions = 0;
    uint64_t issued_cycles = 0;
    uint64_t callbacks = 0, callback_batches = 0;
    uint64_t occupied_slot_cycles = 0;  ///< integral of slots that hold a warp: must equal warp_residence
    uint64_t warp_residence = 0;
    uint64_t lane_busy_cycles = 0, lane_idle_cycles = 0;  ///< of lanes that exist; busy is what pixels get
    uint64_t lane_absent_cycles = 0;                      ///< of lanes past the end of the grid
    StateTable<WarpSlotState> slots;
    StateTable<IssueState> issue;

    template <class F>
    static void fields(F&& f);
  };

  Sm(Engine& engine, uint32_t index, const Config& config, L1Cache& l1, RtCore& rt_core, ShadowMemory& memory,
     uint32_t warp_size);
  void connect(const Component& dispatcher, std::vector<LaunchRun>& launches) {
    dispatcher_ = &dispatcher, launches_ = &launches;
  }

  void handle(const Event& event) override;
  void describe_waiting(std::vector<std::string>& lines) const override;
  void trace_accepted(uint32_t slot) override;
  void ray_done(uint32_t slot, uint32_t lane, Cycle cycles) override;

  /// Closes the books at the end of a run that took `cycles`.
  void finish(Cycle cycles);
  const Stats& stats() const { return stats_; }
  Cycle last_warp_end() const { return last_warp_end_; }
  /// By launch and shader.
  const std::vector<std::vector<ShaderStats>>& shaders() const { return shaders_; }

 private:
  struct Callback {
    uint32_t entry, lane, candidate;
  };
  /// Warp instructions to issue, by how long each takes the issue slot.
  struct Work {
    uint32_t plain = 0, special = 0, memory = 0;
    bool empty() const { return plain == 0 && special == 0 && memory == 0; }
  };
  /// Instructions of one class issued together.
  struct Bundle {
    Cycle issue, latency;  ///< clocks the issue slot is taken; clocks until the warp may go on
  };
  struct Slot {
    bool used = false;
    uint32_t launch = 0;
    uint64_t warp = 0;
    WarpSlotState state = WarpSlotState::before_first_warp;
    Cycle since = 0, begun = 0;
    Simt lanes;
    Simt callback_lanes;
    bool in_callback = false;
    std::vector<Callback> asked, running;  // callbacks waiting, and in callback_lanes
    LaneGroup group;
    Work left;  // of the group
    bool entering_trace = false;
    uint32_t loads_pending = 0;
    std::vector<uint64_t> busy;  // by lane
  };
  struct SubPartition {
    std::deque<uint32_t> ready;
    bool issuing = false;
    uint32_t count[static_cast<size_t>(WarpSlotState::count)] = {};
    Cycle since = 0;
  };

  const WarpCapture& warp_of(const Slot& slot) const { return (*launches_)[slot.launch].capture->warps[slot.warp]; }
  Simt& simt_of(Slot& slot) { return slot.in_callback ? slot.callback_lanes : slot.lanes; }
  SubPartition& sub_partition_of(uint32_t slot) { return sub_partitions_[slot % sub_partitions_.size()]; }

  void warp_arrives(uint32_t launch, uint64_t warp);
  void warp_ends(uint32_t slot);
  void run_next_group(uint32_t slot);
  Work work_of(const LaneGroup& group) const;
  void count_group(const Slot& slot);
  void want_issue(uint32_t slot);
  Bundle take_bundle(Work& work) const;
  void try_issue(SubPartition& sub_partition);
  void issue_done(uint32_t slot, Cycle ready);
  void warp_ready(uint32_t slot);
  void access_memory(uint32_t slot);
  void load(uint32_t slot, const std::vector<LineRequest>& lines, RequestClass request_class);
  void apply_stores(const Slot& slot);
  void loads_returned(const Event& event);
  void group_done(uint32_t slot);
  void begin_trace(uint32_t slot);
  void submit_trace(uint32_t slot);
  void trace_returned(uint32_t slot);
  void callback_arrives(const Event& event);
  void begin_callbacks(uint32_t slot);
  void end_callbacks(uint32_t slot);
  void set_state(uint32_t slot, WarpSlotState state);
  void charge(uint32_t slot, WarpSlotState state, Cycle until);
  LaneMask busy_lanes(const Slot& slot) const;
  void charge_issue_slot(SubPartition& sub_partition);
  void count_occupied();

  Config config_;
  L1Cache& l1_;
  RtCore& rt_core_;
  ShadowMemory& memory_;
  const Component* dispatcher_ = nullptr;
  std::vector<LaunchRun>* launches_ = nullptr;
  uint32_t index_, warp_size_;
  std::vector<Slot> slots_;
  std::vector<SubPartition> sub_partitions_;
  uint64_t occupied_ = 0;
  Cycle occupied_since_ = 0;
  std::vector<std::vector<ShaderStats>> shaders_;
  Cycle last_warp_end_ = 0;
  Stats stats_;
};

template <class F>
void Sm::Stats::fields(F&& f) {
  f("warps", &Stats::warps);
  f("lanes", &Stats::lanes);
  f("warp_operations", &Stats::warp_operations);
  f("lane_operations", &Stats::lane_operations);
  f("call_operations", &Stats::call_operations);
  f("memory_instructions", &Stats::memory_instructions);
  f("issued_cycles", &Stats::issued_cycles);
  f("callbacks", &Stats::callbacks);
  f("callback_batches", &Stats::callback_batches);
  f("occupied_slot_cycles", &Stats::occupied_slot_cycles);
  f("warp_residence", &Stats::warp_residence);
  f("lane_busy_cycles", &Stats::lane_busy_cycles);
  f("lane_idle_cycles", &Stats::lane_idle_cycles);
  f("lane_absent_cycles", &Stats::lane_absent_cycles);
  f("slots", &Stats::slots);
  f("issue", &Stats::issue);
}

}  // namespace rayloom::hwmodel
