// Every rule the loader checks, broken one at a time: an InputError must name the file, the object and the rule.

#include "gltf_asset.h"

#include <rayloom/base/error.h>
#include <rayloom/scenes/gltf/load_gltf.h>

#include <catch2/catch.hpp>
#include <functional>
#include <limits>

using namespace rayloom;
using namespace rayloom::scenes;
using namespace rayloom::scenes::test;

namespace {

struct Case {
  const char* object;
  const char* rule;
  std::function<void(Asset&)> break_it;
};

std::string error_of(const std::vector<std::byte>& bytes) {
  try {
    load_gltf_bytes(bytes, "broken.gltf", "/nonexistent");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// Sets the value at a JSON pointer of the triangle asset.
std::function<void(Asset&)> set(const char* pointer, Json value) {
  return [=](Asset& asset) { asset.root[Json::json_pointer(pointer)] = value; };
}

void check(const Case& broken) {
  Asset asset = Asset::triangle();
  broken.break_it(asset);
  for (const auto& bytes : {asset.gltf(), asset.glb()}) {
    const std::string message = error_of(bytes);
    INFO(message);
    CHECK(message.starts_with("broken.gltf: "));
    CHECK_THAT(message, Catch::Contains(broken.object) && Catch::Contains(broken.rule));
  }
}

void add_texture(Asset& asset, int source) {
  asset.root["textures"] = {{{"source", source}}};
  asset.root["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
}

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

const Case cases[] = {
    {"'asset' is missing", "missing", [](Asset& a) { a.root.erase("asset"); }},
    {"asset", "'version' must be 2.x", set("/asset/version", "1.0")},
    {"asset", "'minVersion' must be 2.x", set("/asset/minVersion", "3.0")},
    {"asset", "must be an object", set("/asset", 3)},
    {"extensionsRequired", "not supported: KHR_draco_mesh_compression, EXT_other",
     set("/extensionsRequired", {"KHR_draco_mesh_compression", "KHR_texture_transform", "EXT_other"})},
    {"extensionsUsed[0]", "must be a string", set("/extensionsUsed", {1})},
    {"scene", "index 4 is out of range, the file has 1 scenes", set("/scene", 4)},
    {"scenes", "must be an array", set("/scenes", 4)},
    {"scenes[0].nodes[0]", "index 9 is out of range", set("/scenes/0/nodes", {9})},
    {"scenes[0].nodes[0]", "must be an index into 'nodes'", set("/scenes/0/nodes", {-1})},
    {"nodes[0]", "must be an object", set("/nodes", {7})},
    {"nodes[0].mesh", "index 3 is out of range, the file has 1 meshes", set("/nodes/0/mesh", 3)},
    {"nodes[0].mesh", "must be an index", set("/nodes/0/mesh", 0.5)},
    {"nodes[0].camera", "out of range", set("/nodes/0/camera", 0)},
    {"nodes[0].skin", "out of range", set("/nodes/0/skin", 0)},
    {"nodes[0].children[0]", "out of range", set("/nodes/0/children", {1})},
    {"nodes[0]", "cyclic", set("/nodes/0/children", {0})},
    {"nodes[", "cyclic", set("/nodes", {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}})},
    {"nodes[2]", "several parents: nodes[0] and nodes[1]",
     set("/nodes", {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}})},
    {"scenes[0].nodes[1]", "nodes[1] is no root node",
     [](Asset& a) {
       a.root["nodes"] = {{{"mesh", 0}, {"children", {1}}}, Json::object()};
       a.root["scenes"][0]["nodes"] = {0, 1};
     }},
    {"nodes[0]", "appears twice", set("/scenes/0/nodes", {0, 0})},
    {"nodes[0].matrix", "must have 16 numbers, it has 3", set("/nodes/0/matrix", {1, 2, 3})},
    {"nodes[0].matrix", "last row", set("/nodes/0/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})},
    {"nodes[0].translation[1]", "must be a number", set("/nodes/0/translation", {1, "x", 3})},
    {"nodes[0].rotation", "no length", set("/nodes/0/rotation", {0, 0, 0, 0})},
    {"nodes[0].rotation[3]", "at most 1.001", set("/nodes/0/rotation", {0, 0, 0, 4})},
    {"nodes[0].scale[0]", "too large", set("/nodes/0/scale", {1e300, 1, 1})},
    {"nodes[1]", "not finite",
     [](Asset& a) {
       a.root["nodes"] = {{{"scale", {1e38, 1, 1}}, {"children", {1}}}, {{"scale", {1e38, 1, 1}}, {"mesh", 0}}};
     }},
    {"meshes[0]", "'primitives' is missing", set("/meshes/0", Json::object())},
    {"meshes[0].primitives", "must not be empty", set("/meshes/0/primitives", Json::array())},
    {"meshes[0].primitives[0]", "'attributes' is missing", [](Asset& a) { a.primitive().erase("attributes"); }},
    {"meshes[0].primitives[0].attributes.POSITION", "index 77 is out of range, the file has 2 accessors",
     set("/meshes/0/primitives/0/attributes/POSITION", 77)},
    {"meshes[0].primitives[0].indices", "out of range", set("/meshes/0/primitives/0/indices", 2)},
    {"meshes[0].primitives[0].material", "out of range", set("/meshes/0/primitives/0/material", 0)},
    {"meshes[0].primitives[0].mode", "must be one of 0, 1, 2", set("/meshes/0/primitives/0/mode", 7)},
    {"meshes[0].primitives[0].indices", "index 3 is out of range, the primitive has 3 vertices",
     [](Asset& a) {
       a.primitive()["indices"] = a.add_accessor(std::vector<uint16_t>{0, 1, 3}, gl_ushort, "SCALAR", 3);
     }},
    {"meshes[0].primitives[0].indices", "must be unsigned scalars", set("/meshes/0/primitives/0/indices", 0)},
    {"meshes[0].primitives[0]", "2 vertices are no whole number of triangles",
     [](Asset& a) {
       a.primitive()["indices"] = a.add_accessor(std::vector<uint16_t>{0, 1}, gl_ushort, "SCALAR", 2);
     }},
    {"meshes[0].primitives[0].attributes.POSITION", "wrong type", set("/meshes/0/primitives/0/attributes/POSITION", 1)},
    {"meshes[0].primitives[0].attributes.POSITION", "component type 5122",
     [](Asset& a) {
       a.primitive()["attributes"]["POSITION"] =
           a.add_accessor(std::vector<int16_t>(12), gl_short, "VEC3", 3, false, 8);
     }},
    {"meshes[0].primitives[0].attributes.NORMAL", "accessors[2] has 2 elements, POSITION has 3",
     [](Asset& a) {
       a.primitive()["attributes"]["NORMAL"] = a.add_accessor(std::vector<float>(6), gl_float, "VEC3", 2);
     }},
    {"meshes[0].primitives[0].attributes.POSITION", "accessors[2]: element 1 holds nan",
     [](Asset& a) {
       a.primitive()["attributes"]["POSITION"] =
           a.add_accessor(std::vector<float>{0, 0, 0, 0, nan_value, 0, 1, 1, 1}, gl_float, "VEC3", 3);
     }},
    {"meshes[0].primitives[0].attributes.POSITION", "element 2 holds inf",
     [](Asset& a) {
       a.primitive()["attributes"]["POSITION"] =
           a.add_accessor(std::vector<float>{0, 0, 0, 0, 0, 0, 1, 1, infinity}, gl_float, "VEC3", 3);
     }},
    {"accessors[0].bufferView", "out of range", set("/accessors/0/bufferView", 5)},
    {"accessors[0].componentType", "must be one of 5120", set("/accessors/0/componentType", 5130)},
    {"accessors[0].type", "must be one of SCALAR", set("/accessors/0/type", "VEC5")},
    {"accessors[0].count", "must be at least 1", set("/accessors/0/count", 0)},
    {"accessors[0].count", "not negative", set("/accessors/0/count", -3)},
    {"accessors[0]", "reach beyond the view's 36 bytes", set("/accessors/0/count", 4)},
    {"accessors[0]", "reach beyond the view's 36 bytes", set("/accessors/0/count", uint64_t{1} << 52)},
    {"accessors[0].count", "must be at least 1 and at most", set("/accessors/0/count", uint64_t{1} << 63)},
    {"accessors[0]", "reach beyond", set("/accessors/0/byteOffset", 4)},
    {"accessors[1]", "is not a multiple of the component size 2",
     [](Asset& a) { a.root["accessors"][1]["byteOffset"] = 1, a.root["accessors"][1]["count"] = 2; }},
    {"accessors[0]", "byteStride 8 is less than the element's 12 bytes", set("/bufferViews/0/byteStride", 8)},
    {"accessors[0].sparse", "'count' is missing", set("/accessors/0/sparse", Json::object())},
    {"accessors[0].sparse", "count 9 exceeds the accessor's count 3",
     set("/accessors/0/sparse", {{"count", 9},
                                 {"indices", {{"bufferView", 1}, {"componentType", gl_ushort}}},
                                 {"values", {{"bufferView", 0}}}})},
    {"accessors[0].sparse.indices", "reach beyond",
     set("/accessors/0/sparse", {{"count", 3},
                                 {"indices", {{"bufferView", 1}, {"componentType", gl_uint}}},
                                 {"values", {{"bufferView", 0}}}})},
    {"accessors[0].sparse.indices", "index 8 is out of range, the accessor has 3 elements",
     [](Asset& a) {
       const int view = a.add_view(std::vector<uint16_t>{0, 8});
       a.root["accessors"][0]["sparse"] = {{"count", 2},
                                           {"indices", {{"bufferView", view}, {"componentType", gl_ushort}}},
                                           {"values", {{"bufferView", 0}}}};
     }},
    {"meshes[0].primitives[0].attributes.POSITION", "more memory than a file of",
     [](Asset& a) {
       a.root["accessors"][0].erase("bufferView");
       a.root["accessors"][0]["count"] = 4000000000u;
       a.primitive().erase("indices");
     }},
    {"bufferViews[0].buffer", "index 1 is out of range", set("/bufferViews/0/buffer", 1)},
    {"bufferViews[0]", "reach beyond buffers[0]", set("/bufferViews/0/byteLength", 1000)},
    {"bufferViews[0]", "reach beyond buffers[0]", set("/bufferViews/0/byteOffset", uint64_t{1} << 53)},
    {"bufferViews[0].byteStride", "must be at least 4", set("/bufferViews/0/byteStride", 2)},
    {"bufferViews[0]", "byteStride 14 must be a multiple of 4", set("/bufferViews/0/byteStride", 14)},
    {"buffers[0]", "file '/nonexistent/gone.bin' does not exist",
     set("/buffers", {{{"byteLength", 44}, {"uri", "gone.bin"}}})},
    {"buffers[0]", "must be a relative path", set("/buffers", {{{"byteLength", 44}, {"uri", "/etc/passwd"}}})},
    {"buffers[0]", "must be a relative path", set("/buffers", {{{"byteLength", 44}, {"uri", "http://x/y.bin"}}})},
    {"buffers[0]", "truncated: byteLength says 44 bytes, 3 are there",
     set("/buffers", {{{"byteLength", 44}, {"uri", "data:x/y;base64,AAAA"}}})},
    {"buffers[0]", "character 2 of the data is not base64",
     set("/buffers", {{{"byteLength", 3}, {"uri", "data:x/y;base64,AA*A"}}})},
    {"buffers[0]", "must be base64", set("/buffers", {{{"byteLength", 3}, {"uri", "data:x/y,AAAA"}}})},
    {"buffers[1]", "no GLB binary chunk",
     set("/buffers", {{{"byteLength", 3}, {"uri", "data:x;base64,AAAA"}}, {{"byteLength", 4}}})},
    {"materials[0].pbrMetallicRoughness.metallicFactor", "2 must be at least 0 and at most 1",
     set("/materials", {{{"pbrMetallicRoughness", {{"metallicFactor", 2}}}}})},
    {"materials[0].pbrMetallicRoughness.baseColorFactor", "must have 4 numbers",
     set("/materials", {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1}}}}}})},
    {"materials[0].alphaMode", "must be one of OPAQUE, MASK, BLEND", set("/materials", {{{"alphaMode", "GLASS"}}})},
    {"materials[0].emissiveFactor[2]", "-1 must be at least 0", set("/materials", {{{"emissiveFactor", {0, 0, -1}}}})},
    {"materials[0].normalTexture", "'index' is missing", set("/materials", {{{"normalTexture", Json::object()}}})},
    {"materials[0].normalTexture.index", "out of range, the file has 0 textures",
     set("/materials", {{{"normalTexture", {{"index", 0}}}}})},
    {"materials[0].extensions.KHR_materials_emissive_strength.emissiveStrength", "at least 0",
     set("/materials", {{{"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", -2}}}}}}})},
    {"textures[0].source", "index 0 is out of range, the file has 0 images", [](Asset& a) { add_texture(a, 0); }},
    {"textures[0].sampler", "out of range", set("/textures", {{{"sampler", 0}}})},
    {"images[0]", "file '/nonexistent/gone.png' does not exist", set("/images", {{{"uri", "gone.png"}}})},
    {"images[0]", "either 'uri' or 'bufferView'", set("/images", Json::array({Json::object()}))},
    {"images[0].bufferView", "out of range", set("/images", {{{"bufferView", 9}, {"mimeType", "image/png"}}})},
    {"samplers[0].wrapS", "must be one of", set("/samplers", {{{"wrapS", 1}}})},
    {"samplers[0].magFilter", "must be one of 9728, 9729", set("/samplers", {{{"magFilter", 9984}}})},
    {"cameras[0].perspective.yfov", "must be above 0",
     set("/cameras", {{{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 0.1}}}}})},
    {"cameras[0].perspective.yfov", "at most 3.14",
     set("/cameras", {{{"type", "perspective"}, {"perspective", {{"yfov", 4}, {"znear", 0.1}}}}})},
    {"cameras[0].perspective.aspectRatio", "must be above 0",
     set("/cameras", {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}, {"aspectRatio", -1}}}}})},
    {"cameras[0]", "'orthographic' is missing", set("/cameras", {{{"type", "orthographic"}}})},
    {"cameras[0].orthographic", "'xmag' must not be zero",
     set("/cameras",
         {{{"type", "orthographic"}, {"orthographic", {{"xmag", 0}, {"ymag", 1}, {"znear", 0}, {"zfar", 1}}}}})},
    {"cameras[0].type", "must be one of", set("/cameras", {{{"type", "fisheye"}}})},
    {"skins[0].joints[0]", "out of range", set("/skins", {{{"joints", {5}}}})},
    {"extensions.KHR_lights_punctual.lights[0].type", "must be one of point, spot, directional",
     set("/extensions/KHR_lights_punctual/lights", {{{"type", "area"}}})},
    {"extensions.KHR_lights_punctual.lights[0].intensity", "at least 0",
     set("/extensions/KHR_lights_punctual/lights", {{{"type", "point"}, {"intensity", -1}}})},
    {"nodes[0].extensions.KHR_lights_punctual", "light 0 is out of range, the file has 0 lights",
     set("/nodes/0/extensions/KHR_lights_punctual/light", 0)},
    {"scenes", "the scene is empty", set("/scenes/0/nodes", Json::array())},
    {"scenes", "the scene is empty", set("/nodes/0", Json::object())},
    {"scenes", "the scene is empty", set("/meshes/0/primitives/0/mode", 0)},
};

}  // namespace

