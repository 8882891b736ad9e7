#include <rayloom/base/error.h>
#include <rayloom/base/parallel.h>
#include <rayloom/runtime/execute.h>
#include <rayloom/runtime/warp.h>

#include <algorithm>
#include <memory>
#include <mutex>

namespace rayloom {

DispatchStatistics& DispatchStatistics::operator+=(const DispatchStatistics& other) {
  rays += other.rays;
  hits += other.hits;
  ray_generation += other.ray_generation;
  intersection += other.intersection;
  any_hit += other.any_hit;
  closest_hit += other.closest_hit;
  miss += other.miss;
  callable += other.callable;
  return *this;
}

namespace detail {
namespace {

/// How many warps a thread takes at a time: without a tracer these are one stream of lanes, which runs out at its end.
constexpr uint64_t least_warps_per_chunk = 4, most_warps_per_chunk = 64, chunks_wanted = 512;
/// Direct mode runs on threads' own stacks, which must have this much.
constexpr uint64_t max_direct_stack_bytes = 1024 * 1024;

struct Problem {
  std::string_view row;  // empty: none
  std::string text;
};

Problem table_problem(const char* name, uint64_t address, uint64_t stride) {
  const std::string object = std::string(name) + ": ";
  if (address % RAYTRACING_SHADER_TABLE_BYTE_ALIGNMENT) return {"ST-02", object + "the address is no multiple of 64"};
  if (stride % RAYTRACING_SHADER_RECORD_BYTE_ALIGNMENT) return {"ST-02", object + "the stride is no multiple of 32"};
  if (stride > RAYTRACING_MAX_SHADER_RECORD_STRIDE) return {"ST-02", object + "the stride is above 4096"};
  return {};
}

Problem dispatch_problem(const DispatchCommand& command) {
  const DISPATCH_RAYS_DESC& desc = command.desc;
  if (!command.state_object) return {"DR-06", "DispatchRays without a raytracing pipeline; it is skipped"};
  if (!desc.Width || !desc.Height || !desc.Depth) return {"DR-02", {}};
  const uint64_t slice = uint64_t{desc.Width} * desc.Height;
  if (slice > RAYTRACING_MAX_RAY_GENERATION_SHADER_THREADS ||
      slice * desc.Depth > RAYTRACING_MAX_RAY_GENERATION_SHADER_THREADS)
    return {"DR-03", "DispatchRays over more than 2^30 threads; it is skipped"};
  const std::pair<const char*, GPU_VIRTUAL_ADDRESS_RANGE_AND_STRIDE> tables[] = {
      {"RayGenerationShaderRecord", {desc.RayGenerationShaderRecord.StartAddress, 0, 0}},
      {"MissShaderTable", desc.MissShaderTable},
      {"HitGroupTable", desc.HitGroupTable},
      {"CallableShaderTable", desc.CallableShaderTable}};
  for (const auto& [name, table] : tables)
    if (Problem problem = table_problem(name, table.StartAddress, table.StrideInBytes); !problem.row.empty())
      return problem;
  return {};
}

uint64_t fiber_stack_bytes(const DispatchCommand& command, const DispatchOptions& options) {
  if (options.fiber_stack_bytes) return std::max<uint64_t>(options.fiber_stack_bytes, 64 * 1024);
  return std::max(default_fiber_stack_bytes, 64 * 1024 + 4 * command.stack_bytes);
}

/// A rule of program and options alone (dispatch.h).
ExecutionMode choose_mode(const DispatchCommand& command, const DispatchOptions& options) {
  const bool fits = fiber_stack_bytes(command, options) <= max_direct_stack_bytes;
  const bool traces = command.state_object->pipeline().config.MaxTraceRecursionDepth > 0;
  const bool direct = options.mode == ExecutionMode::direct || (options.mode == ExecutionMode::automatic &&
                                                                !options.tracer && (!traces || options.warp_size == 1));
  return direct && fits ? ExecutionMode::direct : ExecutionMode::warp;
}

/// Warps that threads hand on to each other, so that fibers are made once per thread and dispatch.
class WarpPool {
 public:
  std::unique_ptr<Warp> take(const DispatchContext& dispatch) {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<Warp> warp = std::move(free_.back());
        free_.pop_back();
        return warp;
      }
    }
    return std::make_unique<Warp>(dispatch);
  }
  void give_back(std::unique_ptr<Warp> warp) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(warp));
  }
  /// When all have been given back.
  DispatchStatistics statistics() const {
    DispatchStatistics sum;
    for (const auto& warp : free_) sum += warp->statistics();
    return sum;
  }

 private:
  std::vector<std::unique_ptr<Warp>> free_;
  std::mutex mutex_;
};

