#include <rayloom/accel/lbvh_treelets.h>
#include <rayloom/accel/part_builder.h>
#include <rayloom/accel/read_ahead.h>
#include <rayloom/accel/sizes.h>

#include <cstring>

namespace rayloom::accel {

/// Measured: larger parts gain little and leave the cache.
PartRecipe part_recipe(Builder builder) {
  if (builder == Builder::lbvh) return {4096, 0, false};
  if (builder == Builder::lbvh_treelets) return {4096, 128, true};
  return {16384, 16384, true};
}

PartBuilder::PartBuilder(const TriangleCurve& order, const TreeInput& input)
    : order_(&order), input_(&input), leaves_{input.triangles, LeafForm::index_table, false} {
  if (input.build_flags & build_flag::allow_update) leaves_.form = LeafForm::full;
}

bool PartBuilder::wants_rows() const {
  return input_->builder == Builder::lbvh && leaves_.form == LeafForm::index_table;
}

TriangleRows PartBuilder::rows() {
  const size_t length = rows_.size() / 4;
  uint32_t* const first = rows_.data();
  return {first, {first + length, first + 2 * length, first + 3 * length}};
}

void PartBuilder::plan(const Subtree& part) {
  built_.refs.resize(part.count);
  scratch_.resize(part.count);
  built_.tree.resize(2 * size_t{part.budget} - 1);
  const auto keys = order_->keys().subspan(part.first, part.count);
  if (wants_rows()) rows_.resize(4 * (size_t{part.count} + leaf_lanes));
  const TriangleRows rows = this->rows();
  has_rows_ = order_->gather(keys, built_.refs.data(), wants_rows() ? &rows : nullptr);
  const uint32_t leaf_size = input_->leaf_size, binned_size = part_recipe(input_->builder).binned_size;
  const Subtree whole{0, 0, part.count, part.budget, part.depth};
  build_on_curve({built_.refs, keys, order_->curve(), leaf_size, binned_size, scratch_, !has_rows_}, whole,
                 built_.tree);
  if (input_->builder == Builder::lbvh_treelets) built_ = rearranged_by_treelets(built_, leaf_size, whole);
  collapse_.emplace(built_.tree, collapse_ ? collapse_->take_memory() : ScratchVector<CollapsePlan>());
}

/// The part's root may not become a node, so what would be its children is left open.
void PartBuilder::write(PartBytes& out) {
  const BinaryTree& tree = built_.tree;
  ChildList list{};
  if (tree[0].is_leaf())
    list.push(0);
  else
    list = collapse_->planned(0);
  out.pieces.clear();
  for (uint32_t i = 0; i < list.count; ++i) {
    const uint32_t slot = list.slot[i];
    const auto leaf = [&](uint32_t place, LooseWide& node, uint32_t) { return write_leaf(place, node, out.wide); };
    out.pieces.push_back({tree[slot].box, out.wide.add_below(tree, *collapse_, slot, leaf)});
  }
}

uint32_t PartBuilder::write_alone(PartBytes& out) {
  const auto leaf = [&](uint32_t place, LooseWide& node, uint32_t) { return write_leaf(place, node, out.wide); };
  const LooseWide root = out.wide.add_below(built_.tree, *collapse_, 0, leaf);
  return root.count == 1 ? root.child[0].ref : out.wide.add_node(root);
}

uint32_t PartBuilder::write_leaf(uint32_t slot, LooseWide& node, WideBytes& wide) {
  const BinaryNode& leaf = built_.tree[slot];
  const auto refs = std::span(built_.refs).subspan(leaf.first, leaf.count);
  write_ahead(wide.next());
  const uint64_t bytes =
      has_rows_ ? leaves_.write_of_rows(rows(), leaf.first, refs, wide.next()) : leaves_.write(refs, wide.next());
  node.push(leaf.box, wide.add_leaf(bytes));
  return 1;
}

void PartBytes::start_apart(const Subtree& part) {
  memory_.resize(node_bound(part.budget) * sizeof(Node8) + part.budget * sizeof(PlainTriangleLeaf));
  wide.start(memory_.data(), 0);
}

void PartBytes::move_to(std::byte* block, uint32_t granule) {
  std::byte* const to = block + uint64_t{granule} * granule_bytes;
  std::memcpy(to, memory_.data(), uint64_t{wide.granule()} * granule_bytes);
  for (const uint32_t node : wide.nodes()) {
    uint32_t(&child)[node_width] = reinterpret_cast<Node8*>(to + uint64_t{node} * granule_bytes)->child;
    for (uint32_t& ref : child) ref += ref != 0 ? granule : 0;
  }
  for (Piece& piece : pieces)
    for (uint32_t i = 0; i < piece.wide.count; ++i) piece.wide.child[i].ref += granule;
}

}  // namespace rayloom::accel
