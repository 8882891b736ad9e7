#include <rayloom/base/error.h>
#include <rayloom/shaders/environment.h>
#include <rayloom/shaders/lights.h>
#include <rayloom/shaders/scene_to_device.h>
#include <rayloom/shaders/sphere.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rayloom::shaders {
namespace {

constexpr uint64_t block_alignment = 64;  // vertex arrays start on their own cache lines

template <class T>
uint64_t block_bytes(const std::vector<T>& data) {
  return (data.size() * sizeof(T) + block_alignment - 1) / block_alignment * block_alignment;
}

bool uses_uv_set(const scenes::Material& m, uint32_t set) {
  const auto uses = [&](const scenes::TextureRef& ref) { return ref.exists() && ref.uv_set == set; };
  return uses(m.base_color_texture) || uses(m.metallic_roughness_texture) || uses(m.normal_texture) ||
         uses(m.occlusion_texture) || uses(m.emissive_texture);
}

/// Whether some hit may not count: a constant coverage that always counts needs no any-hit shader.
bool alpha_tested(const scenes::Material& material, const scenes::Geometry& geometry) {
  if (material.alpha_mode == scenes::AlphaMode::opaque) return false;
  if (material.base_color_texture.exists() || !geometry.colors.empty()) return true;
  return material.base_color.w < (material.alpha_mode == scenes::AlphaMode::mask ? material.alpha_cutoff : 1.0f);
}

/// A uv set is kept where a texture reads it, and the first one also for the uv view.
bool keeps_uv1(const scenes::Material& material, const scenes::Geometry& geometry) {
  return !geometry.uv1.empty() && uses_uv_set(material, 1);
}
bool keeps_tangents(const scenes::Material& material, const scenes::Geometry& geometry) {
  return !geometry.tangents.empty() && material.normal_texture.exists();
}

MaterialCore make_core(const scenes::Material& m) {
  MaterialCore core;
  core.base_color = m.base_color;
  core.emissive = m.emissive;
  core.metallic = m.metallic;
  core.roughness = m.roughness;
  core.normal_scale = m.normal_scale;
  core.alpha_cutoff = m.alpha_cutoff;
  const auto slot = [](const scenes::TextureRef& ref, TextureSlot s) {
    return ref.exists() ? material_flag::first_texture << static_cast<uint32_t>(s) : 0u;
  };
  core.flags = slot(m.base_color_texture, TextureSlot::base_color) |
               slot(m.metallic_roughness_texture, TextureSlot::metallic_roughness) |
               slot(m.normal_texture, TextureSlot::normal) | slot(m.occlusion_texture, TextureSlot::occlusion) |
               slot(m.emissive_texture, TextureSlot::emissive) | (m.double_sided ? material_flag::double_sided : 0u) |
               (m.alpha_mode == scenes::AlphaMode::mask ? material_flag::mask : 0u) |
               (m.alpha_mode == scenes::AlphaMode::blend ? material_flag::blend : 0u);
  return core;
}

RAYTRACING_GEOMETRY_DESC describe_triangles(const TriangleRecord& record, bool opaque) {
  RAYTRACING_GEOMETRY_DESC desc;
  desc.Type = RAYTRACING_GEOMETRY_TYPE_TRIANGLES;
  desc.Flags = opaque ? RAYTRACING_GEOMETRY_FLAG_OPAQUE : RAYTRACING_GEOMETRY_FLAG_NONE;
  desc.Triangles = {0,
                    FORMAT_R32_UINT,
                    FORMAT_R32G32B32_FLOAT,
                    record.index_count,
                    record.vertex_count,
                    record.indices,
                    {record.positions, sizeof(float3)}};
  return desc;
}

RAYTRACING_GEOMETRY_DESC describe_boxes(uint64_t address, uint64_t count) {
  RAYTRACING_GEOMETRY_DESC desc;
  desc.Type = RAYTRACING_GEOMETRY_TYPE_PROCEDURAL_PRIMITIVE_AABBS;
  desc.Flags = RAYTRACING_GEOMETRY_FLAG_OPAQUE;
  desc.AABBs = {count, {address, sizeof(RAYTRACING_AABB)}};
  return desc;
}

float bounding_radius(const scenes::Scene& scene) {
  const scenes::Bounds bounds = scenes::world_bounds(scene);
  const float radius = bounds.empty() ? 1.0f : 0.5f * glm::length(bounds.max - bounds.min);
  return radius > 0 && radius < INFINITY ? radius : 1.0f;
}

}  // namespace

