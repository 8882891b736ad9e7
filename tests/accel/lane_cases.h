#pragma once

// Nodes and leaves of eight lanes, from ordinary to absurd.

#include "triangle_cases.h"

#include <rayloom/accel/layout.h>
#include <rayloom/accel/prepared_ray.h>

#include <vector>

namespace rayloom::accel::test {

struct NodeCase {
  Node8 node;
  PreparedRay ray;
  uint32_t empty_lanes;
};

/// A leaf of `count` lanes with vertices of their own.
inline PlainTriangleLeaf plain_leaf(uint32_t count) {
  PlainTriangleLeaf leaf{};
  leaf.count = static_cast<uint8_t>(count);
  leaf.slots = TriangleLeaf::plain_slots;
  leaf.mixed = 1;
  for (uint32_t i = 0; i < 24; ++i) leaf.corner[i / 8][i % 8] = static_cast<uint8_t>(i);
  for (uint32_t lane = 0; lane < 8; ++lane) leaf.primitive[lane] = lane < count ? lane : no_index;
  return leaf;
}

struct LeafCase {
  PlainTriangleLeaf leaf;
  PreparedRay ray;
  uint32_t unused_lanes;
};

/// One coordinate: ordinary, on a grid, of any finite size.
inline float any_coordinate(Random& random, uint32_t style) {
  if (style == 0) return random.uniform(-4, 4);
  if (style == 1) return static_cast<float>(random.below(9)) - 4;
  return style == 2 ? random.scaled(-149, 128) : random.any_finite();
}

inline Ray any_ray(Random& random, uint32_t style) {
  Ray ray{{}, 0, {}, std::numeric_limits<float>::infinity()};
  for (int k = 0; k < 3; ++k) {
    ray.origin[k] = any_coordinate(random, style);
    ray.direction[k] = random.chance(4) ? (random.chance(2) ? 0.0f : -0.0f) : any_coordinate(random, style);
  }
  if (random.chance(4)) ray.t_min = std::fabs(any_coordinate(random, style));
  if (random.chance(4)) ray.t_max = ray.t_min + std::fabs(any_coordinate(random, style));
  return ray;
}

inline NodeCase random_node_case(Random& random) {
  NodeCase out{};
  const uint32_t style = random.below(4);
  float low[3], high[3];
  std::fill_n(low, 3, std::numeric_limits<float>::infinity());
  std::fill_n(high, 3, -std::numeric_limits<float>::infinity());
  out.empty_lanes = static_cast<uint32_t>(random.bits() & random.bits() & 0xFF);
  for (uint32_t lane = 0; lane < 8; ++lane) {
    for (int k = 0; k < 3; ++k) {
      const bool empty = (out.empty_lanes >> lane & 1) != 0;
      const float a = any_coordinate(random, style), b = random.chance(8) ? a : any_coordinate(random, style);
      out.node.bounds[k][0][lane] = empty ? std::numeric_limits<float>::infinity() : std::min(a, b);
      out.node.bounds[k][1][lane] = empty ? -std::numeric_limits<float>::infinity() : std::max(a, b);
      low[k] = std::min(low[k], out.node.bounds[k][0][lane]);
      high[k] = std::max(high[k], out.node.bounds[k][1][lane]);
    }
  }
  if (out.empty_lanes == 0xFF) std::fill_n(low, 3, 0.0f), std::fill_n(high, 3, 0.0f);
  out.ray = prepare_ray(any_ray(random, style), low, high, random.chance(4) ? 1 + std::fabs(random.scaled(0, 30)) : 1);
  return out;
}

/// A leaf over a table, and room for what vectors read beyond it.
struct TableLeafCase {
  alignas(32) std::byte bytes[TriangleLeaf::bytes(TriangleLeaf::table_slots, true) + TriangleLeaf::overread_bytes] = {};
  PreparedRay ray;
  TriangleLeaf& leaf() { return *reinterpret_cast<TriangleLeaf*>(bytes); }
};

inline TableLeafCase random_table_leaf_case(Random& random) {
  TableLeafCase out;
  const Family family = all_families[random.below(static_cast<uint32_t>(all_families.size()))];
  const float box[2][3] = {{-1, -1, -1}, {1, 1, 1}};
  out.ray = prepare_ray(random_case(random, family).ray, box[0], box[1]);
  TriangleLeaf& leaf = out.leaf();
  leaf.slots = static_cast<uint8_t>(3 + random.below(TriangleLeaf::table_slots - 2));
  leaf.count = static_cast<uint8_t>(1 + random.below(8));
  for (uint32_t i = 0; i < leaf.slots; ++i) {
    const Case c = random_case(random, family);
    for (uint32_t axis = 0; axis < 3; ++axis) leaf.row(axis)[i] = c.triangle[i % 3][axis];
  }
  for (auto& vertex : leaf.corner)
    for (uint32_t lane = 0; lane < leaf.count; ++lane) vertex[lane] = static_cast<uint8_t>(random.below(leaf.slots));
  return out;
}

inline LeafCase random_leaf_case(Random& random) {
  LeafCase out{};
  const Family family = all_families[random.below(static_cast<uint32_t>(all_families.size()))];
  const Case first = random_case(random, family);
  const float box[2][3] = {{-1, -1, -1}, {1, 1, 1}};
  out.ray = prepare_ray(first.ray, box[0], box[1]);
  const uint32_t count = 1 + random.below(8);
  out.leaf = plain_leaf(count);
  out.unused_lanes = 0xFFu << count & 0xFF;
  for (uint32_t lane = 0; lane < 8; ++lane) {
    const bool unused = lane >= count;
    const Case c = lane == 0 ? first : random_case(random, family);
    const float poison =
        random.chance(2) ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
    const bool poisoned = random.chance(20);
    for (int vertex = 0; vertex < 3; ++vertex) {
      for (int k = 0; k < 3; ++k) {
        out.leaf.vertex[k][vertex][lane] = unused                         ? std::numeric_limits<float>::quiet_NaN()
                                           : poisoned && random.chance(3) ? poison
                                                                          : c.triangle[vertex][k];
      }
    }
  }
  return out;
}

}  // namespace rayloom::accel::test
