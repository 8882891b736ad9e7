#include <rayloom/accel/chunks.h>
#include <rayloom/accel/loose_tree.h>

namespace rayloom::accel {

namespace {
constexpr uint32_t parallel_threshold = 4096;
}

LooseTree::LooseTree(const BinaryTree& tree, uint32_t leaf_size)
    : leaf_size_(leaf_size), area_(tree[0].box), nodes_(tree.size()) {
  for_each_chunk(tree.size(), [&](size_t, size_t begin, size_t end) { loosen(tree, begin, end); });
  evaluate(0);
}

void LooseTree::loosen(const BinaryTree& tree, size_t begin, size_t end) {
  for (size_t slot = begin; slot < end; ++slot) {
    const BinaryNode& from = tree[slot];
    if (from.count == 0) continue;
    LooseNode& node = nodes_[slot];
    node = {};
    node.box = box4(from.box);
    node.first = from.first;
    node.count = from.count;
    node.area = area_(node.box);
    if (!from.is_leaf()) node.left = static_cast<uint32_t>(slot) + 1, node.right = from.right;
  }
}

template <class Visit>
void LooseTree::visit_children(const LooseNode& node, const Visit& visit) {
  const uint32_t left = node.left, right = node.right;
  if (node.count >= parallel_threshold) {
    parallel_invoke([&visit, left] { visit(left); }, [&visit, right] { visit(right); });
  } else {
    visit(left);
    visit(right);
  }
}

void LooseTree::evaluate(uint32_t slot) {
  LooseNode& node = nodes_[slot];
  if (!node.is_leaf()) visit_children(node, [this](uint32_t child) { evaluate(child); });
  node.cost = is_final_leaf(node) ? node.area : split_cost(node);
}

void LooseTree::restructure_below(uint32_t slot, uint32_t smallest) {
  LooseNode& node = nodes_[slot];
  if (node.is_leaf() || node.count < smallest) return;
  visit_children(node, [this, smallest](uint32_t child) { restructure_below(child, smallest); });
  node.cost = is_final_leaf(node) ? node.area : split_cost(node);
  restructure_treelet(nodes_, slot, area_, leaf_size_);
}

}  // namespace rayloom::accel
