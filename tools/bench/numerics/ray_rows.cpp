// K16, K17, K19, K20: directions of any length, rays that are no rays, the ends of the interval, walking on.

#include <rayloom/accel/walk.h>
#include <rayloom/tests/accel/brute_force.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>

#include <rayloom/accel/visitor.h>

namespace rayloom::bench::numerics {
namespace {

using accel::Hit;
using accel::test::Case;
using accel::test::Family;

constexpr float infinity = accel::Box::infinity;

Ray random_ray(Random& random, const Mesh& mesh) {
  const Point from{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
  return ray_between(from, mesh.vertices[random.below(static_cast<uint32_t>(mesh.vertices.size()))]);
}

/// The direction times 2^shift, if that loses no bit.
std::optional<Ray> scaled(const Ray& ray, int shift) {
  Ray out = ray;
  for (float& x : out.direction) {
    const float before = x;
    x = std::ldexp(x, shift);
    if (!std::isfinite(x) || std::ldexp(x, -shift) != before) return std::nullopt;
  }
  return out;
}

bool same_but_for_t(const Hit& a, const Hit& b) {
  Hit c = b;
  c.t = a.t;
  return accel::test::same_bits(a, c);
}

/// The same ray with a direction 2^shift times as long: t 2^shift times as short, everything else the same.
void compare_scaled(const MeshTracer& tracer, const Mesh& mesh, Random& random, Tally& tally) {
  const Ray ray = random_ray(random, mesh);
  const int shift = static_cast<int>(random.below(201)) - 100;
  const auto longer = scaled(ray, shift);
  if (!longer) return;
  const Hit a = tracer.closest(ray), b = tracer.closest(*longer);
  const bool same = same_but_for_t(a, b) && (!a || b.t == std::ldexp(a.t, -shift));
  if (!same) tally.fail(0, ray, {});
  tally.add(1, static_cast<bool>(a));
}

/// Components of all sizes and zeros.
void compare_wild(const MeshTracer& tracer, const std::vector<accel::test::NamedTriangle>& triangles, Random& random,
                  Tally& tally) {
  Ray ray{{}, 0, {}, infinity};
  for (int k = 0; k < 3; ++k) {
    ray.origin[k] = random.uniform(-1.5f, 1.5f);
    ray.direction[k] = random.chance(4) ? 0.0f : random.chance(3) ? random.scaled(-3, 1) : random.scaled(-149, 127);
  }
  const auto hits = accel::test::all_hits(triangles, ray);
  const bool same = accel::test::same_bits(tracer.closest(ray), accel::test::closest_of(hits, ray)) &&
                    tracer.count(ray) == hits.size();
  if (!same) tally.fail(0, ray, {});
  tally.add(1, !hits.empty());
}

/// Nodes a walk visits.
struct NodeCount : accel::Visitor {
  void on_node(const accel::Node8*, uint32_t, const float (&)[8]) { ++nodes; }
  uint32_t nodes = 0;
};

/// A ray with the chosen ones of its eight numbers bad.
Ray spoiled(Ray ray, uint32_t pattern, float bad) {
  float* const numbers[] = {&ray.origin[0],    &ray.origin[1],    &ray.origin[2],    &ray.t_min,
                            &ray.direction[0], &ray.direction[1], &ray.direction[2], &ray.t_max};
  for (int i = 0; i < 8; ++i)
    if (pattern >> i & 1) *numbers[i] = bad;
  return ray;
}

/// An infinite t_max is a ray, an infinite t_min one that hits nothing; everything else misses.
bool is_still_a_ray(uint32_t pattern, float bad) { return pattern == 0 || (pattern == 0x80 && bad == infinity); }

/// One batch of valid rays with a spoiled one among them.
void trace_spoiled(const accel::test::Block& block, const Mesh& mesh, uint32_t pattern, float bad, Random& random,
                   Tally& tally) {
  std::vector<accel::TraceRequest> requests;
  for (int i = 0; i < 17; ++i) requests.push_back(accel::test::request_for(block, random_ray(random, mesh)));
  std::vector<Hit> before(requests.size()), after(requests.size());
  accel::trace({}, requests, before);
  const uint32_t place = random.below(17);
  requests[place].ray = spoiled(requests[place].ray, pattern, bad);
  accel::trace({}, requests, after);
  for (uint32_t i = 0; i < requests.size(); ++i)
    if (i != place) tally.add(1, !accel::test::same_bits(before[i], after[i]));
  if (is_still_a_ray(pattern, bad)) return;
  tally.add(0, static_cast<bool>(after[place]) || static_cast<bool>(accel::trace({}, requests[place])));
  NodeCount visitor;
  accel::walk({}, requests[place], visitor);
  tally.grow(0, visitor.nodes);
}

/// The t of a random hit on one triangle, and the tracer it is on.
struct OneHit {
  Case c;
  float t;
};

std::optional<OneHit> one_hit(const Subject& subject, Random& random) {
  const Case c = accel::test::unit_case(random, random.chance(2) ? Family::inside : Family::edge);
  if (!accel::test::usable(c)) return std::nullopt;
  const auto hit = subject.triangle(c.ray, c.triangle);
  return hit ? std::optional(OneHit{c, hit->t}) : std::nullopt;
}

/// Exclusive at both ends: hit exactly if t_min < t < t_max.
void try_ends(const MeshTracer& tracer, const OneHit& one, Tally& tally) {
  const float t = one.t, below = std::nextafter(t, 0.0f), above = std::nextafter(t, infinity);
  for (const float low : {0.0f, below, t, above, infinity})
    for (const float high : {below, t, above, infinity}) {
      Ray ray = one.c.ray;
      ray.t_min = low, ray.t_max = high;
      const bool expected = low < t && t < high;
      if ((tracer.count(ray) == 1) != expected || static_cast<bool>(tracer.closest(ray)) != expected)
        tally.fail(0, ray, {one.c.triangle});
    }
}

/// A procedural hit reported at exactly t_min or t_max counts (inclusive), the next float outside does not.
void try_procedural_ends(const accel::test::Block& block, Random& random, Tally& tally) {
  Ray ray{{random.uniform(-0.5f, 0.5f), 0, -2}, random.uniform(0.25f, 1), {0, 0, 1}, random.uniform(4, 5)};
  const float reports[] = {std::nextafter(ray.t_min, 0.0f), ray.t_min, ray.t_max, std::nextafter(ray.t_max, infinity)};
  for (float report : reports) {
    accel::TraceRequest request = accel::test::request_for(block, ray);
    request.user = &report;
    request.candidate = [](void* user, const accel::Candidate&) noexcept {
      return accel::Verdict{true, false, *static_cast<const float*>(user), 0};
    };
    const bool expected = report >= ray.t_min && report <= ray.t_max;
    if (static_cast<bool>(accel::trace({}, request)) != expected) tally.fail(1, ray, {});
  }
}

/// From hit to hit with t_min = t: every distinct t of the any-hit list once, in order.
void walk_hits(const MeshTracer& tracer, const std::vector<accel::test::NamedTriangle>& triangles, Ray ray,
               Tally& tally) {
  std::vector<float> expected;
  for (const Hit& hit : accel::test::all_hits(triangles, ray)) expected.push_back(hit.t);
  std::sort(expected.begin(), expected.end());
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  const Ray start = ray;
  std::vector<float> found;
  for (Hit hit = tracer.closest(ray); hit && found.size() <= expected.size(); hit = tracer.closest(ray)) {
    found.push_back(hit.t);
    ray.t_min = hit.t;
  }
  if (found != expected) tally.fail(0, start, {});
  tally.count[1] += expected.size();
}

}  // namespace

void run_direction_scales(RowRun& run) {
  const Mesh mesh = accel::test::bumpy_sphere(2);
  const auto tracer = run.subject.tracer({mesh});
  const Tally scaling = run.sample(run.rays(1000000), 256,
                                   [&](Random& random, Tally& tally) { compare_scaled(*tracer, mesh, random, tally); });
  run.none("hits changed by a direction 2^k as long", scaling.count[0], scaling.count[1]);
  const auto triangles = accel::test::all_triangles({mesh.geometry()});
  const Tally wild = run.sample(run.slow(50000), 32,
                                [&](Random& random, Tally& tally) { compare_wild(*tracer, triangles, random, tally); });
  run.none("other hits than brute force, components 2^-149 to 2^127", wild.count[0], wild.cases);
}

void run_invalid_rays(RowRun& run) {
  const Mesh mesh = accel::test::icosphere(2);
  const auto block = accel::test::build_mesh(mesh);
  Tally total;
  accel::test::for_each_isa([&](accel::Isa) {
    total.merge(run.sample(run.slow(20), 1, [&](Random& random, Tally& tally) {
      for (const float bad : {std::numeric_limits<float>::quiet_NaN(), infinity, -infinity})
        for (uint32_t pattern = 0; pattern < 256; ++pattern) trace_spoiled(block, mesh, pattern, bad, random, tally);
    }));
  });
  const uint64_t rays = total.cases * 3 * 256;
  run.none("hits of rays that are none", total.count[0], rays);
  run.none("neighbours in the batch changed", total.count[1], rays * 16);
  run.at_most("nodes visited by such a ray, most", total.most[0], "nodes", 1, rays);
}

void run_interval_ends(RowRun& run) {
  const Tally tally = run.sample(run.slow(50000), 64, [&](Random& random, Tally& t) {
    const auto one = one_hit(run.subject, random);
    if (!one) return;
    Mesh mesh;
    mesh.add_triangle(one->c.triangle[0], one->c.triangle[1], one->c.triangle[2]);
    try_ends(*run.subject.tracer({mesh}), *one, t);
    ++t.count[2];
    if (!difference_from_exact(run.subject, one->c.ray, one->c.triangle).empty())
      t.fail(3, one->c.ray, {one->c.triangle});
  });
  run.none("triangles wrongly in or out", tally.count[0], 20 * tally.count[2], "intervals");
  run.none("t at the end different from the rationals", tally.count[3], tally.count[2]);
  const float box[6] = {-1, -1, -1, 1, 1, 1};
  const accel::AabbGeometry geometry{reinterpret_cast<const std::byte*>(box), 24, 1, 0};
  const auto block = accel::test::build_geometries(std::vector{geometry});
  const Tally procedural =
      run.sample(run.rays(500000), 256, [&](Random& random, Tally& t) { try_procedural_ends(block, random, t); });
  run.none("procedural hits wrongly in or out", procedural.count[1], 4 * procedural.cases, "intervals");
}

void run_next_hits(RowRun& run) {
  Mesh mesh;
  Random shapes(run.seed());
  for (int i = 0; i < 400; ++i) {
    const Triangle t = accel::test::shape(shapes, i % 4 ? Family::inside : Family::needle);
    mesh.add_triangle(t[0], t[1], t[2]);
  }
  for (float z = -0.5f; z <= 0.5f; z = z < 0 ? z / 2 : z > 0 ? z * 2 : 0x1p-20f) {  // sheets ever closer together
    mesh.add_triangle({-1, -1, z}, {1, -1, z}, {0, 1, z});
    if (z < 0 && z > -0x1p-20f) z = 0;
  }
  const auto tracer = run.subject.tracer({mesh});
  const auto triangles = accel::test::all_triangles({mesh.geometry()});
  const Tally tally = run.sample(run.slow(20000), 16, [&](Random& random, Tally& t) {
    walk_hits(*tracer, triangles, random_ray(random, mesh), t);
  });
  run.none("walks that lose or repeat a hit", tally.count[0], tally.cases, "walks");
  run.report("hits walked over", static_cast<double>(tally.count[1]), "hits");
}

}  // namespace rayloom::bench::numerics
