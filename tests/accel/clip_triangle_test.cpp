#include <rayloom/accel/clip_triangle.h>
#include <rayloom/tests/repetitions.h>

#include <catch2/catch.hpp>

#include <gmpxx.h>

#include "random.h"

using namespace rayloom::accel;
using rayloom::accel::test::Random;

namespace {

using RationalPoint = std::array<mpq_class, 3>;

RationalPoint rational(const float (&p)[3]) { return {mpq_class(p[0]), mpq_class(p[1]), mpq_class(p[2])}; }

RationalPoint between(const RationalPoint& a, const RationalPoint& b, const mpq_class& weight) {
  RationalPoint p;
  for (int k = 0; k < 3; ++k) p[k] = a[k] + weight * (b[k] - a[k]);
  return p;
}

bool holds(const Box& box, const RationalPoint& p) {
  for (int k = 0; k < 3; ++k)
    if (box.empty() || p[k] < mpq_class(box.min[k]) || p[k] > mpq_class(box.max[k])) return false;
  return true;
}

/// Points of the triangle that decide the parts' boxes: corners, crossings of edges and plane; and some inside.
std::vector<RationalPoint> points_of(const InputTriangle& triangle, int axis, float plane, Random& random) {
  RationalPoint v[3];
  for (int i = 0; i < 3; ++i) v[i] = rational(triangle.vertex[i]);
  std::vector<RationalPoint> points(v, v + 3);
  for (int i = 0; i < 3; ++i) {
    const RationalPoint &a = v[i], &b = v[(i + 1) % 3];
    if ((a[axis] < plane) != (b[axis] < plane))
      points.push_back(between(a, b, (mpq_class(plane) - a[axis]) / (b[axis] - a[axis])));
    const RationalPoint edge = between(a, b, mpq_class(random.below(1000), 999u));
    points.push_back(between(edge, v[(i + 2) % 3], mpq_class(random.below(1000), 999u)));
  }
  return points;
}

struct Case {
  InputTriangle triangle;
  int axis;
  float plane;
};

template <class Coordinate>
Case make_case(Random& random, const Coordinate& coordinate) {
  Case c{};
  for (auto& vertex : c.triangle.vertex)
    for (float& x : vertex) x = coordinate();
  c.axis = static_cast<int>(random.below(3));
  const auto at = [&](int i) { return c.triangle.vertex[i][c.axis]; };
  const float low = std::min({at(0), at(1), at(2)}), high = std::max({at(0), at(1), at(2)});
  c.plane = random.chance(8) ? at(1) : static_cast<float>(low + (double{high} - low) * random.uniform(0, 1));
  return c;
}

Box bounds_of(const InputTriangle& triangle) {
  Box box;
  for (const auto& vertex : triangle.vertex) box.extend(vertex);
  return box;
}

/// Counts the points inside `cell` that neither part holds although it lies on that side.
size_t lost(const Case& c, const Box& cell, Random& random) {
  const Halves halves = clip_triangle(c.triangle, cell, c.axis, c.plane);
  size_t count = 0;
  for (const RationalPoint& p : points_of(c.triangle, c.axis, c.plane, random)) {
    if (!holds(cell, p)) continue;
    count += p[c.axis] <= c.plane && !holds(halves.left, p);
    count += p[c.axis] >= c.plane && !holds(halves.right, p);
  }
  return count;
}

template <class Coordinate>
void check_covers(uint64_t seed, const Coordinate& coordinate) {
  Random random(seed);
  size_t missed = 0;
  for (int i = 0; i < rayloom::test::repetitions(20000); ++i) {
    const Case c = make_case(random, [&] { return coordinate(random); });
    Box cell = bounds_of(c.triangle);
    missed += lost(c, cell, random);
    for (int k = 0; k < 3; ++k)  // a cell that earlier cuts have left
      if (random.chance(2)) {
        const auto inside = static_cast<float>(cell.min[k] + cell.extent(k) * random.uniform(0, 1));
        (random.chance(2) ? cell.min[k] : cell.max[k]) = std::clamp(inside, cell.min[k], cell.max[k]);
      }
    missed += lost(c, cell, random);
  }
  CHECK(missed == 0);
}

}  // namespace

TEST_CASE("every exact point of a triangle lies in the box of its part", "[oracle]") {
  check_covers(1, [](Random& random) { return random.uniform(-1, 1); });
  check_covers(2, [](Random& random) { return random.scaled(-20, 20); });
  check_covers(3, [](Random& random) { return 1e6f + random.uniform(-1, 1); });
  check_covers(4, [](Random& random) { return static_cast<float>(random.below(5)); });
}

TEST_CASE("so it does for any finite floats", "[oracle]") {
  check_covers(5, [](Random& random) { return random.any_finite(); });
  check_covers(6, [](Random& random) { return random.scaled(-149, -120); });
}

TEST_CASE("parts end at the plane, stay inside the triangle's box and are tight", "[unit]") {
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    const Case c = make_case(random, [&] { return random.uniform(1, 2); });
    const Box whole = bounds_of(c.triangle);
    const Halves halves = clip_triangle(c.triangle, whole, c.axis, c.plane);
    if (halves.left.empty() || halves.right.empty()) continue;
    CHECK(halves.left.max[c.axis] <= c.plane);
    CHECK(halves.right.min[c.axis] >= c.plane);
    for (int k = 0; k < 3; ++k) {
      CHECK(std::min(halves.left.min[k], halves.right.min[k]) == whole.min[k]);
      CHECK(std::max(halves.left.max[k], halves.right.max[k]) == whole.max[k]);
    }
  }
  const InputTriangle triangle{{{0, 0, 0}, {4, 4, 0}, {4, 0, 0}}};
  const Halves halves = clip_triangle(triangle, bounds_of(triangle), 0, 1);
  CHECK(halves.left.max[1] >= 1);
  CHECK(halves.left.max[1] <= std::nextafter(1.0f, 2.0f));
  CHECK(halves.right.max[1] == 4);
  CHECK(halves.left.max[2] == 0);
}

TEST_CASE("a part outside of the cell is empty", "[unit]") {
  const InputTriangle triangle{{{0, 0, 0}, {4, 4, 0}, {4, 0, 0}}};
  const Box cell{{0, 3, 0}, {4, 4, 0}};  // the triangle is in it for x >= 3 only
  CHECK(clip_triangle(triangle, cell, 0, 2).left.empty());
  CHECK(!clip_triangle(triangle, cell, 0, 2).right.empty());
}
