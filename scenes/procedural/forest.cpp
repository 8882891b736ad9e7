#include "builder.h"
#include "gradient_noise.h"
#include "height_grid.h"
#include "pictures.h"
#include "scenes.h"
#include "tree.h"

#include <rayloom/base/det_math.h>
#include <rayloom/base/parallel.h>
#include <rayloom/scenes/camera.h>

#include <algorithm>
#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr float spacing = 5;      // metres between trees, about
constexpr float path_width = 7;   // nothing grows on it
constexpr uint32_t variants = 3;  // meshes of each species

struct Leaves {
  TreeSpecies species;
  float share;  ///< of the trees
  enum { broad, small, needles } picture;
  glm::vec3 bark;
};

// count, first, angle, length, taper, lift, wander, sides, rings
std::vector<Leaves> make_species() {
  return {{{"oak",
            0.30f,
            {{1, 0, 0, 10, 0, 0.1f, 0.07f, 14, 12},
             {12, 0.28f, 62, 0.62f, 0.28f, 0.55f, 0.16f, 9, 8},
             {8, 0.25f, 52, 0.46f, 0.28f, 0.35f, 0.2f, 6, 5},
             {6, 0.2f, 48, 0.42f, 0.32f, 0.2f, 0.2f, 3, 3}},
            18,
            0.30f,
            {1.0f, 1.0f, 0.8f}},
           0.30f,
           Leaves::broad,
           {0.26f, 0.20f, 0.15f}},
          {{"birch",
            0.13f,
            {{1, 0, 0, 13, 0, 0.1f, 0.04f, 12, 14},
             {22, 0.30f, 48, 0.34f, 0.10f, 0.25f, 0.12f, 6, 7},
             {7, 0.2f, 45, 0.42f, 0.3f, -0.7f, 0.16f, 4, 4},
             {4, 0.2f, 42, 0.5f, 0.4f, -1.0f, 0.2f, 3, 3}},
            14,
            0.20f,
            {1.15f, 1.15f, 0.65f}},
           0.25f,
           Leaves::small,
           {0.72f, 0.70f, 0.66f}},
          {{"spruce",
            0.22f,
            {{1, 0, 0, 16, 0, 0, 0.01f, 12, 14},
             {76, 0.10f, 98, 0.23f, 0.03f, 0.12f, 0.05f, 5, 6},
             {13, 0.12f, 62, 0.42f, 0.18f, -0.25f, 0.08f, 3, 3}},
            8,
            0.34f,
            {0.75f, 0.95f, 0.85f}},
           0.33f,
           Leaves::needles,
           {0.22f, 0.15f, 0.11f}},
          {{"hazel",
            0.07f,
            {{1, 0, 0, 1.0f, 0, 0, 0.1f, 8, 4},
             {13, 0.1f, 38, 2.6f, 1.6f, 0.1f, 0.12f, 5, 6},
             {9, 0.25f, 50, 0.4f, 0.2f, 0.3f, 0.2f, 3, 4},
             {4, 0.2f, 50, 0.5f, 0.4f, 0, 0.2f, 3, 2}},
            12,
            0.17f,
            {1.1f, 1.2f, 0.7f}},
           0.12f,
           Leaves::broad,
           {0.30f, 0.24f, 0.18f}}};
}

/// Low hills: metres above the mean.
float hill(glm::vec2 p, uint32_t seed) {
  return 5.0f * gradient_noise(p / 75.0f, seed * 64).value + 1.4f * gradient_noise(p / 26.0f, seed * 64 + 1).value +
         0.12f * gradient_noise(p / 2.4f, seed * 64 + 2).value;
}

/// A path winds from +z to -z: metres from its middle line.
float from_path(glm::vec2 p) { return std::fabs(p.x - 7 * det::sin(p.y / 28)); }

