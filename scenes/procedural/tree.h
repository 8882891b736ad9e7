#pragma once

// Trees: branches that bear branches, and cards of leaves or needles on the thinnest.

#include <rayloom/scenes/scene.h>

#include <string>
#include <vector>

namespace rayloom::scenes {

/// How the branches of one order are, and how many the order below bears. Order 0 is the trunk.
struct BranchOrder {
  uint32_t count;         ///< on each branch of the order before; 1 for the trunk
  float first;            ///< they begin at this part of the bearing branch's length
  float angle;            ///< degrees from its direction
  float length, taper;    ///< in parts of its length, at the first and at the last of them; metres for the trunk
  float lift;             ///< how much they bend upwards (or down) along their length
  float wander;           ///< how crooked they are
  uint32_t sides, rings;  ///< of the tube
};

struct TreeSpecies {
  std::string name;
  float trunk_radius;               ///< metres
  std::vector<BranchOrder> orders;  ///< the last bears the leaves
  uint32_t leaves;                  ///< cards on each branch of the last order
  float leaf_size;                  ///< metres
  glm::vec3 leaf_tint;              ///< times the texture's colour; each card a little different
};

struct TreeMesh {
  Geometry wood;    ///< closed tubes
  Geometry leaves;  ///< quads, for a masked material whose picture grows from the middle of its lower edge
};

/// A tree with its foot around the origin, a little below y = 0.
TreeMesh make_tree(const TreeSpecies& species, uint32_t seed);

}  // namespace rayloom::scenes