TEST_CASE("the unbroken asset loads from both containers") {
  const Asset asset = Asset::triangle();
  CHECK(error_of(asset.gltf()) == "no error");
  CHECK(error_of(asset.glb()) == "no error");
}

TEST_CASE("each broken rule is named with file and object") {
  for (const Case& broken : cases) check(broken);
}

TEST_CASE("JSON errors carry their position") {
  CHECK_THAT(error_of(as_bytes("{\"asset\": \n  {\"version\" \"2.0\"}}")), Catch::Contains("line 2, column 18"));
  CHECK_THAT(error_of({}), Catch::Contains("broken.gltf: JSON: "));
  CHECK_THAT(error_of(as_bytes("[]")), Catch::Contains("the root must be an object"));
  CHECK_THAT(error_of(as_bytes("{\"a\":" + std::string(100, '[') + std::string(100, ']') + "}")),
             Catch::Contains("nested deeper than 64 levels"));
  CHECK_THAT(error_of(as_bytes(std::string(1000000, '['))), Catch::Contains("nested deeper than 64 levels"));
}

TEST_CASE("GLB headers and chunks are checked") {
  const std::vector<std::byte> good = Asset::triangle().glb();
  const auto patched = [&](size_t offset, uint8_t value) {
    std::vector<std::byte> bytes = good;
    bytes[offset] = std::byte{value};
    return error_of(bytes);
  };
  CHECK_THAT(patched(4, 1), Catch::Contains("GLB header: version must be 2, it is 1"));
  CHECK_THAT(patched(11, 1), Catch::Contains("GLB header: truncated"));
  CHECK_THAT(patched(14, 255), Catch::Contains("GLB chunk 0: length"));
  CHECK_THAT(patched(12, 1), Catch::Contains("is not a multiple of 4"));
  CHECK_THAT(patched(16, 0), Catch::Contains("GLB chunk 0: the first chunk must be of type JSON"));
  for (size_t length = 4; length < good.size(); length += 3) {
    CHECK_THAT(error_of({good.begin(), good.begin() + static_cast<ptrdiff_t>(length)}), Catch::Contains("GLB header"));
  }
}

