// Batches of rays against the same rays one at a time, bit for bit.

#include <catch2/catch.hpp>

#include "brute_force.h"
#include "random.h"
#include "structures.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

/// Rays to and from around the origin, some parallel to an axis, some limited, some that miss by rule.
std::vector<Ray> mixed_rays(uint64_t seed, size_t count) {
  Random random(seed);
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    const auto any = [&] { return random.uniform(-1.5f, 1.5f); };
    Ray ray = ray_between({any(), any(), any()}, {any(), any(), any()});
    if (random.chance(5)) ray.direction[random.below(3)] = random.chance(2) ? 0.0f : -0.0f;
    if (random.chance(3)) ray.t_min = random.uniform(0, 1);
    if (random.chance(3)) ray.t_max = ray.t_min + random.uniform(0, 2);
    if (random.chance(20)) ray.t_max = -1;
    if (random.chance(20)) ray.origin[1] = std::numeric_limits<float>::quiet_NaN();
    rays.push_back(ray);
  }
  return rays;
}

Mesh two_spheres() {
  Mesh mesh = icosphere(3);
  const Mesh inner = moved(bumpy_sphere(3), 0.5f, 0);
  const auto base = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), inner.vertices.begin(), inner.vertices.end());
  for (const auto& triangle : inner.triangles)
    mesh.triangles.push_back({triangle[0] + base, triangle[1] + base, triangle[2] + base});
  return mesh;
}

/// Some of this test's structures, with what they refer to.
struct Scene {
  Mesh mesh = two_spheres();
  Block bottom = build_mesh(mesh, geometry_flag::none);
  Block split = build_mesh(mesh, geometry_flag::opaque, {0, Builder::spatial_splits});
  Block plain = build_mesh(mesh, geometry_flag::opaque, {0, Builder::lbvh});
  Block empty = build_mesh(Mesh{});
  Block top = build_instances(instances());
  Block empty_top = build_instances({});

  std::vector<const Block*> structures() const { return {&bottom, &split, &plain, &empty, &top, &empty_top}; }

  std::vector<InstanceDesc> instances() const {
    std::vector<InstanceDesc> out;
    Random random(5);
    for (int i = 0; i < 40; ++i) {
      Transform3x4 m = identity_transform;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) m[4 * row + column] = 0.4f * random.uniform(-1, 1);
        m[4 * row + 3] = random.uniform(-1, 1);
      }
      out.push_back(instance_of(i % 7 == 3 ? empty : bottom, m));
      out.back().instance_mask = (1u << random.below(3)) & 0xFFu;
      out.back().flags = random.below(16) & 0xFFu;
    }
    return out;
  }
};

constexpr uint32_t flag_sets[] = {ray_flag::none,
                                  ray_flag::accept_first_hit_and_end_search,
                                  ray_flag::cull_back_facing_triangles,
                                  ray_flag::cull_front_facing_triangles | ray_flag::accept_first_hit_and_end_search,
                                  ray_flag::cull_opaque,
                                  ray_flag::force_opaque | ray_flag::cull_opaque,
                                  ray_flag::skip_triangles};

size_t differences(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += !same_bits(a[i], b[i]);
  return count;
}

