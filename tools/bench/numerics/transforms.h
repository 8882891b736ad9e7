#pragma once

// Transforms for the instance rows, and the same in rationals.

#include <rayloom/accel/layout.h>
#include <rayloom/tools/bench/numerics/lab.h>

#include <array>
#include <cmath>

namespace rayloom::bench::numerics {

using Exact3 = std::array<mpq_class, 3>;

/// Random columns scaled by 1e-3 to 1e3, perhaps mirrored, translated by up to 1e7, perhaps nearly singular (columns
/// that agree but for 1e-1 to 1e-7).
Transform3x4 random_affine(Random& random);

/// Zero, flattened, NaN or infinite.
Transform3x4 bad_transform(Random& random);

/// A rotation times a scale of 1/4 to 4, translated by up to 10, in double.
using Matrix = std::array<double, 12>;
Matrix similarity(Random& random);

/// The record a top level makes of a transform; nothing if that has no inverse.
std::optional<accel::InstanceRecord> record_of(const Transform3x4& m);

Point transformed(const Transform3x4& m, const Point& p);
Exact3 transformed_exactly(const Transform3x4& m, const mpq_class (&p)[3]);

double largest(const float (&v)[3]);

double linear_norm(const Transform3x4& m);
double linear_norm(const double (&m)[3][4]);

/// Transforms one after the other, the last the outermost: composed in double and, for comparison, exactly.
class Chain {
 public:
  void append(const Matrix& m);
  Transform3x4 rounded() const;
  /// t of the ray's line with the plane of the exactly transformed triangle.
  mpq_class exact_t(const Ray& ray, const Triangle& triangle) const;
  /// Largest coordinate that a point of the unit ball may have on its way through the chain.
  double reach() const { return reach_; }

 private:
  Matrix composed_{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  std::array<mpq_class, 12> exact_{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  double reach_ = 1;
};

}  // namespace rayloom::bench::numerics
