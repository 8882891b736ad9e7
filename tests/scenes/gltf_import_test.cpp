// What the loader makes of valid files: every way glTF has of storing geometry, and everything a node can carry.

#include "gltf_asset.h"

#include <rayloom/base/error.h>
#include <rayloom/scenes/gltf/load_gltf.h>
#include <rayloom/scenes/procedural/registry.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::scenes;
using namespace rayloom::scenes::test;

namespace {

Scene load(const Asset& asset) {
  Scene from_glb = load_gltf_bytes(asset.glb(), "test.glb", "");
  Scene from_gltf = load_gltf_bytes(asset.gltf(), "test.gltf", "");
  CHECK(from_glb.meshes[0].geometries[0].positions == from_gltf.meshes[0].geometries[0].positions);
  return from_gltf;
}

Geometry load_geometry(const Asset& asset) { return load(asset).meshes.at(0).geometries.at(0); }

bool warned(const Scene& scene, const std::string& text) {
  for (const std::string& warning : scene.warnings) {
    if (warning.find(text) != std::string::npos) return true;
  }
  return false;
}

const std::vector<glm::vec3> triangle_positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
using Indices = std::vector<uint32_t>;

}  // namespace

TEST_CASE("positions and indices arrive as stored") {
  const Geometry geometry = load_geometry(Asset::triangle());
  CHECK(geometry.positions == triangle_positions);
  CHECK(geometry.indices == Indices{0, 1, 2});
  CHECK(geometry.normals.empty());
}

TEST_CASE("indices of all three sizes, and none") {
  Asset asset = Asset::triangle();
  asset.primitive()["indices"] = asset.add_accessor(std::vector<uint8_t>{2, 0, 1}, gl_ubyte, "SCALAR", 3);
  CHECK(load_geometry(asset).indices == Indices{2, 0, 1});
  asset.primitive()["indices"] = asset.add_accessor(std::vector<uint32_t>{1, 2, 0}, gl_uint, "SCALAR", 3);
  CHECK(load_geometry(asset).indices == Indices{1, 2, 0});
  asset.primitive().erase("indices");
  CHECK(load_geometry(asset).indices == Indices{0, 1, 2});
}

TEST_CASE("strips and fans become lists with glTF's winding") {
  Asset asset = Asset::triangle();
  const std::vector<float> five(15, 1.0f);
  asset.primitive()["attributes"]["POSITION"] = asset.add_accessor(five, gl_float, "VEC3", 5);
  asset.primitive().erase("indices");
  asset.primitive()["mode"] = 5;
  CHECK(load_geometry(asset).indices == Indices{0, 1, 2, 1, 3, 2, 2, 3, 4});
  asset.primitive()["mode"] = 6;
  CHECK(load_geometry(asset).indices == Indices{1, 2, 0, 2, 3, 0, 3, 4, 0});
}

TEST_CASE("points and lines are skipped with a warning") {
  Asset asset = Asset::triangle();
  Json lines = asset.primitive();
  lines["mode"] = 1;
  asset.root["meshes"][0]["primitives"].push_back(lines);
  const Scene scene = load(asset);
  CHECK(scene.meshes[0].geometries.size() == 1);
  CHECK(warned(scene, "meshes[0].primitives[1] is made of points or lines"));
}

TEST_CASE("interleaved attributes are taken apart by their stride") {
  Asset asset = Asset::triangle();
  std::vector<float> both;
  for (const glm::vec3& p : triangle_positions) both.insert(both.end(), {p.x, p.y, p.z, 0, 0, 2, p.x, p.y});
  const int view = asset.add_view(both, 32);
  Json& attributes = asset.primitive()["attributes"];
  attributes["POSITION"] = asset.add_accessor_over(view, gl_float, "VEC3", 3);
  attributes["NORMAL"] = asset.add_accessor_over(view, gl_float, "VEC3", 3);
  attributes["TEXCOORD_0"] = asset.add_accessor_over(view, gl_float, "VEC2", 3);
  asset.root["accessors"][3]["byteOffset"] = 12;
  asset.root["accessors"][4]["byteOffset"] = 24;
  const Geometry geometry = load_geometry(asset);
  CHECK(geometry.positions == triangle_positions);
  CHECK(geometry.normals == std::vector<glm::vec3>(3, {0, 0, 1}));
  CHECK(geometry.uv0 == std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}});
}

