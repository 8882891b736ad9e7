#pragma once

#include <rayloom/accel/tree_builder.h>

namespace rayloom::accel {

/// LBVH whose treelets are restructured bottom-up, a few rounds with growing subtrees (Karras and Aila 2013): nearly
/// the trace speed of binned SAH in less time.
BuiltTree build_lbvh_treelets(const PrimitiveRefs& refs, const TreeInput& input);

}  // namespace rayloom::accel
