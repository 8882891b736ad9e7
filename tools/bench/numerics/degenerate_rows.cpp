// K10, K11: triangles without area are never hit; of equal ones the first wins and each is reported once.

#include <rayloom/tests/accel/brute_force.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>

namespace rayloom::bench::numerics {
namespace {

using accel::test::Case;
using accel::test::Family;

/// Three corners on a line without any rounding: small integers times a power of two.
Triangle collinear(Random& random) {
  const auto whole = [&] { return static_cast<float>(static_cast<int>(random.below(65)) - 32); };
  const Point start{whole(), whole(), whole()}, step{whole(), whole(), whole()};
  const float scale = std::ldexp(1.0f, static_cast<int>(random.below(200)) - 120);
  Triangle triangle;
  for (Point& vertex : triangle) {
    const float along = whole();
    for (int k = 0; k < 3; ++k) vertex[k] = (start[k] + along * step[k]) * scale;
  }
  return triangle;
}

Triangle repeated(Random& random) {
  Triangle triangle = accel::test::shape(random, Family::inside);
  triangle[random.below(2)] = triangle[2];
  return triangle;
}

/// So small that every product of coordinates underflows; most of them have area all the same.
Triangle subnormal(Random& random) {
  Triangle triangle;
  for (Point& vertex : triangle)
    for (float& x : vertex) x = std::ldexp(random.uniform(-1, 1), -120 - static_cast<int>(random.below(29)));
  return triangle;
}

bool has_area(const Triangle& t) {
  const auto edge = [&](int i, int k) -> mpq_class { return mpq_class(t[i][k]) - mpq_class(t[0][k]); };
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    if (sgn(mpq_class(edge(1, a) * edge(2, b) - edge(1, b) * edge(2, a))) != 0) return true;
  }
  return false;
}

Case aimed(Random& random, const Triangle& triangle) {
  float reach = 0;
  for (const Point& vertex : triangle)
    for (const float x : vertex) reach = std::max(reach, std::fabs(x));
  Case c{{}, triangle};
  c.ray = accel::test::ray_towards(accel::test::random_point(random, 4 * reach),
                                   target_of(random, triangle, random.chance(2) ? Family::edge : Family::inside));
  return c;
}

/// Triangles without area in a structure: never hit; then moved apart by an update, and hit as brute force says.
void update_degenerate(Random& random, Tally& tally) {
  Mesh mesh;
  for (int i = 0; i < 20; ++i) {
    const Triangle t = random.chance(2) ? collinear(random) : repeated(random);
    mesh.add_triangle(t[0], t[1], t[2]);
    if (random.chance(4)) mesh.triangles.back()[random.below(3)] = mesh.triangles.back()[random.below(3)];
  }
  const auto builders = accel::all_builders();
  const accel::BuildSettings settings(accel::build_flag::allow_update,
                                      builders[random.below(static_cast<uint32_t>(builders.size()))]);
  const accel::TriangleGeometry geometry = mesh.geometry();  // its vertices are replaced in place
  const auto block = accel::test::build_geometries(std::vector{geometry}, settings);
  const auto aim_at_vertex = [&] {
    const Point& at = mesh.vertices[random.below(static_cast<uint32_t>(mesh.vertices.size()))];
    return ray_between(accel::test::random_point(random, 2), at);
  };
  for (int i = 0; i < 4; ++i)
    tally.add(3, accel::trace({}, accel::test::request_for(block, aim_at_vertex())).type != accel::HitType::none);
  for (Point& p : mesh.vertices) p = accel::test::random_point(random, 1);
  const std::span<const accel::TriangleGeometry> span(&geometry, 1);
  accel::refit_bottom_level(span, settings, block.data(), block.span());
  const auto triangles = accel::test::all_triangles({geometry});
  for (int i = 0; i < 4; ++i) {
    const Ray ray = aim_at_vertex();
    const accel::Hit hit = accel::trace({}, accel::test::request_for(block, ray));
    tally.add(4, !accel::test::same_bits(hit, accel::test::closest_of(accel::test::all_hits(triangles, ray), ray)));
    tally.add(5, static_cast<bool>(hit));
  }
}

/// `count` equal triangles in each of two geometries, each geometry in two instances.
void shoot_copies(RowRun& run, uint32_t count, Cases rays) {
  Mesh mesh;
  for (const Point& p : {Point{-1, -1, 1}, {1, -1, 1}, {0, 2, 1}}) mesh.add(p);
  mesh.triangles.assign(count, {0, 1, 2});
  const auto tracer = run.subject.tracer({mesh, mesh}, {accel::identity_transform, accel::identity_transform});
  const Tally tally = run.sample(rays, 1, [&](Random& random, Tally& t) {
    const Ray ray{{random.uniform(-0.25f, 0.25f), random.uniform(-0.25f, 0.25f), 0}, 0, {0, 0, 1}, INFINITY};
    const accel::Hit hit = tracer->closest(ray);
    t.add(0, hit.instance_index != 0 || hit.geometry_index != 0 || hit.primitive_index != 0);
    t.add(1, tracer->count(ray) != 4 * count);
  });
  const std::string what = std::to_string(count) + " copies in 2 geometries in 2 instances";
  run.none("not the smallest name, " + what, tally.count[0], tally.cases);
  run.none("not asked once each, " + what, tally.count[1], tally.cases);
}

/// Quads in one plane over each other: the first of those hit wins.
void shoot_coplanar(RowRun& run, Cases rays) {
  constexpr uint32_t quads = 60;
  Mesh mesh;
  Random random(run.seed());
  for (uint32_t i = 0; i < quads; ++i) {
    const float x = random.uniform(-1, 0), y = random.uniform(-1, 0), w = random.uniform(0.5f, 2),
                h = random.uniform(0.5f, 2);
    mesh.add_triangle({x, y, 1}, {x + w, y, 1}, {x + w, y + h, 1});
    mesh.add_triangle({x, y, 1}, {x + w, y + h, 1}, {x, y + h, 1});
  }
  const auto tracer = run.subject.tracer({mesh});
  const Tally tally = run.sample(rays, 64, [&](Random& r, Tally& t) {
    const Ray ray{{r.uniform(-1, 2), r.uniform(-1, 2), 0}, 0, {0, 0, 1}, INFINITY};
    uint32_t first = accel::no_index, hits = 0;
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      if (!product_subject().triangle(ray, {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]})) continue;
      first = std::min(first, i);
      ++hits;
    }
    t.add(0, tracer->closest(ray).primitive_index != first);
    t.add(1, tracer->count(ray) != hits);
  });
  run.none("not the first of coplanar quads", tally.count[0], tally.cases);
  run.none("other hits than brute force, coplanar quads", tally.count[1], tally.cases);
}

}  // namespace

