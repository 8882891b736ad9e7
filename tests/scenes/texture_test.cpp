#include "gltf_asset.h"

#include <rayloom/base/error.h>
#include <rayloom/scenes/gltf/load_gltf.h>
#include <rayloom/scenes/summary.h>
#include <rayloom/scenes/texture.h>
#include <OpenImageIO/imageio.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <thread>

using namespace rayloom;
using namespace rayloom::scenes;
using namespace rayloom::scenes::test;

/// OpenImageIO leaves a truncated PNG by longjmp, over the destructor of a string of its own (seen with 2.4.7).
extern "C" const char* __lsan_default_suppressions() { return "leak:OpenImageIO_v2_4::ImageInput::geterror\n"; }

namespace {

/// 2 x 1 bytes: black, then white at half alpha.
Scene two_texels(Wrap wrap, Filter filter) {
  Scene scene;
  Pixels pixels{2, 1, {0, 0, 0, 255, 255, 255, 255, 128}, {}};
  scene.images.push_back(std::make_shared<const Image>(Image::from_pixels("two", pixels)));
  scene.textures.push_back({0, wrap, wrap, filter, "two"});
  return scene;
}

float red_at(const Scene& scene, float u) {
  return sample_texture(scene, scene.textures[0], {u, 0.5f}, Encoding::linear).x;
}

std::vector<std::byte> png(int width, int height, int channels, const std::vector<uint8_t>& values) {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/picture.png";
  const auto output = OIIO::ImageOutput::create(path);
  OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  REQUIRE(output->open(path, spec));
  REQUIRE(output->write_image(OIIO::TypeDesc::UINT8, values.data()));
  REQUIRE(output->close());
  std::ifstream file(path, std::ios::binary);
  return as_bytes({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
}

}  // namespace

TEST_CASE("wrap modes map any texel number into the image") {
  const auto sequence = [](Wrap wrap) {
    std::vector<uint32_t> texels;
    for (int64_t i = -4; i < 7; ++i) texels.push_back(wrap_texel(wrap, i, 3));
    return texels;
  };
  CHECK(sequence(Wrap::repeat) == std::vector<uint32_t>{2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0});
  CHECK(sequence(Wrap::mirrored_repeat) == std::vector<uint32_t>{2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0});
  CHECK(sequence(Wrap::clamp_to_edge) == std::vector<uint32_t>{0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2});
}

TEST_CASE("nearest and linear sampling through every wrap mode") {
  const Scene repeat = two_texels(Wrap::repeat, Filter::nearest);
  CHECK(red_at(repeat, 0.4f) == 0);
  CHECK(red_at(repeat, 0.6f) == 1);
  CHECK(red_at(repeat, 1.2f) == 0);
  CHECK(red_at(repeat, -0.2f) == 1);
  CHECK(red_at(two_texels(Wrap::mirrored_repeat, Filter::nearest), 1.2f) == 1);
  CHECK(red_at(two_texels(Wrap::clamp_to_edge, Filter::nearest), -3.0f) == 0);
  CHECK(red_at(two_texels(Wrap::clamp_to_edge, Filter::nearest), 1.0f) == 1);
  CHECK(red_at(two_texels(Wrap::clamp_to_edge, Filter::linear), 0.5f) == 0.5f);
  CHECK(red_at(two_texels(Wrap::clamp_to_edge, Filter::linear), 0.0f) == 0);
  CHECK(red_at(two_texels(Wrap::repeat, Filter::linear), 0.0f) == 0.5f);
  CHECK(red_at(two_texels(Wrap::mirrored_repeat, Filter::linear), 1.0f) == 1);
}

TEST_CASE("absurd coordinates stay inside") {
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge}) {
    for (const Filter filter : {Filter::nearest, Filter::linear}) {
      const Scene scene = two_texels(wrap, filter);
      for (const float u :
           {1e30f, -1e30f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(),
            -std::numeric_limits<float>::denorm_min(), 1e-30f}) {
        const float red = red_at(scene, u);
        CHECK((red >= 0 && red <= 1));
      }
    }
  }
}

TEST_CASE("sRGB bytes and floats decode alike, alpha stays linear") {
  CHECK(srgb_to_linear(0) == 0);
  CHECK(srgb_to_linear(1) == 1);
  CHECK(srgb_to_linear(0.5f) == Approx(0.21404114).epsilon(1e-6));
  CHECK(srgb_to_linear(0.02f) == Approx(0.02 / 12.92).epsilon(1e-6));
  Scene scene;
  scene.images.push_back(std::make_shared<const Image>(Image::from_pixels("g", {1, 1, {188, 10, 0, 128}, {}})));
  const glm::vec4 texel = fetch_texel(*scene.images[0], 0, 0, Encoding::srgb);
  for (int i = 0; i < 256; ++i) {
    const Image image = Image::from_pixels("g", {1, 1, {static_cast<uint8_t>(i), 0, 0, 0}, {}});
    const double encoded = i / 255.0;
    const double exact = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    CHECK(fetch_texel(image, 0, 0, Encoding::srgb).x == Approx(exact).epsilon(1e-7));
  }
  CHECK(texel.w == 128 / 255.0f);
}

TEST_CASE("images decode once, when first read, from any number of threads") {
  const uint64_t before = images_decoded();
  const Image image = Image::from_encoded("grey", png(2, 1, 2, {10, 20, 30, 255}));
  CHECK_FALSE(image.decoded());
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) threads.emplace_back([&] { image.pixels(); });
  for (std::thread& thread : threads) thread.join();
  CHECK(image.decoded());
  CHECK(images_decoded() == before + 1);
  // Grey spreads over RGB; alpha is not multiplied in.
  CHECK(image.pixels().bytes == std::vector<uint8_t>{10, 10, 10, 20, 30, 30, 30, 255});
}

TEST_CASE("pictures that are none fail with their name when read") {
  const Image nonsense = Image::from_encoded("a.glb: images[3]", as_bytes("nonsense"));
  CHECK_THROWS_WITH(nonsense.pixels(), Catch::StartsWith("a.glb: images[3]: "));
  CHECK_THROWS_AS(nonsense.pixels(), InputError);
  std::vector<std::byte> cut = png(64, 64, 3, std::vector<uint8_t>(64 * 64 * 3, 99));
  cut.resize(cut.size() / 2);
  CHECK_THROWS_AS(Image::from_encoded("cut", cut).pixels(), InputError);
  CHECK_THROWS_AS(Image::from_file("/nonexistent.png").pixels(), InputError);
  CHECK_THROWS_AS(Image::from_pixels("bad", {2, 2, {1, 2, 3}, {}}), InputError);
}

TEST_CASE("loading a file and summing it up decodes nothing, sampling its texture decodes one image") {
  Asset asset = Asset::triangle();
  const std::vector<std::byte> encoded = png(1, 1, 3, {255, 0, 0});
  const int view = asset.add_view(encoded);
  asset.root["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}},
                          {{"uri", "data:image/png;base64," + base64(encoded)}}};
  asset.root["textures"] = {{{"source", 0}}, {{"source", 1}}};
  asset.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}}};
  asset.primitive()["material"] = 0;
  const uint64_t before = images_decoded();
  const Scene scene = load_gltf_bytes(asset.glb(), "test.glb", "");
  CHECK(summarize(scene).images_decoded == 0);
  CHECK(images_decoded() == before);
  CHECK(sample_texture(scene, scene.materials[0].base_color_texture, {0, 0}, {0, 0}, Encoding::srgb) ==
        glm::vec4(1, 0, 0, 1));
  CHECK(images_decoded() == before + 1);
  CHECK(summarize(scene).images_decoded == 1);
}
