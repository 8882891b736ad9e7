#include "builder.h"
#include "scenes.h"

#include <rayloom/scenes/camera.h>

namespace rayloom::scenes {

Scene make_triangle(Parameters&) {
  SceneBuilder builder;
  Geometry geometry;
  geometry.name = "triangle";
  geometry.material = builder.material(matte("white", glm::vec3(0.8f)));
  geometry.positions = {{-1, -0.7f, 0}, {1, -0.7f, 0}, {0, 1, 0}};
  geometry.normals.assign(3, glm::vec3(0, 0, 1));
  geometry.uv0 = {{0, 1}, {1, 1}, {0.5f, 0}};
  geometry.indices = {0, 1, 2};
  builder.instance(builder.mesh("triangle", {geometry}), identity_transform, "triangle");
  Scene& scene = builder.scene();
  scene.environment.kind = Environment::Kind::constant;
  scene.environment.zenith = glm::vec3(1);
  SceneCamera camera = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.78539816f);
  camera.name = "front";
  scene.cameras.push_back(camera);
  return builder.finish();
}

}  // namespace rayloom::scenes
