#include "builder.h"
#include "scenes.h"

#include <rayloom/base/hash.h>
#include <rayloom/scenes/camera.h>

#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr uint32_t side = 22;  // 22 x 22 small spheres, three large ones and the ground: 488
constexpr uint32_t matte_count = 24, metal_count = 8, glossy_count = 6, lamp_count = 2;
constexpr float small_radius = 0.2f;

float random(uint32_t what, uint32_t index) { return unit_float(hash64(what, index)); }

glm::vec3 random_color(uint32_t what, uint32_t index) {
  return {random(what, 3 * index), random(what, 3 * index + 1), random(what, 3 * index + 2)};
}

/// One sphere set a material, for the small spheres.
std::vector<SphereSet> make_sets(SceneBuilder& builder) {
  std::vector<SphereSet> sets;
  const auto add = [&](Material material) {
    const std::string name = material.name;
    sets.push_back({name, builder.material(std::move(material)), {}});
  };
  for (uint32_t i = 0; i < matte_count; ++i) {
    const glm::vec3 color = random_color(1, i) * random_color(2, i);
    add(matte("matte " + std::to_string(i), color * 0.9f + 0.05f));
  }
  for (uint32_t i = 0; i < metal_count; ++i) {
    add(metal("metal " + std::to_string(i), random_color(3, i) * 0.5f + 0.5f, 0.5f * random(4, i)));
  }
  for (uint32_t i = 0; i < glossy_count; ++i) {
    add(glossy("glossy " + std::to_string(i), random_color(5, i) * 0.8f + 0.1f, 0.05f + 0.3f * random(6, i)));
  }
  for (uint32_t i = 0; i < lamp_count; ++i) {
    Material lamp = matte("lamp " + std::to_string(i), glm::vec3(0.8f));
    lamp.emissive = 4.0f * (random_color(7, i) * 0.5f + 0.5f);
    add(lamp);
  }
  return sets;
}

/// Seven in ten matte, then metal, glossy and a few lamps.
size_t pick_set(uint32_t index) {
  const float kind = random(8, index);
  const auto among = [&](uint32_t first, uint32_t count) {
    return size_t{first} + static_cast<size_t>(random(9, index) * static_cast<float>(count));
  };
  if (kind < 0.7f) return among(0, matte_count);
  if (kind < 0.85f) return among(matte_count, metal_count);
  if (kind < 0.97f) return among(matte_count + metal_count, glossy_count);
  return among(matte_count + metal_count + glossy_count, lamp_count);
}

/// In its cell, but outside of the three large spheres of radius 1 at x = -4, 0, 4.
Sphere small_sphere(uint32_t index) {
  const float x = static_cast<float>(index % side) - 11 + 0.9f * random(10, index);
  const float z = static_cast<float>(index / side) - 11 + 0.9f * random(11, index);
  glm::vec3 center(x, small_radius, z);
  for (const float large : {-4.0f, 0.0f, 4.0f}) {
    const glm::vec3 away = center - glm::vec3(large, small_radius, 0);
    const float distance = std::sqrt(glm::dot(away, away));
    constexpr float clear = 0.92f;  // sqrt((1 + 0.2)^2 - (1 - 0.2)^2) = 0.894
    if (distance < clear) center += (distance > 0 ? away / distance : glm::vec3(1, 0, 0)) * (clear - distance);
  }
  return {center, small_radius};
}

SphereSet single(SceneBuilder& builder, Material material, Sphere sphere) {
  const std::string name = material.name;
  return {name, builder.material(std::move(material)), {sphere}};
}

void add_sky(Scene& scene) {
  scene.environment.kind = Environment::Kind::gradient;
  scene.environment.zenith = {0.5f, 0.7f, 1.0f};
  scene.environment.horizon = glm::vec3(1);
  scene.environment.nadir = glm::vec3(1);
}

}  // namespace

Scene make_spheres(Parameters&) {
  SceneBuilder builder;
  std::vector<SphereSet> sets = make_sets(builder);
  for (uint32_t i = 0; i < side * side; ++i) sets[pick_set(i)].spheres.push_back(small_sphere(i));
  std::erase_if(sets, [](const SphereSet& set) { return set.spheres.empty(); });
  sets.push_back(single(builder, matte("ground", glm::vec3(0.5f)), {{0, -1000, 0}, 1000}));
  sets.push_back(single(builder, glossy("large glossy", {0.15f, 0.3f, 0.6f}, 0.08f), {{0, 1, 0}, 1}));
  sets.push_back(single(builder, matte("large matte", {0.4f, 0.2f, 0.1f}), {{-4, 1, 0}, 1}));
  sets.push_back(single(builder, metal("large metal", {0.7f, 0.6f, 0.5f}, 0.02f), {{4, 1, 0}, 1}));
  builder.instance(builder.sphere_mesh("spheres", std::move(sets)), identity_transform, "spheres");
  add_sky(builder.scene());
  SceneCamera camera = look_at({13, 2, 3}, {0, 0, 0}, {0, 1, 0}, 0.34906585f);
  camera.name = "front";
  builder.scene().cameras.push_back(camera);
  return builder.finish();
}

}  // namespace rayloom::scenes
