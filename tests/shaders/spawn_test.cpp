#include <rayloom/accel/trace.h>
#include <rayloom/shaders/sampler.h>
#include <rayloom/shaders/spawn.h>
#include <rayloom/shaders/sphere.h>
#include <rayloom/shaders/warp.h>

#include <catch2/catch.hpp>

#include <cstring>
#include <vector>

using namespace rayloom;
using namespace rayloom::shaders;

namespace {

/// A bottom level of one triangle under one transformed instance, traced through accel as DispatchRays would.
struct TracedTriangle {
  std::array<float3, 3> vertices;
  float3x4 object_to_world;
  std::vector<std::byte> bottom_storage, top_storage;
  std::byte* top = nullptr;

  TracedTriangle(const std::array<float3, 3>& v, const float3x4& transform) : vertices(v), object_to_world(transform) {
    accel::TriangleGeometry geometry;
    geometry.vertices = reinterpret_cast<const std::byte*>(vertices.data());
    geometry.vertex_count = 3, geometry.triangle_count = 1, geometry.flags = accel::geometry_flag::opaque;
    std::byte* bottom = aligned(bottom_storage, accel::bottom_level_sizes(std::span(&geometry, 1), 0).result_bytes);
    const uint64_t bottom_bytes = accel::bottom_level_sizes(std::span(&geometry, 1), 0).result_bytes;
    accel::build_bottom_level(std::span(&geometry, 1), 0, {bottom, bottom_bytes});

    accel::InstanceDesc desc{};
    std::memcpy(desc.transform, &object_to_world, sizeof(desc.transform));
    desc.instance_mask = 0xFF;
    desc.bottom_level_address = reinterpret_cast<uint64_t>(bottom);
    const uint64_t top_bytes = accel::top_level_sizes(1, 0).result_bytes;
    top = aligned(top_storage, top_bytes);
    accel::build_top_level(std::span(&desc, 1), {}, 0, {top, top_bytes});
  }

  bool hit(float3 origin, float3 direction) const {
    accel::TraceRequest request;
    std::memcpy(request.ray.origin, &origin, 12);
    std::memcpy(request.ray.direction, &direction, 12);
    request.ray.t_min = 0, request.ray.t_max = INFINITY;
    request.structure = top;
    return static_cast<bool>(accel::trace({}, request));
  }

  SpawnPoint spawn(float2 barycentrics) const { return triangle_spawn_point(vertices, barycentrics, object_to_world); }

 private:
  static std::byte* aligned(std::vector<std::byte>& storage, uint64_t bytes) {
    storage.resize(bytes + accel::structure_alignment);
    const auto address = reinterpret_cast<uintptr_t>(storage.data());
    return storage.data() +
           (accel::structure_alignment - address % accel::structure_alignment) % accel::structure_alignment;
  }
};

struct Family {
  const char* name;
  float size, distance;           ///< of the triangle in object space
  float scale, shear, translate;  ///< of the instance
};

constexpr Family families[] = {
    {"unit", 1, 0, 1, 0, 0},
    {"far from the object origin", 1, 1e5f, 1, 0, 0},
    {"far instance", 1, 0, 1, 0, 1e5f},
    {"moved back near the origin", 1, 1e5f, 1, 0, -1e5f},
    {"tiny", 1e-6f, 0, 1, 0, 0},
    {"tiny and far", 1e-3f, 100, 1, 0, 1e3f},
    {"huge", 1e8f, 1e8f, 1, 0, 0},
    {"small scale", 1, 10, 1e-3f, 0.3f, 1e3f},
    {"large scale", 1, 10, 1e3f, 0.3f, -50},
    {"sheared", 1, 3, 1, 30, 5},
    {"mirrored", 1, 3, -2, 0.5f, 5},
};

/// A point in [-1, 1]^3.
float3 cube(const Sampler& start) {
  Sampler sampler = start;
  return 2.0f * float3(sampler.next_4d()) - 1.0f;
}

TracedTriangle random_triangle(const Family& f, uint32_t i) {
  const auto random = [&](uint32_t stream) { return cube(Sampler({i, stream}, 0, 7)); };
  const float3 centre = f.distance * random(0);
  const std::array<float3, 3> v{centre + f.size * random(1), centre + f.size * random(2), centre + f.size * random(3)};
  const float3 r0 = random(4), r1 = random(5), r2 = random(6), t = random(7);
  const float3x4 transform(float4(f.scale * (float3(1, 0, 0) + f.shear * r0), f.translate * t.x),
                           float4(f.scale * (float3(0, 1, 0) + f.shear * r1), f.translate * t.y),
                           float4(f.scale * (float3(0, 0, 1) + f.shear * r2), f.translate * t.z));
  return {v, transform};
}

}  // namespace

