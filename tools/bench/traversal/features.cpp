#include <rayloom/tools/bench/traversal/features.h>

#include <rayloom/accel/walk.h>
#include <rayloom/base/parallel.h>
#include <rayloom/tools/bench/instructions.h>
#include <rayloom/tools/bench/traced_rays.h>
#include <rayloom/tools/bench/traversal/dispatch.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

/// A feature by the names of its regions. The difference of `unused` to `baseline` has to be zero; that of `used` is
/// its price.
struct Feature {
  const char *name, *baseline, *unused, *used;
  bool in_kernel;
  const char* meaning;  ///< of "used"
};

constexpr Feature features[] = {
    {"any-hit", "plain", "opaque, candidate function", "non-opaque, candidate function", true,
     "every triangle asks a function that accepts"},
    {"mask", "plain", "opaque, mask 0x01", "instance, mask 0x01", true, "one instance, whose mask is tested"},
    {"procedural", "plain", "opaque, candidate function", "boxes", true, "a box a triangle, a function that rejects"},
    {"instancing", "plain", "plain again", "instance, mask 0xFF", true, "one instance around the scene"},
    {"statistics", "scalar", "empty visitor", "counting visitor", true, "scalar kernel; nodes and leaves are counted"},
    {"validation", "dispatch", "dispatch again", "dispatch, validated", false, "the runtime checks every TraceRay"},
};

accel::Verdict accept(void*, const accel::Candidate&) noexcept { return {.commit = true}; }
accel::Verdict reject(void*, const accel::Candidate&) noexcept { return {}; }

struct CountingVisitor : accel::Visitor {
  uint64_t nodes = 0, leaves = 0;
  void on_node(const accel::Node8*, uint32_t, const float (&)[8]) { ++nodes; }
  void on_triangle_leaf(const accel::TriangleLeaf*, uint32_t, uint32_t) { ++leaves; }
};

/// The region in which half the rays are traced.
std::string half_of(const std::string& region) { return region + ", half"; }

/// Counts nothing but the kernel, each time on the same memory: how it is aligned would show.
class KernelCounter {
 public:
  explicit KernelCounter(const Rays& rays) : requests_(rays.size()), hits_(rays.size()) {
    for (size_t i = 0; i < rays.size(); ++i) requests_[i].ray = rays[i];
  }

  void count(const char* name, const std::byte* structure, accel::CandidateFunction candidate = nullptr,
             uint32_t mask = 0xFF) {
    for (accel::TraceRequest& request : requests_) {
      request.structure = structure;
      request.candidate = candidate;
      request.instance_mask = mask;
    }
    count_region(name, [&] { accel::trace({}, requests_, hits_); });
    const size_t half = requests_.size() / 2;
    count_region(half_of(name),
                 [&] { accel::trace({}, std::span(requests_).first(half), std::span(hits_).first(half)); });
  }

 private:
  std::vector<accel::TraceRequest> requests_;
  std::vector<accel::Hit> hits_;
};

/// A box a triangle of the scene, as procedural primitives.
std::vector<std::array<float, 6>> boxes_of(const BenchScene& scene) {
  std::vector<std::array<float, 6>> boxes;
  for (uint32_t i = 0; i < scene.meshes[0].triangle_count(); ++i) {
    scenes::Bounds bounds;
    for (const glm::vec3& corner : scene.triangle(0, i)) bounds.add(corner);
    boxes.push_back({bounds.min.x, bounds.min.y, bounds.min.z, bounds.max.x, bounds.max.y, bounds.max.z});
  }
  return boxes;
}

void count_boxes(const BenchScene& scene, KernelCounter& kernel) {
  const std::vector<std::array<float, 6>> boxes = boxes_of(scene);
  const accel::AabbGeometry geometry[]{{reinterpret_cast<const std::byte*>(boxes.data()), 24, boxes.size(), 0}};
  const std::span<const accel::AabbGeometry> inputs(geometry);
  const uint64_t bytes = accel::bottom_level_sizes(inputs, 0u).result_bytes;
  const auto free = [](std::byte* p) { ::operator delete[](p, std::align_val_t{accel::structure_alignment}); };
  const std::unique_ptr<std::byte[], decltype(free)> block(
      static_cast<std::byte*>(::operator new[](bytes, std::align_val_t{accel::structure_alignment})), free);
  accel::build_bottom_level(inputs, 0u, std::span(block.get(), bytes));
  kernel.count("boxes", block.get(), reject);
}

void count_scalar(const Rays& rays, const OurStructure& structure) {
  const accel::Isa isa = accel::current_isa();
  accel::set_isa(accel::Isa::scalar);
  const auto walk_all = [&](auto& visitor) {
    for (const accel::Ray& ray : rays) accel::walk({}, structure.request(ray), visitor);
  };
  count_region("scalar", [&] {
    accel::Visitor none;
    walk_all(none);
  });
  count_region("empty visitor", [&] {
    struct Empty : accel::Visitor {
    } none;
    walk_all(none);
  });
  count_region("counting visitor", [&] {
    CountingVisitor visitor;
    walk_all(visitor);
  });
  accel::set_isa(isa);
}

