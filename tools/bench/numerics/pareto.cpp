#include <rayloom/base/error.h>
#include <rayloom/tests/accel/structures.h>
#include <rayloom/tools/bench/measure.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/pareto.h>
#include <rayloom/tools/bench/numerics/transforms.h>
#include <rayloom/tools/bench/peer_embree.h>

#include <functional>

#include <fmt/format.h>

namespace rayloom::bench::numerics {
namespace {

using Hits = std::vector<accel::Hit>;
using Rays = std::vector<Ray>;

/// A closed mesh from inside, and its triangles as the peer takes them.
struct Scene {
  std::string name;
  Mesh mesh;
  Point inside;
  std::vector<float> vertices;
  std::vector<uint32_t> indices;

  Scene(std::string scene_name, Mesh closed, const Point& origin)
      : name(std::move(scene_name)), mesh(std::move(closed)), inside(origin) {
    for (const Point& p : mesh.vertices) vertices.insert(vertices.end(), p.begin(), p.end());
    vertices.resize(vertices.size() + 4);  // slack that the peer reads
    for (const auto& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  }
};

Mesh moved_to(Mesh mesh, float scale, const Point& to) {
  for (Point& p : mesh.vertices)
    for (int k = 0; k < 3; ++k) p[k] = p[k] * scale + to[k];
  return mesh;
}

/// The second is where Embree's own watertightness test stands.
std::vector<Scene> pareto_scenes() {
  using namespace accel::test;
  const Point far{148376, 1234, -223423}, million{1e6f, 1e6f, 1e6f};
  std::vector<Scene> scenes;
  scenes.emplace_back("sphere", icosphere(6), Point{0.1f, -0.2f, 0.3f});
  scenes.emplace_back("far sphere", moved_to(icosphere(6), 2, far), far);
  scenes.emplace_back("very far sphere", moved_to(icosphere(5), 1, million), million);
  scenes.emplace_back("bumpy sphere", bumpy_sphere(6), Point{0, 0, 0});
  scenes.emplace_back("torus", torus(400, 100, 0.375f), Point{1, 0.0625f, 0});
  scenes.emplace_back("poles of 2000", sphere_with_poles(2000, 20), Point{0.0625f, -0.03125f, 0.125f});
  return scenes;
}

/// All of them, or the one of that name. Throws InputError.
std::vector<Scene> chosen_scenes(const std::string& name) {
  std::vector<Scene> scenes = pareto_scenes();
  std::string names;
  for (const Scene& scene : scenes) names += " '" + scene.name + "'";
  if (!name.empty()) std::erase_if(scenes, [&](const Scene& scene) { return scene.name != name; });
  if (scenes.empty()) throw InputError("--mesh: '" + name + "' is not one of" + names);
  return scenes;
}

struct Tracer {
  std::string name;
  std::function<void(const Rays&, Hits&)> closest;
};

/// Ours and the peer's over one scene.
class Tracers {
 public:
  explicit Tracers(const Scene& scene) : block_(accel::test::build_mesh(scene.mesh)) {
    list.push_back({"ours, single", [this](const Rays& rays, Hits& hits) {
                      for (size_t i = 0; i < rays.size(); ++i)
                        hits[i] = accel::trace({}, accel::test::request_for(block_, rays[i]));
                    }});
    list.push_back({"ours, batch", [this](const Rays& rays, Hits& hits) { trace_batches(rays, hits); }});
    if (embree_version().empty()) return;
    peer_scene_.meshes = {{scene.vertices, scene.indices}};
    for (const auto& [robust, compact, name] :
         {std::tuple{false, false, "Embree fast"}, {true, false, "Embree robust"}, {false, true, "Embree compact"}}) {
      EmbreeOptions options;
      options.robust = robust, options.compact = compact;
      peers_.push_back(make_embree(peer_scene_, options));
      const Peer* peer = peers_.back().get();
      list.push_back({name, [peer](const Rays& rays, Hits& hits) { peer->closest_hits(rays, hits); }});
    }
  }
  Tracers(const Tracers&) = delete;
  Tracers& operator=(const Tracers&) = delete;

  std::vector<Tracer> list;

 private:
  void trace_batches(const Rays& rays, Hits& hits) const {
    constexpr size_t batch = 4096;
    std::vector<accel::TraceRequest> requests;
    for (size_t begin = 0; begin < rays.size(); begin += batch) {
      requests.clear();
      for (size_t i = begin; i < std::min(rays.size(), begin + batch); ++i)
        requests.push_back(accel::test::request_for(block_, rays[i]));
      accel::trace({}, requests, std::span(hits).subspan(begin, requests.size()));
    }
  }

