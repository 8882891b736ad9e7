// One kept ray against the rationals, through the triangle test and through a structure.

#include <rayloom/tests/accel/structures.h>
#include <rayloom/tools/bench/numerics/failing_ray.h>
#include <rayloom/tools/bench/numerics/subject.h>

#include <fmt/format.h>

namespace rayloom::bench::numerics {
namespace {

Mesh mesh_of(const std::vector<Triangle>& triangles) {
  Mesh mesh;
  for (const Triangle& t : triangles) mesh.add_triangle(t[0], t[1], t[2]);
  return mesh;
}

std::string compare_triangles(const FailingRay& failing, const Subject& product) {
  for (size_t i = 0; i < failing.triangles.size(); ++i) {
    const std::string difference = difference_from_exact(product, failing.ray, failing.triangles[i]);
    if (!difference.empty()) return fmt::format("triangle {}: {}", i, difference);
  }
  return {};
}

/// The hits that brute force over `triangles` finds, which compare_triangles() has compared with the rationals.
std::vector<accel::Hit> expected_hits(const FailingRay& failing, const Subject& product) {
  std::vector<accel::Hit> hits;
  for (size_t i = 0; i < failing.triangles.size(); ++i) {
    const auto hit = product.triangle(failing.ray, failing.triangles[i]);
    if (hit && hit->t < failing.ray.t_max)
      hits.push_back(
          {hit->t, hit->u, hit->v, 0, 0, static_cast<uint32_t>(i), hit->hit_kind(), accel::HitType::triangle});
  }
  return hits;
}

accel::Hit closest_of(const std::vector<accel::Hit>& hits, const Ray& ray) {
  accel::Hit closest;
  closest.t = ray.t_max;
  for (const accel::Hit& hit : hits)
    if (hit.t < closest.t) closest = hit;
  return closest;
}

}  // namespace

std::string replay(const FailingRay& failing) {
  const Subject& product = product_subject();
  std::string difference = compare_triangles(failing, product);
  if (!difference.empty() || failing.triangles.empty()) return difference;
  const auto hits = expected_hits(failing, product);
  const accel::Hit closest = closest_of(hits, failing.ray);
  const auto tracer = product.tracer({mesh_of(failing.triangles)});
  accel::test::for_each_isa([&](accel::Isa isa) {
    if (tracer->count(failing.ray) != hits.size())
      difference = fmt::format("{}: the structure reports {} hits of {}", accel::isa_name(isa),
                               tracer->count(failing.ray), hits.size());
    if (!accel::test::same_bits(tracer->closest(failing.ray), closest))
      difference = fmt::format("{}: the structure's closest hit differs", accel::isa_name(isa));
  });
  return difference;
}

}  // namespace rayloom::bench::numerics
