#pragma once

// What `rayloom scene` prints: counts, bounds, memory, warnings. Nothing is decoded or built for it.

#include <rayloom/scenes/scene.h>

namespace rayloom::scenes {

struct SceneSummary {
  std::string name;
  uint64_t meshes = 0;
  uint64_t geometries = 0;
  uint64_t instances = 0;
  uint64_t triangles = 0;            ///< stored
  uint64_t instanced_triangles = 0;  ///< counted once an instance
  uint64_t spheres = 0;
  uint64_t instanced_spheres = 0;
  uint64_t vertices = 0;
  uint64_t materials = 0;
  uint64_t masked_materials = 0;
  uint64_t blended_materials = 0;
  uint64_t emissive_materials = 0;
  uint64_t textures = 0;
  uint64_t images = 0;
  uint64_t images_decoded = 0;
  uint64_t point_lights = 0;
  uint64_t spot_lights = 0;
  uint64_t directional_lights = 0;
  uint64_t perspective_cameras = 0;
  uint64_t orthographic_cameras = 0;
  uint64_t geometry_bytes = 0;  ///< vertex attributes, indices, spheres
  uint64_t image_bytes = 0;     ///< encoded and decoded
  Bounds bounds;                ///< world space
  std::vector<std::string> extensions_used;
  std::vector<std::string> warnings;
};

SceneSummary summarize(const Scene& scene);

}  // namespace rayloom::scenes
