#include <rayloom/tools/bench/ray_sets.h>

#include <rayloom/base/det_math.h>
#include <rayloom/base/hash.h>
#include <rayloom/scenes/camera.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace rayloom::bench {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float offset_of_diagonal = 1e-5f, occlusion_of_diagonal = 0.1f, light_of_diagonal = 0.02f;

accel::Ray make_ray(glm::vec3 origin, glm::vec3 direction, float t_max) {
  return {{origin.x, origin.y, origin.z}, 0, {direction.x, direction.y, direction.z}, t_max};
}

/// Where a primary ray hit, on the side it came from.
struct Vertex {
  glm::vec3 position, normal;
};

float random_unit(uint64_t index, uint64_t dimension) { return unit_float(hash64(index, dimension)); }

glm::vec3 random_in_cube(uint64_t index, uint64_t dimension) {
  return {random_unit(index, dimension) - 0.5f, random_unit(index, dimension + 1) - 0.5f,
          random_unit(index, dimension + 2) - 0.5f};
}

/// Cosine distributed: the normal plus a point on the unit sphere.
glm::vec3 cosine_direction(glm::vec3 normal, uint64_t index) {
  const float z = 1 - 2 * random_unit(index, 0), angle = 6.2831853f * random_unit(index, 1);
  const float r = std::sqrt(std::max(0.0f, 1 - z * z));
  return glm::normalize(normal * 1.0001f + glm::vec3{r * det::cos(angle), r * det::sin(angle), z});
}

Rays primary_rays(const BenchScene& scene, uint32_t size) {
  const scenes::CameraRays camera = scenes::camera_rays(scene.camera, size, size);
  const float scale = 1 / static_cast<float>(size);
  const uint64_t side = std::bit_ceil(uint64_t{size});
  Rays rays;
  for (uint64_t i = 0; i < side * side; ++i) {
    const MortonPixel pixel = morton_pixel(i);
    if (pixel.x >= size || pixel.y >= size) continue;
    const scenes::CameraRay ray = scenes::camera_ray(camera, (static_cast<float>(pixel.x) + 0.5f) * scale,
                                                     1 - (static_cast<float>(pixel.y) + 0.5f) * scale);
    rays.push_back(make_ray(ray.origin, ray.direction, infinity));
  }
  return rays;
}

std::vector<Vertex> first_vertices(const BenchScene& scene, const OurStructure& structure, const Rays& primary,
                                   float offset) {
  std::vector<Vertex> vertices;
  for (const accel::Ray& ray : primary) {
    const accel::Hit hit = accel::trace({}, structure.request(ray));
    if (!hit) continue;
    const glm::vec3 origin{ray.origin[0], ray.origin[1], ray.origin[2]};
    const glm::vec3 direction{ray.direction[0], ray.direction[1], ray.direction[2]};
    const std::array<glm::vec3, 3> corners = scene.triangle(hit.instance_index, hit.primitive_index);
    glm::vec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    if (glm::dot(normal, direction) > 0) normal = -normal;
    vertices.push_back({origin + hit.t * direction + offset * normal, normal});
  }
  return vertices;
}

Rays shadow_rays(const std::vector<Vertex>& vertices, glm::vec3 light, float size) {
  Rays rays;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const glm::vec3 point = light + size * random_in_cube(i, 2);
    rays.push_back(make_ray(vertices[i].position, point - vertices[i].position, 1));
  }
  return rays;
}

double share_of_hits(const OurStructure& structure, const Rays& rays) {
  size_t hits = 0;
  for (const accel::Ray& ray : rays) {
    hits += bool{accel::trace({}, structure.request(ray, accel::ray_flag::accept_first_hit_and_end_search))};
  }
  return rays.empty() ? 0 : static_cast<double>(hits) / static_cast<double>(rays.size());
}

/// Of some points in the scene's box, the one that a third of what the camera sees does not see: neither a light in a
/// closed room nor a sun without shadows says much about occlusion.
glm::vec3 choose_light(const BenchScene& scene, const OurStructure& structure, const std::vector<Vertex>& vertices) {
  std::vector<Vertex> some;
  for (size_t i = 0; i < vertices.size(); i += std::max<size_t>(1, vertices.size() / 256)) some.push_back(vertices[i]);
  glm::vec3 best{};
  double best_distance = infinity;
  for (uint64_t candidate = 0; candidate < 32; ++candidate) {
    const glm::vec3 extent = scene.bounds.max - scene.bounds.min;
    const glm::vec3 light = scene.bounds.min + extent * (random_in_cube(candidate, 8) + 0.5f);
    const double distance = std::fabs(share_of_hits(structure, shadow_rays(some, light, 0)) - 0.35);
    if (distance < best_distance) best_distance = distance, best = light;
  }
  return best;
}

Rays shuffled(Rays rays) {
  for (size_t i = rays.size(); i > 1; --i) std::swap(rays[i - 1], rays[hash64(i, 99) % i]);
  return rays;
}

}  // namespace

MortonPixel morton_pixel(uint64_t index) {
  MortonPixel pixel{0, 0};
  for (uint32_t bit = 0; bit < 32; ++bit) {
    pixel.x |= static_cast<uint32_t>(index >> (2 * bit) & 1) << bit;
    pixel.y |= static_cast<uint32_t>(index >> (2 * bit + 1) & 1) << bit;
  }
  return pixel;
}

RaySets make_ray_sets(const BenchScene& scene, const OurStructure& structure, uint32_t size) {
  const float diagonal = glm::length(scene.bounds.max - scene.bounds.min);
  RaySets sets;
  sets.primary = primary_rays(scene, size);
  const std::vector<Vertex> vertices = first_vertices(scene, structure, sets.primary, offset_of_diagonal * diagonal);
  for (size_t i = 0; i < vertices.size(); ++i) {
    const glm::vec3 direction = cosine_direction(vertices[i].normal, i);
    sets.bounce.push_back(make_ray(vertices[i].position, direction, infinity));
    sets.ambient.push_back(make_ray(vertices[i].position, direction, occlusion_of_diagonal * diagonal));
  }
  sets.shadow = shadow_rays(vertices, choose_light(scene, structure, vertices), light_of_diagonal * diagonal);
  sets.shuffled = shuffled(sets.bounce);
  return sets;
}

}  // namespace rayloom::bench
