#include <rayloom/shaders/alpha_test.h>
#include <rayloom/shaders/material.h>

namespace rayloom::shaders {

bool candidate_counts(const AnyHitContext& ctx, const MaterialView& materials, uint64_t path_key, float2 barycentrics) {
  const TriangleRecord record = ctx.LocalRoot<TriangleRecord>();
  const MaterialCore core = load_material(materials, record.material);
  const Attributes at = interpolate_attributes(record, triangle_indices(record, ctx.PrimitiveIndex()), barycentrics);
  const float alpha = material_alpha(materials, record.material, core, at);
  const CandidateKey key{path_key, ctx.InstanceIndex(), ctx.GeometryIndex(), ctx.PrimitiveIndex()};
  return covers(core, alpha, candidate_random(key));
}

}  // namespace rayloom::shaders