  accel::test::Block block_;
  PeerScene peer_scene_;
  std::vector<std::unique_ptr<Peer>> peers_;
};

Ray random_ray(const Scene& scene, Random& random) {
  Ray ray{{scene.inside[0], scene.inside[1], scene.inside[2]}, 0, {}, accel::Box::infinity};
  for (float& x : ray.direction) x = random.uniform(-1, 1);
  return ray;
}

Ray vertex_ray(const Scene& scene, Random& random) {
  return ray_between(scene.inside,
                     scene.mesh.vertices[random.below(static_cast<uint32_t>(scene.mesh.vertices.size()))]);
}

Ray edge_ray(const Scene& scene, Random& random) {
  const auto& triangle = scene.mesh.triangles[random.below(static_cast<uint32_t>(scene.mesh.triangles.size()))];
  const uint32_t corner = random.below(3);
  Point target = scene.mesh.vertices[triangle[corner]];
  const Point& next = scene.mesh.vertices[triangle[(corner + 1) % 3]];
  const float along = random.uniform(0, 1);
  for (int k = 0; k < 3; ++k) target[k] += along * (next[k] - target[k]);
  return ray_between(scene.inside, target);
}

template <class Make>
Rays make_rays(const Scene& scene, uint64_t count, uint64_t seed, const Make& make) {
  Random random(seed);
  Rays rays(count);
  for (Ray& ray : rays) ray = make(scene, random);
  return rays;
}

/// What one tracer came to on one scene.
struct Outcome {
  double ns = 0;
  uint64_t misses = 0, edge_rays = 0;
  uint64_t vertex_misses = 0, vertex_rays = 0;
  std::vector<float> ulps;
};

uint64_t misses_of(const Hits& hits) {
  return static_cast<uint64_t>(std::count_if(hits.begin(), hits.end(), [](const accel::Hit& hit) { return !hit; }));
}

/// Errors of t against the exact plane of the triangle that the tracer names.
std::vector<float> t_errors(const Scene& scene, const Rays& rays, const Hits& hits) {
  std::vector<float> ulps(rays.size());
  parallel_for(rays.size(), 64, [&](uint64_t begin, uint64_t end) {
    for (uint64_t i = begin; i < end; ++i) {
      if (!hits[i]) continue;
      const auto& [a, b, c] = scene.mesh.triangles[hits[i].primitive_index];
      const Triangle triangle{scene.mesh.vertices[a], scene.mesh.vertices[b], scene.mesh.vertices[c]};
      ulps[i] = static_cast<float>(ulps_from(hits[i].t, Chain().exact_t(rays[i], triangle)));
    }
  });
  std::sort(ulps.begin(), ulps.end());
  return ulps;
}

double quantile(const std::vector<float>& sorted, double fraction) {
  return sorted.empty() ? 0 : sorted[static_cast<size_t>(fraction * static_cast<double>(sorted.size() - 1))];
}

/// Points of all tracers on one scene, in the order of Tracers::list.
std::vector<Outcome> measure_scene(const Scene& scene, const Tracers& tracers, const ParetoOptions& options) {
  const Rays edge = make_rays(scene, options.edge_rays, options.seed, edge_ray);
  const Rays vertex = make_rays(scene, options.edge_rays / 5, options.seed + 3, vertex_ray);
  const Rays timed = make_rays(scene, options.timed_rays, options.seed + 1, random_ray);
  const Rays exact = make_rays(scene, options.exact_rays, options.seed + 2, random_ray);
  std::vector<Outcome> points(tracers.list.size());
  std::vector<Measurand> measurands;
  Hits timed_hits(timed.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Tracer& tracer = tracers.list[i];
    Hits hits(edge.size());
    tracer.closest(edge, hits);
    points[i].misses = misses_of(hits);
    points[i].edge_rays = edge.size();
    hits.resize(vertex.size());
    tracer.closest(vertex, hits);
    points[i].vertex_misses = misses_of(hits);
    points[i].vertex_rays = vertex.size();
    hits.resize(exact.size());
    tracer.closest(exact, hits);
    points[i].ulps = t_errors(scene, exact, hits);
    measurands.push_back({tracer.name, [&] { tracer.closest(timed, timed_hits); }, static_cast<double>(timed.size())});
  }
  const auto measured = measure_interleaved(measurands, options.repetitions, Clock::thread_cpu, scene.name);
  for (size_t i = 0; i < points.size(); ++i) points[i].ns = 1e9 * measured[i].time().median / measured[i].work;
  return points;
}

double per_billion(uint64_t misses, uint64_t rays) {
  return 1e9 * static_cast<double>(misses) / static_cast<double>(rays);
}

std::string rate_text(uint64_t misses, uint64_t rays) {
  return misses ? fmt::format("{:.3g}", per_billion(misses, rays)) : fmt::format("0 (< {:.2g})", per_billion(3, rays));
}

std::vector<std::string> table_row(const std::string& scene, const std::string& tracer, const Outcome& point) {
  return {scene,
          tracer,
          fmt::format("{:.1f}", point.ns),
          std::to_string(point.misses),
          std::to_string(point.edge_rays),
          rate_text(point.misses, point.edge_rays),
          rate_text(point.vertex_misses, point.vertex_rays),
          fmt::format("{:.3g}", quantile(point.ulps, 0.5)),
          fmt::format("{:.3g}", quantile(point.ulps, 0.999)),
          fmt::format("{:.3g}", quantile(point.ulps, 1))};
}

/// Over all scenes: the median time, all misses of all rays, all errors.
Outcome combined(const std::vector<Outcome>& scenes) {
  Outcome all;
  std::vector<double> times;
  for (const Outcome& point : scenes) {
    times.push_back(point.ns);
    all.misses += point.misses;
    all.edge_rays += point.edge_rays;
    all.vertex_misses += point.vertex_misses;
    all.vertex_rays += point.vertex_rays;
    all.ulps.insert(all.ulps.end(), point.ulps.begin(), point.ulps.end());
  }
  std::sort(all.ulps.begin(), all.ulps.end());
  all.ns = spread_of(times).median;
  return all;
}

struct Charts {
  Chart misses{"pareto_misses",
               "Time against false misses",
               {"ns/ray", false, true},
               {"false misses per 10⁹ edge rays (0 seen: 95 % bound)", true},
               {}};
  Chart errors{"pareto_t", "Time against error of t", {"ns/ray", false, true}, {"99.9 % error of t (ulp)", true}, {}};

