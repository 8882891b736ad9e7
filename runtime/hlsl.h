#pragma once

// HLSL's vocabulary on GLM, so that a shader functor reads like its HLSL twin.
//
// Matrices: HLSL's floatRxC has R rows of C numbers and m[r] is a row. GLM's matRxC is an array of R vectors of C
// numbers and m[r] is the r-th vector, so the alias gives HLSL's indexing and HLSL's row-major bytes (the bytes of
// DXR's FLOAT[3][4]). Multiply with mul() below, which has HLSL's meaning; GLM's operator* reads the vectors as
// columns.

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat3x4.hpp>
#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>

namespace rayloom {

using uint = uint32_t;
using float2 = glm::vec2;
using float3 = glm::vec3;
using float4 = glm::vec4;
using int2 = glm::ivec2;
using int3 = glm::ivec3;
using int4 = glm::ivec4;
using uint2 = glm::uvec2;
using uint3 = glm::uvec3;
using uint4 = glm::uvec4;
using float3x3 = glm::mat3x3;
using float3x4 = glm::mat3x4;
using float4x3 = glm::mat4x3;
using float4x4 = glm::mat4x4;

/// HLSL's mul: matrix times column vector, or row vector times matrix. Sums run left to right.
inline float3 mul(const float3x4& m, const float4& v) { return v * m; }
inline float3 mul(const float4& v, const float4x3& m) { return m * v; }
inline float3 mul(const float3x3& m, const float3& v) { return v * m; }
inline float3 mul(const float3& v, const float3x3& m) { return m * v; }
inline float4 mul(const float4x4& m, const float4& v) { return v * m; }
inline float4 mul(const float4& v, const float4x4& m) { return m * v; }

inline float saturate(float x) { return x < 0 ? 0.0f : (x > 1 ? 1.0f : x); }
template <class T>
inline T lerp(const T& a, const T& b, float s) {
  return a + (b - a) * s;
}

/// HLSL's RayDesc. Direction is never normalised; t counts in its lengths (SV-22, EXT-06).
struct RayDesc {
  float3 Origin;
  float TMin;
  float3 Direction;
  float TMax;
};
static_assert(sizeof(RayDesc) == 32);

/// Weights of vertices 1 (x) and 2 (y) of the application's vertex order (CM-02).
struct BuiltInTriangleIntersectionAttributes {
  float2 barycentrics;
};

/// The scene argument of TraceRay: the device address of a top-level structure; 0 always misses (TR-03).
struct RaytracingAccelerationStructure {
  uint64_t address = 0;
};

enum RAY_FLAG : uint {
  RAY_FLAG_NONE = 0,
  RAY_FLAG_FORCE_OPAQUE = 0x1,
  RAY_FLAG_FORCE_NON_OPAQUE = 0x2,
  RAY_FLAG_ACCEPT_FIRST_HIT_AND_END_SEARCH = 0x4,
  RAY_FLAG_SKIP_CLOSEST_HIT_SHADER = 0x8,
  RAY_FLAG_CULL_BACK_FACING_TRIANGLES = 0x10,
  RAY_FLAG_CULL_FRONT_FACING_TRIANGLES = 0x20,
  RAY_FLAG_CULL_OPAQUE = 0x40,
  RAY_FLAG_CULL_NON_OPAQUE = 0x80,
  RAY_FLAG_SKIP_TRIANGLES = 0x100,
  RAY_FLAG_SKIP_PROCEDURAL_PRIMITIVES = 0x200,
};
/// Every bit DXR 1.1 defines; others are dropped and reported (RF-17, RF-18).
inline constexpr uint defined_ray_flags = 0x3FF;

enum HIT_KIND : uint {
  HIT_KIND_TRIANGLE_FRONT_FACE = 0xFE,
  HIT_KIND_TRIANGLE_BACK_FACE = 0xFF,
};

}  // namespace rayloom
