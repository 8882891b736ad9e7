// Pictures by the command: the same for every way of making them, and what their files say.

#include <rayloom/tools/image_compare.h>
#include <rayloom/tools/image_io.h>

#include "run_command.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace rayloom::tools;

namespace {

/// A small picture of a scene with triangles, any-hit or intersection shaders, with an id channel.
std::vector<std::string> small_picture(const std::string& scene, const std::string& output) {
  return {"render", scene, "-o", output, "--size", "40x24", "--spp", "2", "--aov", "N,Z,id", "-q"};
}

void render(const Scratch& scratch, std::vector<std::string> arguments, const std::vector<std::string>& more = {}) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = scratch.rayloom(arguments);
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
}

}  // namespace

TEST_CASE("Threads, instruction set and mode do not reach the picture: the files are equal byte for byte") {
  const Scratch scratch;
  const std::string scene = GENERATE(as<std::string>(), "cornell", "spheres");
  render(scratch, small_picture(scene, "reference.exr"), {"--threads", "1", "--isa", "scalar"});
  const std::string reference = scratch.read("reference.exr");
  const std::string isas = scratch.rayloom({"--version"}).out;
  std::vector<std::vector<std::string>> ways{
      {"--threads", "2"}, {"--threads", "7"}, {"--mode", "direct"}, {"--mode", "warp"}};
  for (const char* isa : {"avx2", "avx512"}) {
    if (isas.find(isa) != std::string::npos) ways.push_back({"--isa", isa});
  }
  for (const auto& way : ways) {
    CAPTURE(way);
    render(scratch, small_picture(scene, "other.exr"), way);
    CHECK(scratch.read("other.exr") == reference);
  }
}

TEST_CASE("The report says which instruction set, mode and thread count were used") {
  const Scratch scratch;
  render(scratch, small_picture("cornell", "a.exr"),
         {"--threads", "2", "--isa", "scalar", "--mode", "direct", "--json=a.json"});
  const auto report = nlohmann::json::parse(scratch.read("a.json"));
  CHECK(report["schema"] == "rayloom.render");
  CHECK(report["tool"]["isa"] == "scalar");
  CHECK(report["config"]["mode"] == "direct");
  CHECK(report["config"]["threads"] == 2);
  CHECK(report["result"]["samples_per_pixel"] == 2);
  CHECK(report["result"]["rays"] > 40 * 24 * 2);
  CHECK(report["result"]["render_time_ns"] > 0);
}

TEST_CASE("Another seed is another picture, and the comparer says so") {
  const Scratch scratch;
  render(scratch, small_picture("cornell", "a.exr"), {"--seed", "1"});
  render(scratch, small_picture("cornell", "b.exr"), {"--seed", "2"});
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr"}).exit_code == 1);
}

TEST_CASE("One pixel alone equals that pixel of the whole picture") {
  const Scratch scratch;
  render(scratch, small_picture("cornell", "a.exr"));
  const Image whole = read_image(scratch.file("a.exr"));
  for (const auto& [x, y] : {std::pair{0, 0}, {39, 23}, {17, 11}}) {
    const Outcome one = scratch.rayloom({"render", "cornell", "--size", "40x24", "--spp", "2", "--aov", "N,Z,id",
                                         "--pixel", std::to_string(x) + "," + std::to_string(y), "--json"});
    REQUIRE(one.exit_code == 0);
    const auto channels = nlohmann::json::parse(one.out)["result"]["pixel"]["channels"];
    CHECK(channels.size() == whole.channels.size());
    for (const Channel& channel : whole.channels) {
      CAPTURE(channel.name, x, y);
      const size_t index = static_cast<size_t>(y) * 40 + static_cast<size_t>(x);
      if (channel.is_id()) {
        CHECK(channels[channel.name].get<uint32_t>() == channel.ids()[index]);
      } else if (channels[channel.name].is_number()) {
        CHECK(channels[channel.name].get<float>() == channel.floats()[index]);
      } else {
        CHECK_FALSE(std::isfinite(channel.floats()[index]));
      }
    }
  }
}

