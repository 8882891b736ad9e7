// Flipped, overwritten and cut bytes of valid files, a fixed sequence of them: the loader either succeeds or throws
// InputError, whatever it is given. The fuzzer in tests/fuzz goes on where this ends.

#include "gltf_asset.h"

#include <rayloom/base/error.h>
#include <rayloom/base/hash.h>
#include <rayloom/scenes/gltf/load_gltf.h>
#include <rayloom/scenes/summary.h>
#include <rayloom/tests/repetitions.h>

#include <catch2/catch.hpp>

using namespace rayloom;
using namespace rayloom::scenes;
using namespace rayloom::scenes::test;

namespace {

/// Everything the loader reads, once.
Asset rich_asset() {
  Asset asset = Asset::triangle();
  Json& attributes = asset.primitive()["attributes"];
  attributes["NORMAL"] = asset.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, gl_float, "VEC3", 3);
  attributes["TANGENT"] = asset.add_accessor(std::vector<float>(12, 1), gl_float, "VEC4", 3);
  attributes["TEXCOORD_0"] = asset.add_accessor(std::vector<uint16_t>(6, 9), gl_ushort, "VEC2", 3, true);
  attributes["COLOR_0"] = asset.add_accessor(std::vector<uint8_t>(12, 200), gl_ubyte, "VEC4", 3, true);
  attributes["JOINTS_0"] = asset.add_accessor(std::vector<uint8_t>(12, 0), gl_ubyte, "VEC4", 3);
  attributes["WEIGHTS_0"] = asset.add_accessor(std::vector<float>(12, 0.25f), gl_float, "VEC4", 3);
  const int values = asset.add_view(std::vector<float>{5, 5, 5}), indices = asset.add_view(std::vector<uint8_t>{1});
  asset.root["accessors"].push_back({{"componentType", gl_float},
                                     {"type", "VEC3"},
                                     {"count", 3},
                                     {"sparse",
                                      {{"count", 1},
                                       {"indices", {{"bufferView", indices}, {"componentType", gl_ubyte}}},
                                       {"values", {{"bufferView", values}}}}}});
  asset.primitive()["targets"] = {{{"POSITION", asset.root["accessors"].size() - 1}}};
  asset.primitive()["material"] = 0;
  asset.root["meshes"][0]["weights"] = {0.5};
  asset.root["images"] = {{{"bufferView", values}, {"mimeType", "image/png"}}};
  asset.root["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
  asset.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
  asset.root["materials"] = {
      {{"alphaMode", "MASK"},
       {"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"rotation", 1}, {"scale", {2, 2}}}}}}}}}}}};
  asset.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  asset.root["skins"] = {{{"joints", {1}}}};
  asset.root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_mesh_quantization"};
  asset.root["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "spot"}, {"spot", Json::object()}}}}}}};
  asset.root["nodes"] = {{{"mesh", 0}, {"skin", 0}},
                         {{"translation", {1, 2, 3}}, {"children", {2}}},
                         {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
  asset.root["scenes"][0]["nodes"] = {0, 1};
  return asset;
}

std::vector<std::byte> mutated(std::vector<std::byte> bytes, uint64_t seed) {
  const auto random = [&](uint64_t what, uint64_t below) { return hash64(seed, what) % below; };
  for (uint64_t change = 0; change < 1 + random(0, 4); ++change) {
    if (bytes.empty()) break;
    const size_t at = random(10 * change + 1, bytes.size());
    const size_t end = std::min(bytes.size(), at + 1 + random(10 * change + 2, 8));
    switch (random(10 * change + 3, 6)) {
      case 0:
        bytes[at] ^= static_cast<std::byte>(1u << random(10 * change + 4, 8));
        break;
      case 1:
        bytes[at] = static_cast<std::byte>(random(10 * change + 4, 256));
        break;
      case 2:
        bytes[at] = static_cast<std::byte>("0123456789-.[]{},\"e"[random(10 * change + 4, 19)]);
        break;
      case 3:
        bytes.erase(bytes.begin() + static_cast<ptrdiff_t>(at), bytes.begin() + static_cast<ptrdiff_t>(end));
        break;
      case 4:
        bytes.insert(bytes.begin() + static_cast<ptrdiff_t>(at),
                     static_cast<std::byte>('0' + random(10 * change + 4, 10)));
        break;
      default:
        if (random(10 * change + 4, 8) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

/// Whether it loaded. Whatever else escapes fails the test, and a crash ends it.
bool survives(const std::vector<std::byte>& bytes) {
  try {
    const Scene scene = load_gltf_bytes(bytes, "mutated", "/nonexistent");
    return summarize(scene).instances > 0;
  } catch (const InputError&) {
    return false;
  }
}

void mutate(const std::vector<std::byte>& good, uint64_t seed) {
  REQUIRE(survives(good));
  int loaded = 0, refused = 0;
  for (int i = 0; i < rayloom::test::repetitions(6000); ++i)
    (survives(mutated(good, hash64(seed, static_cast<uint64_t>(i)))) ? loaded : refused) += 1;
  CHECK(loaded > rayloom::test::repetitions(100));
  CHECK(refused > rayloom::test::repetitions(1000));
}

}  // namespace

TEST_CASE("mutated .gltf files load or are refused") { mutate(rich_asset().gltf(), 1); }
TEST_CASE("mutated .glb files load or are refused") { mutate(rich_asset().glb(), 2); }
