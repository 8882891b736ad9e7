// K12 to K15: no box is missed whose triangle is hit.

#include <rayloom/accel/structure.h>
#include <rayloom/tests/accel/structures.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/node_walk.h>
#include <rayloom/tools/bench/numerics/rows.h>

namespace rayloom::bench::numerics {
namespace {

using accel::Box;
using accel::test::Case;

Box box_of(const Triangle& triangle) {
  Box box;
  for (const Point& vertex : triangle) box.extend({vertex[0], vertex[1], vertex[2]});
  return box;
}

/// A long edge close beside the ray, as on a ridge.
Case ridge_case(Random& random) {
  const float length = std::pow(10.0f, static_cast<float>(1 + random.below(6)));
  const float beside = std::pow(10.0f, -2.0f - static_cast<float>(random.below(5)));
  Case c{{},
         {{{-length, 0, 0}, {length, 0, 0}, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}}}};
  const Point origin{random.uniform(-1, 1), beside * random.uniform(-1, 1), beside * random.uniform(-1, 1)};
  c.ray = ray_between(origin, {random.chance(2) ? length : -length, 0, 0});
  for (float& x : c.ray.direction) x = random.nudged(x, 2);
  return c;
}

Case any_case(Random& random) {
  if (random.chance(2)) return ridge_case(random);
  const auto families = static_cast<uint32_t>(accel::test::all_families.size());
  return accel::test::random_case(random, accel::test::all_families[random.below(families)]);
}

bool is_finite(const Box& box) {
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(box.min[k]) || !std::isfinite(box.max[k])) return false;
  return true;
}

/// The boxes from the triangle's own to the root's, each larger on a few sides.
std::vector<Box> ancestors(Random& random, const Triangle& triangle) {
  std::vector<Box> boxes{box_of(triangle)};
  float size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, boxes[0].max[k] - boxes[0].min[k]);
  for (int level = 0; level < 5; ++level, size *= 4) {
    Box box = boxes.back();
    const uint32_t axis = random.below(3);
    if (random.chance(2)) box.min[axis] -= size * random.uniform(0, 1);
    if (random.chance(2)) box.max[axis] += size * random.uniform(0, 1);
    boxes.push_back(box);
  }
  return boxes;
}

/// Long things, seen from close beside their long edges.
std::vector<ClosedMesh> corridors() {
  std::vector<ClosedMesh> meshes;
  for (const float length : {10.0f, 1e3f, 1e6f}) {
    Mesh ridge;
    for (const float x : {-length, length})
      for (const Point& p : {Point{x, 0, -1}, {x, 0, 1}, {x, 1, 0}}) ridge.add(p);
    ridge.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 2, 5}, {0, 5, 3}, {1, 4, 5}, {1, 5, 2}, {0, 3, 4}, {0, 4, 1}};
    for (int i = 0; i < 3; ++i) ridge = accel::test::subdivided(ridge, [](const Point& p) { return p; });
    ClosedMesh& closed = meshes.emplace_back(ClosedMesh{"ridge", ridge, {}, false});
    for (int k = 2; k <= 6; ++k) {
      const float beside = std::pow(10.0f, static_cast<float>(-k));
      closed.look_from({0.3f, 1 - beside, 1e-7f}).look_from({-0.7f, 1 + beside, 0.3f * beside});
    }
    for (const double radius : {1.0, 1e-3}) {  // a pipe, a power line
      std::vector<std::array<double, 2>> profile{{0, -length}};
      for (int i = -8; i <= 8; ++i) profile.push_back({radius, i * double{length} / 8});
      profile.push_back({0, length});
      meshes.push_back({"pipe", lathe(profile, 12), {}, false});
      const auto r = static_cast<float>(radius);
      meshes.back().look_from({0, 0, 0.1f}).look_from({0.9f * r, 0, 0.1f}).look_from({1.1f * r, 0.2f * r, 0.1f});
    }
  }
  return meshes;
}

/// A long strip of hilly ground, looked along from just above.
ClosedMesh terrain_strip() {
  Mesh strip = accel::test::grid(64, 0);
  for (Point& p : strip.vertices)
    p = {p[0] * 1000, p[1], 0.05f * std::fabs(std::fmod(p[0] * 7 + p[1] * 3, 5.0f) - 2.5f)};
  return {"terrain strip", strip, {{{1.5f, 20.5f, 0.126f}, false}, {{30500, 3.25f, 1e-3f}, false}}, false};
}

accel::AabbGeometry geometry_of(const std::vector<Box>& boxes) {
  return {reinterpret_cast<const std::byte*>(boxes.data()), sizeof(Box), boxes.size(), 0};
}

/// Boxes whose extents differ by up to 2^60, flat ones and some an ulp wide among them.
std::vector<Box> boxes_of_all_sizes(Random& random, uint32_t count) {
  std::vector<Box> boxes(count);
  const int spread = static_cast<int>(random.below(61)) + 1;
  for (Box& box : boxes)
    for (int k = 0; k < 3; ++k) {
      box.min[k] = random.scaled(-spread, 1);
      const uint32_t kind = random.below(4);
      const float up = std::nextafter(box.min[k], Box::infinity);
      box.max[k] = kind == 0 ? box.min[k] : kind == 1 ? up : box.min[k] + std::fabs(random.scaled(-spread, 1));
    }
  return boxes;
}

