#include <rayloom/accel/chunks.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/reinsertion.h>

#include <numeric>

namespace rayloom::accel {
namespace {

constexpr uint32_t none = UINT32_MAX;

/// Small trees are worth trying every node; and no search may go through all of a tree whose boxes all overlap.
constexpr size_t least_candidates = 4096;
constexpr uint32_t most_visits = 1024;

/// A node with links both ways; numbered in depth-first order at first, the root is 0.
struct Node {
  Box box;
  float area = 0;  ///< half of the surface, relative to the root's
  uint32_t parent = none;
  uint32_t child[2] = {none, none};  ///< none: a leaf
  uint32_t leaf = 0;                 ///< the leaf's slot in the tree it comes from
  bool is_leaf() const { return child[0] == none; }
};

/// Move `node`, with its parent, to between `target` and target's parent. A gain of 0 moves nothing.
struct Move {
  float gain = 0;
  uint32_t node = none, target = none;
};

Box together(Box a, const Box& b) {
  a.extend(b);
  return a;
}

class Reinsertion {
 public:
  Reinsertion(const BinaryTree& tree) : source_(tree) {
    const double area = tree[0].box.half_area();
    scale_ = area > 0 ? 1 / area : 0;
    add(0, none);
    touched_.resize(nodes_.size());
  }

  void round(uint32_t share) {
    const std::vector<uint32_t> candidates = largest(std::max(nodes_.size() / share, least_candidates));
    std::vector<Move> moves(candidates.size());
    parallel_for(candidates.size(), 64, [&](uint64_t begin, uint64_t end) {
      for (uint64_t i = begin; i < end; ++i) moves[i] = best_move(candidates[i]);
    });
    apply(moves);
    refit();
  }

  BinaryTree finish() const {
    BinaryTree tree;
    tree.reserve(nodes_.size());
    emit(0, tree);
    return tree;
  }

  uint32_t depth(uint32_t node = 0) const {
    const Node& n = nodes_[node];
    return n.is_leaf() ? 0 : 1 + std::max(depth(n.child[0]), depth(n.child[1]));
  }

 private:
  float area_of(const Box& box) const { return static_cast<float>(box.half_area() * scale_); }

  uint32_t add(uint32_t slot, uint32_t parent) {
    const auto index = static_cast<uint32_t>(nodes_.size());
    const BinaryNode& from = source_[slot];
    nodes_.push_back({from.box, area_of(from.box), parent, {none, none}, slot});
    if (from.is_leaf()) return index;
    const uint32_t left = add(slot + 1, index), right = add(from.right, index);
    nodes_[index].child[0] = left;
    nodes_[index].child[1] = right;
    return index;
  }

  uint32_t sibling(uint32_t node) const {
    const Node& parent = nodes_[nodes_[node].parent];
    return parent.child[parent.child[0] == node];
  }

  /// Nodes at least two levels below the root, the largest; equals by number.
  std::vector<uint32_t> largest(size_t count) const {
    std::vector<uint32_t> list;
    for (uint32_t i = 1; i < nodes_.size(); ++i)
      if (nodes_[i].parent != 0) list.push_back(i);
    if (list.size() <= count) return list;
    std::nth_element(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count), list.end(),
                     [&](uint32_t a, uint32_t b) {
                       return nodes_[a].area != nodes_[b].area ? nodes_[a].area > nodes_[b].area : a < b;
                     });
    list.resize(count);
    std::sort(list.begin(), list.end());
    return list;
  }

  /// Goes up from the node; at each ancestor looks down into the other branch.
  Move best_move(uint32_t node) const {
    Move best{0, node, none};
    uint32_t pivot = nodes_[node].parent;
    float gain = nodes_[pivot].area;  // the parent goes from here
    Box rest = nodes_[sibling(node)].box;
    uint32_t visits = most_visits;
    while (pivot != 0 && visits > 0) {
      const uint32_t other = sibling(pivot);
      if (pivot != nodes_[node].parent) {
        gain += nodes_[pivot].area - area_of(rest);  // the pivot shrinks
        consider({gain - nodes_[pivot].area, node, pivot}, best);
      }
      search_below(other, gain, best, visits);
      rest.extend(nodes_[other].box);
      pivot = nodes_[pivot].parent;
    }
    return best;
  }

