// B1 to B4: shapes made to hurt builders. Depth, size and hits are gated; times are not.

#include <rayloom/accel/walk.h>
#include <rayloom/tests/accel/brute_force.h>
#include <rayloom/tests/accel/hard_meshes.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>

#include <chrono>
#include <fmt/format.h>

namespace rayloom::bench::numerics {
namespace {

using accel::test::Block;
using accel::test::concentric;
using accel::test::copies;
using accel::test::exponential;

Mesh two_clusters(uint64_t count) {
  Mesh mesh;
  for (const float x : {-100.0f, 100.0f})
    for (const Point& p : {Point{x - 1, -1, 1}, {x + 1, -1, 1}, {x, 2, 1}}) mesh.add(p);
  for (uint64_t i = 0; i < count; ++i)
    mesh.triangles.push_back(i % 2 ? std::array{0u, 1u, 2u} : std::array{3u, 4u, 5u});
  return mesh;
}

Mesh scattered(uint64_t count, uint64_t seed) {
  Mesh mesh;
  Random random(seed);
  for (uint64_t i = 0; i < count; ++i) {
    const Point at = accel::test::random_point(random, 100);
    mesh.add_triangle(at, {at[0] + random.uniform(-1, 1), at[1] + 1, at[2]},
                      {at[0], at[1] + random.uniform(-1, 1), at[2] + 1});
  }
  return mesh;
}

/// Octahedra inside each other.
Mesh nested_shells(int levels) {
  Mesh mesh;
  const Mesh shell = accel::test::octahedron();
  for (int i = 0; i < levels; ++i) {
    const Mesh scaled = accel::test::moved(shell, std::ldexp(1.0f, -i), 0);
    for (const auto& [a, b, c] : scaled.triangles)
      mesh.add_triangle(scaled.vertices[a], scaled.vertices[b], scaled.vertices[c]);
  }
  return mesh;
}

Mesh slivers(uint64_t count, uint64_t seed) {
  Mesh mesh;
  Random random(seed);
  for (uint64_t i = 0; i < count; ++i) {
    const Point a = accel::test::random_point(random, 1), b = accel::test::random_point(random, 1);
    mesh.add_triangle(a, b, {a[0] + 1e-4f, a[1], a[2]});
  }
  return mesh;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct TimedBuild {
  Block block;
  double seconds;
};

TimedBuild timed_build(const Mesh& mesh, accel::Builder builder) {
  const auto geometry = mesh.geometry();
  const accel::BuildSettings settings(accel::build_flag::none, builder);
  const std::span<const accel::TriangleGeometry> span(&geometry, 1);
  Block block(accel::bottom_level_sizes(span, settings).result_bytes);
  const auto start = std::chrono::steady_clock::now();
  block.used = accel::build_bottom_level(span, settings, block.span());
  return {std::move(block), seconds_since(start)};
}

/// Of rays along z through the middle, as a batch.
double ns_per_ray(const Block& block) {
  std::vector<Ray> rays(16, Ray{{0.01f, 0.02f, 0}, 0, {0, 0, 1}, INFINITY});
  for (size_t i = 0; i < rays.size(); ++i) rays[i].origin[0] += 0.001f * static_cast<float>(i);
  std::vector<accel::Hit> hits(rays.size());
  const auto start = std::chrono::steady_clock::now();
  accel::trace({}, accel::test::request_for(block, rays[0]), rays, hits);
  return 1e9 * seconds_since(start) / static_cast<double>(rays.size());
}

void judge_depth(RowRun& run, const std::string& what, const Mesh& mesh, const TimedBuild& built, double uniform) {
  const auto count = static_cast<double>(mesh.triangles.size());
  run.at_most(what + ": depth", built.block.header().depth, "nodes", std::ceil(std::log2(count)) + 8);
  run.at_most(what + ": bytes per triangle", static_cast<double>(built.block.used) / count, "bytes", 128);
  run.report(what + ": build time over that of scattered triangles", built.seconds / uniform, "x (a time: not gated)");
  run.report(what + ": a ray through all", ns_per_ray(built.block), "ns (a time: not gated)");
}

/// Closest hits of every builder's tree against brute force.
void compare_builders(RowRun& run, const std::string& what, const Mesh& mesh, Cases rays) {
  const auto triangles = accel::test::all_triangles({mesh.geometry()});
  std::vector<TimedBuild> built;
  uint64_t deepest = 0;
  for (const accel::Builder builder : accel::all_builders()) {
    built.push_back(timed_build(mesh, builder));
    deepest = std::max<uint64_t>(deepest, built.back().block.header().depth);
  }
  const Tally tally = run.sample(rays, 8, [&](Random& random, Tally& t) {
    const Point& at = mesh.vertices[random.below(static_cast<uint32_t>(mesh.vertices.size()))];
    const Ray ray = ray_between(accel::test::random_point(random, 1), at);
    const auto expected = accel::test::closest_of(accel::test::all_hits(triangles, ray), ray);
    for (const TimedBuild& tree : built) {
      const auto hit = accel::trace({}, accel::test::request_for(tree.block, ray));
      if (!accel::test::same_bits(hit, expected)) t.fail(0, ray, {});
    }
  });
  run.none(what + ": other hits than brute force", tally.count[0], rays.count * built.size());
  run.at_most(what + ": depth", static_cast<double>(deepest), "nodes", accel::max_depth);
}

/// The most that the stack of a walk over everything held.
struct StackWatch : accel::Visitor {
  void on_pop(uint32_t, float, bool) { --now; }
  void on_node(const accel::Node8*, uint32_t mask, const float (&)[8]) {
    now += std::popcount(mask);
    most = std::max(most, now);
  }
  int now = 1, most = 1;
};

/// A mesh of a random kind, so that trees of all shapes come up.
Mesh any_mesh(Random& random) {
  const uint32_t count = 1 + random.below(1 + random.below(600));
  switch (random.below(5)) {
    case 0:
      return scattered(count, random.bits());
    case 1:
      return slivers(count, random.bits());
    case 2:
      return exponential(1 + static_cast<int>(random.below(140)), 1 + static_cast<int>(random.below(4)),
                         random.chance(2));
    case 3:
      return copies(count);
    default:
      return concentric(count);
  }
}

void watch_stack(Random& random, Tally& tally) {
  const Mesh mesh = any_mesh(random);
  const auto builders = accel::all_builders();
  const TimedBuild built = timed_build(mesh, builders[random.below(static_cast<uint32_t>(builders.size()))]);
  const auto depth = static_cast<int>(built.block.header().depth);
  for (int i = 0; i < 4; ++i) {
    const Point& at = mesh.vertices[random.below(static_cast<uint32_t>(mesh.vertices.size()))];
    auto request = accel::test::request_for(built.block, ray_between(accel::test::random_point(random, 2), at),
                                            accel::ray_flag::force_non_opaque);
    request.candidate = [](void*, const accel::Candidate&) noexcept { return accel::Verdict{}; };  // nothing is culled
    StackWatch watch;
    accel::walk({}, request, watch);
    tally.add(0, watch.most > 7 * depth + 1);
    tally.grow(0, watch.most);
    tally.grow(1, depth);
  }
}

}  // namespace

void run_equal_centres(RowRun& run) {
  const uint64_t count = std::min<uint64_t>(10000000, run.slow(500000).count);
  const Mesh reference = scattered(count, run.seed());
  const auto builders = accel::all_builders();
  run.repeat({builders.size(), Growth::slow}, [&](uint64_t i) {
    const accel::Builder builder = builders[i];
    const std::string name = fmt::format("{}, {} ", accel::builder_name(builder), count);
    const double uniform = timed_build(reference, builder).seconds;
    for (const auto& [what, mesh] : {std::pair{"identical", copies(count)},
                                     {"concentric", concentric(count)},
                                     {"in two clusters", two_clusters(count)}})
      judge_depth(run, name + what, mesh, timed_build(mesh, builder), uniform);
  });
}

void run_exponential(RowRun& run) {
  for (const bool both : {false, true})
    for (const int per_level : {1, 9, 100})
      compare_builders(run, fmt::format("{} a level{}", per_level, both ? ", both sides" : ""),
                       exponential(141, per_level, both), run.slow(200));
  compare_builders(run, "nested shells", nested_shells(120), run.slow(400));
}

void run_slivers(RowRun& run) {
  compare_builders(run, "3,000 slivers", slivers(3000, run.seed()), run.slow(500));
  std::vector<uint64_t> counts{1000, 30000};
  if (run.tier() >= Tier::nightly) counts.push_back(1000000);
  for (const uint64_t count : counts) {
    const Mesh mesh = slivers(count, run.seed());
    const TimedBuild built = timed_build(mesh, accel::Builder::automatic);
    Random random(run.seed());
    const auto start = std::chrono::steady_clock::now();
    constexpr int rays = 300;
    for (int i = 0; i < rays; ++i) {
      const Ray ray = ray_between(accel::test::random_point(random, 2), accel::test::random_point(random, 1));
      accel::trace({}, accel::test::request_for(built.block, ray));
    }
    run.report(fmt::format("{} slivers", count), 1e9 * seconds_since(start) / rays, "ns/ray (a time: not gated)");
  }
}

void run_stack(RowRun& run) {
  const Tally tally = run.sample(run.slow(5000), 8, watch_stack);
  run.none("walks with more on the stack than 7 depth + 1", tally.count[0], 4 * tally.cases, "walks");
  run.at_most("most on the stack", tally.most[0], "entries", accel::stack_entries);
  run.at_most("deepest tree", tally.most[1], "nodes", accel::max_depth);
}

}  // namespace rayloom::bench::numerics
