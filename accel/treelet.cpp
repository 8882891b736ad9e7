#include <rayloom/accel/treelet.h>

#include <array>
#include <bit>

namespace rayloom::accel {
namespace {

constexpr uint32_t subsets = 1u << treelet_leaves;

class Treelet {
 public:
  Treelet(std::span<LooseNode> nodes, uint32_t root, const BoxArea& area, uint32_t leaf_size)
      : nodes_(nodes), area_of_(area), leaf_size_(leaf_size) {
    inner_[0] = root;
    inner_count_ = 1;
    leaf_[0] = nodes[root].left;
    leaf_[1] = nodes[root].right;
    leaf_count_ = 2;
    while (leaf_count_ < treelet_leaves && open_largest()) {
    }
  }

  void restructure() {
    if (leaf_count_ < 3) return;
    fill_boxes();
    fill_costs();
    const uint32_t all = (1u << leaf_count_) - 1;
    if (!(cost_[all] < nodes_[inner_[0]].cost)) return;
    inner_count_ = 0;
    place(all);
  }

 private:
  bool open_largest() {
    uint32_t best = treelet_leaves;
    for (uint32_t i = 0; i < leaf_count_; ++i) {
      const LooseNode& node = nodes_[leaf_[i]];
      if (!node.is_leaf() && (best == treelet_leaves || node.area > nodes_[leaf_[best]].area)) best = i;
    }
    if (best == treelet_leaves) return false;
    const uint32_t opened = leaf_[best];
    inner_[inner_count_++] = opened;
    leaf_[best] = nodes_[opened].left;
    leaf_[leaf_count_++] = nodes_[opened].right;
    return true;
  }

  void fill_boxes() {
    for (uint32_t i = 0; i < leaf_count_; ++i) {
      const LooseNode& leaf = nodes_[leaf_[i]];
      const uint32_t bit = 1u << i;
      box_[bit] = leaf.box;
      area_[bit] = leaf.area;
      count_[bit] = leaf.count;
      cost_[bit] = leaf.cost;
      for (uint32_t below = 1; below < bit; ++below) {
        Box4 both = box_[below];
        both.extend(leaf.box);
        box_[bit | below] = both;
        area_[bit | below] = area_of_(both);
        count_[bit | below] = count_[below] + leaf.count;
      }
    }
  }

  void fill_costs() {
    for (uint32_t set = 3; set < 1u << leaf_count_; ++set) {
      if ((set & (set - 1)) == 0) continue;
      const float split = area_[set] * inner_cost + least_halves(set);
      cost_[set] = better_as_leaf(area_[set], count_[set], split, leaf_size_) ? area_[set] : split;
    }
  }

  /// Each pair of complementary parts once: the lowest member stays out of `part`.
  template <class Visit>
  static void for_each_part(uint32_t set, const Visit& visit) {
    const uint32_t rest = set & (set - 1);
    for (uint32_t part = rest; part != 0; part = (part - 1) & rest) visit(part);
  }

  float least_halves(uint32_t set) const {
    float least = Box::infinity;
    for_each_part(set, [&](uint32_t part) {
      const float cost = cost_[part] + cost_[set ^ part];
      least = cost < least ? cost : least;
    });
    return least;
  }

  uint32_t best_part(uint32_t set) const {
    const float least = least_halves(set);
    uint32_t best = set & (set - 1);
    for_each_part(set, [&](uint32_t part) {
      if (cost_[part] + cost_[set ^ part] == least) best = part;
    });
    return best;
  }

  /// Makes the subtree of a set and returns its node. The treelet's inner nodes are used again in any order but the
  /// root's, which comes first.
  uint32_t place(uint32_t set) {
    if ((set & (set - 1)) == 0) return leaf_[static_cast<uint32_t>(std::countr_zero(set))];
    const uint32_t slot = inner_[inner_count_++];
    const uint32_t part = best_part(set);
    LooseNode node;
    node.box = box_[set];
    node.count = count_[set];
    node.area = area_[set];
    node.cost = cost_[set];
    node.left = place(set ^ part);
    node.right = place(part);
    nodes_[slot] = node;
    return slot;
  }

  std::span<LooseNode> nodes_;
  const BoxArea& area_of_;
  uint32_t leaf_size_;
  std::array<uint32_t, treelet_leaves> leaf_;
  std::array<uint32_t, treelet_leaves - 1> inner_;
  uint32_t leaf_count_, inner_count_;
  std::array<float, subsets> cost_;
  std::array<float, subsets> area_;
  std::array<uint32_t, subsets> count_;
  std::array<Box4, subsets> box_;
};

}  // namespace

void restructure_treelet(std::span<LooseNode> nodes, uint32_t root, const BoxArea& area, uint32_t leaf_size) {
  Treelet(nodes, root, area, leaf_size).restructure();
}

}  // namespace rayloom::accel