TEST_CASE("sparse accessors substitute over a view and over zeros") {
  Asset asset = Asset::triangle();
  const int values = asset.add_view(std::vector<float>{7, 8, 9, 4, 5, 6});
  const int indices = asset.add_view(std::vector<uint8_t>{0, 2});
  const Json sparse = {{"count", 2},
                       {"indices", {{"bufferView", indices}, {"componentType", gl_ubyte}}},
                       {"values", {{"bufferView", values}}}};
  asset.root["accessors"][0]["sparse"] = sparse;
  CHECK(load_geometry(asset).positions == std::vector<glm::vec3>{{7, 8, 9}, {1, 0, 0}, {4, 5, 6}});
  asset.root["accessors"][0].erase("bufferView");
  CHECK(load_geometry(asset).positions == std::vector<glm::vec3>{{7, 8, 9}, {0, 0, 0}, {4, 5, 6}});
}

TEST_CASE("sparse indices without a view") {
  Asset asset = Asset::triangle();
  const int values = asset.add_view(std::vector<uint16_t>{2, 1}), at = asset.add_view(std::vector<uint8_t>{1, 2});
  asset.root["accessors"].push_back({{"componentType", gl_ushort},
                                     {"type", "SCALAR"},
                                     {"count", 3},
                                     {"sparse",
                                      {{"count", 2},
                                       {"indices", {{"bufferView", at}, {"componentType", gl_ubyte}}},
                                       {"values", {{"bufferView", values}}}}}});
  asset.primitive()["indices"] = 2;
  CHECK(load_geometry(asset).indices == Indices{0, 2, 1});
}

TEST_CASE("normalised integers") {
  Asset asset = Asset::triangle();
  Json& attributes = asset.primitive()["attributes"];
  attributes["TEXCOORD_0"] =
      asset.add_accessor(std::vector<uint8_t>{0, 255, 0, 0, 51, 102, 0, 0, 255, 0, 0, 0}, gl_ubyte, "VEC2", 3, true, 4);
  attributes["TEXCOORD_1"] =
      asset.add_accessor(std::vector<uint16_t>{0, 65535, 13107, 0, 0, 0}, gl_ushort, "VEC2", 3, true);
  const Geometry geometry = load_geometry(asset);
  CHECK(geometry.uv0 == std::vector<glm::vec2>{{0, 1}, {51 / 255.0f, 102 / 255.0f}, {1, 0}});
  CHECK(geometry.uv1 == std::vector<glm::vec2>{{0, 1}, {13107 / 65535.0f, 0}, {0, 0}});
}

TEST_CASE("quantised positions and normals need the extension") {
  Asset asset = Asset::triangle();
  Json& attributes = asset.primitive()["attributes"];
  attributes["POSITION"] = asset.add_accessor(std::vector<int16_t>{0, 0, 0, 0, 32767, 0, 0, 0, -32768, 7, 0, 0},
                                              gl_short, "VEC3", 3, true, 8);
  attributes["NORMAL"] =
      asset.add_accessor(std::vector<int8_t>{0, 0, 127, 0, 0, -128, 0, 0, 0, 0, 5, 0}, gl_byte, "VEC3", 3, true, 4);
  asset.root["extensionsUsed"] = {"KHR_mesh_quantization"};
  asset.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  const Geometry geometry = load_geometry(asset);
  CHECK(geometry.positions == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {-1, 7 / 32767.0f, 0}});
  CHECK(geometry.normals == std::vector<glm::vec3>{{0, 0, 1}, {0, -1, 0}, {0, 0, 1}});
}

