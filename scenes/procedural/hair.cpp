#include "builder.h"
#include "distance.h"
#include "gradient_noise.h"
#include "isosurface.h"
#include "scenes.h"
#include "shapes.h"
#include "tube.h"

#include <rayloom/base/det_math.h>
#include <rayloom/base/hash.h>
#include <rayloom/base/parallel.h>
#include <rayloom/scenes/camera.h>

#include <algorithm>
#include <array>
#include <vector>

namespace rayloom::scenes {
namespace {

constexpr float pi = 3.14159265f;
constexpr uint32_t shades = 3, sides = 3;
constexpr uint32_t most_segments = 128;

struct Style {
  uint32_t strands, segments;
  float radius;  ///< metres
  float curl;    ///< 0 to 1
};

glm::vec3 unit(glm::vec3 v) { return v / length(v); }

/// A head and shoulders, looking along +z, its middle at the origin; metres.
float bust(glm::vec3 p) {
  const glm::vec3 mirrored(std::fabs(p.x), p.y, p.z);
  float d = ellipsoid(p, {0.076f, 0.105f, 0.096f});
  d = blend(d, ellipsoid(p - glm::vec3(0, -0.072f, 0.026f), {0.052f, 0.058f, 0.062f}), 0.05f);             // jaw
  d = blend(d, ellipsoid(p - glm::vec3(0, -0.118f, 0.068f), {0.018f, 0.014f, 0.016f}), 0.03f);             // chin
  d = blend(d, ellipsoid(p - glm::vec3(0, -0.035f, 0.098f), {0.011f, 0.022f, 0.019f}), 0.022f);            // nose
  d = blend(d, ellipsoid(mirrored - glm::vec3(0.027f, -0.005f, 0.088f), {0.02f, 0.008f, 0.010f}), 0.02f);  // brows
  d = blend(d, ellipsoid(mirrored - glm::vec3(0.079f, -0.025f, 0), {0.008f, 0.026f, 0.017f}), 0.01f);      // ears
  d = blend(d, ellipsoid(p - glm::vec3(0, -0.083f, 0.083f), {0.021f, 0.007f, 0.009f}), 0.012f);            // mouth
  d = blend(d, Limb{{0, -0.10f, -0.02f}, {0, -0.25f, -0.035f}, 0.052f, 0.058f}.distance(p), 0.04f);
  d = blend(d, Limb{{0, -0.27f, -0.04f}, {0.16f, -0.30f, -0.04f}, 0.075f, 0.055f}.distance(mirrored), 0.07f);
  return std::max(d, -0.36f - p.y);
}

glm::vec3 outwards(glm::vec3 p) {
  constexpr float h = 0x1p-11f;
  return unit({bust(p + glm::vec3(h, 0, 0)) - bust(p - glm::vec3(h, 0, 0)),
               bust(p + glm::vec3(0, h, 0)) - bust(p - glm::vec3(0, h, 0)),
               bust(p + glm::vec3(0, 0, h)) - bust(p - glm::vec3(0, 0, h))});
}

/// Numbers of one strand.
class Draws {
 public:
  explicit Draws(uint64_t strand) : strand_(strand) {}
  float next() { return unit_float(hash64(strand_, 21u, count_++)); }
  float next_signed() { return 2 * next() - 1; }

