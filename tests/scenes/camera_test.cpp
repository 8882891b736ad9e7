#include <rayloom/base/error.h>
#include <rayloom/scenes/camera.h>

#include <catch2/catch.hpp>
#include <cmath>

using namespace rayloom;
using namespace rayloom::scenes;

namespace {

/// Picture coordinates of a world point, the camera's own way: no use of camera_rays.
glm::vec2 project(const SceneCamera& camera, float aspect, glm::vec3 point) {
  const glm::vec3 d = point - camera.position;
  const float depth = -glm::dot(d, camera.backward), half = std::tan(camera.yfov / 2);
  return {glm::dot(d, camera.right) / depth / half / aspect, glm::dot(d, camera.up) / depth / half};
}

}  // namespace

TEST_CASE("perspective rays pass through the corners of the view") {
  const SceneCamera camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 1.5707964f);
  const CameraRays rays = camera_rays(camera, 200, 100);
  const CameraRay centre = camera_ray(rays, 0.5f, 0.5f), corner = camera_ray(rays, 1, 1);
  CHECK(centre.origin == glm::vec3(0, 0, 5));
  CHECK(centre.direction.z == Approx(-1));
  CHECK(corner.direction.x / -corner.direction.z == Approx(2));
  CHECK(corner.direction.y / -corner.direction.z == Approx(1));
  CHECK(glm::dot(corner.direction, corner.direction) == Approx(1));
}

TEST_CASE("orthographic rays are parallel and cover ymag") {
  Scene scene;
  const SceneCamera camera = choose_camera(scene, "eye=0,0,5;at=0,0,0;ortho=2", 1);
  const CameraRays rays = camera_rays(camera, 300, 100);
  CHECK(camera_ray(rays, 0, 0).direction == camera_ray(rays, 1, 1).direction);
  CHECK(camera_ray(rays, 1, 1).origin.x == Approx(6));
  CHECK(camera_ray(rays, 1, 0).origin.y == Approx(-2));
  CHECK(camera_ray(rays, 0.5f, 0.5f).origin.z == Approx(5));
}

TEST_CASE("framing shows every corner of the scene, close to the rim, in any shape of picture") {
  Scene scene;
  Geometry geometry;
  geometry.positions = {{-3, 1, -50}, {7, 2, 20}, {0, 90, 0}};
  geometry.indices = {0, 1, 2};
  scene.meshes.push_back({"m", {geometry}, {}});
  scene.instances.push_back({});
  const Bounds box = world_bounds(scene);
  for (const float aspect : {0.2f, 1.0f, 3.0f}) {
    const SceneCamera camera = choose_camera(scene, "", aspect);
    float furthest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec3 point(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                            corner & 4 ? box.max.z : box.min.z);
      const glm::vec2 p = project(camera, aspect, point);
      furthest = std::max({furthest, std::fabs(p.x), std::fabs(p.y)});
    }
    CHECK(furthest < 1);
    CHECK(furthest > 0.8f);
  }
}

TEST_CASE("cameras are chosen by index, name, spec; the file's first comes before framing") {
  Scene scene;
  scene.cameras.resize(2);
  scene.cameras[0].name = "front", scene.cameras[1].name = "side";
  CHECK(choose_camera(scene, "", 1).name == "front");
  CHECK(choose_camera(scene, "side", 1).name == "side");
  CHECK(choose_camera(scene, "1", 1).name == "side");
  CHECK(choose_camera(scene, "frame", 1).name == "frame");
  const SceneCamera spec = choose_camera(scene, "eye=1,2,3;at=1,2,-4;up=1,0,0;fov=90", 1);
  CHECK(spec.position == glm::vec3(1, 2, 3));
  CHECK(spec.up == glm::vec3(1, 0, 0));
  CHECK(spec.right == glm::vec3(0, -1, 0));
  CHECK(spec.yfov == Approx(1.5707963));
}

TEST_CASE("bad camera specs are usage errors that say why") {
  const Scene scene;
  const auto message = [&](const char* spec) {
    try {
      choose_camera(scene, spec, 1);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  CHECK_THAT(message("nobody"), Catch::Contains("no such camera; the scene has none"));
  CHECK_THAT(message("3"), Catch::Contains("no such camera"));
  CHECK_THAT(message("eye=1,2,3"), Catch::Contains("eye and at are needed"));
  CHECK_THAT(message("eye=1,2;at=0,0,0"), Catch::Contains("'1,2' is not x,y,z"));
  CHECK_THAT(message("eye=1,2,nan;at=0,0,0"), Catch::Contains("'nan' is not a number"));
  CHECK_THAT(message("eye=1,2,3;at=0,0,0;fov=180"), Catch::Contains("fov must be"));
  CHECK_THAT(message("eye=1,2,3;at=0,0,0;zoom=2"), Catch::Contains("'zoom' is none of"));
  CHECK_THAT(message("eye=1,2,3;at=1,2,3"), Catch::Contains("different points"));
  CHECK_THAT(message("eye=0,5,0;at=0,0,0"), Catch::Contains("up must not be"));
  CHECK_THAT(message("eye=0,5,1;at=0,0,0;ortho=0"), Catch::Contains("ortho must be above 0"));
}
