#include <rayloom/tools/bench/error/lamp_scenes.h>

#include <rayloom/scenes/camera.h>

namespace rayloom::bench {
namespace {

constexpr float power = 60;     // radiance times area of all lamps together
constexpr float room_half = 2;  // metres; the room is open towards the camera, +z
constexpr float lamp_height = 2.5f;

scenes::Material material(glm::vec3 color, float metallic, float roughness) {
  scenes::Material result;
  result.base_color = glm::vec4(color, 1);
  result.metallic = metallic, result.roughness = roughness;
  return result;
}

/// Its front is towards cross(u, v).
void add_quad(scenes::Scene& scene, uint32_t of_material, glm::vec3 center, glm::vec3 u, glm::vec3 v) {
  scenes::Geometry geometry;
  geometry.material = of_material;
  const glm::vec3 corner = center - 0.5f * (u + v);
  geometry.positions = {corner, corner + u, corner + u + v, corner + v};
  geometry.indices = {0, 1, 2, 0, 2, 3};
  scenes::Mesh mesh;
  mesh.geometries.push_back(std::move(geometry));
  scene.meshes.push_back(std::move(mesh));
  scenes::Instance instance;
  instance.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
  scene.instances.push_back(std::move(instance));
}

/// Floor, back wall, and four plates from nearly a mirror to rough, tilted towards the camera.
scenes::Scene room(const char* name) {
  scenes::Scene scene;
  scene.name = name;
  scene.materials = {material({0.6f, 0.55f, 0.5f}, 0, 0.8f), material({0.4f, 0.45f, 0.6f}, 0, 1)};
  add_quad(scene, 0, {0, 0, 0}, {0, 0, 2 * room_half}, {2 * room_half, 0, 0});
  add_quad(scene, 1, {0, 1.5f, -room_half}, {2 * room_half, 0, 0}, {0, 3, 0});
  for (int i = 0; i < 4; ++i) {
    const auto step = static_cast<float>(i);
    scene.materials.push_back(material(glm::vec3(0.9f), 1, 0.1f + 0.15f * step));
    const float tilt = 0.35f + 0.15f * step;  // rise of the plate over its depth
    add_quad(scene, 2 + static_cast<uint32_t>(i), {0, 0.25f + 0.3f * step, 0.9f - 0.7f * step}, {3, 0, 0},
             {0, 0.6f * tilt, -0.6f});
  }
  scene.cameras.push_back(scenes::look_at({0, 1.7f, 5.5f}, {0, 1.1f, 0}, {0, 1, 0}, 0.6f));
  return scene;
}

uint32_t add_lamp_material(scenes::Scene& scene, float area) {
  scene.materials.push_back(material(glm::vec3(0), 0, 1));
  scene.materials.back().emissive = glm::vec3(power / area);
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

scenes::Scene make_small_lamps() {
  constexpr int columns = 5, rows = 4;
  constexpr float side = 0.03f;
  scenes::Scene scene = room(small_lamps);
  const uint32_t lamp = add_lamp_material(scene, columns * rows * side * side);
  for (int x = 0; x < columns; ++x)
    for (int z = 0; z < rows; ++z)
      add_quad(scene, lamp, {-1.5f + 0.75f * static_cast<float>(x), lamp_height, -1.5f + 0.8f * static_cast<float>(z)},
               {side, 0, 0}, {0, 0, side});
  return scene;
}

scenes::Scene make_large_lamps() {
  constexpr float width = 3, depth = 1.5f;
  scenes::Scene scene = room(large_lamps);
  const uint32_t lamp = add_lamp_material(scene, 2 * width * depth);
  add_quad(scene, lamp, {0, lamp_height, -0.9f}, {width, 0, 0}, {0, 0, depth});
  add_quad(scene, lamp, {0, lamp_height, 1.0f}, {width, 0, 0}, {0, 0, depth});
  return scene;
}

}  // namespace

scenes::Scene load_error_scene(const std::string& name) {
  if (name == small_lamps) return make_small_lamps();
  if (name == large_lamps) return make_large_lamps();
  return scenes::load_scene(name);
}

}  // namespace rayloom::bench
