#pragma once

// Vectors of three numbers of any kind: doubles, pairs of doubles, integers.

#include <array>

namespace rayloom::accel {

template <class Number>
using Vector3 = std::array<Number, 3>;

template <class Number>
Vector3<Number> operator-(const Vector3<Number>& a, const Vector3<Number>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template <class Number>
Number dot(const Vector3<Number>& a, const Vector3<Number>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Number>
Vector3<Number> cross(const Vector3<Number>& a, const Vector3<Number>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace rayloom::accel
