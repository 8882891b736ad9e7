#include <rayloom/accel/wide_tree.h>
#include <rayloom/base/parallel.h>

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

namespace rayloom::accel {
namespace {

constexpr uint32_t node_granules = sizeof(Node8) / granule_bytes;
/// Primitives below a node from which on its children are looked at in parallel.
constexpr uint32_t parallel_threshold = 16384;

/// A wide node and what lies below it, the node itself not counted in granules.
struct Part {
  ChildList children;
  uint32_t nodes, leaves, depth;
  uint32_t granules;
  double area;  ///< summed over nodes and leaves
};

/// Runs tasks at the same time where the work is large, else at once.
class Tasks {
 public:
  explicit Tasks(uint32_t primitives) {
    if (primitives >= parallel_threshold) group_.emplace();
  }
  template <class Task>
  void run(const Task& task) {
    if (group_)
      group_->run(task);
    else
      task();
  }
  void wait() {
    if (group_) group_->wait();
  }

 private:
  std::optional<TaskGroup> group_;
};

/// Counts subtrees bottom-up and then places them top-down, both in parallel.
class Layout {
 public:
  Layout(const BinaryTree& tree, uint64_t first_byte, const LeafBytes& leaf_bytes)
      : tree_(tree), collapse_(tree), leaf_bytes_(leaf_bytes), parts_(tree.size()) {
    count(0);
    const Part& whole = parts_[0];
    const auto first = static_cast<uint32_t>(first_byte / granule_bytes);
    wide_.nodes.resize(whole.nodes);
    place(0, 0, first, first + node_granules);
    wide_.bytes = first_byte + (uint64_t{node_granules} + whole.granules) * granule_bytes;
    wide_.depth = whole.depth;
    wide_.leaf_count = whole.leaves;
    const double root_area = tree[0].box.half_area();
    wide_.sah_cost = root_area > 0 ? whole.area / root_area : static_cast<double>(whole.nodes + wide_.leaf_count);
  }

  WideTree take() { return std::move(wide_); }

 private:
  ChildList children_of(uint32_t slot) const {
    if (!tree_[slot].is_leaf()) return collapse_.children(slot);
    ChildList only{};  // the root of a tree of one leaf
    only.push(slot);
    return only;
  }

  void count(uint32_t slot) {
    Part& part = parts_[slot];
    part.children = children_of(slot);
    Tasks tasks(tree_[slot].count);
    for (uint32_t i = 0; i < part.children.count; ++i)
      if (const uint32_t child = part.children.slot[i]; !tree_[child].is_leaf())
        tasks.run([this, child] { count(child); });
    tasks.wait();
    part.nodes = 1;
    part.leaves = part.depth = part.granules = 0;
    part.area = tree_[slot].box.half_area();
    for (uint32_t i = 0; i < part.children.count; ++i) add(part, part.children.slot[i]);
    ++part.depth;
  }

  void add(Part& part, uint32_t child) const {
    if (tree_[child].is_leaf()) {
      ++part.leaves;
      part.granules += leaf_bytes_[child];
      part.area += tree_[child].box.half_area();
    } else {
      const Part& below = parts_[child];
      part.nodes += below.nodes;
      part.leaves += below.leaves;
      part.depth = std::max(part.depth, below.depth);
      part.granules += node_granules + below.granules;
      part.area += below.area;
    }
  }

  /// Puts what is below the node from granule `next` on, and the nodes from `index` on in depth-first order.
  void place(uint32_t slot, uint32_t index, uint32_t ref, uint32_t next) {
    WideNode& node = wide_.nodes[index];
    node = {ref, parts_[slot].children, {}};
    const ChildList& list = node.children;
    for (uint32_t i = 0; i < list.count; ++i)
      if (!tree_[list.slot[i]].is_leaf()) node.child_ref[i] = std::exchange(next, next + node_granules);
    for (uint32_t i = 0; i < list.count; ++i)
      if (tree_[list.slot[i]].is_leaf())
        node.child_ref[i] = std::exchange(next, next + leaf_bytes_[list.slot[i]]) | node_ref::leaf_bit;
    Tasks tasks(tree_[slot].count);
    place_children(node, index + 1, next, tasks);
    tasks.wait();
  }

  void place_children(const WideNode& node, uint32_t index, uint32_t next, Tasks& tasks) {
    for (uint32_t i = 0; i < node.children.count; ++i) {
      if (node_ref::is_leaf(node.child_ref[i])) continue;
      const uint32_t child = node.children.slot[i];
      tasks.run([this, child, index, ref = node.child_ref[i], next] { place(child, index, ref, next); });
      index += parts_[child].nodes;
      next += parts_[child].granules;
    }
  }

  const BinaryTree& tree_;
  Collapse collapse_;
  const LeafBytes& leaf_bytes_;
  ScratchVector<Part> parts_;  ///< by slot of the binary tree, set for wide nodes
  WideTree wide_;
};

}  // namespace

WideTree make_wide_tree(const BinaryTree& tree, uint64_t first_byte, const LeafBytes& leaf_bytes) {
  assert(first_byte % granule_bytes == 0);
  return Layout(tree, first_byte, leaf_bytes).take();
}

}  // namespace rayloom::accel
