// K7 to K9: t, u and v against rationals, for ordinary triangles, grazing rays and needles.

#include <rayloom/accel/instance_transform.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>
#include <rayloom/tools/bench/numerics/transforms.h>

namespace rayloom::bench::numerics {
namespace {

using accel::test::Case;
using accel::test::Family;

enum Counter : size_t { false_miss, false_hit, outside_range };
enum Extreme : size_t { weight_error };

/// Whether t lies outside the t's of the triangle's own corners, as an exact hit's never does.
bool outside_own_range(const Case& c, float t) {
  const int axis = accel::test::dominant_axis(c.ray);
  const mpq_class direction = c.ray.direction[axis];
  mpq_class low, high;
  for (int i = 0; i < 3; ++i) {
    const mpq_class at = (mpq_class(c.triangle[i][axis]) - mpq_class(c.ray.origin[axis])) / direction;
    low = i ? std::min(low, at) : at;
    high = i ? std::max(high, at) : at;
  }
  const mpq_class margin = abs(mpq_class(t)) * mpq_class(0x1p-23) + mpq_class(0x1p-149);
  return mpq_class(t) < low - margin || mpq_class(t) > high + margin;
}

void examine(const std::optional<accel::TriangleHit>& hit, const Case& c, Tally& tally) {
  const auto exact = exact_hit(c.ray, c.triangle);
  if (exact && !hit) tally.fail(false_miss, c.ray, {c.triangle});
  if (hit && !exact) tally.fail(false_hit, c.ray, {c.triangle});
  if (hit && !(std::isfinite(hit->t) && std::isfinite(hit->u) && std::isfinite(hit->v)))
    return tally.fail(outside_range, c.ray, {c.triangle});
  if (hit && outside_own_range(c, hit->t)) tally.fail(outside_range, c.ray, {c.triangle});
  if (!hit || !exact) return;
  tally.values.add(ulps_from(hit->t, exact->t));
  tally.grow(weight_error, mpq_class(abs(mpq_class(hit->u) - exact->u)).get_d());
  tally.grow(weight_error, mpq_class(abs(mpq_class(hit->v) - exact->v)).get_d());
}

void judge(RowRun& run, const Tally& tally, const std::string& of = {}) {
  run.none("false misses" + of, tally.count[false_miss], tally.cases);
  run.none("false hits" + of, tally.count[false_hit], tally.cases);
  run.none("t outside the corners' t's" + of, tally.count[outside_range], tally.cases);
  run.report("t error, median" + of, tally.values.quantile(0.5), "ulp", tally.values.size());
  run.report("t error, 99.9 %" + of, tally.values.quantile(0.999), "ulp", tally.values.size());
  run.at_most("t error, largest" + of, tally.values.largest(), "ulp", 0.5, tally.values.size());
  run.at_most("u, v error, largest" + of, tally.most[weight_error], "", 0x1p-25, tally.values.size());
}

/// A triangle in an instance of any transform, hit through both levels, against the rationals for the ray in object
/// space, which is what an instance is defined by (docs/numerics.md, section 4).
void examine_instance(const Subject& subject, Random& random, Tally& tally) {
  const Transform3x4 m = random_affine(random);
  const auto record = record_of(m);
  if (!record) return;
  Case c{{}, accel::test::shape(random, random.chance(4) ? Family::needle : Family::inside)};
  Mesh mesh;
  mesh.add_triangle(c.triangle[0], c.triangle[1], c.triangle[2]);
  const auto tracer = subject.tracer({mesh}, {m});
  Tally here;
  for (int i = 0; i < 4; ++i) {
    const Point from = accel::test::random_point(random, 4), to = target_of(random, c.triangle, Family::inside);
    const Ray world = ray_between(transformed(m, from), transformed(m, to));
    c.ray = accel::object_ray(*record, world);
    if (!accel::test::usable(c)) continue;
    const accel::Hit hit = tracer->closest(world);
    const bool front = hit.hit_kind == accel::hit_kind_triangle_front_face;
    examine(hit ? std::optional(accel::TriangleHit{hit.t, hit.u, hit.v, front}) : std::nullopt, c, here);
  }
  here.examples.clear();  // a ray and a triangle do not show what a transform did
  tally.merge(here);
}

/// Nearly flat ground, seen from just above it at an angle of 1e-1 to 1e-8.
Case grazing_case(Random& random) {
  const auto power = [&](int low, int high) {
    return std::pow(10.0f,
                    static_cast<float>(low + static_cast<int>(random.below(static_cast<uint32_t>(high - low + 1)))));
  };
  Case c{};
  for (Point& vertex : c.triangle)
    vertex = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1e-6f, 1e-6f)};
  const Point target = target_of(random, c.triangle, random.chance(2) ? Family::edge : Family::inside);
  const float angle = power(-8, -1), height = power(-7, -3);
  const float distance = random.chance(2) ? height / angle : random.uniform(0.1f, 3);
  const float x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  c.ray = accel::test::ray_towards({target[0] + distance * x, target[1] + distance * y, target[2] + distance * angle},
                                   target);
  return c;
}

/// A sliver of aspect 1 : 10^1 to 10^7; one in four corners lies on the long edge as nearly as floats can.
Case needle_case(Random& random) {
  Case c{};
  const float width = std::pow(10.0f, -1.0f - static_cast<float>(random.below(7)));
  c.triangle = {accel::test::random_point(random, 1), accel::test::random_point(random, 1), {}};
  c.triangle[2] = accel::test::lerp(c.triangle[0], c.triangle[1], random.uniform(-0.5f, 1.5f));
  if (!random.chance(4))
    for (float& x : c.triangle[2]) x += width * random.uniform(-1, 1);
  const Family aim = random.chance(2) ? Family::inside : random.chance(2) ? Family::edge : Family::vertex;
  c.ray = accel::test::ray_towards(accel::test::random_point(random, 10), target_of(random, c.triangle, aim));
  return c;
}

template <class Make>
void examine_all(RowRun& run, Cases cases, const Make& make) {
  judge(run, run.sample(cases, 16, [&](Random& random, Tally& tally) {
    const Case c = make(random);
    if (accel::test::usable(c)) examine(run.subject.triangle(c.ray, c.triangle), c, tally);
  }));
}

Mesh stretched(Mesh mesh, float factor) {
  for (Point& p : mesh.vertices) p[2] *= factor;
  return mesh;
}

}  // namespace

void run_accuracy(RowRun& run) {
  examine_all(run, run.slow(200000), [](Random& random) {
    const auto count = static_cast<uint32_t>(accel::test::all_families.size());
    return accel::test::random_case(random, accel::test::all_families[random.below(count)]);
  });
  judge(run,
        run.sample(run.slow(20000), 8,
                   [&](Random& random, Tally& tally) { examine_instance(run.subject, random, tally); }),
        ", in instances");
}

void run_grazing(RowRun& run) { examine_all(run, run.slow(100000), grazing_case); }

void run_needles(RowRun& run) {
  examine_all(run, run.slow(100000), needle_case);
  Tally total;
  for (const float factor : {1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f}) {
    ClosedMesh fan{"sliver fan", stretched(bipyramid(4096), factor), {}, true};
    fan.look_from({0.0625f, -0.03125f, 0.125f * factor});
    for (const Aim aim : {Aim::edge, Aim::vertex}) total.merge(shoot(run, fan, aim, run.rays(4000)));
  }
  judge_shots(run, total, "sliver fans");
}

}  // namespace rayloom::bench::numerics