Cover forest_floor(uint32_t seed, glm::vec3 position) {
  const glm::vec2 p(position.x, position.z);
  const float patch = gradient_noise(p / 5.0f, seed * 64 + 3).value,
              grain = gradient_noise(p / 0.8f, seed * 64 + 4).value;
  const glm::vec3 litter(0.17f, 0.11f, 0.06f), moss(0.08f, 0.13f, 0.03f), earth(0.30f, 0.24f, 0.17f);
  const float mossy = smooth_step(-0.15f, 0.3f, patch + 0.3f * grain);
  const float trodden = 1 - smooth_step(0.25f * path_width, 0.5f * path_width, from_path(p) + 0.5f * grain);
  const glm::vec3 color = litter + (moss - litter) * mossy;
  return {(color + (earth - color) * trodden) * (1 + 0.25f * grain), 0};
}

void add_ground(SceneBuilder& builder, float side, uint32_t seed) {
  const auto cells = static_cast<uint32_t>(std::clamp(side / 0.6f, 64.0f, 1024.0f));
  HeightGrid grid{side, cells, {{"forest floor", builder.material(matte("forest floor", glm::vec3(1)))}}, {}, {}};
  grid.height = [seed](glm::vec2 p) { return hill(p, seed); };
  grid.cover = [seed](glm::vec3 position, glm::vec3) { return forest_floor(seed, position); };
  builder.instance(builder.mesh("ground", make_height_grid(grid)), identity_transform, "ground");
}

/// A mesh for each variant of each species, in order.
std::vector<uint32_t> add_tree_meshes(SceneBuilder& builder, const std::vector<Leaves>& species, uint32_t seed) {
  const uint32_t pictures[3] = {builder.texture("leaves", leaf_spray(256, 7, 0.13f), Wrap::clamp_to_edge),
                                builder.texture("small leaves", leaf_spray(256, 13, 0.085f), Wrap::clamp_to_edge),
                                builder.texture("needles", needle_spray(256), Wrap::clamp_to_edge)};
  std::vector<TreeMesh> trees(species.size() * variants);
  parallel_for(trees.size(), 1, [&](uint64_t begin, uint64_t end) {
    for (uint64_t i = begin; i < end; ++i) {
      trees[i] = make_tree(species[i / variants].species, static_cast<uint32_t>(hash64(seed, i)));
    }
  });
  std::vector<uint32_t> meshes;
  for (size_t kind = 0; kind < species.size(); ++kind) {
    const std::string& name = species[kind].species.name;
    const uint32_t bark = builder.material(matte(name + " bark", species[kind].bark));
    Material leaf = glossy(name + " leaf", glm::vec3(1), 0.55f);
    leaf.base_color_texture = texture_ref(pictures[species[kind].picture]);
    leaf.alpha_mode = AlphaMode::mask;
    leaf.double_sided = true;
    const uint32_t leaf_material = builder.material(leaf);
    for (uint32_t i = 0; i < variants; ++i) {
      TreeMesh& tree = trees[kind * variants + i];
      tree.wood.material = bark;
      tree.leaves.material = leaf_material;
      meshes.push_back(builder.mesh(name + " " + std::to_string(i), {std::move(tree.wood), std::move(tree.leaves)}));
    }
  }
  return meshes;
}

/// One place in each cell of a grid, moved by up to 0.3 of its side: no two nearer than 0.4. None on the path. The
/// `count` that a hash puts first, in the grid's order.
std::vector<glm::vec2> scatter(uint32_t count, float side, uint32_t seed) {
  struct Place {
    uint64_t key;
    uint32_t cell;
    glm::vec2 p;
  };
  std::vector<Place> places;
  for (auto columns = static_cast<uint32_t>(std::sqrt(static_cast<float>(count))); places.size() < count; ++columns) {
    places.clear();
    const float cell = side / static_cast<float>(columns);
    for (uint32_t i = 0; i < columns * columns; ++i) {
      const glm::vec2 jitter = 0.3f * lattice_vector(static_cast<int32_t>(i), 0, seed);
      const glm::vec2 p = cell * (glm::vec2(i % columns, i / columns) + 0.5f + jitter) - 0.5f * side;
      if (from_path(p) > 0.5f * path_width + 0.6f) places.push_back({hash64(seed, i, 9u), i, p});
    }
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.key < b.key; });
  places.resize(count);
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.cell < b.cell; });
  std::vector<glm::vec2> result;
  for (const Place& place : places) result.push_back(place.p);
  return result;
}