  static void consider(const Move& move, Move& best) {
    if (move.gain > best.gain) best = move;
  }

  /// All places in the subtree `top` that may be better; `gain` is what leaving the old place brings.
  void search_below(uint32_t top, float gain, Move& best, uint32_t& visits) const {
    struct Entry {
      uint32_t node;
      float gain;
    };
    const Node& moved = nodes_[best.node];
    Entry stack[2 * max_depth];
    uint32_t size = 0;
    stack[size++] = {top, gain};
    for (; size > 0 && visits > 0; --visits) {
      const Entry entry = stack[--size];
      if (entry.gain - moved.area <= best.gain) continue;
      const Node& at = nodes_[entry.node];
      const float grown = area_of(together(at.box, moved.box));
      consider({entry.gain - grown, best.node, entry.node}, best);
      if (at.is_leaf() || size + 2 > 2 * max_depth) continue;
      const float below = entry.gain - (grown - at.area);
      stack[size++] = {at.child[0], below};
      stack[size++] = {at.child[1], below};
    }
  }

  void apply(std::vector<Move>& moves) {
    std::erase_if(moves, [](const Move& move) { return !(move.gain > 0); });
    std::sort(moves.begin(), moves.end(),
              [](const Move& a, const Move& b) { return a.gain != b.gain ? a.gain > b.gain : a.node < b.node; });
    std::fill(touched_.begin(), touched_.end(), false);
    for (const Move& move : moves)
      if (claim(move)) relink(move);
  }

  /// Whether the nodes that the move links anew are as the search saw them; they count as touched from now on.
  bool claim(const Move& move) {
    const uint32_t parent = nodes_[move.node].parent;
    const uint32_t links[] = {
        move.node, parent, sibling(move.node), nodes_[parent].parent, move.target, nodes_[move.target].parent};
    for (const uint32_t link : links)
      if (touched_[link]) return false;
    for (uint32_t above = move.target; above != none; above = nodes_[above].parent)
      if (above == move.node) return false;  // an earlier move has put the target below the node
    for (const uint32_t link : links) touched_[link] = true;
    return true;
  }

  void relink(const Move& move) {
    const uint32_t parent = nodes_[move.node].parent, kept = sibling(move.node);
    replace(parent, kept);
    replace(move.target, parent);
    nodes_[parent].child[0] = move.target;
    nodes_[parent].child[1] = move.node;
    nodes_[move.target].parent = parent;
  }

  /// Puts `by` where `node` hangs.
  void replace(uint32_t node, uint32_t by) {
    const uint32_t above = nodes_[node].parent;
    nodes_[above].child[nodes_[above].child[1] == node] = by;
    nodes_[by].parent = above;
  }

  void refit() {
    std::vector<uint32_t> order;
    order.reserve(nodes_.size());
    order.push_back(0);
    for (size_t i = 0; i < order.size(); ++i)
      for (const uint32_t child : nodes_[order[i]].child)
        if (child != none) order.push_back(child);
    for (size_t i = order.size(); i-- > 0;) {
      Node& node = nodes_[order[i]];
      if (node.is_leaf()) continue;
      node.box = together(nodes_[node.child[0]].box, nodes_[node.child[1]].box);
      node.area = area_of(node.box);
    }
  }

  void emit(uint32_t index, BinaryTree& tree) const {
    const Node& node = nodes_[index];
    const size_t slot = tree.size();
    tree.push_back(node.is_leaf() ? source_[node.leaf] : BinaryNode{node.box, 0, 0, 0});
    if (node.is_leaf()) return;
    emit(node.child[0], tree);
    tree[slot].right = static_cast<uint32_t>(tree.size());
    emit(node.child[1], tree);
    tree[slot].first = tree[slot + 1].first;
    tree[slot].count = tree[slot + 1].count + tree[tree[slot].right].count;
  }

  const BinaryTree& source_;
  double scale_ = 0;
  std::vector<Node> nodes_;
  std::vector<bool> touched_;
};

}  // namespace

BinaryTree reinsert(BinaryTree tree, const ReinsertionEffort& effort) {
  Reinsertion work(tree);
  for (uint32_t i = 0; i < effort.rounds; ++i) work.round(effort.share);
  return work.depth() <= max_depth ? work.finish() : std::move(tree);
}

}  // namespace rayloom::accel
