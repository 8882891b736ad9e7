#include <rayloom/shaders/spawn.h>

#include <cmath>

namespace rayloom::shaders {
namespace {

constexpr double half_ulp = 0x1p-24;
constexpr double safety = 1.25;

double3 row_of(const float3x4& m, int i) { return double3(m[i]); }

double3 transform_point(const float3x4& m, double3 p) {
  return {glm::dot(row_of(m, 0), p) + double{m[0].w}, glm::dot(row_of(m, 1), p) + double{m[1].w},
          glm::dot(row_of(m, 2), p) + double{m[2].w}};
}

/// The inverse of a matrix's linear part in double, by its adjugate: products of floats are exact there, so that each
/// element is as good as the matrix allows, and the float inverse of the context is not needed.
struct Inverse {
  double3 row[3];

  explicit Inverse(const float3x4& m) {
    const double3 x(row_of(m, 0)), y(row_of(m, 1)), z(row_of(m, 2));
    const double3 columns[3] = {glm::cross(y, z), glm::cross(z, x), glm::cross(x, y)};
    const double determinant = glm::dot(x, columns[0]);
    for (int i = 0; i < 3; ++i) row[i] = double3(columns[0][i], columns[1][i], columns[2][i]) / determinant;
  }
  /// M^-T n
  double3 transposed(double3 n) const { return n.x * row[0] + n.y * row[1] + n.z * row[2]; }
};

/// `object_normal` is unit; `rounding` bounds, an axis, how far float moves points there (object space, in units of u).
SpawnPoint make_spawn_point(double3 object_point, double3 object_normal, double3 rounding,
                            const float3x4& object_to_world) {
  const Inverse inverse(object_to_world);
  const double3 normal = inverse.transposed(object_normal);
  const double k = glm::length(normal);
  SpawnPoint spawn;
  spawn.position = transform_point(object_to_world, object_point);
  spawn.start = spawn.position;
  spawn.normal = k > 0 ? normal / k : object_normal;
  const double world_error = glm::dot(glm::abs(spawn.normal), glm::abs(spawn.position));
  const double object_error = k > 0 ? glm::dot(glm::abs(object_normal), rounding) / k : 0.0;
  spawn.offset = safety * half_ulp * (world_error + object_error) + 0x1p-140;
  const double3 lengths(glm::length(inverse.row[0]), glm::length(inverse.row[1]), glm::length(inverse.row[2]));
  spawn.grazing = safety * half_ulp * (4 + glm::dot(glm::abs(object_normal), lengths) / k);
  return spawn;
}

double3 transform_vector(const float3x4& m, double3 v) {
  return {glm::dot(row_of(m, 0), v), glm::dot(row_of(m, 1), v), glm::dot(row_of(m, 2), v)};
}

/// How far in world space rounding may take an origin near `object_point`, in any direction.
double largest_stray(const SpawnPoint& spawn, double3 object_point, const float3x4& m) {
  const double3 rows(glm::length(row_of(m, 0)), glm::length(row_of(m, 1)), glm::length(row_of(m, 2)));
  return safety * half_ulp * (glm::length(spawn.position) + glm::length(rows) * glm::length(object_point));
}

/// The position; where it lies closer to an edge than `margin`, moved towards the triangle's centre until it does not,
/// but by three margins at most.
double3 off_edges(double3 position, const std::array<double3, 3>& corners, double3 weights, double margin) {
  const double area = glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  double share = 0;
  for (int i = 0; i < 3; ++i) {
    const double height = area / glm::length(corners[(i + 2) % 3] - corners[(i + 1) % 3]);
    const double distance = weights[i] * height;
    if (distance < margin)
      share = std::fmax(share, height > 3 * margin ? (margin - distance) / (height / 3 - distance) : 1);
  }
  if (share == 0) return position;
  const double3 to_centre = (corners[0] + corners[1] + corners[2]) / 3.0 - position;
  const double way = share * glm::length(to_centre);
  return position + std::fmin(1.0, 3 * margin / way) * share * to_centre;
}

}  // namespace

SpawnPoint triangle_spawn_point(const std::array<float3, 3>& vertices, float2 barycentrics,
                                const float3x4& object_to_world) {
  const double3 v0(vertices[0]), v1(vertices[1]), v2(vertices[2]);
  const double3 edge1 = v1 - v0, edge2 = v2 - v0;
  const double3 point = v0 + double{barycentrics.x} * edge1 + double{barycentrics.y} * edge2;
  const double3 reach = glm::max(glm::abs(v0), glm::max(glm::abs(v1), glm::abs(v2)));
  const double3 normal = glm::normalize(glm::cross(edge1, edge2));
  SpawnPoint spawn = make_spawn_point(point, normal, glm::abs(point) + reach, object_to_world);
  const double3 start = transform_point(object_to_world, v0);
  const std::array<double3, 3> corners{start, start + transform_vector(object_to_world, edge1),
                                       start + transform_vector(object_to_world, edge2)};
  const double b1 = barycentrics.x, b2 = barycentrics.y;
  const double margin = 2 * (largest_stray(spawn, point, object_to_world) + spawn.offset);
  spawn.start = off_edges(spawn.position, corners, {1 - b1 - b2, b1, b2}, margin);
  return spawn;
}

SpawnPoint sphere_spawn_point(float3 center, float radius, double3 object_point, const float3x4& object_to_world) {
  const double3 normal = glm::normalize(object_point - double3(center));
  const double3 point = double3(center) + double{radius} * normal;
  return make_spawn_point(point, normal, glm::abs(point), object_to_world);
}

}  // namespace rayloom::shaders
