#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/chunks.h>
#include <rayloom/accel/partition.h>
#include <rayloom/accel/reinsertion.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/spatial_split.h>
#include <rayloom/accel/split_tree.h>

#include <algorithm>
#include <utility>

namespace rayloom::accel {
namespace {

/// A spatial split is looked for where the children of the best object split overlap by this much of the root's area
/// (the paper's alpha), and by this much of the node's, which costs little quality and saves a quarter of the time.
constexpr double root_overlap = 1e-5, node_overlap = 0.25;

/// Below this depth cost no longer chooses: halving 2^30 references down to one leaf takes at most 30 further levels.
constexpr uint32_t max_sah_depth = 32;
constexpr size_t parallel_threshold = 4096;

/// A subtree to build: it owns the slots [slot, slot + 2 * budget - 1), the references [first, first + count), and room
/// up to first + room.
struct Subtree {
  uint32_t slot, first, count, room, budget, depth;
  RangeBounds bounds;
};

struct Counts {
  uint32_t left, right;
};

double overlap(const Box& a, const Box& b) {
  Box common;
  for (int k = 0; k < 3; ++k) {
    common.min[k] = std::max(a.min[k], b.min[k]);
    common.max[k] = std::min(a.max[k], b.max[k]);
    if (common.min[k] > common.max[k]) return 0;
  }
  return common.half_area();
}

class SplitTreeBuilder {
 public:
  SplitTreeBuilder(PrimitiveRefs refs, const TreeInput& input)
      : triangles_(input.triangles),
        leaf_size_(input.leaf_size),
        built_{std::move(refs), BinaryTree(2 * input.leaf_budget - 1)} {
    const auto count = static_cast<uint32_t>(built_.refs.size());
    const auto room = static_cast<uint32_t>(split_reference_bound(count));
    built_.refs.resize(room);
    scratch_.resize(room);
    const RangeBounds bounds = bounds_of({built_.refs.data(), count});
    min_overlap_ = root_overlap * bounds.box.half_area();
    build({0, 0, count, room, static_cast<uint32_t>(input.leaf_budget), 0, bounds});
  }

  BuiltTree take() { return std::move(built_); }

 private:
  std::span<PrimitiveRef> refs_of(const Subtree& subtree) {
    return {built_.refs.data() + subtree.first, subtree.count};
  }
  std::span<PrimitiveRef> scratch_of(const Subtree& subtree) { return {scratch_.data() + subtree.first, subtree.room}; }

  void build(const Subtree& subtree) {
    BinaryNode& node = built_.tree[subtree.slot];
    node = {subtree.bounds.box, subtree.first, subtree.count, 0};
    const auto refs = refs_of(subtree);
    if (subtree.count <= leaf_size_) return std::sort(refs.begin(), refs.end(), name_less);
    const std::pair<Subtree, Subtree> halves = split(subtree);
    const Subtree &left = halves.first, &right = halves.second;
    node.right = right.slot;
    if (subtree.count < parallel_threshold) {
      build(left);
      build(right);
      return;
    }
    parallel_invoke([&, this] { build(left); }, [&, this] { build(right); });
  }

  std::pair<Subtree, Subtree> split(const Subtree& subtree) {
    const auto refs = refs_of(subtree);
    if (subtree.depth >= max_sah_depth) return split_in_half(subtree);
    const auto object = find_binned_split(refs, subtree.bounds.centres, leaf_size_, subtree.budget);
    if (!object) return split_in_half(subtree);
    const auto left_count =
        static_cast<uint32_t>(partition_by_split(refs, scratch_of(subtree).first(subtree.count), *object));
    const Counts counts{left_count, subtree.count - left_count};
    const RangeBounds left = bounds_of(refs.first(left_count)), right = bounds_of(refs.subspan(left_count));
    if (overlap(left.box, right.box) > std::max(min_overlap_, node_overlap * subtree.bounds.box.half_area()))
      if (const auto spatial = split_in_space(subtree, object->cost)) return *spatial;
    return children(subtree, counts, left, right);
  }

