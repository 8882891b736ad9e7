#include "builder.h"

#include <rayloom/base/det_math.h>

namespace rayloom::scenes {

uint32_t SceneBuilder::material(Material material) {
  scene_.materials.push_back(std::move(material));
  return static_cast<uint32_t>(scene_.materials.size() - 1);
}

uint32_t SceneBuilder::texture(const std::string& name, Pixels pixels, Wrap wrap) {
  scene_.images.push_back(std::make_shared<const Image>(Image::from_pixels(name, std::move(pixels))));
  Texture texture;
  texture.image = static_cast<uint32_t>(scene_.images.size() - 1);
  texture.wrap_u = texture.wrap_v = wrap;
  texture.name = name;
  scene_.textures.push_back(texture);
  return static_cast<uint32_t>(scene_.textures.size() - 1);
}

uint32_t SceneBuilder::mesh(const std::string& name, std::vector<Geometry> geometries) {
  scene_.meshes.push_back({name, std::move(geometries), {}});
  return static_cast<uint32_t>(scene_.meshes.size() - 1);
}

uint32_t SceneBuilder::sphere_mesh(const std::string& name, std::vector<SphereSet> sets) {
  scene_.meshes.push_back({name, {}, std::move(sets)});
  return static_cast<uint32_t>(scene_.meshes.size() - 1);
}

void SceneBuilder::instance(uint32_t mesh, const Transform3x4& transform, const std::string& name) {
  scene_.instances.push_back({mesh, transform, name, name});
}

void SceneBuilder::camera(const std::string& name, SceneCamera camera) {
  camera.name = name;
  scene_.cameras.push_back(std::move(camera));
}

Material matte(const std::string& name, glm::vec3 color) {
  Material material;
  material.name = name;
  material.base_color = glm::vec4(color, 1.0f);
  material.metallic = 0;
  material.roughness = 1;
  return material;
}

Material metal(const std::string& name, glm::vec3 color, float roughness) {
  Material material = matte(name, color);
  material.metallic = 1;
  material.roughness = roughness;
  return material;
}

Material glossy(const std::string& name, glm::vec3 color, float roughness) {
  Material material = matte(name, color);
  material.roughness = roughness;
  return material;
}

TextureRef texture_ref(uint32_t texture) {
  TextureRef ref;
  ref.texture = texture;
  return ref;
}

Transform3x4 placed(glm::vec3 position, float degrees_about_y, glm::vec3 scale) {
  const auto [s, c] = det::sincos(static_cast<double>(degrees_about_y) * (3.14159265358979323846 / 180));
  const auto sine = static_cast<float>(s), cosine = static_cast<float>(c);
  return {cosine * scale.x, 0, sine * scale.z,   position.x, 0, scale.y, 0, position.y,
          -sine * scale.x,  0, cosine * scale.z, position.z};
}

}  // namespace rayloom::scenes
