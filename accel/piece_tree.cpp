#include <rayloom/accel/piece_tree.h>
#include <rayloom/accel/reinsertion.h>
#include <rayloom/base/error.h>

#include <string>

namespace rayloom::accel {

PieceTree::PieceTree(std::vector<const Piece*> pieces, bool reinserts)
    : pieces_(std::move(pieces)), refs_(pieces_.size()) {
  for (size_t i = 0; i < pieces_.size(); ++i)
    refs_[i] = make_primitive_ref(pieces_[i]->box, 0, static_cast<uint32_t>(i));
  tree_ = build_binary_tree(refs_, {1, refs_.size()});
  if (reinserts) tree_ = reinsert(std::move(tree_), {});
  if (depth() > max_depth) build_balanced();
}

void PieceTree::ask_ahead(uint32_t slot) const {
  constexpr size_t distance = 6, line = 64;
  const size_t later = tree_[slot].first + distance;
  if (later >= refs_.size()) return;
  const auto* const bytes = reinterpret_cast<const std::byte*>(pieces_[refs_[later].primitive]);
  for (size_t i = 0; i < sizeof(Piece); i += line) __builtin_prefetch(bytes + i);
}

uint32_t PieceTree::depth_below(uint32_t slot) const {
  if (tree_[slot].is_leaf()) return piece(slot).wide.depth + 1;
  return 1 + std::max(depth_below(slot + 1), depth_below(tree_[slot].right));
}

/// Choices in a part end at max_choice_depth, and halving it takes at most 11 levels more: pieces are no deeper than
/// 42, and up to 2^21 of them fit. More pieces than that, all of the deepest, no input is known to have; but a
/// structure that overflows the traversal's stack must not come out.
void PieceTree::build_balanced() {
  const auto count = static_cast<uint32_t>(refs_.size());
  PrimitiveRefs scratch(count);
  tree_.assign(2 * size_t{count} - 1, {});
  build_binary_subtree(refs_, scratch, 1, {0, 0, count, count, max_choice_depth}, tree_);
  if (depth() > max_depth)
    throw InputError("acceleration structure build", "geometries",
                     "a tree over " + std::to_string(count) + " parts of them would be deeper than " +
                         std::to_string(max_depth) + " nodes; split them into several structures");
}

}  // namespace rayloom::accel
