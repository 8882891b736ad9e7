#pragma once

// The second of four evaluations of a hit, in double (docs/numerics.md, "The determinants"). In a header, so that
// traversal compiles it into its loops.

#include <rayloom/accel/refined_triangle.h>
#include <rayloom/accel/triangle.h>

#include <cmath>
#include <limits>
#include <optional>

namespace rayloom::accel {

/// Whether the exact t of a triangle that is hit is certainly not in range, told before any division. The float after
/// t_far is at most t_far (1 + 2^-23) + 2^-149, and a t that rounds to more than t_far may lie below it.
inline bool out_of_range(const PreparedRay& ray, const Determinants<double>& determinants,
                         const DeterminantErrors& errors, float t_far) {
  const double area = std::fabs(determinants.area);
  const double depth = determinants.depth * std::copysign(1.0, determinants.area);
  const double after_far = double{t_far} * (1 + 0x1p-23) + 0x1p-149;
  const bool before = depth + errors.depth() <= double{ray.t_min} * area;
  const bool beyond = depth - errors.depth() > after_far * area;
  return before | beyond;
}

enum class Decision { miss, hit, undecided };

/// Whether the line meets the triangle, by the signs of its weights.
inline Decision decide(const Determinants<double>& determinants, const DeterminantErrors& errors) {
  const double value[] = {determinants.u, determinants.v, determinants.w()};
  const double error[] = {errors.u(), errors.v(), errors.w()};
  int above = 0, below = 0;
  for (int i = 0; i < 3; ++i) {
    above += value[i] > error[i];
    below += value[i] < -error[i];
  }
  if (above > 0 && below > 0) return Decision::miss;
  return above == 3 || below == 3 ? Decision::hit : Decision::undecided;
}

/// The floats that the ends of an interval around a quotient round to: equal if every real in it rounds to that float.
/// The error of the numerator covers the division.
struct Ends {
  Ends(double numerator, double error, double inverse)
      : low(static_cast<float>((numerator - error) * inverse)),
        high(static_cast<float>((numerator + error) * inverse)) {}

  bool known() const { return low == high; }
  float value() const { return low + 0.0f; }

  float low, high;
};

/// The second of four evaluations, in double; docs/numerics.md, "The determinants". Undecided triangles and those with
/// a coordinate that is not finite, of which every bound is infinite or NaN, are left to the third.
template <bool certain>
[[gnu::always_inline]] inline std::optional<TriangleHit> hit_of(const PreparedRay& ray, const TriangleCorners& corners,
                                                                float t_far, TriangleEffort& effort) {
  const TriangleVectors<double> vectors = vectors_of<double>(ray, corners);
  const Determinants<double> determinants = vectors.determinants();
  const DeterminantErrors errors(extent_of(ray, vectors), double_unit);
  const auto refined = [&](bool is_hit) { return refined_hit(ray, corners, t_far, is_hit, effort); };
  if constexpr (!certain) {
    const Decision decision = decide(determinants, errors);
    if (decision == Decision::miss) return std::nullopt;
    if (decision == Decision::undecided) return refined(false);
  }
  if (!(std::fabs(determinants.area) > errors.area())) return refined(true);
  if (out_of_range(ray, determinants, errors, t_far)) return std::nullopt;

  const auto [area, u_area, v_area, depth] = determinants;
  const double inverse = 1 / area;
  const Ends t(depth, errors.t_divided(depth), inverse);
  const Ends u(u_area, errors.u_divided(area), inverse);
  const Ends v(v_area, errors.v_divided(area), inverse);
  bool known = t.known();
  known &= u.known();
  known &= v.known();
  if (!known) return refined(true);
  if (!in_range(ray, t.value(), t_far)) return std::nullopt;
  return TriangleHit{t.value(), u.value(), v.value(), area < 0};
}

}  // namespace rayloom::accel
