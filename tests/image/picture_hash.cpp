#include "picture_hash.h"

#include <rayloom/scenes/camera.h>

#include "../shaders/scenes.h"

#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace rayloom::test {
namespace {

struct Fnv1a {
  uint64_t state = 0xcbf29ce484222325u;
  void add(const void* data, size_t bytes) {
    for (size_t i = 0; i < bytes; ++i) state = (state ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001b3u;
  }
};

scenes::Material matte(glm::vec3 color, float roughness) {
  scenes::Material material;
  material.base_color = glm::vec4(color, 1);
  material.metallic = 0, material.roughness = roughness;
  return material;
}

std::shared_ptr<const scenes::Image> leaf_image() {
  scenes::Pixels pixels{8, 8, std::vector<uint8_t>(4 * 64), {}};
  for (uint32_t i = 0; i < 64; ++i) {
    const uint32_t x = i % 8, y = i / 8;
    const bool leaf = (x * x + 3 * y + x * y) % 5 < 3;
    pixels.bytes[4 * i] = static_cast<uint8_t>(40 + 20 * x),
                     pixels.bytes[4 * i + 1] = static_cast<uint8_t>(90 + 18 * y);
    pixels.bytes[4 * i + 2] = 30, pixels.bytes[4 * i + 3] = leaf ? 255 : 0;
  }
  return std::make_shared<scenes::Image>(scenes::Image::from_pixels("leaf", std::move(pixels)));
}

scenes::Scene masked_scene() {
  scenes::Scene scene;
  scene.name = "masked";
  scene.materials = {matte({0.7f, 0.7f, 0.7f}, 0.6f), matte({1, 1, 1}, 0.9f), matte({0.9f, 0.3f, 0.2f}, 0.2f)};
  scene.materials[1].alpha_mode = scenes::AlphaMode::mask;
  scene.materials[1].base_color_texture.texture = scene.materials[1].normal_texture.texture = 0;
  scene.materials[2].alpha_mode = scenes::AlphaMode::blend;
  scene.materials[2].base_color.w = 0.6f;
  scene.images.push_back(leaf_image());
  scene.textures.push_back({});
  add_mesh(scene, quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, 0));
  const uint32_t screen = add_mesh(scene, quad({-1, 0, 0}, {2, 0, 0}, {0, 2, 0}, 1));
  scene.instances.push_back({screen, {0.6f, 0, 0.7f, 1, 0, 0.5f, 0, 0, -0.7f, 0, 0.6f, 0.8f}, "leaf", "leaf"});
  add_mesh(scene, box({-1.4f, 0, 0.3f}, {-0.7f, 0.7f, 1}, 2));
  scene.environment.kind = scenes::Environment::Kind::gradient;
  scene.environment.zenith = {0.4f, 0.6f, 1}, scene.environment.horizon = {0.9f, 0.8f, 0.7f};
  scenes::Light sun;
  sun.kind = scenes::Light::Kind::directional;
  sun.direction = glm::normalize(glm::vec3(-0.4f, -1, -0.3f)), sun.intensity = {2, 1.8f, 1.5f};
  scene.lights.push_back(sun);
  scene.cameras.push_back(scenes::look_at({0.8f, 1.6f, 4}, {0, 0.8f, 0}, {0, 1, 0}, 0.8f));
  return scene;
}

}  // namespace

uint64_t picture_hash(const shaders::Picture& picture) {
  Fnv1a hash;
  hash.add(&picture.width, sizeof(picture.width));
  hash.add(&picture.height, sizeof(picture.height));
  hash.add(picture.rgba.data(), picture.rgba.size() * sizeof(float4));
  return hash.state;
}

std::string PictureCase::key() const {
  std::ostringstream text;
  text << scene << ' ' << program << ' ' << width << 'x' << height << " spp=" << samples << " seed=" << seed;
  return text.str();
}

scenes::Scene make_scene(const std::string& name) {
  return name == "masked" ? masked_scene() : scenes::load_scene(name);
}

shaders::Picture render_case(const PictureCase& picture) {
  const scenes::Scene scene = make_scene(picture.scene);
  shaders::RenderOptions options;
  options.program = picture.program;
  options.width = picture.width, options.height = picture.height, options.seed = picture.seed;
  shaders::Renderer renderer(scene, options);
  renderer.render(0, picture.samples);
  return renderer.picture();
}

std::map<std::string, uint64_t> read_hashes(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  std::map<std::string, uint64_t> hashes;
  for (std::string line; std::getline(file, line);) {
    const size_t colon = line.rfind(": ");
    if (line.empty() || line[0] == '#' || colon == std::string::npos) continue;
    hashes[line.substr(0, colon)] = std::stoull(line.substr(colon + 2), nullptr, 16);
  }
  return hashes;
}

void write_hashes(const std::string& path, const std::map<std::string, uint64_t>& hashes) {
  std::ofstream file(path);
  file << "# Hashes of small renders, compared bit for bit by image_hash_test on every machine.\n"
          "# When a change of pictures is meant: look at the pictures, then run\n"
          "#   RAYLOOM_UPDATE_HASHES=1 ctest -R image_hash_test\n"
          "# and say in the commit why they changed.\n";
  for (const auto& [key, hash] : hashes) file << key << ": " << std::hex << hash << std::dec << '\n';
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace rayloom::test
