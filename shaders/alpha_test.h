#pragma once

// The any-hit shader of masked and blended triangles. Its verdict depends on the candidate alone (guarantee G3b).

#include <rayloom/runtime/stage_context.h>
#include <rayloom/shaders/hash.h>
#include <rayloom/shaders/scene_view.h>

namespace rayloom::shaders {

/// Whether the candidate counts; `path_key` names the ray.
bool candidate_counts(const AnyHitContext& ctx, const MaterialView& materials, uint64_t path_key, float2 barycentrics);

/// `Payload` tells with path_key() which ray it belongs to.
template <class Payload>
struct AlphaTest {
  MaterialView materials;

  AnyHitVerdict operator()(AnyHitContext& ctx, Payload& payload,
                           const BuiltInTriangleIntersectionAttributes& hit) const {
    return candidate_counts(ctx, materials, payload.path_key(), hit.barycentrics) ? ctx.AcceptHit() : ctx.IgnoreHit();
  }
};

}  // namespace rayloom::shaders
