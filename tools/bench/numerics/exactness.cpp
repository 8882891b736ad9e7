// A subject's triangle test against the rationals.

#include <rayloom/tools/bench/numerics/subject.h>

#include <fmt/format.h>

namespace rayloom::bench::numerics {
namespace {

/// Whether the exact t, rounded, is a float in (t_min, t_max].
bool in_interval(const Ray& ray, const mpq_class& t) {
  using accel::test::is_nearest;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  if (is_nearest(infinity, t) || t <= mpq_class(ray.t_min) || is_nearest(ray.t_min, t)) return false;
  return std::isinf(ray.t_max) || t <= mpq_class(ray.t_max) || is_nearest(ray.t_max, t);
}

}  // namespace

std::optional<accel::test::RationalHit> exact_hit(const Ray& ray, const Triangle& triangle) {
  auto hit = accel::test::rational_hit(ray, triangle);
  if (hit && !in_interval(ray, hit->t)) hit.reset();
  return hit;
}

std::string difference_from_exact(const Subject& subject, const Ray& ray, const Triangle& triangle) {
  const auto hit = subject.triangle(ray, triangle);
  const auto exact = exact_hit(ray, triangle);
  if (hit.has_value() != exact.has_value()) return hit ? "a false hit" : "a false miss";
  if (!hit) return {};
  if (!accel::test::is_nearest(hit->t, exact->t)) return fmt::format("t is {:a}", hit->t);
  if (!accel::test::is_nearest(hit->u, exact->u)) return fmt::format("u is {:a}", hit->u);
  if (!accel::test::is_nearest(hit->v, exact->v)) return fmt::format("v is {:a}", hit->v);
  return hit->front == exact->front ? "" : "the facing is wrong";
}

double ulps_from(float value, const mpq_class& exact) {
  if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
  const float magnitude = std::fabs(value);
  const mpq_class ulp =
      mpq_class(std::nextafter(magnitude, std::numeric_limits<float>::infinity())) - mpq_class(magnitude);
  return mpq_class(abs(mpq_class(value) - exact) / ulp).get_d();
}

}  // namespace rayloom::bench::numerics
