#include <rayloom/accel/binary_tree.h>
#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/collapse.h>
#include <rayloom/accel/partition.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/wide_tree.h>

#include <catch2/catch.hpp>

#include <set>

#include "random.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

std::vector<PrimitiveRef> random_refs(size_t count, uint64_t seed, uint32_t clusters = 1000000) {
  Random random(seed);
  std::vector<PrimitiveRef> refs;
  for (uint32_t i = 0; i < count; ++i) {
    Random place(seed + random.below(clusters));
    Box box;
    const float c[3] = {place.uniform(-1, 1), place.uniform(-1, 1), place.uniform(-1, 1)};
    box.extend(c, {c[0] + 0.01f, c[1] + 0.01f, c[2] + 0.01f});
    refs.push_back(make_primitive_ref(box, 0, i));
  }
  return refs;
}

struct Facts {
  uint64_t leaves = 0, primitives = 0, largest_leaf = 0;
  uint32_t depth = 0;
};

void walk_binary(const BinaryTree& tree, uint32_t slot, uint32_t depth, Facts& facts) {
  const BinaryNode& node = tree[slot];
  facts.depth = std::max(facts.depth, depth);
  if (node.is_leaf()) {
    ++facts.leaves;
    facts.primitives += node.count;
    facts.largest_leaf = std::max<uint64_t>(facts.largest_leaf, node.count);
    return;
  }
  REQUIRE(tree[slot + 1].count + tree[node.right].count == node.count);
  REQUIRE(tree[node.right].first == node.first + tree[slot + 1].count);
  walk_binary(tree, slot + 1, depth + 1, facts);
  walk_binary(tree, node.right, depth + 1, facts);
}

Facts facts_of(const BinaryTree& tree) {
  Facts facts;
  walk_binary(tree, 0, 1, facts);
  return facts;
}

}  // namespace

TEST_CASE("trees keep to any budget of leaves, down to full leaves") {
  for (const uint32_t clusters : {1u, 7u, 1000000u})
    for (const uint32_t leaf_size : {1u, 8u})
      for (const size_t count : {1u, 9u, 100u, 5000u}) {
        const uint64_t full = blocks_for(count, leaf_size);
        for (const uint64_t budget : {full, full + 1, full + full / 2 + 6}) {
          auto refs = random_refs(count, 51, clusters);
          const BinaryTree tree = build_binary_tree(refs, {leaf_size, budget});
          const Facts facts = facts_of(tree);
          CHECK(facts.primitives == count);
          CHECK(facts.leaves <= budget);
          CHECK(facts.largest_leaf <= leaf_size);
          CHECK(facts.depth <= max_depth);
        }
      }
}

TEST_CASE("a tree does not depend on the order of its input") {
  auto refs = random_refs(3000, 52, 500), shuffled = refs;
  std::reverse(shuffled.begin(), shuffled.end());
  std::swap_ranges(shuffled.begin(), shuffled.begin() + 1000, shuffled.begin() + 2000);
  const BinaryTree a = build_binary_tree(refs, {8, 600}), b = build_binary_tree(shuffled, {8, 600});
  REQUIRE(a.size() == b.size());
  for (size_t i = 0; i < refs.size(); ++i) REQUIRE(refs[i].primitive == shuffled[i].primitive);
  for (size_t i = 0; i < a.size(); ++i) REQUIRE((a[i].right == b[i].right && a[i].count == b[i].count));
}

TEST_CASE("a split by cost separates two clusters") {
  std::vector<PrimitiveRef> refs;
  for (uint32_t i = 0; i < 32; ++i) {
    Box box;
    const float x = i % 2 ? 10.f : 0.f;
    box.extend({x, 0, 0}, {x + 1, 1 + static_cast<float>(i), 1});
    refs.push_back(make_primitive_ref(box, 0, i));
  }
  const auto split = find_binned_split(refs, bounds_of(refs).centres, 8, 4);
  REQUIRE(split);
  CHECK(split->axis == 0);
  std::vector<PrimitiveRef> scratch(refs.size());
  const size_t left = partition_by_split(refs, scratch, *split);
  CHECK(left == 16);
  for (size_t i = 0; i < refs.size(); ++i) CHECK(refs[i].primitive % 2 == (i < left ? 0 : 1));
  CHECK(!find_binned_split(refs, bounds_of(refs).centres, 8, 3));
}

TEST_CASE("a median split leaves a multiple of the leaf size on the left") {
  for (const uint32_t leaf_size : {1u, 8u})
    for (size_t count = leaf_size + 1; count < 100; ++count) {
      auto refs = random_refs(count, 53, 3);
      const size_t left = partition_by_median(refs, bounds_of(refs).centres, leaf_size);
      CHECK(left % leaf_size == 0);
      CHECK((left > 0 && left < count));
      CHECK(blocks_for(left, leaf_size) + blocks_for(count - left, leaf_size) == blocks_for(count, leaf_size));
    }
}

TEST_CASE("wide nodes cover each leaf once, absorb what fits and order their children") {
  for (const uint32_t clusters : {1u, 20u, 1000000u}) {
    auto refs = random_refs(4000, 54, clusters);
    const BinaryTree tree = build_binary_tree(refs, {1, 4000});
    const WideTree wide = make_wide_tree(tree, 128, LeafBytes(tree.size(), sizeof(InstanceRecord) / granule_bytes));
    CHECK(wide.leaf_count == 4000);
    CHECK(wide.nodes.size() <= node_bound(4000));
    CHECK(wide.bytes == 128 + wide.nodes.size() * sizeof(Node8) + 4000 * sizeof(InstanceRecord));
    std::set<uint32_t> refs_seen;
    std::vector<uint32_t> count_of(wide.bytes / granule_bytes);
    for (const WideNode& node : wide.nodes) count_of[node.ref] = node.children.count;
    for (const WideNode& node : wide.nodes) {
      REQUIRE(node.children.count >= 2);
      for (uint32_t i = 0; i < node.children.count; ++i) {
        const bool leaf = node_ref::is_leaf(node.child_ref[i]);
        REQUIRE(leaf == tree[node.children.slot[i]].is_leaf());
        REQUIRE(refs_seen.insert(node.child_ref[i]).second);
        if (!leaf) REQUIRE(node.children.count - 1 + count_of[node.child_ref[i]] > node_width);
        if (i == 0) continue;
        const bool before_leaf = node_ref::is_leaf(node.child_ref[i - 1]);
        REQUIRE(before_leaf <= leaf);
        if (before_leaf == leaf)
          REQUIRE(tree[node.children.slot[i - 1]].box.half_area() <= tree[node.children.slot[i]].box.half_area());
      }
    }
    CHECK(refs_seen.size() == wide.nodes.size() - 1 + 4000);
  }
}

TEST_CASE("nodes and leaves are well filled") {
  auto refs = random_refs(20000, 55);
  const BinaryTree tree = build_binary_tree(refs, {8, 3756});
  const WideTree wide = make_wide_tree(tree, 128, LeafBytes(tree.size(), sizeof(PlainTriangleLeaf) / granule_bytes));
  const auto children = static_cast<double>(wide.nodes.size() - 1 + wide.leaf_count);
  CHECK(children / static_cast<double>(wide.nodes.size()) > 5.5);
  CHECK(20000.0 / static_cast<double>(wide.leaf_count) > 6.5);
}
