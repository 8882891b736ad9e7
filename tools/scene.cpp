// rayloom scene SCENE: what a scene holds, without building or decoding anything.

#include <rayloom/base/error.h>
#include <rayloom/scenes/procedural/registry.h>
#include <rayloom/scenes/summary.h>
#include <rayloom/tools/cli.h>
#include <rayloom/tools/report.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace rayloom::tools {
namespace {

constexpr const char* examples =
    "  rayloom scene house.glb              counts, bounds, cameras, materials, warnings\n"
    "  rayloom scene atrium --json          the same as JSON\n"
    "  rayloom scene terrain:resolution=500  a procedural scene with a parameter\n";

Json to_json(glm::vec3 v) { return {v.x, v.y, v.z}; }

Json to_json(const scenes::Bounds& bounds) {
  if (bounds.empty()) return nullptr;
  return {{"min", to_json(bounds.min)}, {"max", to_json(bounds.max)}};
}

const char* name_of(scenes::AlphaMode mode) {
  switch (mode) {
    case scenes::AlphaMode::opaque:
      return "opaque";
    case scenes::AlphaMode::mask:
      return "mask";
    default:
      return "blend";
  }
}

const char* name_of(scenes::Light::Kind kind) {
  switch (kind) {
    case scenes::Light::Kind::point:
      return "point";
    case scenes::Light::Kind::spot:
      return "spot";
    default:
      return "directional";
  }
}

const char* name_of(scenes::SceneCamera::Kind kind) {
  return kind == scenes::SceneCamera::Kind::perspective ? "perspective" : "orthographic";
}

Json counts_to_json(const scenes::SceneSummary& summary) {
  return {{"meshes", summary.meshes},
          {"geometries", summary.geometries},
          {"instances", summary.instances},
          {"triangles", summary.triangles},
          {"instanced_triangles", summary.instanced_triangles},
          {"spheres", summary.spheres},
          {"instanced_spheres", summary.instanced_spheres},
          {"vertices", summary.vertices},
          {"materials", summary.materials},
          {"masked_materials", summary.masked_materials},
          {"blended_materials", summary.blended_materials},
          {"emissive_materials", summary.emissive_materials},
          {"textures", summary.textures},
          {"images", summary.images},
          {"point_lights", summary.point_lights},
          {"spot_lights", summary.spot_lights},
          {"directional_lights", summary.directional_lights},
          {"perspective_cameras", summary.perspective_cameras},
          {"orthographic_cameras", summary.orthographic_cameras},
          {"geometry_bytes", summary.geometry_bytes},
          {"image_bytes", summary.image_bytes}};
}

Json to_json(const scenes::SceneCamera& camera) {
  Json json{{"name", camera.name},
            {"kind", name_of(camera.kind)},
            {"position", to_json(camera.position)},
            {"forward", to_json(-camera.backward)},
            {"up", to_json(camera.up)}};
  if (camera.kind == scenes::SceneCamera::Kind::perspective) {
    json["yfov_radians"] = camera.yfov;
  } else {
    json["ymag_metres"] = camera.ymag;
  }
  return json;
}

Json to_json(const scenes::Material& material) {
  return {{"name", material.name},
          {"base_color", {material.base_color.r, material.base_color.g, material.base_color.b, material.base_color.a}},
          {"metallic", material.metallic},
          {"roughness", material.roughness},
          {"emissive", to_json(material.emissive)},
          {"alpha_mode", name_of(material.alpha_mode)},
          {"double_sided", material.double_sided},
          {"base_color_texture", material.base_color_texture.exists()},
          {"metallic_roughness_texture", material.metallic_roughness_texture.exists()},
          {"normal_texture", material.normal_texture.exists()},
          {"occlusion_texture", material.occlusion_texture.exists()},
          {"emissive_texture", material.emissive_texture.exists()}};
}

Json to_json(const scenes::Light& light) {
  return {{"name", light.name},
          {"kind", name_of(light.kind)},
          {"position", to_json(light.position)},
          {"direction", to_json(light.direction)},
          {"intensity", to_json(light.intensity)}};
}

template <class Items>
Json list_to_json(const Items& items) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(to_json(item));
  return list;
}

std::string or_unnamed(const std::string& name) { return name.empty() ? "(unnamed)" : name; }

std::string details_text(const scenes::Scene& scene, const scenes::SceneSummary& summary) {
  std::string text;
  const scenes::Bounds& b = summary.bounds;
  text += b.empty() ? "bounds: empty\n"
                    : fmt::format("bounds: ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", b.min.x, b.min.y,
                                  b.min.z, b.max.x, b.max.y, b.max.z);
  for (size_t i = 0; i < scene.cameras.size(); ++i) {
    const scenes::SceneCamera& camera = scene.cameras[i];
    text += fmt::format("camera {}: {}, {}\n", i, or_unnamed(camera.name), name_of(camera.kind));
  }
  for (const scenes::Material& material : scene.materials) {
    text += fmt::format("material: {}, {}{}{}\n", or_unnamed(material.name), name_of(material.alpha_mode),
                        material.double_sided ? ", double-sided" : "", material.emits() ? ", emissive" : "");
  }
  for (const scenes::Light& light : scene.lights) {
    text += fmt::format("light: {}, {}\n", or_unnamed(light.name), name_of(light.kind));
  }
  if (!summary.extensions_used.empty())
    text += fmt::format("extensions: {}\n", fmt::join(summary.extensions_used, " "));
  for (const std::string& warning : summary.warnings) text += "warning: " + warning + "\n";
  return text;
}

std::string to_text(const scenes::Scene& scene, const scenes::SceneSummary& summary) {
  std::vector<std::vector<std::string>> rows{{"scene", summary.name}};
  const Json counts = counts_to_json(summary);
  for (const auto& [key, value] : counts.items()) {
    if (value != 0) rows.push_back({key, with_commas(value.get<uint64_t>())});
  }
  return format_table(rows) + details_text(scene, summary);
}

int run_scene(const std::string& name, const CommonOptions& common) {
  check_json_output(common);
  const scenes::Scene scene = scenes::load_scene(name);
  const scenes::SceneSummary summary = scenes::summarize(scene);
  Json report = new_report("scene");
  report["scene"] = summary.name;
  report["counts"] = counts_to_json(summary);
  report["bounds"] = to_json(summary.bounds);
  report["cameras"] = list_to_json(scene.cameras);
  report["materials"] = list_to_json(scene.materials);
  report["lights"] = list_to_json(scene.lights);
  report["extensions_used"] = summary.extensions_used;
  report["warnings"] = summary.warnings;
  print_report(common, report, to_text(scene, summary));
  return exit_ok;
}

}  // namespace

void add_scene_command(CLI::App& app, CommonOptions& common, Action& action) {
  const auto scene = std::make_shared<std::string>();
  CLI::App* sub = add_subcommand(
      app, "scene",
      "Say what a scene holds: counts, bounds, cameras, materials, lights, and what the importer skipped.",
      examples + ("\nProcedural scenes, as name or name:key=value,key=value:\n" + scenes::procedural_scene_help()),
      common);
  sub->add_option("SCENE", *scene, "A glTF file or a procedural scene")->required();
  sub->callback([=, &common, &action] { action = [=, &common] { return run_scene(*scene, common); }; });
}

}  // namespace rayloom::tools