TEST_CASE("vertex colours of every kind") {
  Asset asset = Asset::triangle();
  Json& color = asset.primitive()["attributes"]["COLOR_0"];
  const std::vector<glm::vec4> red(3, {1, 0, 0, 1});
  color = asset.add_accessor(std::vector<float>{1, 0, 0, 1, 0, 0, 1, 0, 0}, gl_float, "VEC3", 3);
  CHECK(load_geometry(asset).colors == red);
  color =
      asset.add_accessor(std::vector<uint8_t>{255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, gl_ubyte, "VEC3", 3, true, 4);
  CHECK(load_geometry(asset).colors == red);
  color = asset.add_accessor(std::vector<uint16_t>{65535, 0, 0, 65535, 65535, 0, 0, 65535, 65535, 0, 0, 65535},
                             gl_ushort, "VEC4", 3, true);
  CHECK(load_geometry(asset).colors == red);
}

TEST_CASE("normals without a length become the face's") {
  Asset asset = Asset::triangle();
  asset.primitive()["attributes"]["NORMAL"] =
      asset.add_accessor(std::vector<float>{0, 0, 0, 0, 3, 0, 0, 0, 5}, gl_float, "VEC3", 3);
  const Scene scene = load(asset);
  CHECK(scene.meshes[0].geometries[0].normals == std::vector<glm::vec3>{{0, 0, 1}, {0, 1, 0}, {0, 0, 1}});
  CHECK(warned(scene, "normals of length zero"));
}

TEST_CASE("nodes: matrices and TRS compose, shared meshes become instances, mirroring keeps the winding") {
  Asset asset = Asset::triangle();
  asset.root["nodes"] = {{{"name", "root"}, {"translation", {10, 0, 0}}, {"children", {1, 2}}},
                         {{"name", "mirror"},
                          {"mesh", 0},
                          {"scale", {-2, 1, 1}},
                          {"rotation", {0, 0, 0.70710678118654752, 0.70710678118654752}}},
                         {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1}}}};
  const Scene scene = load(asset);
  REQUIRE(scene.meshes.size() == 1);
  REQUIRE(scene.instances.size() == 2);
  CHECK(scene.instances[0].path == "root/mirror");
  CHECK(scene.instances[1].path == "root/#2");
  const Transform3x4 mirror = {0, -1, 0, 10, -2, 0, 0, 0, 0, 0, 1, 0}, stretch = {1, 0, 0, 10, 0, 3, 0, 5, 0, 0, 1, 0};
  for (size_t i = 0; i < 12; ++i) {
    CHECK(scene.instances[0].transform[i] == Approx(mirror[i]).margin(1e-7));
    CHECK(scene.instances[1].transform[i] == stretch[i]);
  }
  CHECK(scene.meshes[0].geometries[0].indices == Indices{0, 1, 2});
}

TEST_CASE("the default scene is shown, else the first, else every root") {
  Asset asset = Asset::triangle();
  asset.root["nodes"] = {{{"mesh", 0}, {"name", "a"}}, {{"mesh", 0}, {"name", "b"}}};
  asset.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  asset.root["scene"] = 1;
  CHECK(load(asset).instances.at(0).name == "b");
  asset.root.erase("scene");
  CHECK(load(asset).instances.at(0).name == "a");
  asset.root.erase("scenes");
  CHECK(load(asset).instances.size() == 2);
}

