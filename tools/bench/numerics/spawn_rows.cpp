// T6 to T8: where rays start that leave a surface.

#include <rayloom/shaders/spawn.h>
#include <rayloom/shaders/warp.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>
#include <rayloom/tools/bench/numerics/transforms.h>

#include <cstring>

#include <fmt/format.h>

namespace rayloom::bench::numerics {
namespace {

using shaders::double3;
using shaders::SpawnPoint;

float3 vec(const Point& p) { return {p[0], p[1], p[2]}; }
Point point(float3 v) { return {v.x, v.y, v.z}; }

float3x4 matrix(const Transform3x4& m) {
  return {m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11]};
}

/// A triangle and, across the edge 1-2, one in the same plane as nearly as floats can put it there.
struct Surface {
  Triangle triangle;
  Mesh mesh;
  Transform3x4 transform = accel::identity_transform;

  explicit Surface(const Triangle& t) : triangle(t) {
    Point across;
    for (int k = 0; k < 3; ++k) across[k] = t[1][k] + (t[2][k] - t[0][k]);
    mesh.add_triangle(t[0], t[1], t[2]);
    mesh.add_triangle(t[1], across, t[2]);
  }
  /// By the subject's offset: that of the library, or none.
  SpawnPoint spawn(float2 barycentrics, double scale) const {
    SpawnPoint spawn = shaders::triangle_spawn_point({vec(triangle[0]), vec(triangle[1]), vec(triangle[2])},
                                                     barycentrics, matrix(transform));
    spawn.offset *= scale;
    return spawn;
  }
};

/// Of any size, at any distance from the object's origin, half of them long and thin.
Surface random_surface(Random& random) {
  const auto power = [&](int low, uint32_t count) {
    return std::pow(10.0f, static_cast<float>(low + static_cast<int>(random.below(count))));
  };
  const float size = power(-6, 13), distance = random.chance(2) ? 0 : size * power(0, 6);
  const Point centre = accel::test::random_point(random, distance);
  Triangle t;
  for (Point& vertex : t) {
    vertex = accel::test::random_point(random, size);
    for (int k = 0; k < 3; ++k) vertex[k] += centre[k];
  }
  if (random.chance(2)) {
    const float width = power(-5, 5);
    for (int k = 0; k < 3; ++k) t[2][k] = t[0][k] + 0.5f * (t[1][k] - t[0][k]) + width * (t[2][k] - t[0][k]);
  }
  Surface surface(t);
  if (random.chance(2)) surface.transform = random_affine(random);
  return surface;
}

/// A unit direction at the given sine above the surface, on the side of `normal`.
float3 direction_above(float3 normal, float sine, float turn) {
  return shaders::make_frame(normal).to_world(shaders::direction_at(sine, turn));
}

bool is_usable(const Surface& surface) {
  for (const Point& vertex : surface.mesh.vertices)
    for (const float x : vertex)
      if (!std::isfinite(x)) return false;
  const auto record = record_of(surface.transform);
  return record.has_value();
}

/// What "ulp of the largest coordinate" counts in: coordinates as large as any that took part on the way to the world.
double reach_in_world(const Surface& surface) {
  double reach = 0;
  for (int row = 0; row < 3; ++row) {
    double sum = std::fabs(double{surface.transform[4 * row + 3]});
    for (int k = 0; k < 3; ++k) {
      double largest_corner = 0;
      for (const Point& vertex : surface.triangle)
        largest_corner = std::max(largest_corner, std::fabs(double{vertex[k]}));
      sum += std::fabs(double{surface.transform[4 * row + k]}) * largest_corner;
    }
    reach = std::max(reach, sum);
  }
  return reach;
}

enum Counter : size_t { self_hits, fired, too_grazing };
enum Extreme : size_t { offset_ulps };

/// Rays to both sides, half of them at sines of 1e-1 to 1e-4. Any hit is a self-hit: nothing else is there.
void leave(RowRun& run, const Surface& surface, const MeshTracer& tracer, Random& random, Tally& tally) {
  const float2 barycentrics = shaders::uniform_triangle({random.uniform(0, 0.999999f), random.uniform(0, 0.999999f)});
  const SpawnPoint spawn = surface.spawn(barycentrics, run.subject.spawn_scale());
  if (std::isnan(spawn.offset)) return;  // without area: never hit
  const bool front = random.chance(2);
  const float3 normal(front ? spawn.normal : -spawn.normal);
  const float grazing = std::pow(10.0f, -1.0f - static_cast<float>(random.below(4)));
  const float sine = random.chance(2) ? grazing : random.uniform(1e-4f, 1);
  const float3 direction = direction_above(normal, sine, random.uniform(0, 1));
  if (glm::dot(double3(direction), double3(normal)) <= spawn.grazing) return void(++tally.count[too_grazing]);
  ++tally.count[fired];
  const Ray ray = ray_between(point(spawn.origin(front)), {0, 0, 0});
  Ray leaving = ray;
  for (int k = 0; k < 3; ++k) leaving.direction[k] = direction[k];
  if (tracer.count(leaving) != 0) tally.fail(self_hits, leaving, {});
  const double ulps = spawn.offset / (reach_in_world(surface) * 0x1p-23);
  tally.grow(offset_ulps, surface.transform == accel::identity_transform ? ulps : 0);
  tally.values.add(ulps);
}

/// The sheets z = 0 and z = gap, moved and turned: the smallest gap that is safe must be resolved.
void try_contact(RowRun& run, Random& random, Tally& tally) {
  Surface lower(accel::test::shape(random, accel::test::Family::inside));
  const float height = std::ldexp(random.uniform(1, 2), static_cast<int>(random.below(40)) - 20);
  for (Point& p : lower.triangle) p[2] = height;
  const SpawnPoint spawn = lower.spawn({0.3f, 0.3f}, 1);
  const float ulp = std::nextafter(height, INFINITY) - height;
  const float side = spawn.normal.z > 0 ? 1.0f : -1.0f;
  const auto resolved = [&](double gap) {
    const auto z = static_cast<float>(double{height} + side * gap);
    Mesh upper;
    upper.add_triangle({-9, -9, z}, {9, -9, z}, {0, 9, z});
    Ray ray = ray_between(point(spawn.origin(true)), {0, 0, 0});
    ray.direction[0] = ray.direction[1] = 0, ray.direction[2] = side;
    return run.subject.tracer({upper})->count(ray) == 1;
  };
  if (!resolved(2 * spawn.offset + 2 * double{ulp})) ++tally.count[0];
  double gap = ulp;
  while (gap < 1e3 * ulp && !resolved(gap)) gap *= 2;
  tally.grow(0, gap / ulp);
  tally.grow(1, spawn.offset / ulp);
}

struct ClosedBox {
  Mesh mesh;
  std::unique_ptr<MeshTracer> tracer;
  Point centre;
};

/// Turned by the rotation of the quaternion (4, 1, 2, 3) / sqrt(30), so that no wall lies in a plane of floats.
Point turned(const Point& p) {
  return {(4 * p[0] - 20 * p[1] + 22 * p[2]) / 30, (28 * p[0] + 10 * p[1] + 4 * p[2]) / 30,
          (-10 * p[0] + 20 * p[1] + 20 * p[2]) / 30};
}

ClosedBox closed_box(const Subject& subject, bool is_turned, float scale, float offset) {
  Mesh mesh = accel::test::cube(2);
  if (is_turned)
    for (Point& p : mesh.vertices) p = turned(p);
  ClosedBox box{accel::test::moved(mesh, scale, offset), nullptr, {offset, offset, offset}};
  box.tracer = subject.tracer({box.mesh});
  return box;
}

/// A path of diffuse bounces from the middle of a closed box; outside is light. True: it saw the light.
bool leaks_light(const Subject& subject, const ClosedBox& box, uint32_t bounces, Random& random) {
  Ray ray = ray_between(box.centre, {0, 0, 0});
  const auto head = [&](float3 d) { std::memcpy(ray.direction, &d, sizeof(ray.direction)); };
  head(shaders::uniform_sphere({random.uniform(0, 1), random.uniform(0, 1)}));
  for (uint32_t i = 0; i < bounces; ++i) {
    const accel::Hit hit = box.tracer->closest(ray);
    if (!hit) return true;
    const auto& [a, b, c] = box.mesh.triangles[hit.primitive_index];
    const Surface wall({box.mesh.vertices[a], box.mesh.vertices[b], box.mesh.vertices[c]});
    const SpawnPoint spawn = wall.spawn({hit.u, hit.v}, subject.spawn_scale());
    const bool front = hit.hit_kind == accel::hit_kind_triangle_front_face;
    const float3 origin = spawn.origin(front), normal(front ? spawn.normal : -spawn.normal);
    std::memcpy(ray.origin, &origin, sizeof(ray.origin));
    head(
        shaders::make_frame(normal).to_world(shaders::cosine_hemisphere({random.uniform(0, 1), random.uniform(0, 1)})));
  }
  return false;
}

}  // namespace