 private:
  uint64_t strand_;
  uint32_t count_ = 0;
};

/// Above the forehead, the ears and the nape.
bool on_scalp(glm::vec3 direction) {
  const float line = 0.55f * direction.z - 0.05f;
  return direction.y > line;
}

/// A point of the scalp, each as likely as another seen from the head's middle.
glm::vec3 root(Draws& draws) {
  glm::vec3 direction(0, 1, 0);
  for (int i = 0; i < 64; ++i) {
    const glm::vec3 p(draws.next_signed(), draws.next_signed(), draws.next_signed());
    const float square = glm::dot(p, p);
    if (square > 1 || square < 0.01f || !on_scalp(unit(p))) continue;
    direction = unit(p);
    break;
  }
  glm::vec3 p = 0.2f * direction;
  for (int i = 0; i < 24; ++i) p -= bust(p) * direction;
  return p - 0.0015f * direction;  // under the skin
}

/// Combed from a parting a little to the left, falling, lying on what is under it.
struct Strand {
  std::array<glm::vec3, most_segments + 1> points, directions;
};

void comb(Strand& strand, const Style& style, Draws& draws) {
  const float layer = 0.002f + 0.012f * draws.next();
  const float step = (0.20f + 0.12f * draws.next()) / static_cast<float>(style.segments);
  glm::vec3 p = root(draws), normal = outwards(p);
  const float from_parting = p.x + 0.018f + 0.01f * draws.next_signed();
  const float sideways = std::clamp(from_parting / 0.035f, -1.0f, 1.0f) * smooth_step(-0.07f, 0.04f, p.z);
  const glm::vec3 flow(0.9f * sideways + 0.25f * draws.next_signed(), -0.3f, -0.5f + 0.2f * draws.next_signed());
  glm::vec3 direction = unit(flow - (glm::dot(flow, normal) - 0.5f) * normal);
  strand.points[0] = p;
  for (uint32_t i = 1; i <= style.segments; ++i) {
    const float fallen = static_cast<float>(i) * step;
    const glm::vec3 pull = glm::vec3(0, -1, 0) + std::max(0.0f, 1 - 9 * fallen) * flow;
    direction = unit(direction + 25 * step * pull);
    p += step * direction;
    normal = outwards(p);
    const float above = bust(p) - layer * std::min(1.0f, 25 * fallen);  // it lies on the layers below
    if (above < 0) p -= above * normal;
    if (above > 0 && p.y > -0.06f) p -= std::min(0.6f * above, 0.5f * step) * normal;
    direction = unit(p - strand.points[i - 1]);
    strand.points[i] = p;
  }
}

/// Locks: strands near each other wave together.
void curl(Strand& strand, const Style& style, Draws& draws) {
  const glm::vec3 p = strand.points[0];
  const uint64_t lock = hash64(static_cast<int>(std::floor(p.x * 70)), static_cast<int>(std::floor(p.y * 70)),
                               static_cast<int>(std::floor(p.z * 70)));
  const float start = 2 * pi * unit_float(lock) + 0.5f * draws.next();
  const float waves = 2 + 2 * unit_float(mix64(lock)), wide = style.curl * (0.006f + 0.003f * draws.next());
  for (uint32_t i = 1; i <= style.segments; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(style.segments);
    const auto [s, c] = det::sincos(start + 2 * pi * waves * t);
    strand.points[i] += wide * std::min(1.0f, 2.5f * t) * glm::vec3(c, 0.3f * s, s);
  }
}

void find_directions(Strand& strand, uint32_t segments) {
  for (uint32_t i = 0; i <= segments; ++i) {
    strand.directions[i] = unit(strand.points[std::min(i + 1, segments)] - strand.points[i == 0 ? 0 : i - 1]);
  }
}

/// Strands `shade`, `shade` + shades, ...
Geometry make_hair(const Style& style, uint32_t shade) {
  const uint64_t count = (style.strands - shade + shades - 1) / shades;
  const uint64_t vertices = tube_vertices(style.segments, sides), triangles = tube_triangles(style.segments, sides);
  Geometry geometry;
  geometry.name = "hair " + std::to_string(shade);
  geometry.positions.resize(count * vertices), geometry.normals.resize(count * vertices);
  geometry.uv0.resize(count * vertices), geometry.indices.resize(3 * count * triangles);
  parallel_for(count, 128, [&](uint64_t begin, uint64_t end) {
    Strand strand;
    for (uint64_t i = begin; i < end; ++i) {
      Draws draws(i * shades + shade);
      comb(strand, style, draws);
      curl(strand, style, draws);
      find_directions(strand, style.segments);
      const std::span points(strand.points.data(), style.segments + 1),
          directions(strand.directions.data(), style.segments + 1);
      write_tube(geometry, i * vertices, i * triangles, {points, directions, style.radius, 0.4f * style.radius}, sides);
    }
  });
  return geometry;
}

void add_bust(SceneBuilder& builder) {
  Geometry geometry;
  add_isosurface_of(geometry, {{{-0.26f, -0.37f, -0.15f}, {0.26f, 0.12f, 0.14f}}, bust}, 60000);
  geometry.name = "bust";
  geometry.material = builder.material(glossy("bust", {0.72f, 0.66f, 0.60f}, 0.5f));
  builder.instance(builder.mesh("bust", {std::move(geometry)}), identity_transform, "bust");
}

void add_hair(SceneBuilder& builder, const Style& style) {
  const glm::vec3 colors[shades] = {{0.16f, 0.075f, 0.035f}, {0.24f, 0.11f, 0.045f}, {0.09f, 0.045f, 0.025f}};
  const char* names[shades] = {"brown hair", "auburn hair", "dark hair"};
  std::vector<Geometry> geometries;
  for (uint32_t shade = 0; shade < shades && shade < style.strands; ++shade) {
    geometries.push_back(make_hair(style, shade));
    geometries.back().material = builder.material(glossy(names[shade], colors[shade], 0.3f));
  }
  builder.instance(builder.mesh("hair", std::move(geometries)), identity_transform, "hair");
}

void add_light(Scene& scene) {
  scene.environment.kind = Environment::Kind::gradient;
  scene.environment.zenith = {0.9f, 0.95f, 1.05f};
  scene.environment.horizon = {0.45f, 0.46f, 0.5f};
  scene.environment.nadir = {0.12f, 0.11f, 0.1f};
  const auto add = [&](const char* name, glm::vec3 direction, glm::vec3 intensity) {
    Light light;
    light.kind = Light::Kind::directional;
    light.name = name;
    light.direction = unit(direction);
    light.intensity = intensity;
    scene.lights.push_back(light);
  };
  add("key", {-0.6f, -0.75f, -0.7f}, {4.5f, 4.2f, 3.8f});
  add("rim", {0.7f, -0.6f, 0.8f}, {3.0f, 3.2f, 3.6f});
}

}  // namespace

Scene make_hair(Parameters& parameters) {
  Style style;
  style.strands = static_cast<uint32_t>(parameters.get("strands", 40000, 1, 1000000));
  style.segments = static_cast<uint32_t>(parameters.get("segments", 20, 4, most_segments));
  style.radius = 0.5e-6f * static_cast<float>(parameters.get("micrometres", 80, 10, 1000));
  style.curl = 0.01f * static_cast<float>(parameters.get("curl", 40, 0, 100));
  parameters.check_all_used();
  SceneBuilder builder;
  add_bust(builder);
  add_hair(builder, style);
  add_light(builder.scene());
  builder.camera("portrait", look_at({0.38f, 0.06f, 0.85f}, {0, -0.08f, 0}, {0, 1, 0}, 0.5f));
  builder.camera("back", look_at({-0.35f, 0.18f, -0.85f}, {0, -0.08f, 0}, {0, 1, 0}, 0.5f));
  builder.camera("close", look_at({0.22f, 0.05f, 0.16f}, {0.06f, 0.01f, 0.02f}, {0, 1, 0}, 0.5f));
  return builder.finish();
}

}  // namespace rayloom::scenes