DeviceScene::DeviceScene(Device& device, const scenes::Scene& scene, const SceneUploadOptions& options)
    : device_(device), scene_(scene), textures_(scene), radius_(bounding_radius(scene)) {
  upload_materials();
  upload_geometry();
  build_bottom_levels();
  build_top_level_structure(options.build_flags);
  if (!options.lights) return;
  upload_lights();
  upload_environment(options.environment ? *options.environment : scene.environment);
}

template <class T>
StructuredBuffer<T> DeviceScene::upload(const std::vector<T>& data) {
  if (data.empty()) return {};
  buffers_.push_back(device_.upload(data));
  return {buffers_.back().address(), data.size()};
}

void DeviceScene::upload_materials() {
  std::vector<MaterialCore> cores;
  std::vector<scenes::TextureRef> refs;
  bool textured = false;
  for (const scenes::Material& m : scene_.materials) {
    cores.push_back(make_core(m));
    refs.insert(refs.end(), {m.base_color_texture, m.metallic_roughness_texture, m.normal_texture, m.occlusion_texture,
                             m.emissive_texture});
    textured = textured || cores.back().flags >= material_flag::first_texture;
  }
  view_.materials.cores = upload(cores);
  if (textured) view_.materials.texture_refs = upload(refs);
  view_.materials.textures = &textures_;
}

/// Copies every vertex array into one block of device memory.
void DeviceScene::upload_geometry() {
  uint64_t bytes = 0;
  for (const scenes::Mesh& mesh : scene_.meshes) {
    for (const scenes::Geometry& g : mesh.geometries) {
      const scenes::Material& m = scene_.materials.at(g.material);
      bytes += block_bytes(g.positions) + block_bytes(g.indices) + block_bytes(g.normals) + block_bytes(g.uv0) +
               block_bytes(g.colors) + (keeps_uv1(m, g) ? block_bytes(g.uv1) : 0) +
               (keeps_tangents(m, g) ? block_bytes(g.tangents) : 0);
    }
    for (const scenes::SphereSet& s : mesh.sphere_sets)
      bytes += block_bytes(s.spheres) + block_bytes(std::vector<RAYTRACING_AABB>(s.spheres.size()));
  }
  geometry_ = device_.create_buffer(bytes);
  report_.geometry_bytes = bytes;
  for (const scenes::Mesh& mesh : scene_.meshes) {
    first_record_.push_back(static_cast<uint32_t>(records_.size()));
    for (const scenes::Geometry& g : mesh.geometries) {
      const bool masked = alpha_tested(scene_.materials.at(g.material), g);
      const HitKind kind = masked ? HitKind::masked_triangles : HitKind::opaque_triangles;
      records_.push_back({kind, upload_triangles(g), {}});
      geometry_descs_.push_back(describe_triangles(records_.back().triangles, !masked));
      has_[static_cast<size_t>(kind)] = true;
    }
    for (const scenes::SphereSet& s : mesh.sphere_sets) {
      records_.push_back({HitKind::spheres, {}, upload_spheres(s)});
      has_[static_cast<size_t>(HitKind::spheres)] = true;
    }
  }
  view_.ray_types = has(HitKind::masked_triangles) || has(HitKind::spheres) ? 2 : 1;
}

template <class T>
static uint64_t place(const Buffer& block, uint64_t& used, const std::vector<T>& data) {
  if (data.empty()) return 0;
  block.upload(std::span<const T>(data), used);
  const uint64_t address = block.address() + used;
  used += block_bytes(data);
  return address;
}

TriangleRecord DeviceScene::upload_triangles(const scenes::Geometry& g) {
  const scenes::Material& m = scene_.materials.at(g.material);
  TriangleRecord record;
  record.positions = place(geometry_, geometry_used_, g.positions);
  record.indices = place(geometry_, geometry_used_, g.indices);
  record.normals = place(geometry_, geometry_used_, g.normals);
  record.uv0 = place(geometry_, geometry_used_, g.uv0);
  record.colors = place(geometry_, geometry_used_, g.colors);
  if (keeps_uv1(m, g)) record.uv1 = place(geometry_, geometry_used_, g.uv1);
  if (keeps_tangents(m, g)) record.tangents = place(geometry_, geometry_used_, g.tangents);
  record.vertex_count = static_cast<uint32_t>(g.positions.size());
  record.index_count = static_cast<uint32_t>(g.indices.size());
  record.material = g.material;
  report_.triangles += g.triangle_count();
  return record;
}

