// Real files by others, where they are present: the directory named by RAYLOOM_SHARED_SCENES, else ../shared/scenes
// beside the repository. Without them each case says so and checks nothing.

#include <rayloom/scenes/camera.h>
#include <rayloom/scenes/summary.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <iostream>

using namespace rayloom::scenes;

namespace {

std::string directory() {
  const char* named = std::getenv("RAYLOOM_SHARED_SCENES");
  return named ? named : RAYLOOM_SHARED_SCENES_DEFAULT;
}

struct Expected {
  const char* file;
  uint64_t triangles, instanced;
  std::vector<const char*> warnings;  ///< exactly these, by a part of each
};

const char* const no_light = "the file has no light";

const Expected assets[] = {
    {"balloon/scene.gltf", 35698, 35698, {no_light}},
    {"cornellBox/cornellBox.gltf", 16720, 16732, {"extension NV_materials_mdl is not supported", "textures[0].source"}},
    {"dragon.glb", 871414, 871414, {no_light}},
    {"chinesedragon.gltf", 100960, 100960, {no_light}},
    {"samplebuilding.gltf", 11132, 23388, {"normals of length zero", "normals of length zero", no_light}},
    {"house.glb", 10497, 10497, {no_light}},
    {"statue.glb", 16259, 16259, {no_light}},
    {"terrain.glb", 3868, 3868, {no_light}},
    {"CesiumMan.glb", 4672, 4672, {"animations are ignored", "skins[0]", no_light}},
    {"morph-stress-test.glb", 2412, 2412, {"animations are ignored", "morph targets", no_light}},
    {"ClearCoatTest.glb", 37116, 37116, {"KHR_materials_clearcoat"}},
    {"NormalTangentTest.glb", 7774, 7774, {no_light}},
};

void check(const Expected& expected) {
  const std::string path = directory() + "/" + expected.file;
  if (!std::filesystem::exists(path)) {
    std::cerr << "skipped: " << path << " is not there\n";
    return;
  }
  const SceneSummary summary = summarize(load_scene(path));
  INFO(path);
  CHECK(summary.triangles == expected.triangles);
  CHECK(summary.instanced_triangles == expected.instanced);
  CHECK(summary.images_decoded == 0);
  CHECK_FALSE(summary.bounds.empty());
  REQUIRE(summary.warnings.size() == expected.warnings.size());
  for (size_t i = 0; i < summary.warnings.size(); ++i)
    CHECK_THAT(summary.warnings[i], Catch::Contains(expected.warnings[i]));
}

}  // namespace

TEST_CASE("triangle counts and warnings of real files") {
  for (const Expected& expected : assets) check(expected);
}

TEST_CASE("cornellBox has a light or a camera of its own") {
  const std::string path = directory() + "/cornellBox/cornellBox.gltf";
  if (!std::filesystem::exists(path)) {
    std::cerr << "skipped: " << path << " is not there\n";
    return;
  }
  const Scene scene = load_scene(path);
  CHECK(scene.lights.size() + scene.cameras.size() > 0);
  CHECK(scene.environment.kind == Environment::Kind::none);
}

TEST_CASE("images of real files decode when asked") {
  const std::string path = directory() + "/NormalTangentTest.glb";
  if (!std::filesystem::exists(path)) {
    std::cerr << "skipped: " << path << " is not there\n";
    return;
  }
  const Scene scene = load_scene(path);
  REQUIRE_FALSE(scene.images.empty());
  for (const auto& image : scene.images) CHECK(image->pixels().width > 0);
}
