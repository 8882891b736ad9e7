#include "load_gltf.h"

#include "container.h"
#include "importer.h"

#include <rayloom/base/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace rayloom::scenes {
namespace gltf {

void Importer::fail(const std::string& object, const std::string& rule) const {
  throw InputError(document.file, object, rule);
}

void Importer::warn(const std::string& sentence) {
  auto& warnings = scene.warnings;
  if (std::find(warnings.begin(), warnings.end(), sentence) == warnings.end()) warnings.push_back(sentence);
}

namespace {

void warn_of_extensions(Importer& importer) {
  for (const std::string& name : importer.document.unsupported_extensions) {
    importer.warn(fmt::format("extension {} is not supported and is ignored", name));
  }
  if (importer.document.animation_count != 0) importer.warn("animations are ignored: the scene is shown at rest");
}

bool anything_emits(const Scene& scene) {
  const auto emits = [](const Material& material) { return material.emits(); };
  return !scene.lights.empty() || std::any_of(scene.materials.begin(), scene.materials.end(), emits);
}

/// glTF knows no environment: a file without lights would show nothing but black.
void add_default_sky(Importer& importer) {
  if (anything_emits(importer.scene)) return;
  importer.scene.environment.kind = Environment::Kind::constant;
  importer.scene.environment.zenith = glm::vec3(1);
  importer.warn("the file has no light: the scene is lit by a white sky");
}

Scene import_scene(Document document) {
  Importer importer(std::move(document));
  importer.scene.name = importer.document.file;
  importer.scene.extensions_used = importer.model().extensionsUsed;
  warn_of_extensions(importer);
  import_textures(importer);
  import_materials(importer);
  const std::vector<VisitedNode> nodes = visit_nodes(importer);
  import_instances(importer, nodes);
  import_cameras(importer, nodes);
  import_lights(importer, nodes);
  if (importer.scene.instances.empty()) {
    importer.fail(importer.model().scenes.empty() ? "nodes" : "scenes",
                  "the scene is empty: no node of it has a mesh of triangles");
  }
  add_default_sky(importer);
  return std::move(importer.scene);
}

}  // namespace
}  // namespace gltf

Scene load_gltf(const std::string& path) {
  const std::vector<std::byte> bytes = gltf::read_file(path, path, "");
  return load_gltf_bytes(bytes, path, std::filesystem::path(path).parent_path().string());
}

Scene load_gltf_bytes(std::span<const std::byte> bytes, const std::string& name, const std::string& directory) {
  return gltf::import_scene(gltf::read_document(bytes, name, directory));
}

}  // namespace rayloom::scenes
