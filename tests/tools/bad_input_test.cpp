// Bad scenes and bad outputs: exit code 3, a message that names file, object and rule, and no file left behind.

#include "run_command.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

using namespace rayloom::tools;
using Json = nlohmann::json;

namespace {

/// Three vertices and three 16-bit indices, as the buffer of triangle_document() lays them out (42 bytes).
std::string triangle_bytes(float first_coordinate, uint16_t last_index) {
  const float positions[9] = {first_coordinate, 0, 0, 1, 0, 0, 0, 1, 0};
  const uint16_t indices[3] = {0, 1, last_index};
  std::string bytes(42, '\0');
  std::memcpy(bytes.data(), positions, 36);
  std::memcpy(bytes.data() + 36, indices, 6);
  return bytes;
}

/// A good glTF of one triangle with its buffer in "triangle.bin".
Json triangle_document() {
  return Json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}, {}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
      {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
    "buffers": [{"uri": "triangle.bin", "byteLength": 42}]})");
}

struct BadScene {
  const char* name;
  const char* change;  ///< merged into the good document (RFC 7396)
  std::string bytes;
  const char* message;  ///< besides the file's name
};

std::vector<BadScene> bad_scenes() {
  const std::string good = triangle_bytes(0, 2);
  return {
      {"index out of range", "{}", triangle_bytes(0, 3), "primitives[0]"},
      {"NaN position", "{}", triangle_bytes(std::numeric_limits<float>::quiet_NaN(), 2), "POSITION"},
      {"infinite position", "{}", triangle_bytes(std::numeric_limits<float>::infinity(), 2), "POSITION"},
      {"cyclic nodes", R"({"nodes": [{"mesh": 0, "children": [1]}, {"children": [0]}]})", good, "nodes["},
      {"node its own child", R"({"nodes": [{"mesh": 0, "children": [0]}]})", good, "nodes["},
      {"required extension",
       R"({"extensionsRequired": ["KHR_draco_mesh_compression"], "extensionsUsed": ["KHR_draco_mesh_compression"]})",
       good, "KHR_draco_mesh_compression"},
      {"missing buffer", R"({"buffers": [{"uri": "gone.bin", "byteLength": 42}]})", good, "gone.bin"},
      {"short buffer", "{}", good.substr(0, 41), "buffer"},
      {"view past the buffer", R"({"buffers": [{"uri": "triangle.bin", "byteLength": 40}]})", good, "bufferView"},
      {"no such mesh", R"({"nodes": [{"mesh": 7}]})", good, "nodes[0]"},
      {"no such scene", R"({"scene": 3})", good, "scene"},
      {"empty scene", R"({"scenes": [{}]})", good, ""},
      {"glTF 1", R"({"asset": {"version": "1.0"}})", good, "version"},
  };
}

/// What render owes for a bad scene.
void check_refused(const Scratch& scratch, const std::string& scene, const std::string& message) {
  const std::string before = scratch.listing();
  const Outcome outcome = scratch.rayloom({"render", scene, "-o", "a.exr", "--size", "8x8", "--spp", "1"});
  CHECK(outcome.exit_code == 3);
  CHECK(outcome.out.empty());
  CHECK_THAT(outcome.err, Catch::StartsWith("rayloom: ") && Catch::Contains(scene) && Catch::Contains(message));
  CHECK(scratch.listing() == before);
}

}  // namespace

TEST_CASE("The good document, which every bad one differs from in one thing, renders") {
  const Scratch scratch;
  scratch.write("triangle.bin", triangle_bytes(0, 2));
  scratch.write("good.gltf", triangle_document().dump());
  CHECK(scratch.rayloom({"render", "good.gltf", "-o", "a.exr", "--size", "8x8", "--spp", "1"}).exit_code == 0);
  CHECK(scratch.listing() == "a.exr\ngood.gltf\ntriangle.bin\n");
}

