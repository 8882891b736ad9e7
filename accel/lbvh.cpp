#include <rayloom/accel/chunks.h>
#include <rayloom/accel/curve_tree.h>
#include <rayloom/accel/lbvh.h>

namespace rayloom::accel {

BuiltTree build_lbvh(const PrimitiveRefs& refs, const TreeInput& input) {
  const MortonCurve curve(bounds_of(refs).centres);
  const ScratchVector<MortonKey> keys = sorted_keys(curve, refs);
  BuiltTree built;
  built.refs.resize(refs.size());
  built.tree.resize(2 * input.leaf_budget - 1);
  for_each_chunk(refs.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) built.refs[i] = refs[keys[i].index];
  });
  const auto count = static_cast<uint32_t>(refs.size());
  build_on_curve({built.refs, keys, curve, input.leaf_size}, {0, 0, count, static_cast<uint32_t>(input.leaf_budget), 0},
                 built.tree);
  return built;
}

}  // namespace rayloom::accel