TEST_CASE("rays from spawn points never meet the triangle they leave: 1,100,000 rays") {
  constexpr uint32_t triangles = 500, rays = 200;
  for (const Family& family : families) {
    uint32_t hits = 0, unmoved_hits = 0;
    double largest_offset_ulps = 0;
    for (uint32_t i = 0; i < triangles; ++i) {
      const TracedTriangle triangle = random_triangle(family, i);
      for (uint32_t k = 0; k < rays; ++k) {
        Sampler sampler({i, k}, 1, 11);
        const float4 u = sampler.next_4d();
        const float2 grazing = sampler.next_2d();
        const SpawnPoint spawn = triangle.spawn(uniform_triangle({u.x, u.y}));
        const bool front = u.z < 0.5f;
        // Half the directions graze: cosines from 1e-4 to 1.
        const float cosine = u.w < 0.5f ? grazing.x : std::fmax(1e-4f, 0.01f * grazing.x);
        const float3 normal(front ? spawn.normal : -spawn.normal);
        const float3 direction = make_frame(normal).to_world(direction_at(cosine, grazing.y));
        hits += triangle.hit(spawn.origin(front), direction);
        unmoved_hits += triangle.hit(float3(spawn.position), direction);
        const double reach =
            std::max({std::abs(spawn.position.x), std::abs(spawn.position.y), std::abs(spawn.position.z)});
        if (reach > 0) largest_offset_ulps = std::max(largest_offset_ulps, spawn.offset / (reach * 0x1p-23));
      }
    }
    CAPTURE(family.name, largest_offset_ulps);
    CHECK(hits == 0);
    CHECK(unmoved_hits > 0);  // the test can fail: without the offset rays do hit
  }
}

TEST_CASE("the offset is small: at most 20 ulp of the largest coordinate where object and world are one") {
  const float3x4 identity(float4(1, 0, 0, 0), float4(0, 1, 0, 0), float4(0, 0, 1, 0));
  for (uint32_t i = 0; i < 2000; ++i) {
    const float3 at = 1000.0f * cube(Sampler({i, 0}, 0, 3));
    const std::array<float3, 3> v{at, at + cube(Sampler({i, 1}, 0, 3)), at + cube(Sampler({i, 2}, 0, 3))};
    const SpawnPoint spawn = triangle_spawn_point(v, {0.3f, 0.3f}, identity);
    const double reach = std::max({std::abs(spawn.position.x), std::abs(spawn.position.y), std::abs(spawn.position.z)});
    CHECK(spawn.offset < 20 * reach * 0x1p-23);
  }
}

TEST_CASE("rays that leave a sphere never meet it: 200,000 rays") {
  const float3x4 identity(float4(1, 0, 0, 0), float4(0, 1, 0, 0), float4(0, 0, 1, 0));
  uint32_t outside = 0, inside_missed = 0;
  for (const float distance : {0.0f, 1.0f, 100.0f, 1e3f})
    for (uint32_t i = 0; i < 50000; ++i) {
      Sampler sampler({i, 5}, 2, 1);
      const scenes::Sphere sphere{distance * cube(sampler), 0.01f + sampler.next_2d().x};
      const double3 normal(uniform_sphere(sampler.next_2d()));
      const SpawnPoint spawn =
          sphere_spawn_point(sphere.center, sphere.radius, double3(sphere.center) + normal, identity);
      const float3 away = make_frame(float3(spawn.normal)).to_world(cosine_hemisphere(sampler.next_2d()));
      const auto crossings = intersect_sphere(sphere, spawn.origin(true), away);
      outside += crossings && crossings->leave >= 0;
      const auto within = intersect_sphere(sphere, spawn.origin(false), -away);
      inside_missed += !within || within->enter >= 0 || !(within->leave > 0);
    }
  CHECK(outside == 0);
  CHECK(inside_missed == 0);
}
