#include "builder.h"
#include "scenes.h"
#include "shapes.h"

#include <rayloom/scenes/camera.h>

namespace rayloom::scenes {
namespace {

Geometry quad(const std::string& name, uint32_t material, const glm::vec3 (&corners)[4]) {
  Geometry geometry;
  geometry.name = name;
  geometry.material = material;
  add_quad(geometry, corners);
  return geometry;
}

/// Walls of [-1, 1] x [0, 2] x [-1, 1], facing inwards, open towards +z.
std::vector<Geometry> room(uint32_t white, uint32_t red, uint32_t green) {
  return {quad("floor", white, {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}),
          quad("ceiling", white, {{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}}),
          quad("back", white, {{-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}}),
          quad("left", red, {{-1, 0, 1}, {-1, 0, -1}, {-1, 2, -1}, {-1, 2, 1}}),
          quad("right", green, {{1, 0, -1}, {1, 0, 1}, {1, 2, 1}, {1, 2, -1}})};
}

uint32_t block(SceneBuilder& builder, uint32_t white) {
  Geometry geometry;
  geometry.name = "block";
  geometry.material = white;
  add_box(geometry, {-0.3f, 0, -0.3f}, {0.3f, 0.6f, 0.3f});
  return builder.mesh("block", {geometry});
}

Material lamp() {
  Material material = matte("lamp", glm::vec3(0.78f));
  material.emissive = glm::vec3(17, 12, 4);
  return material;
}

}  // namespace

Scene make_cornell(Parameters&) {
  SceneBuilder builder;
  const uint32_t white = builder.material(matte("white", {0.725f, 0.71f, 0.68f}));
  const uint32_t red = builder.material(matte("red", {0.63f, 0.065f, 0.05f}));
  const uint32_t green = builder.material(matte("green", {0.14f, 0.45f, 0.091f}));
  const uint32_t light = builder.material(lamp());
  builder.instance(builder.mesh("room", room(white, red, green)), identity_transform, "room");
  const uint32_t cube = block(builder, white);
  builder.instance(cube, placed({0.33f, 0, 0.37f}, -17), "short block");
  builder.instance(cube, placed({-0.34f, 0, -0.3f}, 17, {1, 2, 1}), "tall block");
  const Geometry panel = quad(
      "light", light, {{-0.24f, 1.98f, -0.22f}, {0.24f, 1.98f, -0.22f}, {0.24f, 1.98f, 0.16f}, {-0.24f, 1.98f, 0.16f}});
  builder.instance(builder.mesh("light", {panel}), identity_transform, "light");
  SceneCamera camera = look_at({0, 1, 3.9f}, {0, 1, 0}, {0, 1, 0}, 0.68f);
  camera.name = "front";
  builder.scene().cameras.push_back(camera);
  return builder.finish();
}

}  // namespace rayloom::scenes
