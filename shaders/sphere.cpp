#include <rayloom/shaders/sphere.h>

#include <cmath>
#include <limits>

namespace rayloom::shaders {
namespace {

float below(double x) { return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity()); }
float above(double x) { return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity()); }

}  // namespace

RAYTRACING_AABB sphere_box(const scenes::Sphere& sphere) {
  const double3 c(sphere.center);
  const double r = sphere.radius;
  return {below(c.x - r), below(c.y - r), below(c.z - r), above(c.x + r), above(c.y + r), above(c.z + r)};
}

std::optional<SphereCrossings> intersect_sphere(const scenes::Sphere& sphere, float3 origin, float3 direction) {
  const double3 to_center = double3(sphere.center) - double3(origin), d(direction);
  const double a = glm::dot(d, d), b = glm::dot(to_center, d);
  const double radius = sphere.radius;
  const double3 nearest = to_center - (b / a) * d;
  const double discriminant = radius * radius - glm::dot(nearest, nearest);
  if (!(discriminant >= 0)) return std::nullopt;
  const double c = glm::dot(to_center, to_center) - radius * radius;
  const double q = b + std::copysign(std::sqrt(a * discriminant), b);
  const double t0 = q != 0 ? c / q : 0, t1 = q / a;
  return t0 < t1 ? SphereCrossings{t0, t1} : SphereCrossings{t1, t0};
}

}  // namespace rayloom::shaders
