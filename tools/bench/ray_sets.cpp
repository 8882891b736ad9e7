#include "ray_sets.h"

#include <rayloom/accel/trace.h>
#include <rayloom/base/det_math.h>
#include <rayloom/base/hash.h>
#include <rayloom/scenes/camera.h>

#include <cmath>
#include <limits>

namespace rayloom::bench {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

accel::Ray make_ray(glm::vec3 origin, glm::vec3 direction, float t_min) {
  return {{origin.x, origin.y, origin.z}, t_min, {direction.x, direction.y, direction.z}, infinity};
}

glm::vec3 vertex(const TriangleSoup& soup, uint32_t primitive, uint32_t corner) {
  const float* p = &soup.vertices[size_t{soup.indices[size_t{primitive} * 3 + corner]} * 3];
  return {p[0], p[1], p[2]};
}

/// The side of the triangle that `direction` comes from.
glm::vec3 facing_normal(const TriangleSoup& soup, uint32_t primitive, glm::vec3 direction) {
  const glm::vec3 v0 = vertex(soup, primitive, 0);
  const glm::vec3 n = glm::normalize(glm::cross(vertex(soup, primitive, 1) - v0, vertex(soup, primitive, 2) - v0));
  return glm::dot(n, direction) > 0 ? -n : n;
}

float random_unit(uint64_t index, uint64_t dimension) { return unit_float(hash64(index, dimension)); }

/// Cosine distributed: the normal plus a point on the unit sphere.
glm::vec3 bounce_direction(glm::vec3 normal, uint64_t index) {
  const float z = 1 - 2 * random_unit(index, 0), angle = 6.2831853f * random_unit(index, 1);
  const float r = std::sqrt(std::max(0.0f, 1 - z * z));
  return glm::normalize(normal * 1.0001f + glm::vec3{r * det::cos(angle), r * det::sin(angle), z});
}

}  // namespace

std::vector<accel::Ray> primary_rays(const std::string& scene_name, uint32_t size) {
  const scenes::Scene scene = scenes::load_scene(scene_name);
  const scenes::CameraRays camera = scenes::camera_rays(scenes::choose_camera(scene, "", 1), size, size);
  std::vector<accel::Ray> rays;
  const auto scale = 1 / static_cast<float>(size);
  for (uint32_t y = 0; y < size; ++y)
    for (uint32_t x = 0; x < size; ++x) {
      const scenes::CameraRay ray = scenes::camera_ray(camera, (static_cast<float>(x) + 0.5f) * scale,
                                                       1 - (static_cast<float>(y) + 0.5f) * scale);
      rays.push_back(make_ray(ray.origin, ray.direction, 0));
    }
  return rays;
}

std::vector<accel::Ray> bounce_rays(const std::vector<accel::Ray>& primary, const TriangleSoup& soup,
                                    const Structure& structure) {
  std::vector<accel::Ray> rays;
  for (size_t i = 0; i < primary.size(); ++i) {
    const accel::Hit hit = accel::trace({}, {.ray = primary[i], .structure = structure.block()});
    if (!hit) continue;
    const glm::vec3 origin{primary[i].origin[0], primary[i].origin[1], primary[i].origin[2]};
    const glm::vec3 direction{primary[i].direction[0], primary[i].direction[1], primary[i].direction[2]};
    const glm::vec3 normal = facing_normal(soup, hit.primitive_index, direction);
    rays.push_back(make_ray(origin + hit.t * direction + 1e-4f * normal, bounce_direction(normal, i), 1e-4f));
  }
  return rays;
}

}  // namespace rayloom::bench