/// Every way to trace `rays` with what `shared` says.
void check(const TraceRequest& shared, const std::vector<Ray>& rays, size_t& hit_count) {
  std::vector<Hit> alone, batch(rays.size()), run(rays.size());
  std::vector<TraceRequest> requests;
  for (const Ray& ray : rays) {
    requests.push_back(shared);
    requests.back().ray = ray;
    alone.push_back(trace({}, requests.back()));
    hit_count += static_cast<bool>(alone.back());
  }
  trace({}, requests, batch);
  CHECK(differences(alone, batch) == 0);
  trace({}, shared, rays, run);
  CHECK(differences(alone, run) == 0);

  std::vector<uint8_t> occlusion(rays.size(), 7);
  occluded({}, shared, rays, occlusion);
  size_t wrong = 0;
  for (size_t i = 0; i < rays.size(); ++i) wrong += occlusion[i] != static_cast<uint8_t>(static_cast<bool>(alone[i]));
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("rays in batches of any size hit what they hit alone") {
  const Scene scene;
  for_each_isa([&](Isa) {
    size_t hits = 0;
    for (const Block* structure : scene.structures())
      for (const uint32_t flags : flag_sets)
        for (const size_t count : {1u, 3u, 4u, 31u, 33u, 300u}) {
          TraceRequest shared = request_for(*structure, {}, flags);
          shared.instance_mask = flags % 3 == 0 ? 0xFF : 0x5;
          check(shared, mixed_rays(count + flags, count), hits);
        }
    CHECK(hits > 3000);
  });
}

TEST_CASE("an empty batch and a missing structure are no trouble") {
  for_each_isa([&](Isa) {
    trace({}, std::span<const TraceRequest>(), std::span<Hit>());
    trace({}, TraceRequest(), std::span<const Ray>(), std::span<Hit>());
    size_t hits = 0;
    check(TraceRequest(), mixed_rays(1, 50), hits);
    CHECK(hits == 0);
  });
}

TEST_CASE("a candidate function is asked in a batch whenever it is alone, and only then") {
  const Mesh mesh = bumpy_sphere(3);
  const Block opaque = build_geometries(std::vector{mesh.geometry()});
  const Block mixed = build_geometries(std::vector{mesh.geometry(), cube(2).geometry(geometry_flag::none)});
  static size_t asked;
  const auto reject = [](void*, const Candidate&) noexcept -> Verdict { return ++asked, Verdict{}; };
  for_each_isa([&](Isa) {
    for (const Block* structure : {&opaque, &mixed})
      for (const uint32_t flags : {ray_flag::none, ray_flag::force_non_opaque, ray_flag::force_opaque,
                                   ray_flag::accept_first_hit_and_end_search}) {
        CAPTURE(flags, structure == &opaque);
        TraceRequest shared = request_for(*structure, {}, flags);
        shared.candidate = reject;
        size_t hits = 0;
        asked = 0;
        check(shared, mixed_rays(80, 300), hits);
        const bool silent =
            structure == &opaque ? flags != ray_flag::force_non_opaque : flags == ray_flag::force_opaque;
        CHECK((asked == 0) == silent);
      }
  });
}

TEST_CASE("a batch may mix structures, flags and rays with candidate functions") {
  const Scene scene;
  const auto accept_small = [](void*, const Candidate& candidate) noexcept -> Verdict {
    return {candidate.primitive_index % 2 == 0, false, candidate.t, candidate.hit_kind};
  };
  constexpr uint32_t masks[] = {0xFF, 0x1, 0x2, 0xFFFFFF05};
  const auto structures = scene.structures();
  Random random(9);
  const auto any = [&](const auto& of) { return of[random.below(static_cast<uint32_t>(std::size(of)))]; };
  TraceRequest next = request_for(*structures[0], {});
  std::vector<TraceRequest> requests;
  for (const Ray& ray : mixed_rays(77, 3000)) {
    // One thing at a time: requests that differ in that alone stand side by side.
    const uint32_t change = random.below(9);
    if (change == 0) next.structure = any(structures)->data();
    if (change == 1) next.ray_flags = any(flag_sets);
    if (change == 2) next.instance_mask = any(masks);
    if (change == 3) next.candidate = next.candidate ? nullptr : +accept_small;
    requests.push_back(next);
    requests.back().ray = ray;
  }
  for_each_isa([&](Isa) {
    std::vector<Hit> alone, batch(requests.size());
    for (const TraceRequest& request : requests) alone.push_back(trace({}, request));
    trace({}, requests, batch);
    CHECK(differences(alone, batch) == 0);
  });
}
