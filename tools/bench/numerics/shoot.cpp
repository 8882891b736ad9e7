// Rays at the edges and vertices of closed meshes.

#include <rayloom/tools/bench/numerics/closed_mesh.h>

namespace rayloom::bench::numerics {
namespace {

Triangle corners(const Mesh& mesh, uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

struct Target {
  Point point;
  uint32_t vertex;  ///< at or near it; no_index for a point of no significance
};

Point lerp(const Point& a, const Point& b, float s) {
  Point p = a;
  for (int k = 0; k < 3; ++k) p[k] += s * (b[k] - a[k]);
  return p;
}

Target choose_target(const Mesh& mesh, Aim aim, Random& random) {
  const auto& triangle = mesh.triangles[random.below(static_cast<uint32_t>(mesh.triangles.size()))];
  const uint32_t corner = random.below(3);
  Target target{mesh.vertices[triangle[corner]], triangle[corner]};
  if (aim == Aim::vertex) return target;
  const Point& next = mesh.vertices[triangle[(corner + 1) % 3]];
  target.point = lerp(target.point, next, random.chance(4) ? 0.5f : random.uniform(0, 1));
  if (aim == Aim::anywhere)
    target.point = lerp(target.point, mesh.vertices[triangle[(corner + 2) % 3]], random.uniform(0, 1));
  return target;
}

/// Up to eight triangles at the vertex: enough to show what went wrong there.
std::vector<Triangle> triangles_at(const Mesh& mesh, uint32_t vertex) {
  std::vector<Triangle> triangles;
  for (uint32_t i = 0; i < mesh.triangles.size() && triangles.size() < 8; ++i) {
    const auto& t = mesh.triangles[i];
    if (std::find(t.begin(), t.end(), vertex) != t.end()) triangles.push_back(corners(mesh, i));
  }
  return triangles;
}

}  // namespace

Ray ray_between(const Point& origin, const Point& target) {
  return {{origin[0], origin[1], origin[2]},
          0,
          {target[0] - origin[0], target[1] - origin[1], target[2] - origin[2]},
          accel::Box::infinity};
}

Tally shoot(RowRun& run, const ClosedMesh& closed, Aim aim, Cases rays) {
  const auto tracer = run.subject.tracer({closed.mesh});
  return run.sample(rays, 512, [&](Random& random, Tally& tally) {
    const Viewpoint& view = closed.viewpoints[random.below(static_cast<uint32_t>(closed.viewpoints.size()))];
    Target target = choose_target(closed.mesh, aim, random);
    if (random.chance(2))
      for (float& x : target.point) x = random.nudged(x, 4);
    if (target.point == view.origin) return;
    const Ray ray = ray_between(view.origin, target.point);
    const uint32_t hits = tracer->count(ray);
    const auto check = [&](size_t counter, bool failed) {
      if (failed) tally.fail(counter, ray, triangles_at(closed.mesh, target.vertex));
    };
    check(leaks, view.inside && hits == 0);
    check(wrong_parity, hits % 2 != (view.inside ? 1 : 0));
    check(not_one, closed.convex && view.inside && hits != 1);
    check(closest_differs, static_cast<bool>(tracer->closest(ray)) != (hits > 0));
  });
}

void compare_with_brute_force(RowRun& run, const ClosedMesh& closed, Cases rays, Tally& total) {
  const auto tracer = run.subject.tracer({closed.mesh});
  total.merge(run.sample(rays, 32, [&](Random& random, Tally& tally) {
    const Point& to = closed.mesh.vertices[random.below(static_cast<uint32_t>(closed.mesh.vertices.size()))];
    const Viewpoint& from = closed.viewpoints[random.below(static_cast<uint32_t>(closed.viewpoints.size()))];
    if (to == from.origin) return;
    const Ray ray = ray_between(from.origin, to);
    float nearest = accel::Box::infinity;
    for (uint32_t i = 0; i < closed.mesh.triangles.size(); ++i) {
      const auto found = product_subject().triangle(ray, corners(closed.mesh, i));
      if (found) nearest = std::min(nearest, found->t);
    }
    if (tracer->closest(ray).t != nearest) tally.fail(0, ray, {});
  }));
}

void judge_shots(RowRun& run, const Tally& shots, const std::string& what) {
  const std::string at = what.empty() ? "" : ", " + what;
  run.none("leaks" + at, shots.count[leaks], shots.cases);
  run.none("wrong parity" + at, shots.count[wrong_parity], shots.cases);
  run.none("not exactly one" + at, shots.count[not_one], shots.cases);
  run.none("closest and any hit disagree" + at, shots.count[closest_differs], shots.cases);
}

}  // namespace rayloom::bench::numerics
