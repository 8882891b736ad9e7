#include <rayloom/accel/lbvh.h>
#include <rayloom/accel/lbvh_treelets.h>
#include <rayloom/accel/reinsertion.h>
#include <rayloom/accel/sizes.h>
#include <rayloom/accel/split_tree.h>
#include <rayloom/accel/structure_in_parts.h>
#include <rayloom/accel/tree_builder.h>

namespace rayloom::accel {

namespace {

/// A clipped box means nothing for a primitive that may move.
bool can_split(StructureKind kind, uint32_t flags) {
  return kind == StructureKind::triangles && !(flags & build_flag::allow_update);
}

Builder by_flags(uint32_t flags) {
  if (flags & build_flag::prefer_fast_build) return Builder::lbvh;
  return (flags & build_flag::prefer_fast_trace) ? Builder::reinsertion : Builder::binned_sah;
}

/// What a fast-trace build has time for.
constexpr ReinsertionEffort whole_tree{.rounds = 6, .share = 4};

}  // namespace

Builder chosen_builder(StructureKind kind, const BuildSettings& settings) {
  const Builder wanted = settings.builder == Builder::automatic ? by_flags(settings.flags) : settings.builder;
  const bool lazy = kind == StructureKind::triangles && (settings.flags & build_flag::lazy);
  if (lazy && !builds_in_parts(wanted)) return Builder::binned_sah;
  return wanted == Builder::spatial_splits && !can_split(kind, settings.flags) ? Builder::binned_sah : wanted;
}

TreeInput tree_input(StructureKind kind, uint64_t primitives, const BuildSettings& settings) {
  return {
      kind, chosen_builder(kind, settings), settings.flags, leaf_size(kind), leaf_budget(primitives, kind, settings),
      {}};
}

BuiltTree build_tree(PrimitiveRefs refs, const TreeInput& input) {
  if (input.builder == Builder::spatial_splits) return build_split_tree(std::move(refs), input);
  if (input.builder == Builder::lbvh) return build_lbvh(refs, input);
  if (input.builder == Builder::lbvh_treelets) return build_lbvh_treelets(refs, input);
  BuiltTree built{std::move(refs), {}};
  built.tree = build_binary_tree(built.refs, {input.leaf_size, input.leaf_budget});
  if (input.builder == Builder::reinsertion) built.tree = reinsert(std::move(built.tree), whole_tree);
  return built;
}

}  // namespace rayloom::accel
