#pragma once

// A scene as every tracer of a comparison builds it: triangles alone, each mesh one geometry, everything opaque.

#include <rayloom/scenes/scene.h>
#include <rayloom/tools/bench/peer_embree.h>

#include <string>
#include <vector>

namespace rayloom::bench {

struct BenchMesh {
  std::vector<float> vertices;  ///< three a vertex, and slack_floats at the end
  std::vector<uint32_t> indices;

  static constexpr size_t slack_floats = 6;  ///< peers read whole vectors
  uint32_t vertex_count() const { return static_cast<uint32_t>((vertices.size() - slack_floats) / 3); }
  uint32_t triangle_count() const { return static_cast<uint32_t>(indices.size() / 3); }
  PeerMesh peer() const { return {{vertices.data(), size_t{vertex_count()} * 3}, indices}; }
};

struct BenchScene {
  std::string name;
  std::vector<BenchMesh> meshes;
  std::vector<PeerInstance> instances;  ///< empty: one mesh in world space
  scenes::SceneCamera camera;
  scenes::Bounds bounds;

  bool two_level() const { return !instances.empty(); }
  uint64_t stored_triangles() const;
  uint64_t effective_triangles() const;  ///< counting every instance
  PeerScene peer() const;
  /// Corners in world space; the instance index is ignored in a scene of one level.
  std::array<glm::vec3, 3> triangle(uint32_t instance, uint32_t primitive) const;
};

/// Scenes with more triangles than this, counting instances, keep their instances; others become one mesh.
inline constexpr uint64_t flatten_limit = 16'000'000;

/// `name`: a file, a procedural scene, or the name of a file in `directory`, with or without ".glb" or ".gltf".
/// InputError when there is none such, or it has no triangles.
BenchScene load_bench_scene(const std::string& name, const std::string& directory,
                            uint64_t largest_flat = flatten_limit);

/// Whether load_bench_scene would find it.
bool bench_scene_exists(const std::string& name, const std::string& directory);

/// --scenes-dir's default: the environment's RAYLOOM_SHARED_SCENES, or "".
std::string default_scenes_directory();

}  // namespace rayloom::bench
