#include "tree.h"

#include "tube.h"

#include <rayloom/base/det_math.h>
#include <rayloom/base/hash.h>

#include <algorithm>
#include <cmath>

namespace rayloom::scenes {
namespace {

constexpr float pi = 3.14159265f, golden_angle = 2.39996323f;

glm::vec3 unit(glm::vec3 v) { return v / std::sqrt(glm::dot(v, v)); }

/// The middle line of a branch.
struct Path {
  std::vector<glm::vec3> points, directions;
  float radius;

  float thickness(float t) const { return radius * (1 - 0.85f * t); }
  glm::vec3 point(float t) const {
    const float at = t * static_cast<float>(points.size() - 1);
    const size_t i = std::min(static_cast<size_t>(at), points.size() - 2);
    return points[i] + (at - static_cast<float>(i)) * (points[i + 1] - points[i]);
  }
  glm::vec3 direction(float t) const {
    return directions[static_cast<size_t>(t * static_cast<float>(points.size() - 1))];
  }
};

class Grower {
 public:
  Grower(const TreeSpecies& species, uint32_t seed) : species_(species), seed_(seed) {
    tree_.wood.name = species.name + " wood";
    tree_.leaves.name = species.name + " leaves";
  }

  TreeMesh grow() {
    const float length = species_.orders[0].length * (0.85f + 0.3f * random());
    grow_branch(0, {0, -0.4f, 0}, {0, 1, 0}, length, species_.trunk_radius);
    return std::move(tree_);
  }

 private:
  float random() { return unit_float(hash64(seed_, draws_++)); }
  float signed_random() { return 2 * random() - 1; }

  void grow_branch(size_t order, glm::vec3 base, glm::vec3 direction, float length, float radius) {
    const Path path = bend(species_.orders[order], base, direction, length, radius);
    add_tube(tree_.wood, {path.points, path.directions, radius, path.thickness(1)}, species_.orders[order].sides);
    if (order + 1 < species_.orders.size()) {
      bear_branches(order + 1, path, length);
    } else {
      for (uint32_t i = 0; i < species_.leaves; ++i)
        add_leaf(path, (static_cast<float>(i) + random()) / static_cast<float>(species_.leaves));
    }
  }

  Path bend(const BranchOrder& order, glm::vec3 base, glm::vec3 direction, float length, float radius) {
    Path path{{base}, {direction}, radius};
    const float step = length / static_cast<float>(order.rings);
    for (uint32_t i = 0; i < order.rings; ++i) {
      const glm::vec3 drift(signed_random(), signed_random(), signed_random());
      direction =
          unit(direction + order.wander * drift + glm::vec3(0, order.lift / static_cast<float>(order.rings), 0));
      path.points.push_back(path.points.back() + step * direction);
      path.directions.push_back(direction);
    }
    return path;
  }

  void bear_branches(size_t order, const Path& path, float length) {
    const BranchOrder& kind = species_.orders[order];
    float around = 2 * pi * random();
    for (uint32_t i = 0; i < kind.count; ++i) {
      const float part = (static_cast<float>(i) + 0.8f * random()) / static_cast<float>(kind.count);
      const float t = kind.first + (0.98f - kind.first) * part;
      const float size = length * (kind.length + (kind.taper - kind.length) * part) * (0.75f + 0.5f * random());
      const glm::vec3 axis = path.direction(t);
      around += golden_angle + 0.4f * signed_random();
      const float angle = kind.angle * (pi / 180) * (0.8f + 0.4f * random());
      grow_branch(order, path.point(t), unit(leaning(axis, beside(axis), angle, around)), size,
                  std::min(0.65f * path.thickness(t), 0.04f * size));
    }
  }

  /// A card from the branch outwards, mostly to the side and upwards.
  void add_leaf(const Path& path, float t) {
    const glm::vec3 axis = path.direction(t), root = path.point(t);
    const glm::vec3 out =
        unit(leaning(axis, beside(axis), 0.5f + 0.7f * random(), 2 * pi * random()) + glm::vec3(0, 0.15f, 0));
    const glm::vec3 across = unit(glm::cross(out, glm::vec3(0.5f * signed_random(), 1, 0.5f * signed_random())));
    const float size = species_.leaf_size * (0.7f + 0.6f * random());
    const glm::vec3 wide = 0.5f * size * across, tip = size * out, normal = unit(glm::cross(wide, tip));
    const glm::vec4 tint(species_.leaf_tint * (0.75f + 0.5f * random()), 1.0f);
    Geometry& g = tree_.leaves;
    const auto first = static_cast<uint32_t>(g.positions.size());
    g.positions.insert(g.positions.end(), {root - wide, root + wide, root + wide + tip, root - wide + tip});
    g.uv0.insert(g.uv0.end(), {glm::vec2(0, 1), glm::vec2(1, 1), glm::vec2(1, 0), glm::vec2(0, 0)});
    g.normals.insert(g.normals.end(), 4, normal);
    g.colors.insert(g.colors.end(), 4, tint);
    g.indices.insert(g.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  }

  const TreeSpecies& species_;
  uint32_t seed_;
  uint32_t draws_ = 0;
  TreeMesh tree_;
};

}  // namespace

TreeMesh make_tree(const TreeSpecies& species, uint32_t seed) { return Grower(species, seed).grow(); }

}  // namespace rayloom::scenes