TEST_CASE("A scene that breaks a rule is refused with file, object and rule") {
  for (const BadScene& bad : bad_scenes()) {
    CAPTURE(bad.name);
    const Scratch scratch;
    Json document = triangle_document();
    document.merge_patch(Json::parse(bad.change));
    scratch.write("bad.gltf", document.dump());
    scratch.write("triangle.bin", bad.bytes);
    check_refused(scratch, "bad.gltf", bad.message);
  }
}

TEST_CASE("Files that are no scenes are refused") {
  const Scratch scratch;
  const std::string document = triangle_document().dump();
  scratch.write("triangle.bin", triangle_bytes(0, 2));
  scratch.write("cut.gltf", document.substr(0, document.size() / 2));
  scratch.write("empty.gltf", "");
  scratch.write("noise.gltf", std::string(1000, '\x7f'));
  scratch.write("cut.glb", std::string("glTF\2\0\0\0\377\377\0\0", 12));
  scratch.write("header.glb", "glTF");
  std::filesystem::create_directory(scratch.path() / "folder.gltf");
  for (const char* scene : {"missing.gltf", "cut.gltf", "empty.gltf", "noise.gltf", "cut.glb", "header.glb",
                            "folder.gltf", "nosuchscene"}) {
    CAPTURE(scene);
    check_refused(scratch, scene, "");
  }
}

TEST_CASE("Every subcommand that takes a scene refuses a bad one") {
  const Scratch scratch;
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"simulate", "missing.gltf", "-o", "out"}, {"bvh", "missing.gltf"}, {"scene", "missing.gltf", "--json"}}) {
    CAPTURE(arguments.front());
    const Outcome outcome = scratch.rayloom(arguments);
    CHECK(outcome.exit_code == 3);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, Catch::Contains("missing.gltf"));
  }
  CHECK(scratch.listing().empty());
}

TEST_CASE("An output that cannot be written is refused before the work, and nothing is left") {
  const Scratch scratch;
  std::filesystem::create_directory(scratch.path() / "folder.exr");
  scratch.write("file", "");
  const std::string before = scratch.listing();
  for (const char* output : {"none/a.exr", "none/a.png", "folder.exr", "file/a.exr"}) {
    CAPTURE(output);
    const Outcome outcome =
        scratch.rayloom({"render", "cornell", "-o", output, "--size", "60000x4000", "--spp", "60000"});
    CHECK(outcome.exit_code == 3);
    CHECK_THAT(outcome.err, Catch::Contains(output));
  }
  CHECK(scratch.rayloom({"simulate", "cornell", "-o", "file/dir", "--size", "4x4"}).exit_code == 3);
  CHECK(scratch.rayloom({"simulate", "cornell", "-o", "file", "--size", "4x4"}).exit_code == 3);
  CHECK(scratch.rayloom({"scene", "cornell", "--json=none/a.json"}).exit_code == 3);
  CHECK(scratch.listing() == before);
}

TEST_CASE("A full disk is exit code 3 and leaves nothing half-written") {
  const Scratch scratch;
  RunOptions full;
  full.file_size_limit = 1000;
  for (const char* output : {"a.exr", "a.png"}) {
    CAPTURE(output);
    const Outcome outcome = scratch.rayloom({"render", "cornell", "-o", output, "--size", "64x64", "--spp", "1"}, full);
    CHECK(outcome.exit_code == 3);
    CHECK_THAT(outcome.err, Catch::Contains(output));
  }
  CHECK(scratch.rayloom({"simulate", "cornell", "-o", "out", "--size", "32x32", "--spp", "1"}, full).exit_code == 3);
  CHECK(scratch.listing().empty());
}

TEST_CASE("A full standard output is an error, not a silent loss") {
  const Scratch scratch;
  RunOptions full;
  full.stdout_to = "/dev/full";
  CHECK(scratch.rayloom({"scene", "cornell"}, full).exit_code == 3);
  CHECK(scratch.rayloom({"scene", "cornell", "--json"}, full).exit_code == 3);
}
