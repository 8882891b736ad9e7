#include <rayloom/shaders/surface.h>

#include <cmath>

namespace rayloom::shaders {
namespace {

template <class T>
T vertex(uint64_t address, uint32_t count, uint32_t index) {
  return StructuredBuffer<T>{address, count}[index];
}

template <class T>
T interpolate(uint64_t address, const TriangleRecord& record, uint3 v, float2 b) {
  return (1.0f - b.x - b.y) * vertex<T>(address, record.vertex_count, v.x) +
         b.x * vertex<T>(address, record.vertex_count, v.y) + b.y * vertex<T>(address, record.vertex_count, v.z);
}

float3 linear_part(const float3x4& m, float3 v) {
  return {glm::dot(float3(m[0]), v), glm::dot(float3(m[1]), v), glm::dot(float3(m[2]), v)};
}

/// Normals map by the inverse transposed.
float3 normal_to_world(const float3x4& world_to_object, float3 n) {
  return n.x * float3(world_to_object[0]) + n.y * float3(world_to_object[1]) + n.z * float3(world_to_object[2]);
}

/// The object-space direction in which u grows, from the triangle's own texture coordinates: (tangent, sign of the
/// bitangent). Zero where they do not span the plane.
float4 tangent_of_triangle(const std::array<float3, 3>& p, float2 uv0, float2 uv1, float2 uv2, float3 normal) {
  const float3 edge1 = p[1] - p[0], edge2 = p[2] - p[0];
  const float2 d1 = uv1 - uv0, d2 = uv2 - uv0;
  const float determinant = d1.x * d2.y - d1.y * d2.x;
  if (!(determinant != 0)) return float4(0);
  const float side = determinant > 0 ? 1.0f : -1.0f;
  const float3 along_u = side * (d2.y * edge1 - d1.y * edge2), along_v = side * (d1.x * edge2 - d2.x * edge1);
  const float sign = glm::dot(glm::cross(normal, along_u), along_v) < 0 ? -1.0f : 1.0f;
  return {normalize_or(along_u, float3(0)), sign};
}

float4 object_tangent(const TriangleRecord& record, uint3 v, float2 b, const std::array<float3, 3>& positions,
                      float3 normal, uint32_t uv_set) {
  if (record.tangents) {
    const float4 first = vertex<float4>(record.tangents, record.vertex_count, v.x);
    return {float3(interpolate<float4>(record.tangents, record, v, b)), first.w};
  }
  const uint64_t uv = uv_set == 0 ? record.uv0 : record.uv1;
  if (!uv) return float4(0);
  return tangent_of_triangle(positions, vertex<float2>(uv, record.vertex_count, v.x),
                             vertex<float2>(uv, record.vertex_count, v.y), vertex<float2>(uv, record.vertex_count, v.z),
                             normal);
}

/// Makes the tangent orthogonal to the shading normal; drops it where that leaves nothing.
void set_tangent(Surface& surface, float4 tangent, const HitInstance& instance) {
  const float3 world = linear_part(instance.object_to_world, float3(tangent));
  const float3 orthogonal = world - glm::dot(world, surface.shading_normal) * surface.shading_normal;
  surface.tangent = normalize_or(orthogonal, float3(0));
  surface.bitangent_sign = surface.tangent == float3(0) ? 0.0f : tangent.w;
}

/// Seen from behind, the whole shading frame turns about (glTF 2.0, 3.9.2: the normal of a back face is reversed). So
/// does one that disagrees with the winding.
void turn_to_viewer(Surface& surface) {
  if (!(glm::dot(surface.shading_normal, surface.geometric_normal) < 0)) return;
  surface.shading_normal = -surface.shading_normal;
  surface.tangent = -surface.tangent;
  surface.bitangent_sign = -surface.bitangent_sign;
}

}  // namespace

uint3 triangle_indices(const TriangleRecord& record, uint32_t primitive) {
  return StructuredBuffer<uint3>{record.indices, record.index_count / 3}[primitive];
}

Attributes interpolate_attributes(const TriangleRecord& record, uint3 v, float2 b) {
  Attributes attributes;
  if (record.uv0) attributes.uv[0] = interpolate<float2>(record.uv0, record, v, b);
  if (record.uv1) attributes.uv[1] = interpolate<float2>(record.uv1, record, v, b);
  if (record.colors) attributes.color = interpolate<float4>(record.colors, record, v, b);
  return attributes;
}

Surface triangle_surface(const TriangleRecord& record, uint32_t primitive, float2 b, bool front,
                         const HitInstance& instance, bool tangents, uint32_t tangent_uv_set) {
  const uint3 v = triangle_indices(record, primitive);
  const std::array<float3, 3> positions{vertex<float3>(record.positions, record.vertex_count, v.x),
                                        vertex<float3>(record.positions, record.vertex_count, v.y),
                                        vertex<float3>(record.positions, record.vertex_count, v.z)};
  Surface surface;
  surface.front = front;
  surface.spawn = triangle_spawn_point(positions, b, instance.object_to_world);
  const float3 front_normal(surface.spawn.normal);
  surface.shading_normal = front_normal;
  if (record.normals)
    surface.shading_normal = normalize_or(
        normal_to_world(instance.world_to_object, interpolate<float3>(record.normals, record, v, b)), front_normal);
  surface.tangent = float3(0), surface.bitangent_sign = 0;
  if (tangents) {
    const float3 object_normal = glm::cross(positions[1] - positions[0], positions[2] - positions[0]);
    set_tangent(surface, object_tangent(record, v, b, positions, object_normal, tangent_uv_set), instance);
  }
  surface.geometric_normal = front ? front_normal : -front_normal;
  turn_to_viewer(surface);
  surface.attributes = interpolate_attributes(record, v, b);
  return surface;
}

Surface sphere_surface(const scenes::Sphere& sphere, double3 object_point, bool front, const HitInstance& instance) {
  Surface surface;
  surface.front = front;
  surface.spawn = sphere_spawn_point(sphere.center, sphere.radius, object_point, instance.object_to_world);
  surface.geometric_normal = float3(front ? surface.spawn.normal : -surface.spawn.normal);
  surface.shading_normal = surface.geometric_normal;
  surface.tangent = float3(0), surface.bitangent_sign = 0;
  return surface;
}

}  // namespace rayloom::shaders
