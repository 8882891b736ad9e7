#include <rayloom/tools/image_io.h>

#include "run_command.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

using namespace rayloom::tools;

namespace {

Image grey(std::vector<float> values) {
  const auto width = static_cast<uint32_t>(values.size());
  return {width, 1, {{"R", values}, {"G", values}, {"B", values}}, {}};
}

}  // namespace

TEST_CASE("diff answers with its exit code") {
  const Scratch scratch;
  write_exr(scratch.file("a.exr"), grey({1, 2, 3}));
  write_exr(scratch.file("b.exr"), grey({1, 2, 4}));
  CHECK(scratch.rayloom({"diff", "a.exr", "a.exr"}).exit_code == 0);
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr"}).exit_code == 1);
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr", "--metric", "max", "--max", "1"}).exit_code == 0);
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr", "--metric", "max", "--max", "0.999"}).exit_code == 1);
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr", "--metric", "psnr", "--max", "4"}).exit_code == 0);
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr", "--metric", "psnr", "--max", "5"}).exit_code == 1);
}

TEST_CASE("diff reports measures as JSON, and only JSON, on standard output") {
  const Scratch scratch;
  write_exr(scratch.file("a.exr"), grey({1, 2, 3}));
  write_exr(scratch.file("b.exr"), grey({1, 2, 4}));
  const Outcome outcome = scratch.rayloom({"diff", "--json", "a.exr", "b.exr", "--metric", "relmse"});
  CHECK(outcome.exit_code == 1);
  CHECK(outcome.err.empty());
  const auto report = nlohmann::json::parse(outcome.out);
  CHECK(report["schema"] == "rayloom.diff");
  CHECK(report["schema_version"] == 1);
  CHECK(report["value"].get<double>() == Approx(1 / 16.01 / 3));
  CHECK(report["overall"]["mse"].get<double>() == Approx(1.0 / 3));
  CHECK(report["overall"]["different_samples"] == 3);
  CHECK(report["channels"].size() == 3);
  CHECK(report["bits_equal"] == false);
}

TEST_CASE("diff writes where the pictures differ") {
  const Scratch scratch;
  write_exr(scratch.file("a.exr"), grey({1, 2, 3}));
  write_exr(scratch.file("b.exr"), grey({1, 2.5f, 4}));
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr", "-o", "d.exr"}).exit_code == 1);
  CHECK(read_image(scratch.file("d.exr")).find("G")->floats() == std::vector<float>{0, 0.5f, 1});
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr", "-o", "d.png"}).exit_code == 1);
  const Image heat = read_image(scratch.file("d.png"));
  CHECK(heat.find("R")->floats()[0] == 0);
  CHECK(heat.find("R")->floats()[2] == 1);
}

TEST_CASE("diff measures FLIP, bounds it and writes its map") {
  const Scratch scratch;
  write_exr(scratch.file("a.exr"), grey({0.1f, 0.2f, 0.3f}));
  write_exr(scratch.file("b.exr"), grey({0.1f, 0.2f, 0.6f}));
  const auto diff = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"diff", "a.exr", "b.exr", "--metric", "flip"});
    return scratch.rayloom(more);
  };
  const auto report = nlohmann::json::parse(diff({"--json", "-o", "map.exr"}).out);
  CHECK(report["metric"] == "flip");
  CHECK(report["flip"]["mode"] == "hdr");
  CHECK(report["flip"]["exposures"]["count"] == 2);
  CHECK(report["flip"]["pixels_per_degree"] == 67.0206);
  CHECK(report["flip"]["incomparable_pixels"] == 0);
  const double value = report["value"];
  CHECK(value == report["flip"]["mean"].get<double>());
  const std::vector<float> map = read_image(scratch.file("map.exr")).find("FLIP")->floats();
  CHECK((map[0] + map[1] + map[2]) / 3 == Approx(value));

  CHECK(diff({}).exit_code == 1);
  CHECK(diff({"--max", std::to_string(value + 1e-3)}).exit_code == 0);
  CHECK(diff({"--max", std::to_string(value - 1e-3), "-o", "map.png"}).exit_code == 1);
  CHECK(read_image(scratch.file("map.png")).find("R")->floats().size() == 3);
  const auto ldr = nlohmann::json::parse(diff({"--json", "--flip-mode", "ldr"}).out);
  CHECK(ldr["flip"]["mode"] == "ldr");
  CHECK(ldr["flip"]["exposures"].is_null());
  CHECK(ldr["value"].get<double>() != value);
}

TEST_CASE("diff takes 8-bit pictures as a screen shows them, and no bound covers NaN") {
  const Scratch scratch;
  write_png(scratch.file("a.png"), {2, 1, {0, 0, 0, 255, 255, 255}}, {});
  write_png(scratch.file("b.png"), {2, 1, {0, 0, 0, 250, 255, 255}}, {});
  const auto report =
      nlohmann::json::parse(scratch.rayloom({"diff", "a.png", "b.png", "--metric", "flip", "--json"}).out);
  CHECK(report["flip"]["mode"] == "ldr");
  CHECK(report["value"].get<double>() > 0);
  write_exr(scratch.file("a.exr"), grey({1, 2, std::nanf("")}));
  write_exr(scratch.file("b.exr"), grey({1, 2, 3}));
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr", "--metric", "flip", "--max", "1"}).exit_code == 1);
}

TEST_CASE("diff refuses FLIP options it cannot follow") {
  const Scratch scratch;
  write_exr(scratch.file("a.exr"), grey({1, 2, 3}));
  write_exr(scratch.file("depth.exr"), {3, 1, {{"Z", std::vector<float>{1, 2, 3}}}, {}});
  const auto exit_code = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "diff");
    return scratch.rayloom(arguments).exit_code;
  };
  CHECK(exit_code({"a.exr", "a.exr", "--metric", "flop"}) == 2);
  CHECK(exit_code({"a.exr", "a.exr", "--metric", "flip", "--flip-mode", "sdr"}) == 2);
  CHECK(exit_code({"a.exr", "a.exr", "--flip-mode", "ldr"}) == 2);
  CHECK(exit_code({"depth.exr", "depth.exr", "--metric", "flip"}) == 3);
}

TEST_CASE("diff refuses what cannot be compared") {
  const Scratch scratch;
  write_exr(scratch.file("a.exr"), grey({1, 2, 3}));
  write_exr(scratch.file("wide.exr"), grey({1, 2, 3, 4}));
  write_exr(scratch.file("depth.exr"), {3, 1, {{"Z", std::vector<float>{1, 2, 3}}}, {}});
  scratch.write("text.exr", "this is no picture");
  const std::string before = scratch.listing();
  for (const char* other : {"wide.exr", "depth.exr", "text.exr", "missing.exr"}) {
    CAPTURE(other);
    const Outcome outcome = scratch.rayloom({"diff", "a.exr", other, "-o", "d.exr"});
    CHECK(outcome.exit_code == 3);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, Catch::Contains(other));
  }
  CHECK(scratch.listing() == before);
}

TEST_CASE("A difference in one sample in a million is found") {
  const Scratch scratch;
  std::vector<float> values(1000 * 1000, 0.5f);
  Image image{1000, 1000, {{"R", values}, {"G", values}, {"B", values}}, {}};
  write_exr(scratch.file("a.exr"), image);
  values[123456] = std::nextafter(0.5f, 1.0f);
  image.channels[1].values = values;
  write_exr(scratch.file("b.exr"), image);
  CHECK(scratch.rayloom({"diff", "a.exr", "b.exr"}).exit_code == 1);
}