SphereRecord DeviceScene::upload_spheres(const scenes::SphereSet& set) {
  SphereRecord record;
  record.spheres = {place(geometry_, geometry_used_, set.spheres), set.spheres.size()};
  record.material = set.material;
  std::vector<RAYTRACING_AABB> boxes;
  for (const scenes::Sphere& sphere : set.spheres) boxes.push_back(sphere_box(sphere));
  geometry_descs_.push_back(describe_boxes(place(geometry_, geometry_used_, boxes), boxes.size()));
  report_.spheres += set.spheres.size();
  return record;
}

void DeviceScene::build_bottom_levels() {
  for (size_t mesh = 0; mesh < scene_.meshes.size(); ++mesh) {
    const size_t first = first_record_[mesh];
    const size_t end = mesh + 1 < first_record_.size() ? first_record_[mesh + 1] : records_.size();
    bottom_levels_.push_back(build_bottom_level(device_, std::span(geometry_descs_).subspan(first, end - first)));
    report_.structure_bytes += bottom_levels_.back().bytes();
  }
  report_.bottom_levels = bottom_levels_.size();
}

void DeviceScene::build_top_level_structure(RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS flags) {
  if (records_.size() * view_.ray_types > (1u << 24))
    throw InputError(scene_.name, "geometries", "there are more than DXR's 24-bit hit group offsets can address");
  std::vector<RAYTRACING_INSTANCE_DESC> descs;
  for (const scenes::Instance& source : scene_.instances) {
    RAYTRACING_INSTANCE_DESC desc = instance(bottom_levels_.at(source.mesh));
    std::memcpy(desc.Transform, source.transform.data(), sizeof(desc.Transform));
    desc.InstanceID = static_cast<uint32_t>(descs.size()) & 0xFFFFFFu;
    desc.InstanceContributionToHitGroupIndex = (first_record_[source.mesh] * view_.ray_types) & 0xFFFFFFu;
    descs.push_back(desc);
  }
  top_level_ = build_top_level(device_, descs, flags);
  view_.structure = top_level_.view();
  report_.instances = descs.size();
  report_.structure_bytes += top_level_.bytes();
}

void DeviceScene::upload_lights() {
  const LightTables tables = make_light_tables(scene_, radius_);
  LightView& lights = view_.lights;
  report_.emissive_triangles = tables.triangles.size();
  report_.punctual_lights = tables.punctual.size();
  if (!tables.triangles.empty()) {
    std::vector<TriangleRecord> geometries;
    std::vector<uint32_t> record_of_geometry;  // flat triangle geometry number -> record
    for (uint32_t i = 0; i < records_.size(); ++i)
      if (records_[i].kind != HitKind::spheres) record_of_geometry.push_back(i);
    for (const uint32_t g : tables.emissive_geometries) geometries.push_back(records_[record_of_geometry[g]].triangles);
    lights.triangles = upload(tables.triangles);
    lights.triangle_table = upload(tables.triangle_table);
    lights.geometries = upload(geometries);
    lights.instance_emitters = upload(tables.instance_emitters);
    lights.geometry_lights = upload(tables.geometry_lights);
  }
  lights.punctual = upload(tables.punctual);
  lights.punctual_table = upload(tables.punctual_table);
}

void DeviceScene::upload_environment(const scenes::Environment& environment) {
  EnvironmentTables tables = make_environment_tables(scene_, environment, report_.bad_environment_pixels);
  view_.environment = {environment.kind,      environment.zenith,   environment.horizon, environment.nadir,
                       upload(tables.texels), upload(tables.table), tables.rows,         tables.columns};
}

ShaderTable DeviceScene::hit_group_table(const StateObject& state_object, const HitGroupNames& names) const {
  ShaderTableBuilder builder(state_object);
  for (const GeometryRecords& record : records_)
    for (uint32_t type = 0; type < view_.ray_types; ++type) {
      const std::string& name = (type == 0 ? names.radiance : names.shadow)[static_cast<size_t>(record.kind)];
      if (name.empty())
        builder.add_null();
      else if (record.kind == HitKind::spheres)
        builder.add(name, record.spheres);
      else
        builder.add(name, record.triangles);
    }
  return builder.build(device_);
}

}  // namespace rayloom::shaders
