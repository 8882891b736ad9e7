#include <rayloom/shaders/aov/views.h>
#include <rayloom/shaders/hash.h>

#include <array>

namespace rayloom::shaders {
namespace {

constexpr std::array<AovViewInfo, 13> views{{
    {AovView::depth, "depth", "distance along the viewing direction, in metres"},
    {AovView::position, "position", "world position of the first hit, in metres"},
    {AovView::normal, "normal", "geometric normal on the viewer's side, -1..1 as 0..1"},
    {AovView::shading_normal, "shading_normal", "interpolated and mapped normal, -1..1 as 0..1"},
    {AovView::albedo, "albedo", "base colour"},
    {AovView::occlusion, "occlusion", "the file's baked ambient occlusion"},
    {AovView::uv, "uv", "texture coordinates of set 0, wrapped to 0..1"},
    {AovView::distance, "distance", "distance from the camera, in metres"},
    {AovView::facing, "facing", "front faces green, back faces red"},
    {AovView::instance_id, "instance_id", "a colour an instance"},
    {AovView::geometry_id, "geometry_id", "a colour a geometry of each mesh"},
    {AovView::primitive_id, "primitive_id", "a colour a triangle or sphere"},
    {AovView::material_id, "material_id", "a colour a material"},
}};

float3 color_of_id(uint64_t id) {
  const uint64_t hash = mix64(id + 1);
  const auto channel = [&](int shift) { return 0.1f + 0.9f * static_cast<float>((hash >> shift) & 0xffff) / 65535.0f; };
  return {channel(0), channel(16), channel(32)};
}

float3 signed_to_unit(float3 v) { return 0.5f * v + 0.5f; }

}  // namespace

std::span<const AovViewInfo> aov_views() { return views; }

float3 view_color(AovView view, const AovPayload& p) {
  if (!p.hit()) return float3(0);
  switch (view) {
    case AovView::depth:
      return float3(p.depth);
    case AovView::position:
      return p.position;
    case AovView::normal:
      return signed_to_unit(p.normal);
    case AovView::shading_normal:
      return signed_to_unit(p.shading_normal);
    case AovView::albedo:
      return p.albedo;
    case AovView::occlusion:
      return float3(p.occlusion);
    case AovView::uv:
      return {p.uv.x - std::floor(p.uv.x), p.uv.y - std::floor(p.uv.y), 0};
    case AovView::distance:
      return float3(p.ray_t);
    case AovView::facing:
      return p.facing > 0 ? float3(0, 1, 0) : float3(1, 0, 0);
    case AovView::instance_id:
      return color_of_id(p.instance);
    case AovView::geometry_id:
      return color_of_id(p.geometry);
    case AovView::primitive_id:
      return color_of_id(p.primitive);
    case AovView::material_id:
      return color_of_id(p.material);
  }
  return float3(0);
}

}  // namespace rayloom::shaders