void count_dispatches(const BenchScene& scene, const Rays& rays) {
  DispatchBench plain(scene, rays);
  for (const char* name : {"dispatch", "dispatch again"}) count_region(name, [&] { plain.run(DispatchPart::whole); });
  DispatchBench validated(scene, rays, true);
  count_region("dispatch, validated", [&] { validated.run(DispatchPart::whole); });
}

/// Instructions that a region takes beyond a baseline.
struct Cost {
  double per_ray = 0, per_call = 0;
};

using Regions = std::map<std::string, uint64_t>;

double beyond(const Regions& regions, const std::string& region, const std::string& baseline) {
  return static_cast<double>(regions.at(region)) - static_cast<double>(regions.at(baseline));
}

/// What is the same for half the rays belongs to the call.
Cost cost_beyond(const Regions& regions, double rays, const std::string& region, const std::string& baseline) {
  const double whole = beyond(regions, region, baseline);
  if (!regions.contains(half_of(region))) return {whole / rays, 0};
  const double half = beyond(regions, half_of(region), half_of(baseline));
  const double per_ray = (whole - half) / (rays - std::floor(rays / 2));
  return {per_ray, whole - per_ray * rays};
}

}  // namespace

void count_features(const FeatureOptions& options) {
  const ThreadLimit one_thread(1);
  const BenchScene scene = load_bench_scene(options.scene, options.scenes_directory, UINT64_MAX);
  BenchScene placed = scene;
  placed.instances = {{0, accel::identity_transform}};
  const OurStructure opaque(scene), open(scene, accel::build_flag::prefer_fast_trace, accel::geometry_flag::none);
  const OurStructure instanced(placed);
  const Rays rays = make_ray_sets(scene, opaque, static_cast<uint32_t>(options.size)).bounce;
  KernelCounter kernel(rays);
  // The first leaves the heap as all others find it.
  for (const char* name : {"first", "plain", "plain again"}) kernel.count(name, opaque.root());
  kernel.count("opaque, candidate function", opaque.root(), accept);
  kernel.count("opaque, mask 0x01", opaque.root(), nullptr, 1);
  kernel.count("non-opaque, candidate function", open.root(), accept);
  kernel.count("instance, mask 0xFF", instanced.root());
  kernel.count("instance, mask 0x01", instanced.root(), nullptr, 1);
  count_boxes(scene, kernel);
  count_scalar(rays, opaque);
  count_dispatches(scene, rays);
  fmt::print("{}\n", rays.size());
}

void add_features(BenchReport& report, const FeatureOptions& options) {
  std::vector<std::string> arguments{"bench", "traversal", options.scene, "--count-features",
                                     "--isa", "avx2",      "--size",      std::to_string(options.size)};
  if (!options.scenes_directory.empty()) arguments.insert(arguments.end(), {"--scenes-dir", options.scenes_directory});
  const CountedRun run = count_instructions(arguments);
  const double rays = std::stod(run.out);
  report.json["features"] = {{"scene", options.scene}, {"rays", rays}, {"rows", Json::array()}};
  PageTable table{"features",
                  fmt::format("Instructions a ray, {} bounce rays of {} (callgrind, AVX2)", rays, options.scene),
                  {{"feature", "baseline", "not used", "not used, a call", "used", "what used means"}}};
  for (const Feature& feature : features) {
    const double baseline = static_cast<double>(run.regions.at(feature.baseline)) / rays;
    const double used = beyond(run.regions, feature.used, feature.baseline) / rays;
    const Cost unused = cost_beyond(run.regions, rays, feature.unused, feature.baseline);
    table.rows.push_back({feature.name, fmt::format("{:.1f}", baseline), fmt::format("{:+.3f}", unused.per_ray),
                          fmt::format("{:+.0f}", unused.per_call), fmt::format("{:+.1f}", used), feature.meaning});
    report.json["features"]["rows"].push_back({{"feature", feature.name},
                                               {"baseline_instructions_per_ray", baseline},
                                               {"unused_instructions_per_ray", unused.per_ray},
                                               {"unused_instructions_per_call", unused.per_call},
                                               {"used_instructions_per_ray", used}});
    if (!feature.in_kernel) continue;
    report.targets.at_most(std::string(feature.name) + ": instructions a ray where it is not used", unused.per_ray, 0);
  }
  table.rows.push_back({"micromap hook", "", "+0.000", "+0", "", "the kernels have none"});
  report.add_table(table);
}

}  // namespace rayloom::bench
