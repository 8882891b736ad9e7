// K1 to K5: no ray slips between triangles that share an edge or a vertex, and none is counted twice.

#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>

#include <fmt/format.h>

namespace rayloom::bench::numerics {
namespace {

int largest_level(Tier tier) {
  constexpr int levels[] = {3, 5, 7, 9};
  return levels[static_cast<size_t>(tier)];
}

void shoot_all(RowRun& run, const std::vector<ClosedMesh>& meshes, Aim aim, Cases rays, Tally& total) {
  for (const ClosedMesh& mesh : meshes) total.merge(shoot(run, mesh, aim, rays / meshes.size()));
}

/// Triangles of a random closed mesh against the rationals, by rays aimed at what they share.
void compare_with_rationals(RowRun& run, const std::vector<ClosedMesh>& meshes, Aim aim, Cases rays) {
  const Tally tally = run.sample(rays, 16, [&](Random& random, Tally& t) {
    const Mesh& mesh = meshes[random.below(static_cast<uint32_t>(meshes.size()))].mesh;
    const auto& [a, b, c] = mesh.triangles[random.below(static_cast<uint32_t>(mesh.triangles.size()))];
    const Triangle triangle{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    const Point origin{random.uniform(-0.5f, 0.5f), random.uniform(-0.5f, 0.5f), random.uniform(-0.5f, 0.5f)};
    Point target = triangle[0];
    if (aim == Aim::edge)
      for (int k = 0; k < 3; ++k) target[k] += 0.5f * (triangle[1][k] - triangle[0][k]);
    for (float& x : target) x = random.nudged(x, random.below(3));
    const Ray ray = ray_between(origin, target);
    if (!difference_from_exact(run.subject, ray, triangle).empty()) t.fail(0, ray, {triangle});
  });
  run.none("different from the rationals", tally.count[0], tally.cases, "ray-triangle pairs");
}

/// Counts rays of one placement that leaked or were counted wrongly.
uint64_t failures(const Tally& tally) {
  return tally.count[leaks] + tally.count[wrong_parity] + tally.count[not_one] + tally.count[closest_differs];
}

struct Placement {
  std::string name;
  float scale, offset;
};

/// 2^-100 to 2^100 and 1e-30 to 1e30; fewer for a quick run.
std::vector<Placement> scales(Tier tier) {
  std::vector<Placement> list;
  const int every = tier == Tier::quick ? 10 : 1;
  for (int e = -100; e <= 100; e += 4 * every) list.push_back({fmt::format("2^{}", e), std::ldexp(1.0f, e), 0});
  for (int e = -30; e <= 30; e += every)
    list.push_back({fmt::format("1e{}", e), std::strtof(fmt::format("1e{}", e).c_str(), nullptr), 0});
  return list;
}

/// Shoots at all meshes in all placements; names the placements that failed.
Tally shoot_placements(RowRun& run, const std::vector<ClosedMesh>& meshes, const std::vector<Placement>& placements,
                       Cases rays) {
  Tally total;
  const Cases each = rays / (placements.size() * meshes.size() * 2);
  for (const Placement& placement : placements) {
    Tally here;
    for (const ClosedMesh& mesh : meshes) {
      const ClosedMesh moved = placed(mesh, placement.scale, placement.offset);
      if (moved.viewpoints.empty()) continue;
      for (const Aim aim : {Aim::edge, Aim::vertex}) here.merge(shoot(run, moved, aim, each));
    }
    if (failures(here))
      run.note(fmt::format("at {}: {} failures in {} rays", placement.name, failures(here), here.cases));
    total.merge(here);
  }
  return total;
}

ClosedMesh closed_mixed_scales() {
  ClosedMesh closed{"mixed scales", mixed_scales(24), {}, false};
  return closed.look_from({0, 0, -1e3f}).look_from({1e-7f, 2e-8f, -1e-3f}).look_from({0.5f, 0.25f, 1e5f});
}

/// A ray along z (or slanted by whole steps) through a point of the half-integer grid.
Ray grid_ray(Random& random, uint32_t size) {
  const auto inner = [&] { return 0.5f * static_cast<float>(8 + random.below(2 * size - 16)); };
  const auto slope = [&] { return static_cast<float>(static_cast<int>(random.below(3)) - 1); };
  const float x = inner(), y = inner(), dx = slope(), dy = slope();
  const bool axis = random.chance(2);
  return {{axis ? x : x - 2 * dx, axis ? y : y - 2 * dy, 2}, 0, {axis ? 0 : dx, axis ? 0 : dy, -1}, INFINITY};
}

void shoot_grid(RowRun& run, Cases rays) {
  constexpr uint32_t size = 24;
  const Mesh mesh = accel::test::grid(size, 0);
  const auto tracer = run.subject.tracer({mesh});
  const Tally tally = run.sample(rays, 512, [&](Random& random, Tally& t) {
    const Ray ray = grid_ray(random, size);
    if (tracer->count(ray) != 1) t.fail(0, ray, {});
  });
  run.none("not exactly one, grid and axis rays", tally.count[0], tally.cases);
}

/// The exact rule itself, in rationals, over all triangles of a grid: exactly one, and the one the subject reports.
void sum_rationals_over_grid(RowRun& run, Cases rays) {
  constexpr uint32_t size = 10;
  const Mesh mesh = accel::test::grid(size, 0);
  const auto tracer = run.subject.tracer({mesh});
  const Tally tally = run.sample(rays, 4, [&](Random& random, Tally& t) {
    const Ray ray = grid_ray(random, size);
    uint32_t hits = 0, hit_triangle = 0;
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      if (!exact_hit(ray, {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]})) continue;
      ++hits;
      hit_triangle = i;
    }
    t.add(0, hits != 1);
    t.add(1, tracer->closest(ray).primitive_index != hit_triangle);
  });
  run.none("not exactly one by the rationals' rule", tally.count[0], tally.cases);
  run.none("another triangle than the rationals'", tally.count[1], tally.cases);
}

}  // namespace

