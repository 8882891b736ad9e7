#pragma once

// The four determinants whose quotients are a hit, for any kind of number, and the error that floating-point numbers
// make in them. Proofs: docs/numerics.md, "The determinants".

#include <rayloom/accel/prepared_ray.h>
#include <rayloom/accel/vector3.h>

#include <cmath>

namespace rayloom::accel {

/// The nine coordinates of a triangle, by vertex.
struct TriangleCorners {
  const float* vertex[3];
};

/// With e_i = v_i - v0, p = v0 - o, n = e1 x e2, q = p x d: n.d, e2.q, -e1.q and n.p. They are, times the direction's
/// dominant component, A, E20, E01 and A t of docs/numerics.md.
template <class Number>
struct Determinants {
  Number area, u, v, depth;

  /// E12 in the same units: the third weight.
  Number w() const { return area - u - v; }
};

/// What the determinants are taken of.
template <class Number>
struct TriangleVectors {
  Vector3<Number> edge1, edge2, point, direction;

  Determinants<Number> determinants() const {
    const Vector3<Number> n = cross(edge1, edge2), q = cross(point, direction);
    return {dot(n, direction), dot(edge2, q), -dot(edge1, q), dot(n, point)};
  }
};

template <class Number>
Vector3<Number> vector_of(const float* p) {
  return {Number{p[0]}, Number{p[1]}, Number{p[2]}};
}

template <class Number>
TriangleVectors<Number> vectors_of(const PreparedRay& ray, const TriangleCorners& corners) {
  const Vector3<Number> v0 = vector_of<Number>(corners.vertex[0]);
  return {vector_of<Number>(corners.vertex[1]) - v0, vector_of<Number>(corners.vertex[2]) - v0,
          v0 - vector_of<Number>(ray.origin), vector_of<Number>(ray.direction)};
}

/// Sizes of the vectors, from which every bound follows. Not finite where a coordinate is not.
struct TriangleExtent {
  double edge1, edge2, point;  ///< sums of absolute components
  double direction;            ///< largest absolute component
};

inline double absolute_sum(const Vector3<double>& v) { return std::fabs(v[0]) + std::fabs(v[1]) + std::fabs(v[2]); }

inline TriangleExtent extent_of(const PreparedRay& ray, const TriangleVectors<double>& vectors) {
  return {absolute_sum(vectors.edge1), absolute_sum(vectors.edge2), absolute_sum(vectors.point),
          std::fabs(double{ray.direction[ray.axis[2]]})};
}

inline constexpr double double_unit = 0x1p-53;  // half the distance from 1 to the next double

/// Errors of determinants whose operations have the relative error `unit`, and of the quotients of a triangle that is
/// hit, given the inverse of the computed area.
class DeterminantErrors {
 public:
  DeterminantErrors(const TriangleExtent& extent, double unit)
      : extent_(extent),
        rounding_(8 * unit),
        edges_(rounding_ * (extent.edge1 * extent.edge2)),
        reach_(extent.point + extent.edge1 + extent.edge2),
        weights_(rounding_ * reach_ * extent.direction) {}

  double area() const { return edges_ * extent_.direction; }
  double u() const { return weights_ * extent_.edge2; }
  double v() const { return weights_ * extent_.edge1; }
  double w() const { return 1.25 * (u() + v()); }

  /// Of depth - t area, for the exact t of a hit.
  double depth() const { return 3 * edges_ * reach_; }

  /// Of u, v and depth, so much larger that they cover the division of each by the computed area.
  double u_divided(double area) const { return u() + rounding_ * std::fabs(area); }
  double v_divided(double area) const { return v() + rounding_ * std::fabs(area); }
  double t_divided(double depth_found) const { return depth() + rounding_ * std::fabs(depth_found); }

 private:
  TriangleExtent extent_;
  double rounding_, edges_, reach_, weights_;
};

}  // namespace rayloom::accel
