// The proven error bounds of the float, the double and the double-double evaluation against exact edge functions.

#include "lane_cases.h"
#include "rational_oracle.h"
#include "triangle_cases.h"

#include <rayloom/accel/double_double.h>
#include <rayloom/accel/simd/lanes_scalar.h>
#include <rayloom/accel/triangle_determinants.h>
#include <rayloom/tests/repetitions.h>

#include <catch2/catch.hpp>
#include <cstdio>

namespace rayloom::accel {
namespace {

using test::Case;
using test::Family;
using test::Random;

struct ExactEdgeFunctions {
  mpq_class edge[3];
};

ExactEdgeFunctions exact_edge_functions(const Case& c) {
  test::Projected p[3];
  for (int i = 0; i < 3; ++i) p[i] = test::project(c.ray, c.triangle[i]);
  return {{test::edge_function(p[0], p[1]), test::edge_function(p[1], p[2]), test::edge_function(p[2], p[0])}};
}

PreparedRay prepare(const Ray& ray) {
  const float box[2][3] = {{-1, -1, -1}, {1, 1, 1}};
  return prepare_ray(ray, box[0], box[1]);
}

scalar::EdgeFilter float_filter(const Case& c, const PreparedRay& ray) {
  PlainTriangleLeaf leaf = test::plain_leaf(1);
  for (int vertex = 0; vertex < 3; ++vertex) {
    for (int k = 0; k < 3; ++k) leaf.vertex[k][vertex][0] = c.triangle[vertex][k];
  }
  return scalar::filter_triangle(ray, leaf, 0, std::copysign(0.0f, ray.direction[ray.axis[2]]));
}

/// Checks |computed - exact| <= bound for each edge and returns the largest quotient of the two.
template <class Real>
double check_bound(const Real (&computed)[3], Real bound, const ExactEdgeFunctions& exact) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const mpq_class error = abs(mpq_class(computed[i]) - exact.edge[i]);
    REQUIRE(error <= mpq_class(bound));
    if (bound > 0) worst = std::max(worst, mpq_class(error / mpq_class(bound)).get_d());
  }
  return worst;
}

mpq_class rational(double value) { return value; }
mpq_class rational(const DoubleDouble& value) { return mpq_class(value.high) + mpq_class(value.low); }

/// Checks each determinant, and depth - t area for the t of a hit, and returns the largest quotient of error and bound.
template <class Number>
double check_determinants(const Case& c, const PreparedRay& ray, double unit, const ExactEdgeFunctions& exact) {
  const TriangleCorners corners{{c.triangle[0].data(), c.triangle[1].data(), c.triangle[2].data()}};
  const TriangleExtent extent = extent_of(ray, vectors_of<double>(ray, corners));
  const DeterminantErrors errors(extent, unit);
  const Determinants<Number> found = vectors_of<Number>(ray, corners).determinants();
  const mpq_class scale = ray.direction[ray.axis[2]];
  const mpq_class v = exact.edge[0] * scale, w = exact.edge[1] * scale, u = exact.edge[2] * scale;
  double worst = 0;
  const auto check = [&](const mpq_class& error, double bound) {
    REQUIRE(std::isfinite(bound));
    REQUIRE(abs(error) <= mpq_class(bound));
    if (bound > 0) worst = std::max(worst, mpq_class(abs(error) / mpq_class(bound)).get_d());
  };
  check(rational(found.area) - (u + v + w), errors.area());
  check(rational(found.u) - u, errors.u());
  check(rational(found.v) - v, errors.v());
  check(rational(found.w()) - w, errors.w());
  if (const auto hit = test::rational_hit(c.ray, c.triangle)) {
    check(rational(found.depth) - hit->t * rational(found.area), errors.depth());
  }
  return worst;
}

TEST_CASE("the filters' bounds hold and are not absurdly wide", "[oracle]") {
  double worst_float = 0, worst_double = 0, worst_pair = 0;
  for (const Family family : test::all_families) {
    Random random(61 + static_cast<uint64_t>(family));
    double family_float = 0, family_double = 0, family_pair = 0;
    for (int i = 0; i < rayloom::test::repetitions(15000); ++i) {
      const Case c = test::random_case(random, family);
      const PreparedRay ray = prepare(c.ray);
      const ExactEdgeFunctions exact = exact_edge_functions(c);
      INFO(test::family_name(family) << " case " << i);
      // An infinite or NaN bound decides nothing; any other covers infinite edge functions by their sign alone.
      const scalar::EdgeFilter filter = float_filter(c, ray);
      const auto& edge = filter.edge;
      const float bound = filter.bound;
      if (std::isfinite(bound)) {
        for (int k = 0; k < 3; ++k) {
          if (std::isinf(edge[k])) REQUIRE(sgn(exact.edge[k]) == (edge[k] > 0 ? 1 : -1));
        }
        if (std::isfinite(edge[0] + edge[1] + edge[2])) {
          family_float = std::max(family_float, check_bound(edge, bound, exact));
        }
      }
      family_double = std::max(family_double, check_determinants<double>(c, ray, double_unit, exact));
      family_pair = std::max(family_pair, check_determinants<DoubleDouble>(c, ray, double_double_unit, exact));
    }
    std::printf("%-15s largest error/bound: float %.3f, double %.3f, double-double %.3f\n",
                test::family_name(family).data(), family_float, family_double, family_pair);
    worst_float = std::max(worst_float, family_float);
    worst_double = std::max(worst_double, family_double);
    worst_pair = std::max(worst_pair, family_pair);
  }
  CHECK(worst_float > 0.05);
  CHECK(worst_double > 0.05);
  CHECK(worst_pair > 0.005);
}

}  // namespace
}  // namespace rayloom::accel
