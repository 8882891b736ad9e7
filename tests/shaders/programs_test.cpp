// The programs on scenes whose pictures are known.

#include <rayloom/base/error.h>
#include <rayloom/scenes/camera.h>
#include <rayloom/shaders/renderer.h>

#include "scenes.h"
#include "statistics.h"

#include <catch2/catch.hpp>

#include <set>

using namespace rayloom;
using namespace rayloom::shaders;

namespace {

/// Looks down at [-1, 1]^2 of the xz plane from y = 4, -z up in the picture.
RenderOptions top_view(const std::string& program, uint32_t size = 8) {
  RenderOptions options;
  options.program = program;
  options.width = options.height = size;
  scenes::SceneCamera camera = scenes::look_at({0, 4, 0}, {0, 0, 0}, {0, 0, -1}, 0.5f);
  camera.kind = scenes::SceneCamera::Kind::orthographic, camera.ymag = 1;
  options.camera = camera;
  return options;
}

scenes::Scene floor_scene() {
  scenes::Scene scene = test::empty_scene();
  scene.environment = test::constant_sky(1);
  test::add_mesh(scene, test::quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
  return scene;
}

Picture picture_of(const scenes::Scene& scene, const RenderOptions& options, uint32_t samples = 1) {
  Renderer renderer(scene, options);
  renderer.render(0, samples);
  return renderer.picture();
}

float4 middle(const Picture& p) { return p.rgba[(p.height / 2) * p.width + p.width / 2]; }

std::shared_ptr<const scenes::Image> image(uint32_t width, uint32_t height, std::vector<uint8_t> bytes) {
  return std::make_shared<scenes::Image>(scenes::Image::from_pixels("image", {width, height, std::move(bytes), {}}));
}

const AovChannel& channel(const std::vector<AovChannel>& channels, const std::string& name) {
  for (const AovChannel& c : channels)
    if (c.name == name) return c;
  throw std::runtime_error("no channel " + name);
}

}  // namespace

TEST_CASE("barycentrics are weights of the vertices, in the lecture's order") {
  const Picture p = picture_of(floor_scene(), top_view("barycentrics"));
  for (uint32_t y = 0; y < 8; ++y)
    for (uint32_t x = 0; x < 8; ++x) {
      // Corner (-1, 1) is vertex 0 of both triangles; (s, t) grow along the quad's edges.
      const float s = (float(x) + 0.5f) / 8, t = 1 - (float(y) + 0.5f) / 8;
      if (std::abs(s - t) < 1e-3f) continue;  // the diagonal
      const float b1 = s > t ? s - t : std::min(s, t), b2 = s > t ? t : t - s;
      const float4 pixel = p.rgba[y * 8 + x];
      CHECK(pixel.x == Approx(b1).margin(1e-5));
      CHECK(pixel.y == Approx(b2).margin(1e-5));
      CHECK(pixel.z == Approx(1 - b1 - b2).margin(1e-5));
      CHECK(pixel.w == 1);
    }
}

TEST_CASE("every program renders, and says what hits nothing") {
  scenes::Scene scene = floor_scene();
  test::add_spheres(scene, {{{0.5f, 0.2f, 0.5f}, 0.2f}});
  for (const ProgramInfo& info : programs()) {
    RenderOptions options = top_view(info.name);
    options.camera->ymag = 2;  // a rim of nothing
    CAPTURE(info.name);
    const Picture p = picture_of(scene, options, 4);
    CHECK(p.rgba[0].w == 0);
    CHECK(middle(p).w == 1);
    for (const float4& pixel : p.rgba) CHECK(std::isfinite(pixel.x));
  }
}

TEST_CASE("unknown programs and bad sizes are usage errors") {
  const scenes::Scene scene = floor_scene();
  CHECK_THROWS_AS(Renderer(scene, top_view("path_trace")), UsageError);
  CHECK_THROWS_WITH(Renderer(scene, top_view("x")), Catch::Contains("ambient_occlusion"));
  CHECK_THROWS_AS(Renderer(scene, top_view("normal", 0)), UsageError);
  RenderOptions options = top_view("normal");
  options.window = Window{8, 0, 1, 1};
  CHECK_THROWS_AS(Renderer(scene, options), UsageError);
}

TEST_CASE("AOV channels hold what was hit") {
  scenes::Scene scene = floor_scene();
  scene.materials.resize(2);
  scene.materials[1].base_color = {0.25f, 0.5f, 1, 1};
  test::add_mesh(scene, test::quad({0, 1, 0}, {0, 0, -1}, {1, 0, 0}, 1));  // facing down, upper right quarter
  Renderer renderer(scene, top_view("path_tracer"));
  const auto channels = renderer.aov_channels();
  CHECK(channels.size() == aov_channel_names().size());
  const auto value = [&](const char* name, uint32_t x, uint32_t y) {
    return channel(channels, name).values[y * 8 + x];
  };
  const auto id = [&](const char* name, uint32_t x, uint32_t y) { return channel(channels, name).ids[y * 8 + x]; };
  CHECK(value("Z", 0, 7) == 4);
  CHECK(value("rayT", 7, 0) == 3);
  CHECK(value("P.Y", 7, 0) == 1);
  CHECK(value("P.X", 7, 0) == Approx(0.875));
  CHECK(value("P.Z", 0, 7) == Approx(0.875));
  CHECK(value("N.Y", 7, 0) == 1);  // turned to the viewer
  CHECK(value("facing", 7, 0) == -1);
  CHECK(value("facing", 0, 7) == 1);
  CHECK(value("Albedo.G", 7, 0) == 0.5f);
  CHECK(value("uv.U", 0, 7) == Approx(0.0625));
  CHECK(value("uv.V", 0, 7) == Approx(0.0625));
  CHECK(id("id.instance", 7, 0) == 1);
  CHECK(id("id.material", 7, 0) == 1);
  CHECK(id("id.geometry", 7, 0) == 0);
  CHECK(std::set<uint32_t>{id("id.primitive", 7, 7), id("id.primitive", 0, 0)} == std::set<uint32_t>{0, 1});
}

TEST_CASE("ambient occlusion of a floor under an infinite half-open ceiling") {
  // Seen from the floor's middle a plate at height h over x > 0 hides half of the cosine-weighted hemisphere.
  scenes::Scene scene = floor_scene();
  test::add_mesh(scene, test::quad({0, 1, -1e5f}, {1e5f, 0, 0}, {0, 0, 2e5f}));
  RenderOptions options = top_view("ambient_occlusion", 1);
  options.camera = scenes::look_at({-1.0f, 0.5f, 0}, {0, 0, 0}, {0, 1, 0}, 0.5f);
  options.camera->kind = scenes::SceneCamera::Kind::orthographic, options.camera->ymag = 1e-4f;
  Renderer renderer(scene, options);
  renderer.render(0, 16384);
  const Picture p = renderer.picture();
  CHECK(std::abs(double{p.rgba[0].x} - 0.5) < 4 * std::sqrt(double{p.variance[0].x}));
  options.occlusion_distance = 0.5f;
  CHECK(picture_of(scene, options, 64).rgba[0].x == 1);
}

TEST_CASE("opaque scenes run no any-hit shaders; a masked texel cuts holes in camera and shadow rays alike") {
  scenes::Scene scene = floor_scene();
  Renderer opaque(scene, top_view("path_tracer"));
  opaque.render(0, 4);
  CHECK(opaque.statistics().any_hit == 0);
  CHECK(opaque.device_scene().ray_types() == 1);

  scene.materials.resize(2);
  scene.materials[1].alpha_mode = scenes::AlphaMode::mask;
  scene.materials[1].base_color_texture.texture = 0;
  scene.textures.push_back({});
  scene.textures[0].filter = scenes::Filter::nearest;
  scene.images.push_back(image(2, 1, {255, 255, 255, 255, 255, 255, 255, 0}));  // left half opaque
  test::add_mesh(scene, test::quad({-1, 1, 1}, {2, 0, 0}, {0, 0, -2}, 1));
  Renderer masked(scene, top_view("path_tracer"));
  const auto channels = masked.aov_channels();
  CHECK(channel(channels, "Z").values[0] == 3);
  CHECK(channel(channels, "Z").values[7] == 4);
  CHECK(masked.statistics().any_hit > 0);
  CHECK(masked.device_scene().ray_types() == 2);
  masked.render(0, 256);
  // Below the hole the floor is half shaded by the opaque half: darker than open, brighter than black.
  const float shaded = masked.picture().rgba[4 * 8 + 5].x;
  CHECK(shaded > 0.3f);
  CHECK(shaded < 0.9f);
}

TEST_CASE("a blended surface lets its share of the light through") {
  scenes::Scene scene = test::empty_scene();
  scene.materials.resize(2);
  scene.materials[0].emissive = {1, 1, 1};
  scene.materials[0].base_color = {0, 0, 0, 1};
  scene.materials[1].base_color = {0, 0, 0, 0.25f};
  scene.materials[1].alpha_mode = scenes::AlphaMode::blend;
  test::add_mesh(scene, test::quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0));
  test::add_mesh(scene, test::quad({-1, 1, 1}, {2, 0, 0}, {0, 0, -2}, 1));
  RenderOptions options = top_view("path_tracer");
  options.max_bounces = 0;
  const Picture p = picture_of(scene, options, 1024);
  test::Moments mean;
  for (const float4& pixel : p.rgba) mean.add(double{pixel.x});
  CHECK(std::abs(mean.mean - 0.75) < 4 * mean.standard_error());
}

