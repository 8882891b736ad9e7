#include <rayloom/shaders/spawn.h>

#include <cmath>

namespace rayloom::shaders {
namespace {

constexpr double half_ulp = 0x1p-24;
constexpr double safety = 1.25;

double3 row(const float3x4& m, int i) { return double3(m[i]); }

double3 transform_point(const float3x4& m, double3 p) {
  return {glm::dot(row(m, 0), p) + double{m[0].w}, glm::dot(row(m, 1), p) + double{m[1].w},
          glm::dot(row(m, 2), p) + double{m[2].w}};
}

/// `object_normal` is unit; `rounding` bounds, an axis, how far float moves points there (object space, in units of u).
SpawnPoint make_spawn_point(double3 object_point, double3 object_normal, double3 rounding,
                            const float3x4& object_to_world, const float3x4& world_to_object) {
  SpawnPoint spawn;
  spawn.position = transform_point(object_to_world, object_point);
  const double3 normal = object_normal.x * row(world_to_object, 0) + object_normal.y * row(world_to_object, 1) +
                         object_normal.z * row(world_to_object, 2);
  const double k = glm::length(normal);
  spawn.normal = k > 0 ? normal / k : object_normal;
  const double world_error = glm::dot(glm::abs(spawn.normal), glm::abs(spawn.position));
  const double object_error = k > 0 ? glm::dot(glm::abs(object_normal), rounding) / k : 0.0;
  spawn.offset = safety * half_ulp * (world_error + object_error) + 0x1p-140;
  return spawn;
}

}  // namespace

SpawnPoint triangle_spawn_point(const std::array<float3, 3>& vertices, float2 barycentrics,
                                const float3x4& object_to_world, const float3x4& world_to_object) {
  const double3 v0(vertices[0]), v1(vertices[1]), v2(vertices[2]);
  const double3 edge1 = v1 - v0, edge2 = v2 - v0;
  const double3 point = v0 + double{barycentrics.x} * edge1 + double{barycentrics.y} * edge2;
  const double3 reach = glm::max(glm::abs(v0), glm::max(glm::abs(v1), glm::abs(v2)));
  return make_spawn_point(point, glm::normalize(glm::cross(edge1, edge2)), glm::abs(point) + reach, object_to_world,
                          world_to_object);
}

SpawnPoint sphere_spawn_point(float3 center, float radius, double3 object_point, const float3x4& object_to_world,
                              const float3x4& world_to_object) {
  const double3 normal = glm::normalize(object_point - double3(center));
  const double3 point = double3(center) + double{radius} * normal;
  return make_spawn_point(point, normal, glm::abs(point), object_to_world, world_to_object);
}

}  // namespace rayloom::shaders