TEST_CASE("cameras stand where their nodes do") {
  Asset asset = Asset::triangle();
  asset.root["cameras"] = {
      {{"type", "perspective"}, {"name", "eye"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", 2}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 10}}}}};
  asset.root["nodes"].push_back({{"camera", 0}, {"translation", {1, 2, 3}}, {"scale", {4, 4, 4}}});
  asset.root["nodes"].push_back({{"camera", 1}, {"rotation", {0, 1, 0, 0}}});
  asset.root["scenes"][0]["nodes"] = {0, 1, 2};
  const Scene scene = load(asset);
  REQUIRE(scene.cameras.size() == 2);
  CHECK(scene.cameras[0].name == "eye");
  CHECK(scene.cameras[0].position == glm::vec3(1, 2, 3));
  CHECK(scene.cameras[0].right == glm::vec3(1, 0, 0));
  CHECK(scene.cameras[0].yfov == 0.5f);
  CHECK(scene.cameras[0].aspect == 2);
  CHECK(scene.cameras[1].kind == SceneCamera::Kind::orthographic);
  CHECK(scene.cameras[1].ymag == 2);
  CHECK(scene.cameras[1].backward == glm::vec3(0, 0, -1));
}

TEST_CASE("punctual lights in world space") {
  Asset asset = Asset::triangle();
  asset.root["extensionsUsed"] = {"KHR_lights_punctual"};
  asset.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"},
                                                                {"color", {1, 0.5, 0}},
                                                                {"intensity", 8},
                                                                {"range", 9},
                                                                {"spot", {{"outerConeAngle", 1.0471975511965976}}}},
                                                               {{"type", "directional"}}};
  asset.root["nodes"].push_back({{"translation", {0, 5, 0}},
                                 {"rotation", {-0.70710678118654752, 0, 0, 0.70710678118654752}},
                                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  asset.root["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
  asset.root["scenes"][0]["nodes"] = {0, 1, 2};
  const Scene scene = load(asset);
  REQUIRE(scene.lights.size() == 2);
  const Light& spot = scene.lights[0];
  CHECK(spot.kind == Light::Kind::spot);
  CHECK(spot.position == glm::vec3(0, 5, 0));
  CHECK(spot.direction.y == Approx(-1));
  CHECK(spot.intensity == glm::vec3(8, 4, 0));
  CHECK(spot.range == 9);
  CHECK(spot.cos_inner_cone == 1);
  CHECK(spot.cos_outer_cone == Approx(0.5));
  CHECK(scene.lights[1].kind == Light::Kind::directional);
  CHECK(scene.lights[1].direction == glm::vec3(0, 0, -1));
  CHECK(scene.environment.kind == Environment::Kind::none);
}

TEST_CASE("materials with textures, samplers, both uv sets and a texture transform") {
  Asset asset = Asset::triangle();
  asset.root["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
  asset.root["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  asset.root["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 0}}};
  asset.root["materials"] = {
      {{"name", "m"},
       {"doubleSided", true},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.25},
       {"emissiveFactor", {1, 0.5, 0}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}},
       {"normalTexture", {{"index", 0}, {"scale", 0.5}, {"texCoord", 1}}},
       {"occlusionTexture", {{"index", 1}, {"strength", 0.75}}},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
         {"metallicFactor", 0.5},
         {"roughnessFactor", 0.25},
         {"baseColorTexture",
          {{"index", 0},
           {"extensions",
            {{"KHR_texture_transform",
              {{"offset", {0.5, 0}}, {"rotation", 1.5707963267948966}, {"scale", {2, 3}}}}}}}}}}}};
  asset.primitive()["material"] = 0;
  const Scene scene = load(asset);
  const Material& material = scene.materials.at(0);
  CHECK(scene.materials.size() == 2);
  CHECK(scene.meshes[0].geometries[0].material == 0);
  CHECK(material.base_color == glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
  CHECK(material.metallic == 0.5f);
  CHECK(material.roughness == 0.25f);
  CHECK(material.emissive == glm::vec3(4, 2, 0));
  CHECK(material.alpha_mode == AlphaMode::mask);
  CHECK(material.alpha_cutoff == 0.25f);
  CHECK(material.double_sided);
  CHECK(material.normal_texture.uv_set == 1);
  CHECK(material.normal_scale == 0.5f);
  CHECK(material.occlusion_strength == 0.75f);
  CHECK_FALSE(material.emissive_texture.exists());
  // The specification's matrix: translation * rotation * scale, rotation counter-clockwise in (u, -v).
  const glm::vec2 mapped = material.base_color_texture.map({1, 1});
  CHECK(mapped.x == Approx(0.5 + 3));
  CHECK(mapped.y == Approx(-2));
  CHECK(scene.textures[0].wrap_u == Wrap::clamp_to_edge);
  CHECK(scene.textures[0].wrap_v == Wrap::mirrored_repeat);
  CHECK(scene.textures[0].filter == Filter::nearest);
  CHECK(scene.textures[1].wrap_u == Wrap::repeat);
  CHECK(scene.textures[1].filter == Filter::linear);
}

TEST_CASE("a primitive without a material gets glTF's default") {
  const Scene scene = load(Asset::triangle());
  const Material& material = scene.materials.at(scene.meshes[0].geometries[0].material);
  CHECK(material.base_color == glm::vec4(1));
  CHECK(material.metallic == 1);
  CHECK(material.roughness == 1);
  CHECK(scene.environment.kind == Environment::Kind::constant);
  CHECK(warned(scene, "no light"));
}

