#include <rayloom/accel/float4.h>
#include <rayloom/accel/loose_wide.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace rayloom::accel {
namespace {

constexpr LooseWide::Child no_child{{}, 0, 0};

/// Where children go: inner ones first, then leaves, by rising area. Each is compared with all others, without
/// branches, which nobody could predict, and unrolled, so that counts stay in registers.
std::array<uint32_t, node_width> lanes_of(const LooseWide& node) {
  std::array<uint64_t, node_width> key;
  for (uint32_t i = 0; i < node_width; ++i) {
    const LooseWide::Child& child = i < node.count ? node.child[i] : no_child;
    const uint64_t leaf = child.ref >> 31;
    static_assert(node_ref::leaf_bit == 1u << 31);
    key[i] = i < node.count ? std::bit_cast<uint64_t>(child.area) | leaf << 63 : ~uint64_t{0};
  }
  std::array<uint32_t, node_width> lane;
#pragma GCC unroll 8
  for (uint32_t i = 0; i < node_width; ++i) {
    lane[i] = 0;
#pragma GCC unroll 8
    for (uint32_t k = 0; k < node_width; ++k) lane[i] += k < i ? key[k] <= key[i] : key[k] < key[i];
  }
  return lane;
}

void write_child(const LooseWide::Child& child, uint32_t lane, Node8& out) {
  for (int axis = 0; axis < 3; ++axis) {
    out.bounds[axis][0][lane] = child.box.min[axis];
    out.bounds[axis][1][lane] = child.box.max[axis];
  }
  out.child[lane] = child.ref;
}

}  // namespace

void WideSums::add(const WideSums& other) {
  granules += other.granules;
  node_count += other.node_count;
  leaf_count += other.leaf_count;
  area += other.area;
}

void WideBytes::start(std::byte* block, uint32_t granule) {
  block_ = block;
  first_granule_ = granule_ = granule;
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

uint32_t WideBytes::join(const Box& box, const LooseWide& below, LooseWide& node, uint32_t room) {
  if (below.count > room) {
    node.depth = std::max(node.depth, below.depth + 1);
    node.push(box, add_node(below));
    return 1;
  }
  std::copy_n(below.child.begin(), below.count, node.child.begin() + node.count);
  node.count += below.count;
  node.depth = std::max(node.depth, below.depth);
  return below.count;
}

uint32_t WideBytes::add_node(const LooseWide& node) {
  const auto lane = lanes_of(node);
  auto& out = *reinterpret_cast<Node8*>(next());
  Box4 whole;
  for (uint32_t i = 0; i < node_width; ++i) {
    const LooseWide::Child& child = i < node.count ? node.child[i] : no_child;
    write_child(child, lane[i], out);
    whole.extend(box4(child.box));
    if (node_ref::is_leaf(child.ref)) area_ += child.area;
  }
  area_ += whole.box().half_area();
  nodes_.push_back(granule_);
  granule_ += sizeof(Node8) / granule_bytes;
  return nodes_.back();
}

}  // namespace rayloom::accel
