#include <rayloom/accel/exact_triangle.h>
#include <rayloom/accel/sheared_triangle.h>
#include <rayloom/accel/triangle.h>

#include <cmath>

namespace rayloom::accel {
namespace {

/// -1, 1, or 0 where the filter cannot tell.
int filtered_sign(double edge, double bound) { return edge > bound ? 1 : edge < -bound ? -1 : 0; }

/// Replaces undecided signs by exact ones and notes which edge functions are zero.
bool settle(const PreparedRay& ray, const TriangleCorners& corners, int (&sign)[3], ShearedTriangle& sheared) {
  const ExactEdges exact = exact_edges(ray, corners);
  for (int i = 0; i < 3; ++i) {
    sign[i] = exact.sign[i];
    sheared.exactly_zero[i] = exact.on_edge[i];
  }
  return sign[0] != 0 && sign[0] == sign[1] && sign[1] == sign[2];
}

/// Whether the shifted line meets the triangle.
bool decide(const PreparedRay& ray, const TriangleCorners& corners, ShearedTriangle& sheared) {
  int sign[3];
  bool above = false, below = false, undecided = false;
  for (int i = 0; i < 3; ++i) {
    sign[i] = filtered_sign(sheared.edge[i], sheared.bound);
    above |= sign[i] > 0;
    below |= sign[i] < 0;
    undecided |= sign[i] == 0;
  }
  if (above && below) return false;
  return !undecided || settle(ray, corners, sign, sheared);
}

/// A value known within an error, as a float if every value in reach rounds to the same one.
struct Rounded {
  float value;
  bool known;
};

Rounded round(double value, double error) {
  const float low = static_cast<float>(value - error), high = static_cast<float>(value + error);
  return {low + 0.0f, low == high};
}

bool all_finite(const ShearedTriangle& sheared) { return sheared.bound < std::numeric_limits<double>::infinity(); }

bool in_range(const PreparedRay& ray, float t, float t_far) {
  return t > ray.t_min && t <= t_far && t <= std::numeric_limits<float>::max();
}

/// t, u, v in double with bounds on their errors (docs/numerics.md, "Accepted hits"), exactly where these do not fix
/// the rounded values.
std::optional<TriangleHit> finish(const PreparedRay& ray, const TriangleCorners& corners,
                                  const ShearedTriangle& sheared, float t_far) {
  const auto [e01, e12, e20] = sheared.edge;
  const double area = e01 + e12 + e20;
  const double inverse = 1 / area;
  const double u = e20 * inverse, v = e01 * inverse;
  const double weight_error = 4.5 * sheared.bound * std::fabs(inverse) + 8 * double_unit;
  const double dz1 = sheared.z[1] - sheared.z[0], dz2 = sheared.z[2] - sheared.z[0];
  const double t = (sheared.z[0] + (u * dz1 + v * dz2)) * ray.inverse_z;
  const double depth_error =
      (weight_error + 8 * double_unit) * (std::fabs(dz1) + std::fabs(dz2)) + 8 * double_unit * std::fabs(sheared.z[0]);
  const double t_error = 1.0625 * depth_error * std::fabs(ray.inverse_z);
  if (static_cast<float>(t + t_error) <= ray.t_min || static_cast<float>(t - t_error) > t_far) return std::nullopt;

  const Rounded ft = round(t, t_error);
  const Rounded fu = sheared.exactly_zero[2] ? Rounded{0, true} : round(u, weight_error);
  const Rounded fv = sheared.exactly_zero[0] ? Rounded{0, true} : round(v, weight_error);
  TriangleHit hit{ft.value, fu.value, fv.value, (area > 0) == (ray.direction[ray.axis[2]] < 0)};
  // Above one half the area's sign is in doubt too.
  if (!ft.known || !fu.known || !fv.known || weight_error > 0.5) hit = exact_hit(ray, corners);
  if (!in_range(ray, hit.t, t_far)) return std::nullopt;
  return hit;
}

}  // namespace

std::optional<TriangleHit> intersect_triangle(const PreparedRay& ray, const float v0[3], const float v1[3],
                                              const float v2[3], float t_far) {
  const TriangleCorners corners{{v0, v1, v2}};
  ShearedTriangle sheared = shear_triangle(ray, corners);
  if (!all_finite(sheared) || !decide(ray, corners, sheared)) return std::nullopt;
  return finish(ray, corners, sheared, t_far);
}

std::optional<TriangleHit> finish_triangle(const PreparedRay& ray, const float v0[3], const float v1[3],
                                           const float v2[3], float t_far) {
  const TriangleCorners corners{{v0, v1, v2}};
  const ShearedTriangle sheared = shear_triangle(ray, corners);
  if (!all_finite(sheared)) return std::nullopt;
  return finish(ray, corners, sheared, t_far);
}

}  // namespace rayloom::accel