TEST_CASE("a cut .gltf is an error wherever it is cut") {
  const std::vector<std::byte> good = Asset::triangle().gltf();
  for (size_t length = 0; length + 1 < good.size(); length += 7) {
    CHECK_THAT(error_of({good.begin(), good.begin() + static_cast<ptrdiff_t>(length)}),
               Catch::StartsWith("broken.gltf: JSON"));
  }
}

TEST_CASE("node chains deeper than the limit are refused, not recursed into") {
  Asset asset = Asset::triangle();
  Json nodes = Json::array();
  for (int i = 0; i < 50000; ++i) nodes.push_back({{"children", {i + 1}}});
  nodes.push_back({{"mesh", 0}});
  asset.root["nodes"] = nodes;
  CHECK_THAT(error_of(asset.gltf()), Catch::Contains("deeper than 1024 nodes"));
}

TEST_CASE("many primitives over one accessor cannot ask for unbounded memory") {
  Asset asset = Asset::triangle();
  asset.primitive()["attributes"]["POSITION"] = 2;
  asset.root["accessors"].push_back({{"componentType", gl_float}, {"type", "VEC3"}, {"count", 200000}});
  const Json primitive = asset.primitive();
  for (int i = 0; i < 1000; ++i) asset.root["meshes"][0]["primitives"].push_back(primitive);
  CHECK_THAT(error_of(asset.gltf()), Catch::Contains("more memory than a file of"));
}

TEST_CASE("a missing file is named") {
  CHECK_THROWS_WITH(load_gltf("/nonexistent/scene.glb"), "/nonexistent/scene.glb: no such file");
}
