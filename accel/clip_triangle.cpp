#include <rayloom/accel/clip_triangle.h>

#include <cmath>

namespace rayloom::accel {
namespace {

float round_down(double x) {
  const auto rounded = static_cast<float>(x);
  return double{rounded} > x ? std::nextafter(rounded, -Box::infinity) : rounded;
}

/// Where the edge from a to b, a below the plane and b above it, crosses it. Differences, quotient, product and sum
/// round by less than 6 * 2^-53 (|a| + |b|) together; nothing underflows in double. The real value lies between the
/// ends, so the interval is cut to them.
Box crossing(const float (&a)[3], const float (&b)[3], int axis, float plane) {
  const double at = (double{plane} - a[axis]) / (double{b[axis]} - a[axis]);
  Box box;
  for (int k = 0; k < 3; ++k) {
    const double value = a[k] + at * (double{b[k]} - a[k]);
    const double error = 0x1p-49 * (std::fabs(double{a[k]}) + std::fabs(double{b[k]}));
    box.min[k] = std::max(std::min(a[k], b[k]), round_down(value - error));
    box.max[k] = std::min(std::max(a[k], b[k]), -round_down(-(value + error)));
  }
  box.min[axis] = box.max[axis] = plane;
  return box;
}

void add_edge(const float (&a)[3], const float (&b)[3], int axis, float plane, Halves& halves) {
  if (a[axis] > b[axis]) return add_edge(b, a, axis, plane, halves);
  if (!(a[axis] < plane && plane < b[axis])) return;
  const Box box = crossing(a, b, axis, plane);
  halves.left.extend(box);
  halves.right.extend(box);
}

/// Adding 0 turns -0 into +0.
void cut_to(const Box& cell, Box& box) {
  for (int k = 0; k < 3; ++k) {
    box.min[k] = std::max(box.min[k], cell.min[k]) + 0.0f;
    box.max[k] = std::min(box.max[k], cell.max[k]) + 0.0f;
  }
  if (box.min[0] > box.max[0] || box.min[1] > box.max[1] || box.min[2] > box.max[2]) box = Box{};
}

}  // namespace

Halves clip_triangle(const InputTriangle& triangle, const Box& cell, int axis, float plane) {
  const auto& v = triangle.vertex;
  Halves halves;
  for (int i = 0; i < 3; ++i) {
    if (v[i][axis] <= plane) halves.left.extend(v[i]);
    if (v[i][axis] >= plane) halves.right.extend(v[i]);
    add_edge(v[i], v[(i + 1) % 3], axis, plane, halves);
  }
  cut_to(cell, halves.left);
  cut_to(cell, halves.right);
  return halves;
}

}  // namespace rayloom::accel
