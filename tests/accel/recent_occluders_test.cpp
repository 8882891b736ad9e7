#include <rayloom/accel/recent_occluders.h>

#include <catch2/catch.hpp>

#include "random.h"
#include "structures.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

/// From the next one to visit on.
std::vector<uint32_t> pushed(RecentOccluders& recent, uint32_t first = 0) {
  TraversalStack stack;
  stack.push(77, 0);
  recent.push(stack, first);
  std::vector<uint32_t> refs;
  while (stack.size() > 1) refs.push_back(stack.pop_ref());
  CHECK(stack.pop_ref() == 77);
  return refs;
}

/// Spheres in a slab that hide much of a light from the points below.
struct Scene {
  Block ball = build_mesh(bumpy_sphere(2), geometry_flag::opaque), other = build_mesh(torus(12, 8, 0.4f)),
        ring = build_mesh(torus(60, 12, 0.1f));
  Block top = build_instances(instances());

  std::vector<InstanceDesc> instances() const {
    std::vector<InstanceDesc> out;
    Random random(41);
    for (int i = 0; i < 60; ++i) {
      Transform3x4 m{};
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) m[4 * row + column] = 0.7f * random.uniform(-1, 1);
      m[3] = random.uniform(-8, 8);
      m[7] = random.uniform(-8, 8);
      m[11] = random.uniform(2, 4);
      out.push_back(instance_of(i % 3 == 0 ? other : ball, m));
      out.back().instance_mask = i % 5 == 4 ? 2 : 1;
    }
    return out;
  }

  /// Hooked into one another, so that re-braiding enters them in many places.
  std::vector<InstanceDesc> rings() const {
    std::vector<InstanceDesc> out;
    Random random(43);
    for (int i = 0; i < 60; ++i) {
      const float x = random.uniform(-6, 6), y = random.uniform(-6, 6), z = random.uniform(2, 3);
      out.push_back(instance_of(ring, {2, 0, 0, x, 0, 2, 0, y, 0, 0, 2, z}));
    }
    return out;
  }
};

/// From neighbouring points in rows of 64 to around a light at this height; some are no rays.
std::vector<Ray> shadow_rays(float height, size_t count) {
  Random random(42);
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    const float x = static_cast<float>(i % 64) * 0.2f - 6.4f, y = static_cast<float>(i / 64) * 0.2f - 6.4f;
    rays.push_back(ray_between({x, y, 0}, {random.uniform(-0.2f, 0.2f), random.uniform(-0.2f, 0.2f), height}));
    rays.back().t_max = 1;
    if (i % 50 == 7) rays.back().t_max = -1;
    if (i % 90 == 8) rays.back().origin[1] = std::numeric_limits<float>::quiet_NaN();
    if (i % 70 == 9) rays.back().t_min = 0.5f;
  }
  return rays;
}

}  // namespace

TEST_CASE("the last occluder is tried first, each once, of the last eight") {
  RecentOccluders recent;
  CHECK(recent.empty());
  for (const uint32_t ref : {1u, 2u, 3u, 2u}) recent.note_occluder(ref);
  CHECK(!recent.empty());
  CHECK(pushed(recent) == std::vector<uint32_t>{2, 3, 1});
  CHECK(pushed(recent, 2) == std::vector<uint32_t>{2, 3, 1});
  CHECK(pushed(recent, 1) == std::vector<uint32_t>{1, 3, 2});
  CHECK(pushed(recent, 9) == std::vector<uint32_t>{9, 2, 3, 1});
  for (uint32_t ref = 4; ref < 10; ++ref) recent.note_occluder(ref);
  CHECK(pushed(recent) == std::vector<uint32_t>{9, 8, 7, 6, 5, 4, 2, 3});
  CHECK(pushed(recent, 7) == std::vector<uint32_t>{7, 8, 9, 6, 5, 4, 2, 3});
  CHECK(pushed(recent, 1) == std::vector<uint32_t>{1, 9, 8, 7, 6, 5, 4, 2, 3});
  recent.note_occluder(3);
  CHECK(pushed(recent) == std::vector<uint32_t>{3, 9, 8, 7, 6, 5, 4, 2});
}

TEST_CASE("they are given up where a quarter of the rays finds nothing there") {
  for (const uint32_t one_in : {3u, 5u}) {
    RecentOccluders recent;
    recent.note_occluder(1);
    for (uint32_t i = 0; i < 1000; ++i) {
      if (i % one_in == 0) recent.note_missed();
      if (!recent.given_up()) pushed(recent);
    }
    CHECK(recent.given_up() == (one_in == 3));
  }
}

TEST_CASE("which occluders are tried first does not show") {
  const Scene scene;
  const Block opened = build_instances(scene.rings(), {build_flag::none, Builder::automatic, true});
  REQUIRE(opened.header().leaf_count > 200);
  for_each_isa([&](Isa) {
    for (const Block* const top : {&scene.top, &opened}) {
      for (const float height : {1.0f, 3.0f, 9.0f}) {
        for (const size_t count : {255u, 256u, 4096u}) {
          for (const uint32_t flags : {ray_flag::none, ray_flag::cull_back_facing_triangles}) {
            TraceRequest shared = request_for(*top, {}, flags);
            shared.instance_mask = 1;
            const std::vector<Ray> rays = shadow_rays(height, count);
            std::vector<uint8_t> found(count, 7);
            occluded({}, shared, rays, found);
            size_t wrong = 0, hits = 0;
            for (size_t i = 0; i < count; ++i) {
              shared.ray = rays[i];
              const bool hit{trace({}, shared)};
              wrong += found[i] != static_cast<uint8_t>(hit);
              hits += hit;
            }
            CHECK(wrong == 0);
            if (top == &opened || count < 4096) continue;
            if (height == 1) CHECK(hits == 0);
            if (height == 3) CHECK((hits > 3000 && hits < 3500));  // kept to the end
            if (height == 9) CHECK((hits > 500 && hits < 1000));   // given up
          }
        }
      }
    }
  });
}
