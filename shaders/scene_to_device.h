#pragma once

// A scene in device memory: the one way from scenes::Scene to something rays can hit, for every program and tool.
//
// One bottom-level structure a mesh, one top-level structure, one hit record a geometry and ray type (DXR's index
// formula: ray type + ray_types * geometry + instance contribution). What a scene does not have costs nothing: no
// any-hit records and OPAQUE geometries unless something is masked or blended, no attribute, light, texture or
// environment buffers that nobody would read.

#include <rayloom/runtime/rayloom.h>
#include <rayloom/shaders/scene_view.h>
#include <rayloom/shaders/texture_table.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace rayloom::shaders {

struct SceneUploadOptions {
  /// Light tables and emissive records; programs without light sampling leave them out.
  bool lights = true;
  /// Instead of the scene's own.
  const scenes::Environment* environment = nullptr;
  RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS build_flags = RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAG_NONE;
};

/// How a geometry meets rays, which decides its hit group.
enum class HitKind : uint8_t { opaque_triangles, masked_triangles, spheres };
inline constexpr size_t hit_kinds = 3;

/// Names of a program's hit groups by HitKind, for radiance rays and for shadow rays. An empty name makes a null
/// record.
struct HitGroupNames {
  std::array<std::string, hit_kinds> radiance, shadow;
};

/// Sizes and times of an upload, for reports.
struct SceneUploadReport {
  uint64_t triangles = 0, spheres = 0, instances = 0, bottom_levels = 0;  ///< as built: shared meshes count once
  uint64_t geometry_bytes = 0, structure_bytes = 0;
  uint64_t bad_environment_pixels = 0;  ///< negative or not finite: taken as black
  uint64_t emissive_triangles = 0, punctual_lights = 0;
};

class DeviceScene {
 public:
  /// `device` and `scene` must outlive it. Builds everything; InputError for scenes that break a rule of
  /// scenes/scene.h.
  DeviceScene(Device& device, const scenes::Scene& scene, const SceneUploadOptions& options = {});

  const SceneView& view() const { return view_; }
  const SceneUploadReport& report() const { return report_; }
  const scenes::Scene& scene() const { return scene_; }
  float radius() const { return radius_; }  ///< of a sphere around the world bounds

  /// Which hit kinds occur.
  bool has(HitKind kind) const { return has_[static_cast<size_t>(kind)]; }
  uint32_t ray_types() const { return view_.ray_types; }

  /// The hit group table of a program: every mesh's geometries in order, `ray_types` records each.
  ShaderTable hit_group_table(const StateObject& state_object, const HitGroupNames& names) const;

  const AccelerationStructure& top_level() const { return top_level_; }
  const std::vector<AccelerationStructure>& bottom_levels() const { return bottom_levels_; }  ///< one a mesh

 private:
  struct GeometryRecords {
    HitKind kind;
    TriangleRecord triangles;
    SphereRecord spheres;
  };

  void upload_materials();
  void upload_geometry();
  TriangleRecord upload_triangles(const scenes::Geometry& geometry);
  SphereRecord upload_spheres(const scenes::SphereSet& set);
  void build_bottom_levels();
  void build_top_level_structure(RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS flags);
  void upload_lights();
  void upload_environment(const scenes::Environment& environment);
  template <class T>
  StructuredBuffer<T> upload(const std::vector<T>& data);

  Device& device_;
  const scenes::Scene& scene_;
  TextureTable textures_;
  SceneView view_;
  SceneUploadReport report_;
  float radius_ = 0;
  std::array<bool, hit_kinds> has_{};
  std::vector<GeometryRecords> records_;  // mesh order
  std::vector<uint32_t> first_record_;    // of each mesh
  std::vector<RAYTRACING_GEOMETRY_DESC> geometry_descs_;
  Buffer geometry_;  // all vertex data, one block
  uint64_t geometry_used_ = 0;
  std::vector<Buffer> buffers_;
  std::vector<AccelerationStructure> bottom_levels_;
  AccelerationStructure top_level_;
};

}  // namespace rayloom::shaders
