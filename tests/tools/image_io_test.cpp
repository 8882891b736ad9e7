#include <rayloom/base/error.h>
#include <rayloom/tools/image_compare.h>
#include <rayloom/tools/image_io.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <limits>

using namespace rayloom;
using namespace rayloom::tools;

namespace {

/// A directory of this test's own, gone at its end.
struct Scratch {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "rayloom_image_io_test";
  Scratch() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directory(path);
  }
  ~Scratch() { std::filesystem::remove_all(path); }
  std::string file(const char* name) const { return (path / name).string(); }
};

Image sample_image() {
  constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
  return {2,
          2,
          {{"R", std::vector<float>{0, -0.0f, 1e-40f, 1}},
           {"G", std::vector<float>{nan_value, std::numeric_limits<float>::infinity(), 0.1f, 3e38f}},
           {"B", std::vector<float>{4, 3, 2, 1}},
           {"Albedo.R", std::vector<float>{.1f, .2f, .3f, .4f}},
           {"id.primitive", std::vector<uint32_t>{0, 0xFFFFFFFFu, 16777217, 5}}},
          {{"rayloom:seed", "7"}}};
}

}  // namespace

TEST_CASE("An EXR gives back every bit, floats and ids alike") {
  const Scratch scratch;
  const Image image = sample_image();
  write_exr(scratch.file("a.exr"), image);
  const Image read = read_image(scratch.file("a.exr"));
  const Comparison comparison = compare_images(read, "a.exr", image, "memory");
  CHECK(comparison.bits_equal);
  CHECK(read.find("id.primitive")->ids()[2] == 16777217);
}

TEST_CASE("The same image is the same file") {
  CHECK(encode_exr(sample_image()) == encode_exr(sample_image()));
  Image other = sample_image();
  other.metadata = {{"rayloom:seed", "8"}};
  CHECK(encode_exr(sample_image()) != encode_exr(other));
}

TEST_CASE("A PNG gives back its bytes") {
  const Scratch scratch;
  write_png(scratch.file("a.png"), {2, 1, {0, 128, 255, 1, 2, 3}}, {});
  const Image read = read_image(scratch.file("a.png"));
  REQUIRE(read.width == 2);
  CHECK(read.find("G")->floats()[0] * 255 == Approx(128));
  CHECK(read.find("B")->floats()[1] * 255 == Approx(3));
}

TEST_CASE("Files that are no pictures are refused by name") {
  const Scratch scratch;
  const std::string bytes = encode_exr(sample_image());
  const size_t keep = GENERATE(0, 4, 100, 300);
  std::ofstream(scratch.file("cut.exr"), std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(keep));
  CHECK_THROWS_WITH(read_image(scratch.file("cut.exr")), Catch::Contains("cut.exr"));
  CHECK_THROWS_AS(read_image(scratch.file("missing.exr")), InputError);
}

TEST_CASE("A picture that cannot be written leaves nothing behind") {
  const Scratch scratch;
  CHECK_THROWS_AS(write_exr(scratch.file("none/a.exr"), sample_image()), InputError);
  CHECK_THROWS_AS(write_exr("/dev/full", sample_image()), InputError);
  CHECK(std::filesystem::is_empty(scratch.path));
}

TEST_CASE("Extensions are compared without case") {
  CHECK(has_extension("a/b.EXR", ".exr"));
  CHECK_FALSE(has_extension("exr", ".exr"));
}
