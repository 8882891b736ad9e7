// The triangle test compiled once more, by another compiler or with other flags (row K6). Reads cases of 17 floats (a
// ray, a triangle) from standard input and prints a hash of the hits' bits: of the product's, and of a plain kernel's,
// which shows that the flags did something.

#include <rayloom/accel/triangle.h>
#include <rayloom/base/hash.h>

#include <cinttypes>
#include <cstdio>

namespace {

using namespace rayloom;

struct Case {
  accel::Ray ray;
  float triangle[3][3];
};
static_assert(sizeof(Case) == 17 * sizeof(float));

void add_product(Hash64& hash, const Case& c) {
  const float low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
  const accel::PreparedRay ray = accel::prepare_ray(c.ray, low, high);
  if (!ray.valid) return void(hash.add(2u));
  const auto hit = accel::intersect_triangle(ray, c.triangle[0], c.triangle[1], c.triangle[2], c.ray.t_max);
  hash.add(hit.has_value());
  if (hit) hash.add(hit->t).add(hit->u).add(hit->v).add(hit->front);
}

float determinant(const float (&a)[3], const float (&b)[3], const float (&c)[3]) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

void add_plain(Hash64& hash, const Case& c) {
  float corner[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) corner[i][k] = c.triangle[i][k] - c.ray.origin[k];
  for (int i = 0; i < 3; ++i) hash.add(determinant(c.ray.direction, corner[i], corner[(i + 1) % 3]) > 0);
}

}  // namespace

int main() {
  Hash64 product, plain;
  for (Case c; std::fread(&c, sizeof(c), 1, stdin) == 1;) {
    add_product(product, c);
    add_plain(plain, c);
  }
  std::printf("%016" PRIx64 " %016" PRIx64 "\n", product.value(), plain.value());
}