void run_degenerate(RowRun& run) {
  const Tally exact = run.sample(run.rays(1000000), 256, [&](Random& random, Tally& tally) {
    const Case c = aimed(random, random.chance(2) ? collinear(random) : repeated(random));
    if (accel::test::usable(c) && run.subject.triangle(c.ray, c.triangle)) tally.fail(0, c.ray, {c.triangle});
  });
  run.none("hits of collinear and repeated corners", exact.count[0], exact.cases);
  const Tally tiny = run.sample(run.slow(50000), 16, [&](Random& random, Tally& tally) {
    const Case c = aimed(random, subnormal(random));
    if (!accel::test::usable(c)) return;
    const auto hit = run.subject.triangle(c.ray, c.triangle);
    if (hit && !has_area(c.triangle)) tally.fail(0, c.ray, {c.triangle});
    if (!difference_from_exact(run.subject, c.ray, c.triangle).empty()) tally.fail(1, c.ray, {c.triangle});
    tally.add(2, hit && !(hit->t == hit->t && hit->u == hit->u && hit->v == hit->v));
  });
  run.none("hits of subnormal triangles without area", tiny.count[0], tiny.cases);
  run.none("subnormal triangles different from the rationals", tiny.count[1], tiny.cases);
  run.none("NaN in a hit", tiny.count[2], tiny.cases);
  const Tally updates = run.sample(run.slow(2000), 16, update_degenerate);
  run.none("hits of structures without area", updates.count[3], 4 * updates.cases);
  run.none("other hits than brute force after an update gave them area", updates.count[4], 4 * updates.cases);
  run.report("rays that hit after the update", static_cast<double>(updates.count[5]), "rays");
}

void run_duplicates(RowRun& run) {
  for (uint32_t count = 2; count <= run.slow(100000).count; count *= count < 20 ? 3 : 20) shoot_copies(run, count, {8});
  shoot_coplanar(run, run.rays(100000));
}

}  // namespace rayloom::bench::numerics
