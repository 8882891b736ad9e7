// T1 to T4: what an instance's transform does to hits.

#include <rayloom/accel/instance_transform.h>
#include <rayloom/tests/accel/brute_force.h>
#include <rayloom/tests/accel/triangle_cases.h>
#include <rayloom/tools/bench/numerics/closed_mesh.h>
#include <rayloom/tools/bench/numerics/rows.h>
#include <rayloom/tools/bench/numerics/transforms.h>

#include <fmt/format.h>

namespace rayloom::bench::numerics {
namespace {

/// The world ray that an exact transform makes of an object ray.
Ray transformed_ray(const Transform3x4& m, const Ray& ray) {
  Ray out = ray;
  for (int row = 0; row < 3; ++row) {
    out.origin[row] = out.direction[row] = 0;
    for (int k = 0; k < 3; ++k) {
      out.origin[row] += m[4 * row + k] * ray.origin[k];
      out.direction[row] += m[4 * row + k] * ray.direction[k];
    }
  }
  return out;
}

/// Maps that lose no bit: permutations, mirrors, powers of two.
Transform3x4 exact_transform(Random& random) {
  Transform3x4 m{};
  const uint32_t turn = random.below(3), swap = random.below(2);
  for (uint32_t row = 0; row < 3; ++row) {
    const uint32_t column = ((swap ? 3 - row : row) + turn) % 3;
    m[4 * row + column] = std::ldexp(random.chance(2) ? 1.0f : -1.0f, static_cast<int>(random.below(41)) - 20);
  }
  return m;
}

/// A closed sphere in an instance, seen from near its middle, at its vertices.
struct Placed {
  Transform3x4 transform;
  accel::InstanceRecord record;
  double kappa;
  std::unique_ptr<MeshTracer> tracer;
};

struct Meshes {
  Mesh mesh = accel::test::icosphere(2);
  std::vector<accel::test::NamedTriangle> triangles = accel::test::all_triangles({mesh.geometry()});
  float reach = 1;
};

enum Counter : size_t { instance_leaks, culled, other_t, seen };
enum Extreme : size_t { of_bound };

/// |P - Q| / bound in the maximum norm: P the hit's point by its barycentrics through the exact transform, Q the ray's
/// point at t; the bound is D of docs/numerics.md, section 4, and the rounding of t, u and v.
double error_of_bound(const Placed& placed, const Meshes& meshes, const Ray& ray, const accel::Hit& hit) {
  if (!std::isfinite(hit.t) || !std::isfinite(hit.u) || !std::isfinite(hit.v)) return accel::Box::infinity;
  const auto& [a, b, c] = meshes.mesh.triangles[hit.primitive_index];
  const Point &v0 = meshes.mesh.vertices[a], &v1 = meshes.mesh.vertices[b], &v2 = meshes.mesh.vertices[c];
  mpq_class object[3];
  for (int k = 0; k < 3; ++k)
    object[k] = mpq_class(v0[k]) + mpq_class(hit.u) * (mpq_class(v1[k]) - mpq_class(v0[k])) +
                mpq_class(hit.v) * (mpq_class(v2[k]) - mpq_class(v0[k]));
  const auto world = transformed_exactly(placed.transform, object);
  double error = 0, distance = 0;
  for (int k = 0; k < 3; ++k) {
    const mpq_class along = mpq_class(hit.t) * mpq_class(ray.direction[k]);
    error = std::max(error, mpq_class(abs(mpq_class(ray.origin[k]) + along - world[k])).get_d());
    distance = std::max(distance, mpq_class(abs(along)).get_d());
  }
  const double m = linear_norm(placed.transform), u = 0x1p-24;
  return error / (u * (m * meshes.reach * 4 + (2 * placed.kappa + 2) * distance) * (1 + 0x1p-10));
}

void shoot_instance(const Placed& placed, const Meshes& meshes, Random& random, Tally& tally) {
  const Point& at = meshes.mesh.vertices[random.below(static_cast<uint32_t>(meshes.mesh.vertices.size()))];
  const Ray ray = ray_between(transformed(placed.transform, {0.1f, 0, -0.1f}), transformed(placed.transform, at));
  const auto moves = [](const Ray& r) { return r.direction[0] != 0 || r.direction[1] != 0 || r.direction[2] != 0; };
  if (!moves(ray)) return;
  const Ray object = accel::object_ray(placed.record, ray);
  if (!(std::hypot(object.origin[0], object.origin[1], object.origin[2]) < 0.5f)) return;  // rounded out of the sphere
  ++tally.count[seen];
  const auto expected = accel::test::all_hits(meshes.triangles, object);
  const uint32_t hits = placed.tracer->count(ray);
  if (hits == 0) tally.fail(instance_leaks, ray, {});
  if (hits != expected.size()) tally.fail(culled, ray, {});
  const accel::Hit hit = placed.tracer->closest(ray);
  if (hit.t != accel::test::closest_of(expected, ray).t) tally.fail(other_t, ray, {});
  if (hit && random.chance(16)) tally.grow(of_bound, error_of_bound(placed, meshes, ray, hit));
}

std::optional<Placed> place(const Subject& subject, const Meshes& meshes, const Transform3x4& m) {
  const auto record = record_of(m);
  if (!record) return std::nullopt;
  const double kappa = linear_norm(m) * linear_norm(record->world_to_object);
  return Placed{m, *record, kappa, subject.tracer({meshes.mesh}, {m})};
}

/// Chains composed in double, rounded to float once: t against the exact product of the chain, in ulps of t times the
/// conditioning.
void try_chain(const Subject& subject, const Meshes& meshes, uint32_t length, Random& random, Tally& tally) {
  Chain chain;
  for (uint32_t i = 0; i < length; ++i) chain.append(similarity(random));
  const auto placed = place(subject, meshes, chain.rounded());
  if (!placed) return;
  for (int i = 0; i < 4; ++i) {
    const Point& at = meshes.mesh.vertices[random.below(static_cast<uint32_t>(meshes.mesh.vertices.size()))];
    Point towards = at;
    for (float& x : towards) x *= random.uniform(0.9f, 1);
    const Ray ray =
        ray_between(transformed(placed->transform, {0.1f, 0, -0.1f}), transformed(placed->transform, towards));
    const accel::Hit hit = placed->tracer->closest(ray);
    if (!hit || !std::isfinite(hit.t)) continue;
    const auto& [a, b, c] = meshes.mesh.triangles[hit.primitive_index];
    const auto exact = chain.exact_t(ray, {meshes.mesh.vertices[a], meshes.mesh.vertices[b], meshes.mesh.vertices[c]});
    const double reach = chain.reach() / (std::fabs(hit.t) * largest(ray.direction));
    tally.grow(0, mpq_class(abs(mpq_class(hit.t) - exact) / mpq_class(hit.t)).get_d() * 0x1p23 /
                      (placed->kappa * (1 + reach)));
    ++tally.count[0];
  }
}

}  // namespace

void run_exact_transforms(RowRun& run) {
  const Meshes meshes;
  const auto flat = run.subject.tracer({meshes.mesh});
  const Tally tally = run.sample(run.slow(5000), 4, [&](Random& random, Tally& t) {
    const Transform3x4 m = exact_transform(random);
    const auto instanced = run.subject.tracer({meshes.mesh}, {m});
    for (int i = 0; i < 50; ++i) {
      const Point from = accel::test::random_point(random, 1.5f);
      const Ray object = ray_between(from, meshes.mesh.vertices[random.below(162)]);
      if (!accel::test::same_bits(flat->closest(object), instanced->closest(transformed_ray(m, object))))
        t.fail(0, object, {});
      ++t.count[1];
    }
  });
  run.none("hits with other bits than without an instance", tally.count[0], tally.count[1]);
}

void run_affine_transforms(RowRun& run) {
  const Meshes meshes;
  const Tally tally = run.sample(run.slow(5000), 2, [&](Random& random, Tally& t) {
    const auto placed = place(run.subject, meshes, random_affine(random));
    if (!placed) return;
    for (int i = 0; i < 60; ++i) shoot_instance(*placed, meshes, random, t);
  });
  run.none("leaks of a closed mesh in an instance", tally.count[instance_leaks], tally.count[seen]);
  run.none("hits the top level culled", tally.count[culled], tally.count[seen]);
  run.none("other closest t than brute force", tally.count[other_t], tally.count[seen]);
  run.at_most("displacement over its bound, largest", tally.most[of_bound], "", 1, tally.count[seen] / 16);
}

void run_singular_transforms(RowRun& run) {
  const Meshes meshes;
  const Tally tally = run.sample(run.slow(5000), 8, [&](Random& random, Tally& t) {
    const Transform3x4 m = bad_transform(random);
    const auto tracer = run.subject.tracer({meshes.mesh}, {m, accel::identity_transform});
    for (int i = 0; i < 8; ++i) {
      const Ray ray = ray_between(accel::test::random_point(random, 0.3f), meshes.mesh.vertices[random.below(162)]);
      const accel::Hit hit = tracer->closest(ray);
      t.add(0, hit.instance_index != 1);
      t.add(1, !(std::isfinite(hit.t) && std::isfinite(hit.u) && std::isfinite(hit.v)));
      ++t.count[2];
    }
  });
  run.none("hits of an instance without an inverse, or of its neighbour lost", tally.count[0], tally.count[2]);
  run.none("numbers in a hit that are not finite", tally.count[1], tally.count[2]);
}

void run_transform_chains(RowRun& run) {
  const Meshes meshes;
  run.note("instances nest once (DXR); chains are composed in double and rounded to one float matrix");
  double first = 0, last = 0;
  for (uint32_t length = 2; length <= 8; ++length) {
    const Tally tally = run.sample(
        run.slow(500), 2, [&](Random& random, Tally& t) { try_chain(run.subject, meshes, length, random, t); });
    run.report(fmt::format("t error of chains of {}, largest", length), tally.most[0], "ulp x conditioning",
               tally.count[0]);
    (length == 2 ? first : last) = tally.most[0];
  }
  run.at_most("growth a level", (last - first) / 6, "ulp x conditioning", 1);
}

}  // namespace rayloom::bench::numerics