  void add(const std::string& name, const Outcome& point) {
    const double rate = per_billion(point.misses ? point.misses : 3, point.edge_rays);
    const std::string bound = point.misses ? "" : ": 0 seen";
    misses.series.push_back({name + bound, {{point.ns, rate, 0, 0, ""}}, Style::points});
    errors.series.push_back({name, {{point.ns, quantile(point.ulps, 0.999), 0, 0, ""}}, Style::points});
  }
};

}  // namespace

void add_pareto(BenchReport& report, const ParetoOptions& options) {
  PageTable table{"pareto", "Run time against error, one thread, incoherent rays from inside closed meshes", {}};
  table.rows.push_back({"scene", "tracer", "ns/ray", "false misses", "of edge rays", "per 10^9", "at vertices",
                        "t error, median ulp", "99.9 % ulp", "largest ulp"});
  std::vector<std::string> names;
  std::vector<std::vector<Outcome>> by_tracer;
  for (const Scene& scene : chosen_scenes(options.mesh)) {
    const Tracers tracers(scene);
    const auto points = measure_scene(scene, tracers, options);
    by_tracer.resize(points.size());
    names.clear();
    for (size_t i = 0; i < points.size(); ++i) {
      names.push_back(tracers.list[i].name);
      table.rows.push_back(table_row(scene.name, names[i], points[i]));
      by_tracer[i].push_back(points[i]);
    }
  }
  Charts charts;
  for (size_t i = 0; i < names.size(); ++i) {
    const Outcome all = combined(by_tracer[i]);
    table.rows.push_back(table_row("all", names[i], all));
    charts.add(names[i], all);
    report.json["pareto"].push_back({{"tracer", names[i]},
                                     {"ns_per_ray", all.ns},
                                     {"false_misses", all.misses},
                                     {"edge_rays", all.edge_rays},
                                     {"false_vertex_misses", all.vertex_misses},
                                     {"vertex_rays", all.vertex_rays},
                                     {"t_error_ulp_999", quantile(all.ulps, 0.999)}});
    if (names[i].starts_with("ours")) {
      report.targets.at_most(names[i] + ": false misses", static_cast<double>(all.misses + all.vertex_misses), 0);
      report.targets.at_most(names[i] + ": largest error of t", quantile(all.ulps, 1), 0.5, " ulp");
    }
  }
  report.add_table(table);
  report.page.add_chart(charts.misses);
  report.page.add_chart(charts.errors);
}

}  // namespace rayloom::bench::numerics
