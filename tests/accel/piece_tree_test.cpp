#include <rayloom/accel/piece_tree.h>
#include <rayloom/base/error.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <set>

using namespace rayloom;
using namespace rayloom::accel;

namespace {

/// Pieces of one depth, each half as far from the origin and half as large as the one before.
std::vector<Piece> halving_pieces(int count, uint32_t depth) {
  std::vector<Piece> pieces;
  for (int i = 0; i < count; ++i) {
    const float x = std::ldexp(1.0f, -i);
    Piece piece;
    piece.box.extend({0.5f * x, 0.5f * x, 0.5f * x}, {x, x, x});
    piece.wide.push(piece.box, 1);
    piece.wide.depth = depth;
    pieces.push_back(piece);
  }
  return pieces;
}

PieceTree tree_of(const std::vector<Piece>& pieces, bool reinserts) {
  std::vector<const Piece*> pointers;
  for (const Piece& piece : pieces) pointers.push_back(&piece);
  return {pointers, reinserts};
}

/// Each piece once, in boxes that hold it.
void check_tree(const PieceTree& tree, const std::vector<Piece>& pieces) {
  std::set<const Piece*> found;
  for (uint32_t slot = 0; slot < tree.tree().size(); ++slot) {
    const BinaryNode& node = tree.tree()[slot];
    if (node.count == 1) found.insert(&tree.piece(slot));
    if (!node.is_leaf())
      for (const uint32_t child : {slot + 1, node.right})
        for (int k = 0; k < 3; ++k) CHECK(node.box.min[k] <= tree.tree()[child].box.min[k]);
  }
  CHECK(found.size() == pieces.size());
}

}  // namespace

TEST_CASE("pieces are split by area while the structure stays shallow enough") {
  const std::vector<Piece> pieces = halving_pieces(40, 3);
  const PieceTree tree = tree_of(pieces, false);
  check_tree(tree, pieces);
  CHECK(tree.depth() > 3 + 1 + 6);  // deeper than halving would be
  CHECK(tree.depth() <= max_depth);
}

TEST_CASE("deep pieces in a row are halved") {
  for (const bool reinserts : {false, true}) {
    const std::vector<Piece> pieces = halving_pieces(40, 56);
    const PieceTree tree = tree_of(pieces, reinserts);
    check_tree(tree, pieces);
    CHECK(tree.depth() == 56 + 1 + 6);
  }
}

TEST_CASE("what no tree can hold is an error, not an overflow of the traversal's stack") {
  CHECK_THROWS_AS(tree_of(halving_pieces(40, 58), false), InputError);
  CHECK_NOTHROW(tree_of(halving_pieces(1, max_depth - 1), true));
}