/// The exact closed slab test where every operation is exact: whole numbers and directions of 0 and powers of two.
bool meets_exactly(const Ray& ray, const Box& box) {
  double entry = 0, exit = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const double origin = ray.origin[k], direction = ray.direction[k];
    if (direction == 0) {
      if (origin < double{box.min[k]} || origin > double{box.max[k]}) return false;
      continue;
    }
    const double a = (double{box.min[k]} - origin) / direction, b = (double{box.max[k]} - origin) / direction;
    entry = std::max(entry, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  return entry <= exit;
}

/// On a grid of whole numbers: one or two components of the direction are zero of either sign.
Ray on_grid_ray(Random& random) {
  Ray ray{{}, 0, {}, INFINITY};
  const uint32_t moving = 1 + random.below(6);
  for (int k = 0; k < 3; ++k) {
    ray.origin[k] = static_cast<float>(static_cast<int>(random.below(17)) - 8);
    const float size = moving >> k & 1 ? std::ldexp(1.0f, static_cast<int>(random.below(5)) - 2) : 0.0f;
    ray.direction[k] = random.chance(2) ? size : -size;
  }
  return ray;
}

Box on_grid_box(Random& random) {
  Box box;
  for (int k = 0; k < 3; ++k) {
    box.min[k] = static_cast<float>(static_cast<int>(random.below(17)) - 8);
    box.max[k] = box.min[k] + static_cast<float>(random.below(4));
  }
  return box;
}

Mesh integer_heights(uint32_t size) {
  Mesh mesh = accel::test::grid(size, 0);
  for (Point& p : mesh.vertices) p[2] = std::fmod(p[0] * 5 + p[1] * 3, 4.0f);
  return mesh;
}

/// Axis rays along the planes of an integer height field against brute force.
void shoot_heights(RowRun& run, Cases rays) {
  constexpr uint32_t size = 16;
  const Mesh mesh = integer_heights(size);
  const auto triangles = mesh.triangles;
  const auto tracer = run.subject.tracer({mesh});
  const Tally tally = run.sample(rays, 64, [&](Random& random, Tally& t) {
    Ray ray = on_grid_ray(random);
    for (int k = 0; k < 2; ++k) ray.origin[k] += 8;
    ray.origin[2] = static_cast<float>(random.below(6)) - 1;
    uint32_t hits = 0;
    for (const auto& [a, b, c] : triangles)
      hits += product_subject().triangle(ray, {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}).has_value();
    if (tracer->count(ray) != hits) t.fail(0, ray, {});
  });
  run.none("other hits than brute force, integer heights", tally.count[0], tally.cases);
}

}  // namespace

void run_box_misses(RowRun& run) {
  const Tally tally = run.sample(run.rays(4000000), 256, [&](Random& random, Tally& t) {
    const Case c = any_case(random);
    const auto hit = run.subject.triangle(c.ray, c.triangle);
    if (!hit) return;
    const std::vector<Box> boxes = ancestors(random, c.triangle);
    if (!is_finite(boxes.back())) return;
    for (const Box& box : boxes) {
      ++t.count[1];
      if (!run.subject.enters(c.ray, box, boxes.back(), hit->t)) t.fail(0, c.ray, {c.triangle});
    }
  });
  run.none("boxes of a hit missed", tally.count[0], tally.count[1], "boxes");
}

void run_ridges(RowRun& run) {
  Tally total, brute;
  const std::vector<ClosedMesh> meshes = corridors();
  for (const ClosedMesh& mesh : meshes) {
    for (const Aim aim : {Aim::edge, Aim::vertex}) total.merge(shoot(run, mesh, aim, run.rays(10000)));
    compare_with_brute_force(run, mesh, run.slow(500), brute);
  }
  compare_with_brute_force(run, terrain_strip(), run.slow(1500), brute);
  judge_shots(run, total, "");
  run.none("other closest t than brute force", brute.count[0], brute.cases);
}

void run_node_enclosure(RowRun& run) {
  const Tally tally = run.sample(run.slow(10000), 4, [&](Random& random, Tally& t) {
    const std::vector<Box> boxes = boxes_of_all_sizes(random, 20 + random.below(200));
    const auto block = accel::test::build_geometries(std::vector{geometry_of(boxes)}, random.below(32));
    const EnclosureCount count = check_enclosure(block.data());
    t.count[0] += count.not_enclosed;
    t.count[1] += count.children;
    t.grow(0, count.excess_area);
  });
  run.none("children not enclosed", tally.count[0], tally.count[1], "children");
  run.at_most("largest mean excess area of a structure", 100 * tally.most[0], "%", 0);
}

void run_axis_aligned(RowRun& run) {
  const Tally tally = run.sample(run.rays(5000000), 1024, [&](Random& random, Tally& t) {
    const Ray ray = on_grid_ray(random);
    const Box box = on_grid_box(random);
    Box root = box;
    root.extend({-12, -12, -12});
    root.extend({12, 12, 12});
    const bool met = meets_exactly(ray, box), entered = run.subject.enters(ray, box, root, INFINITY);
    if (met && !entered) t.fail(0, ray, {});
    t.add(1, entered && !met);
    t.add(2, !met);
  });
  run.none("boxes missed by axis rays on the grid", tally.count[0], tally.cases, "boxes");
  run.at_most("boxes entered that are not met",
              100.0 * static_cast<double>(tally.count[1]) / static_cast<double>(tally.count[2]), "%", 1,
              tally.count[2]);
  shoot_heights(run, run.slow(20000));
}

}  // namespace rayloom::bench::numerics
