#pragma once

// Putting a procedural scene together: materials, textures, meshes, instances by index.

#include <rayloom/scenes/scene.h>

#include <utility>

namespace rayloom::scenes {

class SceneBuilder {
 public:
  uint32_t material(Material material);
  /// `pixels` (sRGB or linear as its use says) as image and texture.
  uint32_t texture(const std::string& name, Pixels pixels, Wrap wrap = Wrap::repeat);
  /// A mesh of one or more geometries.
  uint32_t mesh(const std::string& name, std::vector<Geometry> geometries);
  uint32_t sphere_mesh(const std::string& name, std::vector<SphereSet> sets);
  void instance(uint32_t mesh, const Transform3x4& transform, const std::string& name);
  void camera(const std::string& name, SceneCamera camera);
  Scene& scene() { return scene_; }
  Scene finish() { return std::move(scene_); }

 private:
  Scene scene_;
};

Material matte(const std::string& name, glm::vec3 color);
Material metal(const std::string& name, glm::vec3 color, float roughness);
Material glossy(const std::string& name, glm::vec3 color, float roughness);
TextureRef texture_ref(uint32_t texture);

/// Scale, then turn about y (counter-clockwise seen from above), then move.
Transform3x4 placed(glm::vec3 position, float degrees_about_y = 0, glm::vec3 scale = glm::vec3(1));

}  // namespace rayloom::scenes