TEST_CASE("unknown extensions in use are warned of, and a broken texture nobody uses") {
  Asset asset = Asset::triangle();
  asset.root["extensionsUsed"] = {"EXT_unheard_of"};
  asset.root["textures"] = {{{"source", 3}}};
  const Scene scene = load(asset);
  CHECK(warned(scene, "EXT_unheard_of"));
  CHECK(warned(scene, "textures[0].source: index 3 is out of range"));
  CHECK(scene.textures.at(0).image == no_image);
}

TEST_CASE("morph targets stand at the node's weights, else the mesh's") {
  Asset asset = Asset::triangle();
  const int target = asset.add_accessor(std::vector<float>{0, 0, 2, 0, 0, 2, 0, 0, 2}, gl_float, "VEC3", 3);
  asset.primitive()["targets"] = {{{"POSITION", target}}};
  asset.root["meshes"][0]["weights"] = {0.5};
  asset.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"weights", {2}}}, {{"mesh", 0}}};
  asset.root["scenes"][0]["nodes"] = {0, 1, 2};
  const Scene scene = load(asset);
  REQUIRE(scene.meshes.size() == 2);
  CHECK(scene.meshes[0].geometries[0].positions[1] == glm::vec3(1, 0, 1));
  CHECK(scene.meshes[1].geometries[0].positions[1] == glm::vec3(1, 0, 4));
  CHECK(scene.instances[2].mesh == scene.instances[0].mesh);
  CHECK(warned(scene, "meshes[0] has morph targets"));
}

TEST_CASE("a skin moves vertices with its joints and ignores its node's transform") {
  Asset asset = Asset::triangle();
  Json& attributes = asset.primitive()["attributes"];
  attributes["JOINTS_0"] =
      asset.add_accessor(std::vector<uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, gl_ubyte, "VEC4", 3);
  attributes["WEIGHTS_0"] =
      asset.add_accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0}, gl_float, "VEC4", 3);
  std::vector<float> inverse_bind(32, 0.0f);
  for (size_t i = 0; i < 32; i += 16)
    inverse_bind[i] = inverse_bind[i + 5] = inverse_bind[i + 10] = inverse_bind[i + 15] = 1;
  inverse_bind[16 + 12] = -1;
  asset.root["skins"] = {
      {{"joints", {1, 2}}, {"inverseBindMatrices", asset.add_accessor(inverse_bind, gl_float, "MAT4", 2)}}};
  asset.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                         {{"translation", {0, 0, 10}}, {"children", {2}}},
                         {{"translation", {1, 0, 0}}}};
  asset.root["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = load(asset);
  CHECK(scene.instances[0].transform == identity_transform);
  CHECK(scene.meshes[0].geometries[0].positions == std::vector<glm::vec3>{{0, 0, 10}, {1, 0, 10}, {0, 1, 10}});
  CHECK(warned(scene, "skins[0]"));
  asset.root["nodes"][1]["scale"] = {-1, 1, 1};
  const Geometry mirrored = load_geometry(asset);
  CHECK(mirrored.positions[1] == glm::vec3(-1, 0, 10));
  CHECK(mirrored.indices == Indices{0, 2, 1});
}

TEST_CASE("external buffers and images are found beside the file, with escapes in their names") {
  const TemporaryDirectory directory;
  Asset asset = Asset::triangle();
  asset.root["buffers"] = {{{"byteLength", asset.binary.size()}, {"uri", "sub%20dir/data.bin"}}};
  asset.root["images"] = {{{"uri", "picture.png"}}};
  directory.write("sub dir/data.bin", asset.binary);
  const std::string path = directory.write("scene.gltf", as_bytes(asset.root.dump()));
  CHECK_THROWS_WITH(load_gltf(path),
                    Catch::Contains("images[0]: file") && Catch::Contains("picture.png' does not exist"));
  directory.write("picture.png", as_bytes("not a picture"));
  const Scene scene = load_gltf(path);
  CHECK(scene.meshes[0].geometries[0].positions == triangle_positions);
  CHECK_THROWS_AS(scene.images.at(0)->pixels(), InputError);
  CHECK_THROWS_WITH(scene.images.at(0)->pixels(), Catch::Contains("picture.png"));
}

TEST_CASE("load_scene lists the procedural names when a file is missing") {
  CHECK_THROWS_WITH(load_scene("nothing"),
                    "nothing: no such file, and no procedural scene; those are " + procedural_scene_names());
}
