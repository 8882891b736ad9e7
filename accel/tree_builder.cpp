#include <rayloom/accel/sizes.h>
#include <rayloom/accel/tree_builder.h>

namespace rayloom::accel {

Builder chosen_builder(StructureKind, const BuildSettings& settings) {
  if (settings.builder != Builder::automatic) return settings.builder;
  return Builder::binned_sah;
}

TreeInput tree_input(StructureKind kind, uint64_t primitives, const BuildSettings& settings) {
  return {
      kind, chosen_builder(kind, settings), settings.flags, leaf_size(kind), leaf_budget(primitives, kind, settings),
      {}};
}

BuiltTree build_tree(PrimitiveRefs refs, const TreeInput& input) {
  BuiltTree built{std::move(refs), {}};
  built.tree = build_binary_tree(built.refs, {input.leaf_size, input.leaf_budget});
  return built;
}

}  // namespace rayloom::accel
