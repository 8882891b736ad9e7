#include <rayloom/accel/parts_in_order.h>
#include <rayloom/accel/piece_tree.h>
#include <rayloom/accel/structure_in_parts.h>

#include <cstring>

namespace rayloom::accel {
namespace {

constexpr uint32_t header_granules = sizeof(StructureHeader) / granule_bytes;

/// Where the curve is cut, budget and depth shared out on the way.
class PartCutter {
 public:
  PartCutter(const TriangleCurve& order, const TreeInput& input)
      : order_(order), leaf_size_(input.leaf_size), part_size_(part_recipe(input.builder).size) {
    const auto budget = static_cast<uint32_t>(input.leaf_budget);
    cut({0, 0, static_cast<uint32_t>(order.keys().size()), budget, 0}, parts_);
  }
  std::vector<Part> take() { return std::move(parts_); }

 private:
  /// Appends the parts of a subtree, in their order.
  void cut(const Subtree& subtree, std::vector<Part>& parts) const {
    if (subtree.count <= part_size_) return parts.push_back({subtree});
    const auto keys = order_.keys().subspan(subtree.first, subtree.count);
    const auto code_of = [&](uint32_t i) { return order_.code(keys[i].index); };
    const auto [left, right] = halves_of(subtree, curve_cut(keys, subtree, leaf_size_, code_of), leaf_size_);
    std::vector<Part> of_right;
    const bool together = subtree.count >= large;
    build_halves(
        left, right,
        [&, first = left.first](const Subtree& half) { cut(half, together && half.first != first ? of_right : parts); },
        large);
    std::move(of_right.begin(), of_right.end(), std::back_inserter(parts));
  }

  static constexpr uint32_t large = 1 << 16;  ///< halves are cut at the same time
  const TriangleCurve& order_;
  uint32_t leaf_size_, part_size_;
  std::vector<Part> parts_;
};

std::vector<const Piece*> pieces_of(const std::vector<Part>& parts) {
  std::vector<const Piece*> pieces;
  for (const Part& part : parts)
    for (const Piece& piece : part.pieces()) pieces.push_back(&piece);
  return pieces;
}

class StructureInParts {
 public:
  StructureInParts(const TriangleCurve& order, const TreeInput& input, StructureHeader& header,
                   std::span<std::byte> block)
      : order_(order), input_(input), header_(header), block_(block), parts_(PartCutter(order, input).take()) {
    pieces_.resize(parts_.size() * most_pieces * sizeof(Piece));
    for (size_t i = 0; i < parts_.size(); ++i)
      parts_[i].first_piece = reinterpret_cast<Piece*>(pieces_.data()) + i * most_pieces;
    build_parts();
    join_parts();
  }

 private:
  void build_parts() {
    if (thread_limit() == 1) return build_in_turn();
    const PartsInOrder built(order_, input_, parts_, block_, granule_);
    granule_ = built.granule();
    sums_ = built.sums();
  }

  void build_in_turn() {
    PartBuilder builder(order_, input_);
    PartBytes bytes;
    for (Part& part : parts_) {
      builder.plan(part.where);
      bytes.start_in_place(block_.data(), granule_);
      builder.write(bytes);
      part.keep(bytes.pieces);
      granule_ = bytes.wide.granule();
      sums_.add(bytes.wide.sums());
    }
  }

  void join_parts() {
    const PieceTree top(pieces_of(parts_), part_recipe(input_.builder).reinserts_top);
    const BinaryTree& tree = top.tree();
    WideBytes wide;
    wide.start(block_.data(), granule_);
    const LooseWide root = wide.add_below(tree, Collapse(tree), 0, [&](uint32_t slot, LooseWide& node, uint32_t room) {
      top.ask_ahead(slot);
      return wide.join(tree[slot].box, top.piece(slot).wide, node, room);
    });
    header_.root = wide.add_node(root);
    header_.depth = root.depth + 1;
    const uint64_t used = uint64_t{wide.granule()} * granule_bytes;
    std::memset(block_.data() + used, 0, TriangleLeaf::overread_bytes);
    header_.bytes = used + TriangleLeaf::overread_bytes;
    sums_.add(wide.sums());
    header_.node_count = sums_.node_count;
    header_.leaf_count = sums_.leaf_count;
    describe(tree[0].box);
  }

  void describe(const Box& box) {
    const double area = box.half_area();
    header_.active_count = order_.keys().size();
    header_.sah_cost = area > 0 ? sums_.area / area : static_cast<double>(header_.node_count + header_.leaf_count);
    std::copy_n(box.min, 3, header_.bounds_min);
    std::copy_n(box.max, 3, header_.bounds_max);
  }

  const TriangleCurve& order_;
  const TreeInput& input_;
  StructureHeader& header_;
  std::span<std::byte> block_;
  std::vector<Part> parts_;
  ScratchVector<std::byte> pieces_;  ///< memory for the pieces of all parts
  uint32_t granule_ = header_granules;
  WideSums sums_;
};

}  // namespace

void build_in_parts(const TreeInput& input, StructureHeader& header, std::span<std::byte> block) {
  const TriangleCurve order(input.triangles, input.build_flags & build_flag::allow_update);
  if (!order.keys().empty()) build_in_parts(order, input, header, block);
}

void build_in_parts(const TriangleCurve& order, const TreeInput& input, StructureHeader& header,
                    std::span<std::byte> block) {
  StructureInParts(order, input, header, block);
}

}  // namespace rayloom::accel
