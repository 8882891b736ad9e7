#pragma once

// Walks a whole structure and checks what layout.h promises of it.

#include <catch2/catch.hpp>

#include <set>

#include "structures.h"

namespace rayloom::accel::test {

struct TreeFacts {
  uint32_t depth = 0;
  uint64_t nodes = 0, leaves = 0, primitives = 0;
  std::set<std::pair<uint32_t, uint32_t>> names;  ///< (geometry, primitive); (0, index) for instances
};

class StructureChecker {
 public:
  explicit StructureChecker(const Block& block) : block_(block), header_(block.header()) {
    if (header_.root != no_index) node(header_.root, 1);
    CHECK(facts.depth == header_.depth);
    CHECK(facts.depth <= max_depth);
    CHECK(facts.nodes == header_.node_count);
    CHECK(facts.leaves == header_.leaf_count);
    if (!splits()) CHECK(facts.primitives == header_.active_count);
    CHECK(facts.primitives >= header_.active_count);
    CHECK(facts.names.size() == header_.active_count);
    CHECK(header_.bytes == block.used);
    CHECK(header_.bytes <= block.size());
    const uint64_t slack =
        header_.kind == StructureKind::triangles && facts.nodes > 0 ? TriangleLeaf::overread_bytes : 0;
    CHECK(header_.bytes == sizeof(StructureHeader) + facts.nodes * sizeof(Node8) + leaf_bytes_ + slack);
  }

  TreeFacts facts;

 private:
  /// Triangles may lie in several leaves then, and stick out of a leaf's box; instances, when re-braided.
  bool splits() const {
    return static_cast<Builder>(header_.builder) == Builder::spatial_splits || header_.kind == StructureKind::instances;
  }

  uint64_t bytes_of(const std::byte* leaf) const {
    switch (header_.kind) {
      case StructureKind::triangles:
        return reinterpret_cast<const TriangleLeaf*>(leaf)->bytes();
      case StructureKind::procedurals:
        return sizeof(ProceduralLeaf8);
      default:
        return sizeof(InstanceRecord);
    }
  }

  /// Returns the box that the node gives its children together.
  Box node(uint32_t ref, uint32_t depth) {
    const auto& n = *reinterpret_cast<const Node8*>(block_.data() + node_ref::offset(ref));
    facts.depth = std::max(facts.depth, depth);
    ++facts.nodes;
    Box whole;
    for (int i = 0; i < 8; ++i) {
      Box box;
      for (int k = 0; k < 3; ++k) {
        box.min[k] = n.bounds[k][0][i];
        box.max[k] = n.bounds[k][1][i];
      }
      if (box.min[0] > box.max[0]) continue;
      const Box inner = node_ref::is_leaf(n.child[i]) ? leaf(n.child[i]) : node(n.child[i], depth + 1);
      for (int k = 0; k < 3; ++k) {
        broken_ += !(box.min[k] <= inner.min[k] && inner.max[k] <= box.max[k]);
      }
      whole.extend(box);
    }
    if (depth == 1) CHECK(broken_ == 0);
    return whole;
  }

  Box leaf(uint32_t ref) {
    ++facts.leaves;
    const std::byte* address = block_.data() + node_ref::offset(ref);
    leaf_bytes_ += bytes_of(address);
    if (header_.kind == StructureKind::triangles) return triangles(*reinterpret_cast<const TriangleLeaf*>(address));
    if (header_.kind == StructureKind::procedurals) return boxes(*reinterpret_cast<const ProceduralLeaf8*>(address));
    count(0, reinterpret_cast<const InstanceRecord*>(address)->instance_index);
    return {};
  }

  Box triangles(const TriangleLeaf& leaf) {
    Box box;
    REQUIRE(leaf.count > 0);
    REQUIRE(leaf.count <= leaf_lanes);
    for (uint32_t lane = 0; lane < leaf.count; ++lane) {
      count(leaf.geometry_of(lane) & 0xFFFFFF, leaf.primitive[lane]);
      if (splits()) continue;
      for (uint32_t v = 0; v < 3; ++v)
        box.extend({leaf.coordinate(v, 0, lane), leaf.coordinate(v, 1, lane), leaf.coordinate(v, 2, lane)});
    }
    return box;
  }

  Box boxes(const ProceduralLeaf8& leaf) {
    Box box;
    for (int lane = 0; lane < 8; ++lane) {
      if (leaf.primitive[lane] == no_index) continue;
      count(leaf.geometry[lane] & 0xFFFFFF, leaf.primitive[lane]);
      const auto& b = leaf.bounds;
      box.extend({b[0][0][lane], b[1][0][lane], b[2][0][lane]}, {b[0][1][lane], b[1][1][lane], b[2][1][lane]});
    }
    return box;
  }

  void count(uint32_t geometry, uint32_t primitive) {
    ++facts.primitives;
    facts.names.insert({geometry, primitive});
  }

  const Block& block_;
  const StructureHeader& header_;
  int broken_ = 0;
  uint64_t leaf_bytes_ = 0;
};

}  // namespace rayloom::accel::test