TEST_CASE("A constant sky is what rays see that hit nothing, from a colour and from a picture alike") {
  const Scratch scratch;
  Image sky{2, 1, {}, {}};
  for (const auto& [name, value] : {std::pair{"R", 0.25f}, {"G", 0.5f}, {"B", 1.0f}})
    sky.channels.push_back({name, std::vector<float>{value, value}});
  write_exr(scratch.file("sky.exr"), sky);
  const auto picture = [&](const std::string& output, const std::vector<std::string>& more) {
    render(scratch, {"render", "triangle", "-o", output, "--size", "16x16", "--spp", "1", "-q"}, more);
    return read_image(scratch.file(output));
  };
  const Image color = picture("color.exr", {"--environment", "0.25,0.5,1", "--environment-scale", "2"});
  const Image image = picture("image.exr", {"--environment", "sky.exr", "--environment-scale", "2"});
  for (const Image* seen : {&color, &image}) {
    CHECK(seen->find("R")->floats()[0] == 0.5f);
    CHECK(seen->find("G")->floats()[0] == 1.0f);
    CHECK(seen->find("B")->floats()[0] == 2.0f);
  }
  CHECK(picture("dark.exr", {"--environment", "none"}).find("G")->floats()[0] == 0);
  const Outcome missing = scratch.rayloom({"render", "triangle", "-o", "x.exr", "--environment", "gone.exr"});
  CHECK(missing.exit_code == 3);
  CHECK_THAT(missing.err, Catch::Contains("gone.exr"));
}

TEST_CASE("The picture's header names its makers and the command that makes it again") {
  const Scratch scratch;
  render(scratch, small_picture("cornell", "a.exr"));
  const std::string bytes = scratch.read("a.exr");
  for (const char* text : {"rayloom:seed", "rayloom:spp", "rayloom:scene", "rayloom:commit",
                           "rayloom render cornell --shader path_tracer --size 40x24 --spp 2"}) {
    CHECK_THAT(bytes, Catch::Contains(text));
  }
}

TEST_CASE("Every shader renders, EXR and preview at once, without a NaN") {
  const Scratch scratch;
  for (const char* shader : {"path_tracer", "ambient_occlusion", "barycentrics"}) {
    CAPTURE(shader);
    render(scratch,
           {"render", "spheres", "--shader", shader, "--size", "24x16", "--spp", "1", "-o", "a.exr", "-o", "a.png"});
    const Image image = read_image(scratch.file("a.exr"));
    for (const char* name : {"R", "G", "B"}) {
      REQUIRE(image.find(name));
      for (const float value : image.find(name)->floats()) CHECK(std::isfinite(value));
    }
    CHECK(read_image(scratch.file("a.png")).width == 24);
  }
}

TEST_CASE("Ctrl-C ends a long rendering with 130 and no half-written file") {
  const Scratch scratch;
  RunOptions interrupted;
  interrupted.interrupt_after_ms = 1500;
  const Outcome outcome = scratch.rayloom({"render", "cornell", "-o", "a.exr", "--spp", "60000"}, interrupted);
  CHECK(outcome.exit_code == 130);
  const std::string left = scratch.listing();
  CHECK((left.empty() || left == "a.exr\n"));
  if (!left.empty()) CHECK(read_image(scratch.file("a.exr")).width == 960);
}

TEST_CASE("--sampler chooses the random numbers, and the picture's own command says which were not the default's") {
  const Scratch scratch;
  render(scratch, small_picture("cornell", "default.exr"));
  render(scratch, small_picture("cornell", "sobol.exr"), {"--sampler", "owen-sobol"});
  render(scratch, small_picture("cornell", "independent.exr"), {"--sampler", "independent", "--json=a.json"});
  CHECK(scratch.read("sobol.exr") == scratch.read("default.exr"));
  CHECK(scratch.rayloom({"diff", "independent.exr", "sobol.exr"}).exit_code == 1);
  const auto config = nlohmann::json::parse(scratch.read("a.json"))["config"];
  CHECK(config["sampler"] == "independent");
  CHECK(config["command"].get<std::string>().find("--sampler independent") != std::string::npos);
  const Outcome bad = scratch.rayloom({"render", "cornell", "-o", "x.exr", "--sampler", "dice"});
  CHECK(bad.exit_code == 2);
  CHECK(bad.err.find("--sampler: 'dice'") != std::string::npos);
}
