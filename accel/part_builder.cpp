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

void PartBuilder::reserve(const Subtree& part) {
  bytes_.resize(node_bound(part.budget) * sizeof(Node8) + part.budget * sizeof(PlainTriangleLeaf));
}

void PartBuilder::build(const Subtree& part) {
  reserve(part);
  build_in_place(part, bytes_.data(), 0);
}

uint32_t PartBuilder::build_alone(const Subtree& part) {
  reserve(part);
  build_tree(part);
  wide_.start(bytes_.data(), 0);
  pieces_.clear();
  const LooseWide root =
      wide_.add_below(built_.tree, Collapse(built_.tree), 0,
                      [this](uint32_t leaf, LooseWide& node, uint32_t) { return write_leaf(leaf, node); });
  return root.count == 1 ? root.child[0].ref : wide_.add_node(root);
}

void PartBuilder::build_in_place(const Subtree& part, std::byte* block, uint32_t granule) {
  build_tree(part);
  wide_.start(block, granule);
  write_pieces();
}

bool PartBuilder::wants_rows() const {
  return input_->builder == Builder::lbvh && leaves_.form == LeafForm::index_table;
}

TriangleRows PartBuilder::rows() {
  const size_t length = rows_.size() / 4;
  uint32_t* const first = rows_.data();
  return {first, {first + length, first + 2 * length, first + 3 * length}};
}

void PartBuilder::build_tree(const Subtree& part) {
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
}

/// The part's root may not become a node, so what would be its children is left open.
void PartBuilder::write_pieces() {
  const BinaryTree& tree = built_.tree;
  const Collapse collapse(tree);
  ChildList list{};
  if (tree[0].is_leaf())
    list.push(0);
  else
    list = collapse.planned(0);
  pieces_.clear();
  for (uint32_t i = 0; i < list.count; ++i) {
    const uint32_t slot = list.slot[i];
    pieces_.push_back(
        {tree[slot].box, wide_.add_below(tree, collapse, slot, [this](uint32_t leaf, LooseWide& node, uint32_t) {
           return write_leaf(leaf, node);
         })});
  }
}

uint32_t PartBuilder::write_leaf(uint32_t slot, LooseWide& wide) {
  const BinaryNode& node = built_.tree[slot];
  const auto refs = std::span(built_.refs).subspan(node.first, node.count);
  write_ahead(wide_.next());
  const uint64_t bytes =
      has_rows_ ? leaves_.write_of_rows(rows(), node.first, refs, wide_.next()) : leaves_.write(refs, wide_.next());
  wide.push(node.box, wide_.add_leaf(bytes));
  return 1;
}

Pieces PartBuilder::move_to(std::byte* block, uint32_t granule) const {
  std::byte* const to = block + uint64_t{granule} * granule_bytes;
  std::memcpy(to, bytes_.data(), uint64_t{wide_.granule()} * granule_bytes);
  for (const uint32_t node : wide_.nodes()) {
    uint32_t(&child)[node_width] = reinterpret_cast<Node8*>(to + uint64_t{node} * granule_bytes)->child;
    for (uint32_t& ref : child) ref += ref != 0 ? granule : 0;
  }
  Pieces moved = pieces_;
  for (Piece& piece : moved)
    for (uint32_t i = 0; i < piece.wide.count; ++i) piece.wide.child[i].ref += granule;
  return moved;
}

}  // namespace rayloom::accel