  std::pair<Subtree, Subtree> split_in_half(const Subtree& subtree) {
    const auto refs = refs_of(subtree);
    const auto left_count = static_cast<uint32_t>(partition_by_median(refs, subtree.bounds.centres, leaf_size_));
    return children(subtree, {left_count, subtree.count - left_count}, bounds_of(refs.first(left_count)),
                    bounds_of(refs.subspan(left_count)));
  }

  /// The children, their references still side by side, moved to where their room begins.
  std::pair<Subtree, Subtree> children(const Subtree& parent, const Counts& counts, const RangeBounds& left_bounds,
                                       const RangeBounds& right_bounds) {
    auto [left, right] = divide(parent, counts);
    left.bounds = left_bounds;
    right.bounds = right_bounds;
    const PrimitiveRef* const from = built_.refs.data() + left.first + left.count;
    PrimitiveRef* const to = built_.refs.data() + right.first;
    if (from != to) std::move_backward(from, from + right.count, to + right.count);
    return {left, right};
  }

  std::optional<std::pair<Subtree, Subtree>> split_in_space(const Subtree& parent, double object_cost) {
    if (parent.room == parent.count) return std::nullopt;
    const auto refs = refs_of(parent);
    const auto spatial =
        find_spatial_split(refs, parent.bounds.box, triangles_, {leaf_size_, parent.budget, parent.room});
    if (!spatial || spatial->cost >= object_cost) return std::nullopt;
    const auto scratch = scratch_of(parent);
    const auto parts = partition_by_plane(refs, *spatial, triangles_, scratch);
    if (!parts || !admissible(parent, *parts)) return std::nullopt;
    auto [left, right] = divide(parent, {static_cast<uint32_t>(parts->left), static_cast<uint32_t>(parts->right)});
    copy(scratch.first(parts->left), left);
    copy(scratch.subspan(parts->left, parts->right), right);
    left.bounds = bounds_of(refs_of(left));
    right.bounds = bounds_of(refs_of(right));
    return std::pair(left, right);
  }

  bool admissible(const Subtree& parent, const SpatialParts& parts) const {
    return parts.left > 0 && parts.right > 0 && parts.left < parent.count && parts.right < parent.count &&
           blocks_for(parts.left, leaf_size_) + blocks_for(parts.right, leaf_size_) <= parent.budget;
  }

  void copy(std::span<const PrimitiveRef> from, const Subtree& to) {
    PrimitiveRef* const out = built_.refs.data() + to.first;
    for_each_chunk(from.size(), [&](size_t, size_t begin, size_t end) {
      std::copy(from.data() + begin, from.data() + end, out + begin);
    });
  }

  /// Shares out room and blocks beyond need in proportion to need.
  std::pair<Subtree, Subtree> divide(const Subtree& parent, const Counts& counts) const {
    const uint64_t left_need = blocks_for(counts.left, leaf_size_), right_need = blocks_for(counts.right, leaf_size_);
    const uint64_t spare_blocks = parent.budget - left_need - right_need;
    const uint64_t spare_room = parent.room - counts.left - counts.right;
    const auto budget = static_cast<uint32_t>(left_need + spare_blocks * left_need / (left_need + right_need));
    const auto room =
        static_cast<uint32_t>(counts.left + spare_room * counts.left / (uint64_t{counts.left} + counts.right));
    const uint32_t depth = parent.depth + 1;
    return {{parent.slot + 1, parent.first, counts.left, room, budget, depth, {}},
            {parent.slot + 2 * budget,
             parent.first + room,
             counts.right,
             parent.room - room,
             parent.budget - budget,
             depth,
             {}}};
  }

  SplittableTriangles triangles_;
  uint32_t leaf_size_;
  BuiltTree built_;
  PrimitiveRefs scratch_;
  double min_overlap_ = 0;
};

}  // namespace

BuiltTree build_split_tree(PrimitiveRefs refs, const TreeInput& input) {
  BuiltTree built = SplitTreeBuilder(std::move(refs), input).take();
  built.tree = reinsert(std::move(built.tree), {});
  return built;
}

}  // namespace rayloom::accel