void run_edges(RowRun& run) {
  Tally total;
  const Cases rays = run.rays(10000000);
  std::vector<ClosedMesh> meshes = closed_meshes(3);
  shoot_all(run, meshes, Aim::edge, rays / 2, total);
  for (int level = 4; level <= largest_level(run.tier()); ++level) {
    ClosedMesh sphere{"icosphere", accel::test::icosphere(level), {}, true};
    total.merge(shoot(run, sphere.look_from({0.1f, -0.2f, 0.3f}), Aim::edge, rays / 6));
  }
  judge_shots(run, total, "");
  compare_with_rationals(run, meshes, Aim::edge, run.slow(100000));
}

void run_vertices(RowRun& run) {
  Tally total, fans;
  const std::vector<ClosedMesh> meshes = closed_meshes(3), fan = fan_meshes();
  shoot_all(run, meshes, Aim::vertex, run.rays(1000000), total);
  shoot_all(run, fan, Aim::vertex, run.rays(200000), fans);
  judge_shots(run, total, "");
  judge_shots(run, fans, "fans and poles");
  compare_with_rationals(run, meshes, Aim::vertex, run.slow(50000));
  compare_with_rationals(run, fan, Aim::vertex, run.slow(50000));
}

void run_exactly_one(RowRun& run) {
  Tally total;
  std::vector<ClosedMesh> convex = closed_meshes(3);
  std::erase_if(convex, [](const ClosedMesh& mesh) { return !mesh.convex; });
  for (ClosedMesh& mesh : convex) std::erase_if(mesh.viewpoints, [](const Viewpoint& v) { return !v.inside; });
  for (const Aim aim : {Aim::edge, Aim::vertex}) shoot_all(run, convex, aim, run.rays(1500000), total);
  run.none("not exactly one, convex meshes", total.count[not_one], total.cases);
  shoot_grid(run, run.rays(1000000));
  sum_rationals_over_grid(run, run.slow(1000));
}

void run_scales(RowRun& run) {
  const std::vector<ClosedMesh> meshes = closed_meshes(2);
  judge_shots(run, shoot_placements(run, meshes, scales(run.tier()), run.rays(1000000)),
              "2^-100 to 2^100, 1e-30 to 1e30");
  Tally mixed;
  const ClosedMesh closed = closed_mixed_scales();
  for (const Aim aim : {Aim::edge, Aim::vertex, Aim::anywhere}) mixed.merge(shoot(run, closed, aim, run.rays(30000)));
  judge_shots(run, mixed, "1e-12 detail in a body of 1e6");
}

void run_far_from_origin(RowRun& run) {
  const std::vector<ClosedMesh> meshes = closed_meshes(2);
  std::vector<Placement> places;
  float offset = 1;
  for (int k = 0; k <= 7; ++k, offset *= 10) places.push_back({fmt::format("10^{}", k), 1, offset});
  judge_shots(run, shoot_placements(run, meshes, places, run.rays(2000000)), "offsets 1 to 1e7");
  Tally random_rays, brute;
  for (const Placement& place : places) {
    const ClosedMesh far = placed(meshes[0], 1, place.offset);
    random_rays.merge(shoot(run, far, Aim::anywhere, run.rays(100000)));
    compare_with_brute_force(run, far, run.slow(500), brute);
  }
  judge_shots(run, random_rays, "random rays");
  run.none("other closest t than brute force", brute.count[0], brute.cases);
}

}  // namespace rayloom::bench::numerics
