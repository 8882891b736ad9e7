#include <rayloom/accel/loose_wide.h>

#include <algorithm>
#include <cstring>

namespace rayloom::accel {

void WideBytes::start(std::byte* block, uint32_t granule) {
  block_ = block;
  granule_ = granule;
  leaf_count_ = 0;
  area_ = 0;
  nodes_.clear();
}

uint32_t WideBytes::add_leaf(uint64_t bytes) {
  ++leaf_count_;
  const uint32_t ref = granule_ | node_ref::leaf_bit;
  granule_ += static_cast<uint32_t>(bytes / granule_bytes);
  return ref;
}

void WideBytes::absorb(const LooseWide& from, LooseWide& into) {
  std::copy_n(from.child.begin(), from.count, into.child.begin() + into.count);
  into.count += from.count;
  into.depth = std::max(into.depth, from.depth);
}

uint32_t WideBytes::add_node(const LooseWide& node) {
  std::array<uint8_t, node_width> order;
  const auto before = [&](uint8_t a, uint8_t b) {
    const LooseWide::Child &x = node.child[a], &y = node.child[b];
    return node_ref::is_leaf(x.ref) != node_ref::is_leaf(y.ref) ? node_ref::is_leaf(y.ref) : x.area < y.area;
  };
  for (uint8_t i = 0; i < node.count; ++i) {
    uint8_t place = i;
    for (; place > 0 && before(i, order[place - 1]); --place) order[place] = order[place - 1];
    order[place] = i;
  }
  auto& out = *reinterpret_cast<Node8*>(next());
  Box whole;
  for (uint32_t lane = 0; lane < node_width; ++lane) {
    const LooseWide::Child child = lane < node.count ? node.child[order[lane]] : LooseWide::Child{{}, 0, 0};
    for (int axis = 0; axis < 3; ++axis) {
      out.bounds[axis][0][lane] = child.box.min[axis];
      out.bounds[axis][1][lane] = child.box.max[axis];
    }
    out.child[lane] = child.ref;
    whole.extend(child.box);
    if (node_ref::is_leaf(child.ref)) area_ += child.area;
  }
  area_ += whole.half_area();
  nodes_.push_back(granule_);
  granule_ += sizeof(Node8) / granule_bytes;
  return nodes_.back();
}

}  // namespace rayloom::accel