size_t pick_species(const std::vector<Leaves>& species, float at) {
  size_t kind = 0;
  while (kind + 1 < species.size() && at >= species[kind].share) at -= species[kind++].share;
  return kind;
}

void plant(SceneBuilder& builder, uint32_t count, float side, uint32_t seed) {
  const std::vector<Leaves> species = make_species();
  const std::vector<uint32_t> meshes = add_tree_meshes(builder, species, seed);
  const std::vector<glm::vec2> places = scatter(count, side, seed);
  for (uint32_t i = 0; i < places.size(); ++i) {
    const auto random = [&](uint32_t what) { return unit_float(hash64(seed, i, what, 11u)); };
    // Like grows beside like, more or less.
    const float grove = gradient_noise(places[i] / 40.0f, seed * 64 + 5).value;
    const size_t kind =
        pick_species(species, std::clamp(0.5f + 0.45f * grove + 0.7f * (random(0) - 0.5f), 0.0f, 0.999f));
    const auto variant = static_cast<uint32_t>(random(1) * variants);
    const glm::vec3 foot(places[i].x, hill(places[i], seed), places[i].y);
    const glm::vec3 scale(glm::vec3(0.75f + 0.45f * random(2)));
    builder.instance(meshes[kind * variants + variant], placed(foot, 360 * random(3), scale),
                     species[kind].species.name + " " + std::to_string(i));
  }
}

void add_light(Scene& scene) {
  scene.environment.kind = Environment::Kind::gradient;
  scene.environment.zenith = {0.7f, 1.1f, 2.0f};
  scene.environment.horizon = {2.1f, 2.2f, 2.3f};
  scene.environment.nadir = {0.25f, 0.25f, 0.22f};
  Light sun;
  sun.kind = Light::Kind::directional;
  sun.name = "sun";
  sun.direction = {-0.48f, -0.8f, -0.36f};  // unit
  sun.intensity = {17, 15.5f, 12.5f};
  scene.lights.push_back(sun);
}

void add_cameras(SceneBuilder& builder, float side, uint32_t seed) {
  const auto on_path = [&](float z, float height) {
    const glm::vec2 p(7 * det::sin(z / 28), z);
    return glm::vec3(p.x, hill(p, seed) + height, p.y);
  };
  const float z = 0.22f * side;
  builder.camera("path", look_at(on_path(z, 1.8f), on_path(z - 22, 3.2f), {0, 1, 0}, 1.0f));
  builder.camera("above", look_at({0.1f * side, 0.22f * side + 15, 0.62f * side}, {0, 0, 0}, {0, 1, 0}, 0.75f));
  builder.camera("up", look_at(on_path(0.1f * side, 1.5f), on_path(0.1f * side - 9, 12), {0, 1, 0}, 1.2f));
}

}  // namespace

Scene make_forest(Parameters& parameters) {
  const auto count = static_cast<uint32_t>(parameters.get("trees", 4000, 1, 1000000));
  const auto seed = static_cast<uint32_t>(parameters.get("seed", 1, 0, 1000000));
  parameters.check_all_used();
  const float side = spacing * std::sqrt(static_cast<float>(count)) + 16;
  SceneBuilder builder;
  add_ground(builder, side, seed);
  plant(builder, count, side, seed);
  add_light(builder.scene());
  add_cameras(builder, side, seed);
  return builder.finish();
}

}  // namespace rayloom::scenes