TEST_CASE("emission shows from the front, and from behind only when double-sided") {
  for (const bool double_sided : {false, true})
    for (const bool front : {false, true}) {
      scenes::Scene scene = test::empty_scene();
      scene.materials[0].emissive = {1, 2, 3}, scene.materials[0].base_color = {0, 0, 0, 1};
      scene.materials[0].double_sided = double_sided;
      test::add_mesh(
          scene, front ? test::quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}) : test::quad({-1, 0, 1}, {0, 0, -2}, {2, 0, 0}));
      RenderOptions options = top_view("path_tracer");
      options.max_bounces = 0;
      CHECK(float3(middle(picture_of(scene, options))) == (front || double_sided ? float3(1, 2, 3) : float3(0)));
    }
}

TEST_CASE("vertex colours, base colour and texture multiply; textures decode in linear light") {
  scenes::Scene scene = floor_scene();
  scene.materials[0].base_color = {0.5f, 1, 1, 1};
  scene.materials[0].base_color_texture.texture = 0;
  scene.textures.push_back({});
  scene.images.push_back(image(1, 1, {255, 188, 0, 255}));
  scene.meshes[0].geometries[0].colors.assign(4, glm::vec4(0.5f, 0.5f, 1, 1));
  const float4 albedo = middle(picture_of(scene, top_view("albedo")));
  CHECK(albedo.x == 0.25f);
  CHECK(albedo.y == Approx(0.5 * 0.5028865));
  CHECK(albedo.z == 0);
}

