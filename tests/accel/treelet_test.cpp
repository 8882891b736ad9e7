#include <rayloom/accel/treelet.h>

#include <catch2/catch.hpp>

#include <functional>
#include <map>
#include <set>

#include "random.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

struct Tree {
  std::vector<LooseNode> nodes;
  BoxArea area{Box{{-1, -1, -1}, {1, 1, 1}}};

  uint32_t leaf(const Box4& box, uint32_t count) {
    LooseNode node;
    node.box = box;
    node.count = count;
    node.area = node.cost = area(box);
    nodes.push_back(node);
    return static_cast<uint32_t>(nodes.size() - 1);
  }
  uint32_t inner(uint32_t left, uint32_t right, uint32_t leaf_size) {
    LooseNode node;
    node.box = nodes[left].box;
    node.box.extend(nodes[right].box);
    node.left = left;
    node.right = right;
    node.count = nodes[left].count + nodes[right].count;
    node.area = area(node.box);
    const float split = node.area * inner_cost + nodes[left].cost + nodes[right].cost;
    node.cost = better_as_leaf(node.area, node.count, split, leaf_size) ? node.area : split;
    nodes.push_back(node);
    return static_cast<uint32_t>(nodes.size() - 1);
  }
};

Box4 random_box(Random& random) {
  Box4 box;
  for (int corner = 0; corner < 2; ++corner) {
    const Float4 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), 0};
    box.extend(p, p);
  }
  return box;
}

/// A chain of seven leaves; slot 0 stays unused, as 0 means "no child".
uint32_t chain(Tree& tree, uint32_t leaf_size, Random& random) {
  tree.leaf(random_box(random), 1);
  std::vector<uint32_t> leaves;
  for (uint32_t i = 0; i < treelet_leaves; ++i) leaves.push_back(tree.leaf(random_box(random), 1 + random.below(5)));
  uint32_t root = leaves[0];
  for (uint32_t i = 1; i < treelet_leaves; ++i) root = tree.inner(leaves[i], root, leaf_size);
  return root;
}

/// The least cost by trying every tree over every subset, boxes made anew each time.
float least_cost(const Tree& tree, const std::vector<uint32_t>& leaves, uint32_t leaf_size) {
  std::map<uint32_t, float> known;
  const std::function<float(uint32_t)> solve = [&](uint32_t set) -> float {
    if (known.count(set)) return known[set];
    Box4 box;
    uint32_t count = 0;
    for (uint32_t i = 0; i < leaves.size(); ++i)
      if (set >> i & 1) box.extend(tree.nodes[leaves[i]].box), count += tree.nodes[leaves[i]].count;
    const float area = tree.area(box);
    float best = Box::infinity;
    for (uint32_t part = set & (set - 1); part != 0; part = (part - 1) & set)
      best = std::min(best, area * inner_cost + (solve(part) + solve(set ^ part)));
    if (set == (set & -set)) best = area;
    if (count <= leaf_size) best = std::min(best, area);
    return known[set] = best;
  };
  return solve((1u << leaves.size()) - 1);
}

void check_subtree(const Tree& tree, uint32_t slot, std::set<uint32_t>& seen) {
  REQUIRE(seen.insert(slot).second);
  const LooseNode& node = tree.nodes[slot];
  if (node.is_leaf()) return;
  const LooseNode &left = tree.nodes[node.left], &right = tree.nodes[node.right];
  CHECK(node.count == left.count + right.count);
  Box4 both = left.box;
  both.extend(right.box);
  CHECK(node.area == tree.area(both));
  check_subtree(tree, node.left, seen);
  check_subtree(tree, node.right, seen);
}

}  // namespace

TEST_CASE("a treelet of seven leaves becomes the cheapest tree over them") {
  Random random(101);
  int improved = 0;
  for (int round = 0; round < 200; ++round) {
    const uint32_t leaf_size = round % 2 ? 8 : 1;
    Tree tree;
    const uint32_t root = chain(tree, leaf_size, random);
    const float before = tree.nodes[root].cost;
    restructure_treelet(tree.nodes, root, tree.area, leaf_size);
    const float after = tree.nodes[root].cost;
    improved += after < before;
    CHECK(after <= before);
    CHECK(after == Approx(least_cost(tree, {1, 2, 3, 4, 5, 6, 7}, leaf_size)));
    std::set<uint32_t> seen;
    check_subtree(tree, root, seen);
    CHECK(seen.size() == 13);
  }
  CHECK(improved > 150);
}

TEST_CASE("treelets of two leaves stay as they are") {
  Random random(102);
  Tree tree;
  const uint32_t a = tree.leaf(random_box(random), 1), b = tree.leaf(random_box(random), 1);
  const uint32_t root = tree.inner(a, b, 1);
  restructure_treelet(tree.nodes, root, tree.area, 1);
  CHECK(tree.nodes[root].left == a);
  CHECK(tree.nodes[root].right == b);
}

TEST_CASE("areas are compared in one scale, however large or small the boxes") {
  for (const float size : {1e-40f, 1e-20f, 1.0f, 1e20f, 3e38f}) {
    const BoxArea area(Box{{-size, -size, -size}, {size, size, size}});
    const auto cube = [&](float half) { return Box4{splat(-half), splat(half)}; };
    const float whole = area(cube(size));
    CHECK(whole >= (size > 1e-38f ? 3 : 1e-3f));  // 2^127 is the largest scale
    CHECK(whole <= 12);
    CHECK(area(cube(size / 2)) == Approx(whole / 4).epsilon(1e-4));
    CHECK(area(cube(0)) == 0);
  }
}
