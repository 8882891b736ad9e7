#include <rayloom/accel/checks.h>
#include <rayloom/accel/collect_refs.h>
#include <rayloom/accel/procedural_input.h>

#include <cmath>
#include <cstring>

namespace rayloom::accel {
namespace {

float clamp_finite(float x) {
  constexpr float largest = std::numeric_limits<float>::max();
  return std::clamp(x, -largest, largest);
}

bool is_inverted(const Box& box) {
  return box.min[0] > box.max[0] || box.min[1] > box.max[1] || box.min[2] > box.max[2];
}

void collapse_to_centre(Box& box) {
  for (int k = 0; k < 3; ++k) box.min[k] = box.max[k] = 0.5f * box.min[k] + 0.5f * box.max[k];
}

}  // namespace

std::optional<Box> read_box(const AabbGeometry& geometry, uint32_t index) {
  float bounds[6];
  std::memcpy(bounds, geometry.boxes + uint64_t{index} * geometry.stride, sizeof(bounds));
  Box box;
  for (int k = 0; k < 3; ++k) {
    if (std::isnan(bounds[k]) || std::isnan(bounds[3 + k])) return std::nullopt;
    box.min[k] = clamp_finite(bounds[k]) + 0.0f;
    box.max[k] = clamp_finite(bounds[3 + k]) + 0.0f;
  }
  if (is_inverted(box)) collapse_to_centre(box);
  return box;
}

PrimitiveRefs procedural_refs(std::span<const AabbGeometry> geometries) {
  PrimitiveRefs refs;
  refs.reserve(checked_count(geometries));
  for (uint32_t g = 0; g < geometries.size(); ++g) {
    const AabbGeometry& geometry = geometries[g];
    append_refs(refs, geometry.box_count, [&](uint32_t index) -> std::optional<PrimitiveRef> {
      const auto box = read_box(geometry, index);
      if (!box) return std::nullopt;
      return make_primitive_ref(*box, g, index);
    });
  }
  return refs;
}

}  // namespace rayloom::accel
