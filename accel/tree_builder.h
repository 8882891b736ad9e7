#pragma once

// From primitive references to a binary tree: the place where builders plug in.

#include <rayloom/accel/binary_tree.h>
#include <rayloom/accel/build_input.h>
#include <rayloom/accel/build_settings.h>
#include <rayloom/accel/layout.h>

namespace rayloom::accel {

struct TreeInput {
  StructureKind kind = StructureKind::triangles;
  Builder builder = Builder::binned_sah;  ///< what chosen_builder() says
  uint32_t build_flags = 0;
  uint32_t leaf_size = 8;                       ///< primitives a leaf holds
  uint64_t leaf_budget = 1;                     ///< the tree has at most this many leaves
  std::span<const TriangleGeometry> triangles;  ///< what references name, for builders that clip; empty otherwise
};

/// A tree whose leaves are ranges of `refs`, each sorted by name. A builder that splits primitives returns more
/// references than it was given, several of one name; a leaf names a primitive once.
struct BuiltTree {
  PrimitiveRefs refs;
  BinaryTree tree;
};

/// The builder that really runs: `automatic` resolved, and builders replaced that cannot make this kind of structure.
/// Follows from kind and settings alone, as sizes must.
Builder chosen_builder(StructureKind kind, const BuildSettings& settings);

/// Input for a structure over `primitives` (inactive ones included), without triangles.
TreeInput tree_input(StructureKind kind, uint64_t primitives, const BuildSettings& settings);

/// Same references in any order, same tree, for any number of threads; depth at most max_depth. `refs` is not empty.
BuiltTree build_tree(PrimitiveRefs refs, const TreeInput& input);

}  // namespace rayloom::accel
