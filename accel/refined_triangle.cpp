#include <rayloom/accel/double_double.h>
#include <rayloom/accel/exact_triangle.h>
#include <rayloom/accel/refined_triangle.h>

#include <limits>

namespace rayloom::accel {
namespace {

bool finite(const TriangleExtent& extent) {
  return extent.edge1 + extent.edge2 + extent.point < std::numeric_limits<double>::infinity();
}

/// -1, 1, or 0 in doubt.
int sign_beyond(const DoubleDouble& value, double error) {
  return value.high > error ? 1 : value.high < -error ? -1 : 0;
}

struct Decision {
  bool hit;
  bool u_zero = false, v_zero = false;  ///< known to vanish
};

Decision decide_exactly(const PreparedRay& ray, const TriangleCorners& corners) {
  const ExactEdges exact = exact_edges(ray, corners);
  const auto& sign = exact.sign;
  return {sign[0] != 0 && sign[0] == sign[1] && sign[1] == sign[2], exact.on_edge[2], exact.on_edge[0]};
}

/// Whether the shifted line meets the triangle; no value where integers have to tell.
std::optional<bool> decide(const Determinants<DoubleDouble>& determinants, const DeterminantErrors& errors) {
  const int u = sign_beyond(determinants.u, errors.u()), v = sign_beyond(determinants.v, errors.v()),
            w = sign_beyond(determinants.w(), errors.w());
  const bool above = u > 0 || v > 0 || w > 0, below = u < 0 || v < 0 || w < 0;
  if (above && below) return false;
  if (u != 0 && v != 0 && w != 0) return true;
  return std::nullopt;
}

/// The floats that the ends of a quotient's error interval round to.
struct Ends {
  float low, high;
  bool known() const { return low == high; }
};

Ends ends_of(const DoubleDouble& value, double error) {
  return {nearest_float(exact_sum(value.high, value.low - error)) + 0.0f,
          nearest_float(exact_sum(value.high, value.low + error)) + 0.0f};
}

/// t, u, v of a triangle that is hit, as far as double-double tells.
struct Quotients {
  Ends t, u, v;

  Quotients(const Determinants<DoubleDouble>& determinants, const DeterminantErrors& errors) {
    const auto& [area, u_area, v_area, depth] = determinants;
    const double inverse = std::fabs(1 / area.high);
    t = ends_of(depth / area, errors.t_divided(depth.high) * inverse);
    u = ends_of(u_area / area, errors.u_divided(area.high) * inverse);
    v = ends_of(v_area / area, errors.v_divided(area.high) * inverse);
  }
};

/// The hit of a triangle whose line hits it.
std::optional<TriangleHit> quotients_of(const PreparedRay& ray, const TriangleCorners& corners,
                                        const Determinants<DoubleDouble>& determinants, const DeterminantErrors& errors,
                                        const Decision& decision, float t_far, TriangleEffort& effort) {
  TriangleHit hit{};
  QuotientChoice unknown{true, !decision.u_zero, !decision.v_zero};
  const int facing = sign_beyond(determinants.area, errors.area());
  if (facing != 0) {
    const Quotients found(determinants, errors);
    if (found.t.high <= ray.t_min || found.t.low > t_far) return std::nullopt;
    hit = {found.t.low, decision.u_zero ? 0 : found.u.low, decision.v_zero ? 0 : found.v.low, facing < 0};
    unknown = {!found.t.known(), unknown.u && !found.u.known(), unknown.v && !found.v.known()};
  }
  effort.integer_quotients = unknown.count();
  if (facing == 0 || unknown.count() > 0) exact_quotients(ray, corners, unknown, hit);
  if (!in_range(ray, hit.t, t_far)) return std::nullopt;
  return hit;
}

}  // namespace

std::optional<TriangleHit> refined_hit(const PreparedRay& ray, TriangleCorners corners, float t_far, bool certain,
                                       TriangleEffort& effort) {
  const TriangleExtent extent = extent_of(ray, vectors_of<double>(ray, corners));
  if (!finite(extent)) return std::nullopt;
  effort.refined = true;
  const Determinants<DoubleDouble> determinants = vectors_of<DoubleDouble>(ray, corners).determinants();
  const DeterminantErrors errors(extent, double_double_unit);
  Decision decision{true};
  if (!certain) {
    const std::optional<bool> decided = decide(determinants, errors);
    effort.integer_signs = !decided;
    decision = decided ? Decision{*decided} : decide_exactly(ray, corners);
  }
  if (!decision.hit) return std::nullopt;
  return quotients_of(ray, corners, determinants, errors, decision, t_far, effort);
}

}  // namespace rayloom::accel
