// Writes the seed corpus of the glTF fuzzer into the directory it is given.

#include <scenes/gltf_asset.h>

#include <filesystem>
#include <fstream>
#include <iostream>

using namespace rayloom::scenes::test;

namespace {

Asset with_attributes() {
  Asset asset = Asset::triangle();
  Json& attributes = asset.primitive()["attributes"];
  attributes["NORMAL"] = asset.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, gl_float, "VEC3", 3);
  attributes["TEXCOORD_0"] = asset.add_accessor(std::vector<uint16_t>(6, 9), gl_ushort, "VEC2", 3, true);
  attributes["COLOR_0"] = asset.add_accessor(std::vector<uint8_t>(12, 200), gl_ubyte, "VEC4", 3, true);
  return asset;
}

Asset with_sparse() {
  Asset asset = Asset::triangle();
  const int values = asset.add_view(std::vector<float>{5, 5, 5}), indices = asset.add_view(std::vector<uint8_t>{1});
  asset.root["accessors"][0]["sparse"] = {{"count", 1},
                                          {"indices", {{"bufferView", indices}, {"componentType", gl_ubyte}}},
                                          {"values", {{"bufferView", values}}}};
  asset.primitive()["targets"] = {{{"POSITION", 0}}};
  asset.root["meshes"][0]["weights"] = {0.5};
  return asset;
}

Asset with_nodes() {
  Asset asset = Asset::triangle();
  asset.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  asset.root["extensionsUsed"] = {"KHR_lights_punctual"};
  asset.root["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "spot"}, {"spot", Json::object()}}}}}}};
  asset.root["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}, {"scale", {-1, 2, 1}}},
                         {{"camera", 0}, {"rotation", {0, 0, 0, 1}}},
                         {{"translation", {1, 2, 3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
  return asset;
}

Asset with_materials() {
  Asset asset = Asset::triangle();
  asset.root["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
  asset.root["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
  asset.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
  asset.root["materials"] = {{{"alphaMode", "MASK"}, {"normalTexture", {{"index", 0}, {"scale", 2}}}}};
  asset.primitive()["material"] = 0;
  return asset;
}

Asset with_skin() {
  Asset asset = Asset::triangle();
  Json& attributes = asset.primitive()["attributes"];
  attributes["JOINTS_0"] = asset.add_accessor(std::vector<uint8_t>(12, 0), gl_ubyte, "VEC4", 3);
  attributes["WEIGHTS_0"] = asset.add_accessor(std::vector<float>(12, 0.25f), gl_float, "VEC4", 3);
  asset.root["skins"] = {{{"joints", {0}}}};
  asset.root["nodes"][0]["skin"] = 0;
  return asset;
}

void write(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: gltf_seeds DIRECTORY\n";
    return 2;
  }
  const std::filesystem::path directory = argv[1];
  std::filesystem::create_directories(directory);
  const std::pair<const char*, Asset> seeds[] = {{"triangle", Asset::triangle()}, {"attributes", with_attributes()},
                                                 {"sparse", with_sparse()},       {"nodes", with_nodes()},
                                                 {"materials", with_materials()}, {"skin", with_skin()}};
  for (const auto& [name, asset] : seeds) {
    write(directory / (std::string(name) + ".gltf"), asset.gltf());
    write(directory / (std::string(name) + ".glb"), asset.glb());
  }
}
