#include <rayloom/accel/chunks.h>
#include <rayloom/accel/lbvh.h>
#include <rayloom/accel/lbvh_treelets.h>
#include <rayloom/accel/sequence_tree.h>
#include <rayloom/accel/treelet.h>

#include <algorithm>

namespace rayloom::accel {
namespace {

/// Primitives in a leaf of the tree that is restructured; final leaves are made of several.
constexpr uint32_t granule = 4;
/// Smallest subtree of each round, in granules; later rounds leave the lower treelets as they are.
constexpr uint32_t smallest_subtrees[] = {7, 14};
constexpr uint32_t parallel_threshold = 4096;

class TreeletBuilder {
 public:
  TreeletBuilder(const BuiltTree& start, const TreeInput& input)
      : start_(start), leaf_size_(input.leaf_size), area_(start.tree[0].box), nodes_(start.tree.size()) {
    loosen();
    evaluate(0);
    for (const uint32_t smallest : smallest_subtrees) restructure(0, smallest * granule);
    built_.refs.resize(start.refs.size());
    built_.tree.resize(2 * input.leaf_budget - 1);
    const auto count = static_cast<uint32_t>(start.refs.size());
    emit(0, {0, 0, count, static_cast<uint32_t>(input.leaf_budget), 0});
  }

  BuiltTree take() { return std::move(built_); }

 private:
  void loosen() {
    for_each_chunk(nodes_.size(), [&](size_t, size_t begin, size_t end) {
      for (size_t slot = begin; slot < end; ++slot) {
        const BinaryNode& from = start_.tree[slot];
        if (from.count == 0) continue;
        LooseNode& node = nodes_[slot];
        node = {};
        node.box = box4(from.box);
        node.first = from.first;
        node.count = from.count;
        node.area = area_(node.box);
        if (!from.is_leaf()) node.left = static_cast<uint32_t>(slot) + 1, node.right = from.right;
      }
    });
  }

  template <class Visit>
  void visit_children(const LooseNode& node, const Visit& visit) {
    const uint32_t left = node.left, right = node.right;
    if (node.count >= parallel_threshold) {
      parallel_invoke([&visit, left] { visit(left); }, [&visit, right] { visit(right); });
    } else {
      visit(left);
      visit(right);
    }
  }

  float split_cost(const LooseNode& node) const {
    return node.area * inner_cost + nodes_[node.left].cost + nodes_[node.right].cost;
  }
  bool is_final_leaf(const LooseNode& node) const {
    return node.is_leaf() || better_as_leaf(node.area, node.count, split_cost(node), leaf_size_);
  }

  void evaluate(uint32_t slot) {
    LooseNode& node = nodes_[slot];
    if (!node.is_leaf()) visit_children(node, [this](uint32_t child) { evaluate(child); });
    node.cost = is_final_leaf(node) ? node.area : split_cost(node);
  }

  /// Bottom-up: children first, on treelets of at least `smallest` primitives.
  void restructure(uint32_t slot, uint32_t smallest) {
    LooseNode& node = nodes_[slot];
    if (node.is_leaf() || node.count < smallest) return;
    visit_children(node, [this, smallest](uint32_t child) { restructure(child, smallest); });
    node.cost = is_final_leaf(node) ? node.area : split_cost(node);
    restructure_treelet(nodes_, slot, area_, leaf_size_);
  }

  /// Writes the subtree as its costs say, or its primitives in their order where budget or depth leave no choice.
  void emit(uint32_t slot, const Subtree& subtree) {
    const LooseNode& node = nodes_[slot];
    if (is_final_leaf(node) || !fits(node, subtree)) {
      gather(slot, subtree.first);
      return build_sequence(built_.refs, leaf_size_, subtree, built_.tree);
    }
    const auto [left, right] = halves_of(subtree, nodes_[node.left].count, leaf_size_);
    built_.tree[subtree.slot] = {node.box.box(), subtree.first, subtree.count, right.slot};
    build_halves(left, right, [&, this, first = left.first](const Subtree& half) {
      emit(half.first == first ? node.left : node.right, half);
    });
  }

  bool fits(const LooseNode& node, const Subtree& subtree) const {
    const uint32_t left = nodes_[node.left].count;
    return subtree.depth < max_choice_depth &&
           blocks_for(left, leaf_size_) + blocks_for(node.count - left, leaf_size_) <= subtree.budget;
  }

  /// Copies the primitives below a node, left to right; returns where the next ones go.
  uint32_t gather(uint32_t slot, uint32_t to) {
    const LooseNode& node = nodes_[slot];
    if (!node.is_leaf()) return gather(node.right, gather(node.left, to));
    std::copy_n(start_.refs.begin() + node.first, node.count, built_.refs.begin() + to);
    return to + node.count;
  }

  const BuiltTree& start_;
  uint32_t leaf_size_;
  BoxArea area_;
  ScratchVector<LooseNode> nodes_;
  BuiltTree built_;
};

/// What the tree to restructure is built as: small leaves, as many as it likes.
TreeInput granules(const TreeInput& input, size_t references) {
  TreeInput small = input;
  small.leaf_size = std::min(granule, input.leaf_size);
  small.leaf_budget = std::min<uint64_t>(references, 2 * blocks_for(references, small.leaf_size));
  return small;
}

}  // namespace

BuiltTree build_lbvh_treelets(const PrimitiveRefs& refs, const TreeInput& input) {
  const BuiltTree start = build_lbvh(refs, granules(input, refs.size()));
  return TreeletBuilder(start, input).take();
}

}  // namespace rayloom::accel
