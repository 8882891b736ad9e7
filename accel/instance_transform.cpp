#include <rayloom/accel/instance_transform.h>

#include <algorithm>
#include <cmath>

namespace rayloom::accel {
namespace {

bool all_finite(const float (&m)[3][4]) {
  return std::all_of(&m[0][0], &m[0][0] + 12, [](float x) { return std::isfinite(x); });
}

template <class T>
double norm(const T (&m)[3][4]) {
  double largest = 0;
  for (const auto& row : m)
    largest = std::max(largest, std::fabs(double{row[0]}) + std::fabs(double{row[1]}) + std::fabs(double{row[2]}));
  return largest;
}

/// Cofactor of element (row, column). Products of floats are exact in double, so only the difference rounds.
double cofactor(const float (&m)[3][4], int row, int column) {
  const int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
  return double{m[r1][c1]} * double{m[r2][c2]} - double{m[r1][c2]} * double{m[r2][c1]};
}

float round_down(double x) {
  constexpr double largest = std::numeric_limits<float>::max();
  const auto rounded = static_cast<float>(std::clamp(x, -largest, largest));
  const float below = double{rounded} > x ? std::nextafter(rounded, -Box::infinity) : rounded;
  return std::max(below, -std::numeric_limits<float>::max());
}

float round_up(double x) { return -round_down(-x); }

}  // namespace

std::optional<InverseTransform> invert(const float (&m)[3][4]) {
  if (!all_finite(m)) return std::nullopt;
  double c[3][3];
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) c[row][column] = cofactor(m, row, column);
  const double determinant = double{m[0][0]} * c[0][0] + double{m[0][1]} * c[0][1] + double{m[0][2]} * c[0][2];
  if (determinant == 0) return std::nullopt;
  InverseTransform inverse;
  for (int row = 0; row < 3; ++row) {
    double* w = inverse.matrix[row];
    for (int column = 0; column < 3; ++column) w[column] = c[column][row] / determinant + 0.0;
    w[3] = 0.0 - (w[0] * double{m[0][3]} + w[1] * double{m[1][3]} + w[2] * double{m[2][3]});
  }
  inverse.conditioning = std::max(1.0, norm(m) * norm(inverse.matrix) * (1 + 0x1p-40));
  const bool usable = std::isfinite(inverse.conditioning) && std::isfinite(inverse.matrix[0][3]) &&
                      std::isfinite(inverse.matrix[1][3]) && std::isfinite(inverse.matrix[2][3]);
  return usable ? std::optional(inverse) : std::nullopt;
}

// Why the widened box loses no hit. Traversal follows the float ray o' + t d' with o' = W (o - T) and d' = W d, each
// rounded once, u = 2^-24. For a hit at t let p' = o' + t d' (in the object box, |p'| <= R) and p = M p' + T. In the
// maximum norm |o' - W (o - T)| <= u |o'| <= u (R + t |d'|) and |d' - W d| <= u |d'|, so o + t d differs from p by at
// most |M| u (R + 2 t |d'|) <= u |M| R + 2 u kappa t |d|, kappa = |M| |W|; double's own errors are smaller by 2^-29
// kappa. The first term widens the box here, four times over; the second is proportional to the distance from the ray's
// origin, t |d| <= |p - o| but for terms of second order, and lies within the 8 u (pad_scale - 1) |p - o| by which the
// box test widens top-level boxes on top of its own errors, pad_scale - 1 >= kappa.
Box widened_box(const float (&m)[3][4], const Box& object_box, const Interval (&images)[3]) {
  double reach[3], largest = 0;
  for (int k = 0; k < 3; ++k) {
    reach[k] = std::max(std::fabs(double{object_box.min[k]}), std::fabs(double{object_box.max[k]}));
    largest = std::max(largest, reach[k]);
  }
  const double widening = norm(m) * (0x1p-22 * largest + 0x1p-126);
  Box box;
  for (int row = 0; row < 3; ++row) {
    double magnitude = std::fabs(double{m[row][3]});
    for (int k = 0; k < 3; ++k) magnitude += std::fabs(double{m[row][k]}) * reach[k];
    const double margin = widening + 0x1p-48 * magnitude;
    box.min[row] = round_down(images[row].low - margin);
    box.max[row] = round_up(images[row].high + margin);
  }
  return box;
}

Interval image(const float (&row)[4], const Box& object_box) {
  Interval out{row[3], row[3]};
  for (int k = 0; k < 3; ++k) {
    const double a = double{row[k]} * double{object_box.min[k]}, b = double{row[k]} * double{object_box.max[k]};
    out.low += std::min(a, b);
    out.high += std::max(a, b);
  }
  return out;
}

Box world_box(const float (&m)[3][4], const Box& object_box) {
  return widened_box(m, object_box, {image(m[0], object_box), image(m[1], object_box), image(m[2], object_box)});
}

Ray object_ray(const InstanceRecord& instance, const Ray& world_ray) {
  const auto& w = instance.world_to_object;
  double origin[3], direction[3];
  for (int k = 0; k < 3; ++k) {
    origin[k] = double{world_ray.origin[k]} - double{instance.object_to_world[k][3]};
    direction[k] = world_ray.direction[k];
  }
  Ray ray = world_ray;
  for (int k = 0; k < 3; ++k) {
    ray.origin[k] = static_cast<float>(w[k][0] * origin[0] + w[k][1] * origin[1] + w[k][2] * origin[2]);
    ray.direction[k] = static_cast<float>(w[k][0] * direction[0] + w[k][1] * direction[1] + w[k][2] * direction[2]);
  }
  return ray;
}

}  // namespace rayloom::accel
