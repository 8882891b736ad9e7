#include <rayloom/base/error.h>
#include <rayloom/base/float_environment.h>
#include <rayloom/hwmodel/replay.h>
#include <rayloom/runtime/grid_order.h>

#include <algorithm>
#include <memory>

namespace rayloom::hwmodel {

namespace {

/// The components and the wires between them. Their order of construction is the order of events within a clock.
class Gpu {
 public:
  Gpu(std::span<const Capture> captures, const GpuConfig& config);
  ReplayResult run(Observer* observer);

 private:
  /// What lies together on an SM.
  struct Core {
    std::unique_ptr<L1Cache> l1;
    std::unique_ptr<RtCore> rt;
    std::unique_ptr<Sm> sm;
  };

  void build_cores();
  void connect();
  GpuStats collect(Cycle cycles);
  void collect_shaders(GpuStats& stats, const Sm& sm) const;

  std::span<const Capture> captures_;
  GpuConfig config_;
  uint32_t warp_size_ = 32;
  Engine engine_;
  ShadowMemory memory_;
  std::vector<LaunchRun> launches_;
  std::unique_ptr<Dispatcher> dispatcher_;
  std::vector<Core> cores_;
  std::unique_ptr<L2Cache> l2_;
  std::unique_ptr<Dram> dram_;
};

std::vector<uint64_t> warp_counts(std::span<const Capture> captures) {
  std::vector<uint64_t> counts;
  for (const Capture& capture : captures) counts.push_back(capture.warps.size());
  return counts;
}

uint32_t common_warp_size(std::span<const Capture> captures) {
  const uint32_t warp_size = captures.empty() ? 32 : captures.front().header.warp_size;
  for (const Capture& capture : captures)
    if (capture.header.warp_size != warp_size) throw InputError("capture: its launches differ in warp size");
  if (warp_size == 0 || warp_size > max_warp_size)
    throw InputError("capture: warps of " + std::to_string(warp_size) + " lanes; the model has 1 to 64");
  return warp_size;
}

std::vector<uint64_t> by_pixel(const LaunchRun& launch) {
  const uint32_t width = launch.capture->header.width, height = launch.capture->header.height;
  std::vector<uint64_t> pixels(launch.lane_cycles.size());
  for (uint64_t linear = 0; linear < pixels.size(); ++linear) {
    const GridIndex at = grid_index(width, height, linear);
    pixels[at.x + uint64_t{width} * (at.y + uint64_t{height} * at.z)] = launch.lane_cycles[linear];
  }
  return pixels;
}

Gpu::Gpu(std::span<const Capture> captures, const GpuConfig& config)
    : captures_(captures), config_(config), warp_size_(common_warp_size(captures)) {
  for (const Capture& capture : captures) {
    const LaunchHeader& header = capture.header;
    launches_.push_back({&capture, std::vector<uint64_t>(uint64_t{header.width} * header.height * header.depth)});
  }
  dispatcher_ = std::make_unique<Dispatcher>(engine_, config.dispatcher, warp_counts(captures));
  build_cores();
  l2_ = std::make_unique<L2Cache>(engine_, config.l2, config.crossbar, config.l1.line_bytes);
  dram_ = std::make_unique<Dram>(engine_, config.dram, config.l2.latency, config.core_mhz);
  connect();
}

void Gpu::build_cores() {
  for (uint32_t i = 0; i < config_.sm.count; ++i) {
    Core core;
    core.l1 = std::make_unique<L1Cache>(engine_, i, config_.l1, config_.crossbar);
    core.rt = std::make_unique<RtCore>(engine_, i, config_.rt, *core.l1, warp_size_);
    core.sm = std::make_unique<Sm>(engine_, i, config_.sm, *core.l1, *core.rt, memory_, warp_size_);
    cores_.push_back(std::move(core));
  }
}

void Gpu::connect() {
  std::vector<const Component*> sms, l1s;
  for (Core& core : cores_) {
    core.l1->connect(*l2_);
    core.rt->connect(*core.sm, *core.sm);
    core.sm->connect(*dispatcher_, launches_);
    sms.push_back(core.sm.get());
    l1s.push_back(core.l1.get());
  }
  dispatcher_->connect(sms, config_.sm.warp_slots);
  l2_->connect(l1s, *dram_);
  dram_->connect(*l2_);
}

ReplayResult Gpu::run(Observer* observer) {
  const FloatEnvironment environment;
  dispatcher_->start();
  engine_.run(observer);
  ReplayResult result{collect(engine_.now()), {}, std::move(memory_)};
  for (const LaunchRun& launch : launches_) result.pixel_cycles.push_back(by_pixel(launch));
  return result;
}

GpuStats Gpu::collect(Cycle cycles) {
  GpuStats stats;
  stats.config = config_;
  stats.warp_size = warp_size_;
  stats.cycles = cycles;
  stats.events = engine_.events_handled();
  for (const Capture& capture : captures_) {
    stats.capture += count(capture);
    for (const WarpCapture& warp : capture.warps)
      for (const RayCapture& ray : warp.rays) {
        if (stats.rays_by_depth.size() <= ray.depth) stats.rays_by_depth.resize(ray.depth + 1u);
        ++stats.rays_by_depth[ray.depth];
      }
  }
  for (Core& core : cores_) {
    core.sm->finish(cycles);
    core.rt->finish(cycles);
    accumulate(stats.sm, core.sm->stats());
    accumulate(stats.rt, core.rt->stats());
    accumulate(stats.l1, core.l1->stats());
    stats.l1.mshr_peak = std::max(stats.l1.mshr_peak, core.l1->stats().mshr_peak);
    stats.l1_port_busy += core.l1->port_busy();
    stats.sm_end.push_back(core.sm->last_warp_end());
    collect_shaders(stats, *core.sm);
  }
  stats.dispatcher = dispatcher_->stats();
  stats.l2 = l2_->stats();
  stats.l2_port_busy = l2_->port_busy();
  stats.dram = dram_->stats();
  stats.dram_busy = dram_->busy();
  stats.dram_peak_bytes_per_cycle = dram_->peak_bytes_per_cycle();
  return stats;
}

// Shaders of all launches, one behind the other; those of one name and stage are one.
void Gpu::collect_shaders(GpuStats& stats, const Sm& sm) const {
  for (size_t launch = 0; launch < sm.shaders().size(); ++launch)
    for (size_t i = 0; i < sm.shaders()[launch].size(); ++i) {
      const ShaderStats& ran = sm.shaders()[launch][i];
      if (ran.invocations == 0) continue;
      const ShaderInfo& info = captures_[launch].header.shaders.at(i);
      const auto same = [&](const NamedShaderStats& s) { return s.name == info.name && s.stage == info.stage; };
      const auto found = std::find_if(stats.shaders.begin(), stats.shaders.end(), same);
      if (found == stats.shaders.end()) {
        stats.shaders.push_back({info.name, info.stage, ran});
      } else {
        accumulate(found->stats, ran);
      }
    }
}

}  // namespace

ReplayResult replay(std::span<const Capture> captures, const GpuConfig& config, Observer* observer) {
  check_config(config);
  ReplayResult result = Gpu(captures, config).run(observer);
  check_books(result.stats);
  return result;
}

}  // namespace rayloom::hwmodel