/// Lets views reach device memory on this thread.
class MemoryScope {
 public:
  explicit MemoryScope(const ShaderMemory& memory) : outer_(shader_memory) { shader_memory = memory; }
  ~MemoryScope() { shader_memory = outer_; }
  MemoryScope(const MemoryScope&) = delete;
  MemoryScope& operator=(const MemoryScope&) = delete;

 private:
  ShaderMemory outer_;
};

class Grid {
 public:
  explicit Grid(const DispatchContext& dispatch) : dispatch_(dispatch) {}

  uint64_t warp_count() const { return (dispatch_.thread_count() + dispatch_.warp_size - 1) / dispatch_.warp_size; }

  DispatchStatistics run() {
    const uint64_t grain = std::clamp(warp_count() / chunks_wanted, least_warps_per_chunk, most_warps_per_chunk);
    parallel_for(warp_count(), grain, [this](uint64_t begin, uint64_t end) { run_warps(begin, end); });
    return pool_.statistics();
  }

 private:
  void run_warps(uint64_t begin, uint64_t end) {
    const MemoryScope memory(dispatch_.shader_memory);
    std::unique_ptr<Warp> warp = pool_.take(dispatch_);
    if (dispatch_.tracer)
      for (uint64_t index = begin; index < end; ++index) run_traced_warp(*warp, index);
    else
      run_lanes(*warp, nullptr, begin, end);
    pool_.give_back(std::move(warp));  // unless a lane has failed
  }

  /// Those of warps begin .. end - 1.
  void run_lanes(Warp& warp, WarpTracer* tracer, uint64_t begin, uint64_t end) {
    const uint64_t first = begin * dispatch_.warp_size;
    warp.run(tracer, first, std::min(end * dispatch_.warp_size, dispatch_.thread_count()) - first);
  }

  void run_traced_warp(Warp& warp, uint64_t index) {
    std::unique_ptr<WarpTracer> tracer = dispatch_.tracer->begin_warp(index);
    std::exception_ptr failure;
    try {
      run_lanes(warp, tracer.get(), index, index + 1);
    } catch (...) {
      failure = std::current_exception();
    }
    dispatch_.tracer->end_warp(index, std::move(tracer));
    if (failure) std::rethrow_exception(failure);
  }

  const DispatchContext& dispatch_;
  WarpPool pool_;
};

DispatchReport run_grid(const DispatchContext& dispatch) {
  Grid grid(dispatch);
  DispatchReport report;
  report.mode = dispatch.mode;
  report.warp_size = dispatch.warp_size;
  report.warps = grid.warp_count();
  const DISPATCH_RAYS_DESC& desc = dispatch.desc();
  Tracer* const tracer = dispatch.tracer;
  if (tracer)
    tracer->begin_dispatch({desc.Width, desc.Height, desc.Depth, dispatch.warp_size, report.warps,
                            dispatch.pipeline.infos, dispatch.memory.addresses()});
  report.statistics = grid.run();
  if (tracer) tracer->end_dispatch();
  return report;
}

}  // namespace

DispatchReport dispatch_rays(const DispatchCommand& command, const DispatchOptions& options, const DeviceMemory& memory,
                             ValidationLog& log) {
  if (options.warp_size < 1 || options.warp_size > 64)
    throw InputError("DispatchOptions", "warp_size", std::to_string(options.warp_size) + " is not 1 to 64");
  if (const Problem problem = dispatch_problem(command); !problem.row.empty()) {
    if (!problem.text.empty()) log.add(problem.row, 0, problem.text);
    DispatchReport report;
    report.skipped_by = problem.row;
    return report;
  }
  StructureCache structures(memory, options.tracer && options.tracer->observes_shaders());
  const ShaderMemory view = memory.shader_memory();
  const DISPATCH_RAYS_DESC& desc = command.desc;
  const GPU_VIRTUAL_ADDRESS_RANGE& first = desc.RayGenerationShaderRecord;
  const Pipeline& pipeline = command.state_object->pipeline();
  return run_grid(
      {.command = command,
       .pipeline = pipeline,
       .memory = memory,
       .shader_memory = view,
       .tracer = options.tracer,
       .structures = structures,
       .log = log,
       .mode = choose_mode(command, options),
       .warp_size = options.warp_size,
       .lanes = options.tracer ? options.warp_size : 2 * options.warp_size,
       .fiber_stack_bytes = fiber_stack_bytes(command, options),
       .observed = options.tracer && options.tracer->observes_shaders(),
       .validates = log.enabled(),
       .ray_generation = {view, pipeline, {first.StartAddress, first.SizeInBytes, 0}, ExportKind::ray_generation},
       .miss = {view, pipeline, desc.MissShaderTable, ExportKind::miss},
       .hit_groups = {view, pipeline, desc.HitGroupTable, ExportKind::hit_group},
       .callables = {view, pipeline, desc.CallableShaderTable, ExportKind::callable}});
}

}  // namespace detail
}  // namespace rayloom
