#pragma once

// The simulated GPU: captures in; cycles, statistics and the memory the shaders wrote out. A pure function of captures
// and configuration.

#include <rayloom/hwmodel/capture.h>
#include <rayloom/hwmodel/gpu_config.h>
#include <rayloom/hwmodel/ray_machine.h>
#include <rayloom/hwmodel/shadow_memory.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rayloom::hwmodel {

struct NamedShaderStats {
  std::string name;
  ShaderStage stage{};
  ShaderStats stats;
};

struct GpuStats {
  GpuConfig config;
  uint32_t warp_size = 32;
  Cycle cycles = 0;
  uint64_t events = 0;  ///< that the simulator handled
  CaptureCounts capture;
  Dispatcher::Stats dispatcher;
  Sm::Stats sm;  ///< sums over the SMs, RT cores, L1s
  RtCore::Stats rt;
  CacheStats l1, l2;
  Dram::Stats dram;
  Cycle l1_port_busy = 0, l2_port_busy = 0, dram_busy = 0;
  double dram_peak_bytes_per_cycle = 0;
  std::vector<NamedShaderStats> shaders;  ///< those that ran, launch by launch
  std::vector<uint64_t> rays_by_depth;    ///< [0]: traced from ray generation
  std::vector<Cycle> sm_end;              ///< when each SM's last warp ended
};

struct ReplayResult {
  GpuStats stats;
  /// By launch and x + width * (y + height * z): clocks that lane did or awaited its own work. Summed over all launches
  /// they are stats.sm.lane_busy_cycles.
  std::vector<std::vector<uint64_t>> pixel_cycles;
  ShadowMemory memory;
};

/// Replays launches one after another on one GPU. The structures' bytes must be as they were when captured.
/// Throws ReplayMismatch when a ray comes to something else than its capture, UsageError for a bad configuration,
/// InputError for a capture no configuration can run, std::logic_error when the books do not balance.
ReplayResult replay(std::span<const Capture> captures, const GpuConfig& config, Observer* observer = nullptr);

/// What every run is checked for: each table of clocks sums to clocks times units, rays out equal rays in, tests equal
/// the capture's, misses of one level equal requests of the next, nothing is busy longer than the run.
void check_books(const GpuStats& stats);

}  // namespace rayloom::hwmodel
