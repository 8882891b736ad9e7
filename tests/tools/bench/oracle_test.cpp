// The oracle on cases worked out by hand, and that it tells who is right.

#include <rayloom/tools/bench/oracle.h>

#include <limits>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::bench;

namespace {

constexpr float unit_triangle[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

accel::Ray down(float x, float y) { return {{x, y, 2}, 0, {0, 0, -1}, std::numeric_limits<float>::infinity()}; }

/// Two triangles that share the diagonal of a square at z = 0, and one below the first at z = -1.
BenchScene square() {
  BenchScene scene;
  BenchMesh& mesh = scene.meshes.emplace_back();
  mesh.vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, -1, 1, 0, -1, 0, 1, -1};
  mesh.vertices.resize(mesh.vertices.size() + BenchMesh::slack_floats);
  mesh.indices = {0, 1, 2, 1, 3, 2, 4, 5, 6};
  return scene;
}

accel::Hit hit_of(uint32_t primitive) {
  accel::Hit hit;
  hit.type = accel::HitType::triangle;
  hit.instance_index = hit.geometry_index = 0;
  hit.primitive_index = primitive;
  return hit;
}

}  // namespace

TEST_CASE("A ray is inside, on the border of, or outside a triangle, exactly") {
  CHECK(exact_hit(down(0.25f, 0.25f), unit_triangle).position == Position::inside);
  CHECK(exact_hit(down(0.25f, 0.25f), unit_triangle).t == 2);
  CHECK(exact_hit(down(0.5f, 0.5f), unit_triangle).position == Position::border);
  CHECK(exact_hit(down(0, 0), unit_triangle).position == Position::border);
  CHECK(exact_hit(down(0.5f, 0.5000001f), unit_triangle).position == Position::outside);
  CHECK(exact_hit(down(0.5f, 0.49999997f), unit_triangle).position == Position::inside);
  CHECK(exact_hit(down(-1e-38f, 0.5f), unit_triangle).position == Position::outside);
}

TEST_CASE("A hit out of range, behind the ray or seen edge-on is outside") {
  accel::Ray ray = down(0.25f, 0.25f);
  ray.t_max = 2;  // exclusive
  CHECK(exact_hit(ray, unit_triangle).position == Position::outside);
  ray = down(0.25f, 0.25f);
  ray.origin[2] = -2;
  CHECK(exact_hit(ray, unit_triangle).position == Position::outside);
  const accel::Ray along{{-1, 0.25f, 0}, 0, {1, 0, 0}, 10};
  CHECK(exact_hit(along, unit_triangle).position == Position::outside);
}

TEST_CASE("The exact distance is rounded to the nearest float") {
  const accel::Ray ray{{0.1f, 0.1f, 1}, 0, {0, 0, -3}, 10};
  CHECK(exact_hit(ray, unit_triangle).t == 1.0f / 3.0f);
}

TEST_CASE("The oracle tells who is right") {
  const BenchScene scene = square();
  const accel::Hit miss, lower = hit_of(0), upper = hit_of(1), far = hit_of(2);
  CHECK(judge(scene, down(0.25f, 0.25f), lower, upper) == Verdict::ours);
  CHECK(judge(scene, down(0.25f, 0.25f), upper, lower) == Verdict::theirs);
  CHECK(judge(scene, down(0.25f, 0.25f), lower, miss) == Verdict::ours);
  CHECK(judge(scene, down(0.25f, 0.25f), miss, lower) == Verdict::theirs);
  CHECK(judge(scene, down(0.25f, 0.25f), lower, far) == Verdict::ours);
  CHECK(judge(scene, down(0.25f, 0.25f), far, lower) == Verdict::theirs);
  CHECK(judge(scene, down(0.5f, 0.5f), lower, upper) == Verdict::tie);
  CHECK(judge(scene, down(0.5f, 0.5f), miss, upper) == Verdict::tie);
  CHECK(judge(scene, down(0.75f, 0.75f), miss, lower) == Verdict::ours);
  CHECK(judge(scene, down(0.75f, 0.75f), lower, far) == Verdict::undecided);
}

TEST_CASE("An instance is judged in its own space") {
  BenchScene scene = square();
  scene.instances = {{0, {1, 0, 0, 10, 0, 1, 0, 0, 0, 0, 1, 0}}};
  CHECK(judge(scene, down(10.25f, 0.25f), hit_of(0), hit_of(1)) == Verdict::ours);
  CHECK(judge(scene, down(0.25f, 0.25f), hit_of(0), accel::Hit{}) == Verdict::theirs);
}