TEST_CASE("a normal map tilts the shading normal in the texture's directions") {
  scenes::Scene scene = floor_scene();
  scene.materials[0].normal_texture.texture = 0;
  scene.textures.push_back({});
  const auto seen_with = [&](uint8_t x, uint8_t y, uint8_t z) {
    scene.images = {image(1, 1, {x, y, z, 255})};
    return 2.0f * float3(middle(picture_of(scene, top_view("shading_normal")))) - 1.0f;
  };
  const float tilt = 0.380392f / std::sqrt(0.380392f * 0.380392f + 0.866667f * 0.866667f);
  CHECK(seen_with(176, 128, 238).x == Approx(tilt).margin(2e-3));   // u runs along +x on this quad
  CHECK(seen_with(128, 176, 238).z == Approx(-tilt).margin(2e-3));  // v along -z
  CHECK(seen_with(128, 128, 255).y == Approx(1).margin(1e-4));
  // Barely out of the plane: turned until the view is mirrored out of the surface.
  const float3 steep = seen_with(255, 128, 128);
  CHECK(2 * steep.y * steep.y - 1 >= 0.0099f);
  CHECK(steep.x > 0.3f);
  scene.materials[0].normal_scale = 0;
  CHECK(seen_with(176, 128, 238).y == 1);
}

TEST_CASE("textures that no ray meets are not decoded") {
  scenes::Scene scene = floor_scene();
  scene.materials.resize(2);
  scene.materials[1].base_color_texture.texture = 0;
  scene.textures.push_back({});
  scene.images.push_back(std::make_shared<scenes::Image>(scenes::Image::from_encoded("broken", {std::byte{1}})));
  test::add_mesh(scene, test::quad({50, 0, 1}, {2, 0, 0}, {0, 0, -2}, 1));
  CHECK_NOTHROW(picture_of(scene, top_view("albedo")));
  scene.instances[1].transform[3] = -51;  // into view
  scene.instances[1].transform[7] = 1;
  CHECK_THROWS_AS(picture_of(scene, top_view("albedo")), InputError);
}

TEST_CASE("a scene without light gets a sky, one with light does not") {
  scenes::Scene scene = floor_scene();
  CHECK_FALSE(Renderer(scene, top_view("path_tracer")).uses_default_sky());
  scene.environment = {};
  CHECK(Renderer(scene, top_view("path_tracer")).uses_default_sky());
  CHECK(middle(picture_of(scene, top_view("path_tracer"), 16)).x > 0.3f);
  scene.lights.resize(1);
  CHECK_FALSE(Renderer(scene, top_view("path_tracer")).uses_default_sky());
}

TEST_CASE("an empty scene renders its sky") {
  scenes::Scene scene = test::empty_scene();
  scene.environment = test::constant_sky(0.5f);
  RenderOptions options = top_view("path_tracer");
  const float4 pixel = middle(picture_of(scene, options, 2));
  CHECK(pixel == float4(0.5f, 0.5f, 0.5f, 0));
}