void run_self_hits(RowRun& run) {
  constexpr uint64_t rays = 512;
  const Tally tally = run.sample(run.rays(10000000) / rays, 4, [&](Random& random, Tally& t) {
    const Surface surface = random_surface(random);
    if (!is_usable(surface)) return;
    const auto tracer = run.subject.tracer({surface.mesh}, {surface.transform});
    for (uint64_t i = 0; i < rays; ++i) leave(run, surface, *tracer, random, t);
  });
  run.none("self-hits", tally.count[self_hits], tally.count[fired]);
  run.report("offset, median", tally.values.quantile(0.5), "ulp of the largest coordinate", tally.values.size());
  run.report("offset, 99.9 %", tally.values.quantile(0.999), "ulp of the largest coordinate", tally.values.size());
  run.at_most("offset, largest without transform", tally.most[offset_ulps], "ulp of the largest coordinate", 20,
              tally.count[fired]);
  run.report("rays left out as closer to the surface than its bound", static_cast<double>(tally.count[too_grazing]),
             "rays");
}

void run_missed_contact(RowRun& run) {
  const Tally tally = run.sample(run.slow(20000), 16, [&](Random& random, Tally& t) { try_contact(run, random, t); });
  run.none("sheets at twice the offset (and 2 ulp) missed", tally.count[0], tally.cases, "pairs of sheets");
  run.report("smallest gap 2^k always resolved", tally.most[0], "ulp", tally.cases);
  run.report("offset, largest", tally.most[1], "ulp", tally.cases);
}

void run_light_leaks(RowRun& run) {
  Tally total;
  constexpr uint32_t bounces = 8;
  for (const bool is_turned : {false, true})
    for (const float scale : {1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f})
      for (const float offset : {0.0f, 1.0f, 1e3f, 1e6f}) {
        const ClosedBox box = closed_box(run.subject, is_turned, scale, offset * scale);
        const Tally here = run.sample(run.rays(1000000) / 40, 64, [&](Random& random, Tally& t) {
          t.add(0, leaks_light(run.subject, box, bounces, random));
        });
        if (here.count[0])
          run.note(fmt::format("{} of {} paths left the {} box of scale {} at {} scales", here.count[0], here.cases,
                               is_turned ? "turned" : "straight", scale, offset));
        total.merge(here);
      }
  run.none("paths that left a closed box", total.count[0], total.cases, "paths");
}

}  // namespace rayloom::bench::numerics
