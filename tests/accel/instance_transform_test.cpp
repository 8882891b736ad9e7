#include <rayloom/accel/instance_transform.h>

#include <catch2/catch.hpp>

#include <cmath>

#include "random.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

TEST_CASE("inverses of permutations, mirrors and powers of two are exact") {
  const Matrix m{{0, -4, 0, 8}, {0.5f, 0, 0, -3}, {0, 0, 16, 32}};
  const auto inverse = invert(m);
  REQUIRE(inverse);
  const double expected[3][4] = {{0, 2, 0, 6}, {-0.25, 0, 0, 2}, {0, 0, 0.0625, -2}};
  for (int row = 0; row < 3; ++row)
    for (int k = 0; k < 4; ++k) CHECK(inverse->matrix[row][k] == expected[row][k]);
  CHECK(inverse->conditioning >= 32);
  CHECK(inverse->conditioning < 32.001);
}

TEST_CASE("a matrix times its inverse is one within double's rounding") {
  Random random(61);
  for (int i = 0; i < 1000; ++i) {
    Matrix m;
    random_matrix(random, m);
    const auto inverse = invert(m);
    if (!inverse || inverse->conditioning > 1e6) continue;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) sum += inverse->matrix[row][k] * double{m[k][column]};
        REQUIRE(std::fabs(sum - (row == column)) < 1e-14 * inverse->conditioning);
      }
  }
}

TEST_CASE("singular and non-finite matrices have no inverse (TL-08)") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(!invert(Matrix{}));
  CHECK(!invert(Matrix{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 0}}));
  CHECK(!invert(Matrix{{1, 2, 3, 0}, {2, 4, 6, 0}, {0, 0, 1, 0}}));
  CHECK(!invert(Matrix{{1, 0, 0, nan}, {0, 1, 0, 0}, {0, 0, 1, 0}}));
  CHECK(!invert(Matrix{{Box::infinity, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}));
  CHECK(invert(Matrix{{1e-38f, 0, 0, 0}, {0, 1e-38f, 0, 0}, {0, 0, 1e-38f, 0}}));
  CHECK(invert(Matrix{{1e38f, 0, 0, 0}, {0, 1e38f, 0, 0}, {0, 0, 1e38f, 0}}));
}

TEST_CASE("a world box holds every transformed point of the object box") {
  Random random(62);
  for (int i = 0; i < 1000; ++i) {
    Matrix m;
    random_matrix(random, m);
    Box object;
    for (int corner = 0; corner < 2; ++corner)
      object.extend({random.scaled(-3, 9), random.scaled(-3, 9), random.scaled(-3, 9)});
    const Box world = world_box(m, object);
    for (int k = 0; k < 20; ++k) {
      long double p[3];
      for (int axis = 0; axis < 3; ++axis)
        p[axis] = k < 8 ? ((k >> axis & 1) ? object.max[axis] : object.min[axis])
                        : random.uniform(object.min[axis], object.max[axis]);
      for (int row = 0; row < 3; ++row) {
        const long double x = m[row][0] * p[0] + m[row][1] * p[1] + m[row][2] * p[2] + m[row][3];
        REQUIRE((x >= world.min[row] && x <= world.max[row]));
      }
    }
  }
  const Box far = world_box(Matrix{{1e38f, 0, 0, 0}, {0, 1, 0, 3e38f}, {0, 0, 1, 0}}, [] {
    Box box;
    box.extend({-1e30f, -3e38f, 0}, {1e30f, 3e38f, 0});
    return box;
  }());
  CHECK((std::isfinite(far.min[0]) && std::isfinite(far.max[1])));
}

TEST_CASE("an object-space ray is rounded once, also far from the world's origin") {
  Random random(63);
  for (int i = 0; i < 1000; ++i) {
    InstanceRecord record{};
    random_matrix(random, record.object_to_world);
    for (auto& row : record.object_to_world) row[3] = random.uniform(-1e7f, 1e7f);
    const auto inverse = invert(record.object_to_world);
    if (!inverse || inverse->conditioning > 100) continue;
    std::copy_n(&inverse->matrix[0][0], 12, &record.world_to_object[0][0]);
    Ray ray{{}, 0.5f, {random.scaled(-3, 3), random.scaled(-3, 3), random.scaled(-3, 3)}, 7};
    for (int k = 0; k < 3; ++k) ray.origin[k] = record.object_to_world[k][3] + random.uniform(-10, 10);
    const Ray object = object_ray(record, ray);
    CHECK((object.t_min == 0.5f && object.t_max == 7));
    for (int row = 0; row < 3; ++row) {
      long double o = 0, d = 0, size = 0;
      for (int k = 0; k < 3; ++k) {
        const long double offset = static_cast<long double>(ray.origin[k]) - record.object_to_world[k][3];
        o += record.world_to_object[row][k] * offset;
        d += record.world_to_object[row][k] * static_cast<long double>(ray.direction[k]);
        size += std::fabs(record.world_to_object[row][k] * offset);
      }
      REQUIRE(std::fabs(object.origin[row] - o) <= 0x1p-24L * std::fabs(o) + 0x1p-50L * size);
      REQUIRE(std::fabs(object.direction[row] - d) <= 0x1.001p-24L * std::fabs(d) + 1e-12L);
    }
  }
}
