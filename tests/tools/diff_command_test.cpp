#include <rayloom/tools/image_io.h>

#include "run_command.h"

#include <catch2/catch.hpp>
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
