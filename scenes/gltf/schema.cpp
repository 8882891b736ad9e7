#include "schema.h"

#include "checker.h"

#include <rayloom/base/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

namespace rayloom::scenes::gltf {
namespace {

constexpr int max_nesting = 64;
constexpr uint64_t max_size = uint64_t{1} << 53;
constexpr uint64_t max_int = 0x7FFFFFFF;
constexpr double pi = 3.14159265358979323846;

constexpr std::array supported_extensions = {"KHR_lights_punctual", "KHR_materials_emissive_strength",
                                             "KHR_mesh_quantization", "KHR_texture_transform"};

bool is_supported(const std::string& name) {
  return std::find(supported_extensions.begin(), supported_extensions.end(), name) != supported_extensions.end();
}

void check_scene(const Checker& scene) {
  scene.text("name");
  scene.index_list("nodes", "nodes");
}

void check_node(const Checker& node) {
  node.text("name");
  node.index_list("children", "nodes");
  node.index("mesh", "meshes");
  node.index("camera", "cameras");
  node.index("skin", "skins");
  node.numbers("matrix", 16);
  node.numbers("translation", 3);
  node.numbers("rotation", 4, {-1.001, 1.001});
  node.numbers("scale", 3);
  node.numbers("weights", 0);
}

void check_primitive(const Checker& primitive) {
  primitive.object(
      "attributes", [](const Checker& attributes) { attributes.all_indices("accessors"); }, Need::required);
  primitive.index("indices", "accessors");
  primitive.index("material", "materials");
  primitive.one_of("mode", {0, 1, 2, 3, 4, 5, 6});
  primitive.each("targets", [](const Checker& target) { target.all_indices("accessors"); });
}

void check_mesh(const Checker& mesh) {
  mesh.text("name");
  mesh.numbers("weights", 0);
  mesh.each("primitives", check_primitive, Need::required);
}

void check_sparse(const Checker& sparse) {
  sparse.whole("count", 1, max_int, Need::required);
  sparse.object(
      "indices",
      [](const Checker& indices) {
        indices.index("bufferView", "bufferViews", Need::required);
        indices.whole("byteOffset", 0, max_int);
        indices.one_of("componentType", {5121, 5123, 5125}, Need::required);
      },
      Need::required);
  sparse.object(
      "values",
      [](const Checker& values) {
        values.index("bufferView", "bufferViews", Need::required);
        values.whole("byteOffset", 0, max_int);
      },
      Need::required);
}

void check_accessor(const Checker& accessor) {
  accessor.text("name");
  accessor.index("bufferView", "bufferViews");
  accessor.whole("byteOffset", 0, max_size);
  accessor.one_of("componentType", {5120, 5121, 5122, 5123, 5125, 5126}, Need::required);
  accessor.boolean("normalized");
  accessor.whole("count", 1, max_size, Need::required);
  accessor.one_of("type", {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"}, Need::required);
  accessor.object("sparse", check_sparse);
}

void check_buffer_view(const Checker& view) {
  view.index("buffer", "buffers", Need::required);
  view.whole("byteOffset", 0, max_size);
  view.whole("byteLength", 1, max_size, Need::required);
  view.whole("byteStride", 4, 252);
  if (view.has("byteStride") && view.json()["byteStride"].get<int>() % 4 != 0) {
    view.fail(fmt::format("byteStride {} must be a multiple of 4", view.json()["byteStride"].get<int>()));
  }
}

void check_buffer(const Checker& buffer) {
  buffer.text("uri");
  buffer.whole("byteLength", 1, max_size, Need::required);
}

void check_texture_transform(const Checker& transform) {
  transform.numbers("offset", 2);
  transform.number("rotation");
  transform.numbers("scale", 2);
  transform.whole("texCoord", 0, 1);
}

void check_texture_info(const Checker& info) {
  info.index("index", "textures", Need::required);
  info.whole("texCoord", 0, max_int);
  info.number("scale");
  info.number("strength", unit);
  info.object("extensions",
              [](const Checker& extensions) { extensions.object("KHR_texture_transform", check_texture_transform); });
}

void check_metallic_roughness(const Checker& pbr) {
  pbr.numbers("baseColorFactor", 4, unit);
  pbr.number("metallicFactor", unit);
  pbr.number("roughnessFactor", unit);
  pbr.object("baseColorTexture", check_texture_info);
  pbr.object("metallicRoughnessTexture", check_texture_info);
}

void check_material(const Checker& material) {
  material.text("name");
  material.object("pbrMetallicRoughness", check_metallic_roughness);
  material.object("normalTexture", check_texture_info);
  material.object("occlusionTexture", check_texture_info);
  material.object("emissiveTexture", check_texture_info);
  material.numbers("emissiveFactor", 3, not_negative);
  material.one_of("alphaMode", {"OPAQUE", "MASK", "BLEND"});
  material.number("alphaCutoff", not_negative);
  material.boolean("doubleSided");
  material.object("extensions", [](const Checker& extensions) {
    extensions.object("KHR_materials_emissive_strength",
                      [](const Checker& emissive) { emissive.number("emissiveStrength", not_negative); });
  });
}

void check_texture(const Checker& texture) {
  texture.text("name");
  texture.index("sampler", "samplers");
  texture.whole("source", 0, max_int);  // in range only where a material uses it: see texture_ref()
}

void check_image(const Checker& image) {
  image.text("name");
  image.text("uri");
  image.text("mimeType");
  image.index("bufferView", "bufferViews");
  if (image.has("uri") == image.has("bufferView")) image.fail("must have either 'uri' or 'bufferView'");
}

void check_sampler(const Checker& sampler) {
  sampler.one_of("magFilter", {9728, 9729});
  sampler.one_of("minFilter", {9728, 9729, 9984, 9985, 9986, 9987});
  sampler.one_of("wrapS", {33071, 33648, 10497});
  sampler.one_of("wrapT", {33071, 33648, 10497});
}

void check_perspective(const Checker& camera) {
  camera.number("yfov", {0, pi, true}, Need::required);
  camera.number("aspectRatio", positive);
  camera.number("znear", positive, Need::required);
  camera.number("zfar", positive);
}

void check_orthographic(const Checker& camera) {
  for (const char* key : {"xmag", "ymag"}) {
    camera.number(key, any, Need::required);
    if (camera.json()[key].get<double>() == 0) camera.fail(fmt::format("'{}' must not be zero", key));
  }
  camera.number("znear", not_negative, Need::required);
  camera.number("zfar", positive, Need::required);
}

void check_camera(const Checker& camera) {
  camera.text("name");
  camera.one_of("type", {"perspective", "orthographic"}, Need::required);
  const bool perspective = camera.json()["type"] == "perspective";
  camera.object("perspective", check_perspective, perspective ? Need::required : Need::optional);
  camera.object("orthographic", check_orthographic, perspective ? Need::optional : Need::required);
}

void check_skin(const Checker& skin) {
  skin.text("name");
  skin.index_list("joints", "nodes", Need::required);
  skin.index("inverseBindMatrices", "accessors");
  skin.index("skeleton", "nodes");
}

void check_light(const Checker& light) {
  light.text("name");
  light.one_of("type", {"point", "spot", "directional"}, Need::required);
  light.numbers("color", 3, not_negative);
  light.number("intensity", not_negative);
  light.number("range", positive);
  const bool spot = light.json()["type"] == "spot";
  light.object(
      "spot",
      [](const Checker& cone) {
        cone.number("innerConeAngle", {0, pi / 2});
        cone.number("outerConeAngle", {0, pi / 2 + 1e-6, true});
        if (cone.json().value("innerConeAngle", 0.0) > cone.json().value("outerConeAngle", pi / 4)) {
          cone.fail("innerConeAngle must not exceed outerConeAngle");
        }
      },
      spot ? Need::required : Need::optional);
}

void check_lights(const Checker& root) {
  root.object("extensions", [](const Checker& extensions) {
    extensions.object("KHR_lights_punctual", [](const Checker& punctual) { punctual.each("lights", check_light); });
  });
  const size_t lights =
      root.json().value(Json::json_pointer("/extensions/KHR_lights_punctual/lights"), Json::array()).size();
  root.each("nodes", [lights](const Checker& node) {
    node.object("extensions", [lights](const Checker& extensions) {
      extensions.object("KHR_lights_punctual", [lights](const Checker& reference) {
        reference.whole("light", 0, max_int, Need::required);
        const uint64_t light = reference.json()["light"].get<uint64_t>();
        if (light >= lights) {
          reference.fail(fmt::format("light {} is out of range, the file has {} lights", light, lights));
        }
      });
    });
  });
}

void check_asset(const Checker& asset) {
  asset.text("version", Need::required);
  for (const char* key : {"version", "minVersion"}) {
    asset.text(key);
    if (asset.has(key) && !asset.json()[key].get<std::string>().starts_with("2.")) {
      asset.fail(fmt::format("'{}' must be 2.x, it is '{}'", key, asset.json()[key].get<std::string>()));
    }
  }
}

void check_names(const Checker& root, const char* key) {
  const Json* list = root.array(key);
  for (size_t i = 0; list && i < list->size(); ++i) {
    if (!(*list)[i].is_string()) root.fail(fmt::format("{}[{}]", key, i), "must be a string");
  }
}

void prune_value(Json& value) {
  if (value.is_object()) {
    value.erase("extras");
    const auto extensions = value.find("extensions");
    if (extensions != value.end() && extensions->is_object()) {
      for (auto it = extensions->begin(); it != extensions->end();) {
        it = is_supported(it.key()) ? std::next(it) : extensions->erase(it);
      }
    } else if (extensions != value.end()) {
      value.erase(extensions);
    }
  }
  if (value.is_structured()) {
    for (Json& child : value) prune_value(child);
  }
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file) {
  const auto check_depth = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > max_nesting) throw InputError(file, "JSON", fmt::format("nested deeper than {} levels", max_nesting));
    return true;
  };
  try {
    Json root = Json::parse(text.begin(), text.end(), check_depth);
    if (!root.is_object()) throw InputError(file, "JSON", "the root must be an object");
    return root;
  } catch (const Json::exception& error) {
    throw InputError(file, "JSON", error.what());
  }
}

void check_schema(const Json& root, const std::string& file) {
  const Checker checker(file, root);
  checker.object("asset", check_asset, Need::required);
  for (const char* key : {"scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers", "materials", "textures",
                          "images", "samplers", "cameras", "skins", "animations"}) {
    checker.array(key);
  }
  checker.index("scene", "scenes");
  checker.each("scenes", check_scene);
  checker.each("nodes", check_node);
  checker.each("meshes", check_mesh);
  checker.each("accessors", check_accessor);
  checker.each("bufferViews", check_buffer_view);
  checker.each("buffers", check_buffer);
  checker.each("materials", check_material);
  checker.each("textures", check_texture);
  checker.each("images", check_image);
  checker.each("samplers", check_sampler);
  checker.each("cameras", check_camera);
  checker.each("skins", check_skin);
  check_lights(checker);
}

std::vector<std::string> check_extensions(const Json& root, const std::string& file) {
  check_names(Checker(file, root), "extensionsUsed");
  check_names(Checker(file, root), "extensionsRequired");
  std::string missing;
  for (const Json& name : root.value("extensionsRequired", Json::array())) {
    if (!is_supported(name.get<std::string>())) missing += (missing.empty() ? "" : ", ") + name.get<std::string>();
  }
  if (!missing.empty()) throw InputError(file, "extensionsRequired", "not supported: " + missing);
  std::vector<std::string> unsupported;
  for (const Json& name : root.value("extensionsUsed", Json::array())) {
    if (!is_supported(name.get<std::string>())) unsupported.push_back(name.get<std::string>());
  }
  return unsupported;
}

void prune(Json& root) {
  root.erase("animations");
  prune_value(root);
}

}  // namespace rayloom::scenes::gltf
