// Packets of rays that leave neighbouring points: their constants against those of single rays, their box tests against
// exact integers, and whether they hit anything against the single-ray kernel. Compiled per target as
// accel/simd/kernel_highway.cpp is.

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/tests/accel/bundle_test.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <hwy/highway.h>

#include "packet_question.h"

#include <rayloom/accel/batch-inl.h>

#ifndef RAYLOOM_TESTS_ACCEL_BUNDLE_TEST
#define RAYLOOM_TESTS_ACCEL_BUNDLE_TEST

namespace rayloom::accel {

using test::PacketQuestion;

/// What a bundle finds out about a leaf of eight triangles and a node of eight boxes.
struct BundleProbe {
  uint32_t taken = 0;      ///< rays; 0: nothing else is set
  uint32_t boxes = 0;      ///< that some ray may meet
  uint32_t inside[8];      ///< rays that meet each box
  size_t other_masks = 0;  ///< rays of which a leaf's masks are not those of the ray alone
};

struct BundleFunctions {
  void (*probe)(const PacketQuestion&, BundleProbe&);
  /// Returns how many rays went in packets.
  size_t (*occlude)(const TraceRequest& shared, std::span<const Ray>, std::span<uint8_t>);
};

}  // namespace rayloom::accel

#endif

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

bool same_masks(const LeafMasks& a, const LeafMasks& b) {
  return a.possible == b.possible && a.certain == b.certain && a.inside == b.inside;
}

/// Where two axes are equally dominant a ray alone may have chosen the other one; then nothing is compared.
bool differs_from_alone(const LeafMasks& masks, const Ray& ray, uint32_t axis, const PacketQuestion& question) {
  PreparedRay prepared;
  prepare_lanes(ray, BoundsLanes(question.header, 1), prepared);
  if (prepared.axis[2] != axis) return false;
  const DepthInterval depths(prepared, ray.t_max);
  return !same_masks(masks, test_triangles(TriangleLanes(prepared), question.leaf, depths));
}

void probe(const PacketQuestion& question, BundleProbe& out) {
  const RayRun run{nullptr, question.rays, sizeof(Ray), packet_size};
  BundleRays rays;
  out.taken = rays.load(run, all_rays, question.header);
  if (out.taken == 0) return;
  const PacketVector near = rays.near_limit(0), far = rays.far_limit(rays.row[0].t_max);
  const float first_near = hn::GetLane(hn::MinOfLanes(PacketFloats(), near));
  const float last_far = hn::GetLane(hn::MaxOfLanes(PacketFloats(), far));
  out.boxes = test_boxes(rays, question.node, hn::Set(Floats(), first_near), hn::Set(Floats(), last_far)).mask;
  for (int lane = 0; lane < 8; ++lane) out.inside[lane] = test_child(rays, rays.row[0], question.node, lane, near, far);
  const LeafTriangles triangles = load_triangles(question.leaf, rays.axes());
  for (uint32_t left = out.taken; left != 0; left &= left - 1) {
    const auto ray = static_cast<uint32_t>(std::countr_zero(left));
    const LeafMasks masks = test_triangles(rays.lanes(ray), triangles, rays.depths(ray));
    out.other_masks += differs_from_alone(masks, question.rays[ray], rays.axes()[2], question);
  }
}

size_t occlude(const TraceRequest& shared, std::span<const Ray> rays, std::span<uint8_t> results) {
  return occlude_in_packets({}, {&shared, rays.data(), sizeof(Ray), rays.size()}, results.data());
}

BundleFunctions bundle_functions() { return {probe, occlude}; }

#endif

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include "packet_cases.h"
#include "random.h"
#include "targets.h"

#include <rayloom/base/float_environment.h>

#include <catch2/catch.hpp>

namespace rayloom::accel {
namespace {

using namespace test;

constexpr float infinity = std::numeric_limits<float>::infinity();

std::vector<Target<BundleFunctions>> targets() {
  return supported_targets(N_AVX2::bundle_functions(), N_AVX3::bundle_functions());
}

struct Outcomes {
  size_t in_packets = 0, hits = 0;
};

/// Whether rays hit anything, asked of all together and of each alone, on each target; the outcomes of the last.
Outcomes compare(const Block& block, const std::vector<Ray>& rays, uint32_t flags = ray_flag::none) {
  const Isa before = current_isa();
  flags |= ray_flag::accept_first_hit_and_end_search;
  Outcomes outcomes;
  for (const auto& target : targets()) {
    set_isa(target.isa);
    TraceRequest shared = request_for(block, rays[0], flags);
    std::vector<uint8_t> results(rays.size(), 2);
    {
      const FloatEnvironment environment;
      outcomes.in_packets = target.functions.occlude(shared, rays, results);
    }
    std::vector<uint8_t> through_the_door(rays.size(), 2);
    occluded({}, shared, rays, through_the_door);
    CHECK(through_the_door == results);
    size_t different = 0;
    outcomes.hits = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      shared.ray = rays[i];
      different += results[i] != static_cast<uint8_t>(bool{trace({}, shared)});
      outcomes.hits += results[i];
    }
    CHECK(different == 0);
  }
  set_isa(before);
  return outcomes;
}

/// From points of a grid of side `size`, in blocks of 4 x 4, to points of a light; t = 1 is the light.
std::vector<Ray> shadows(int size, const Point& light, float light_size, Random& random, float scale = 1) {
  std::vector<Ray> rays;
  const float step = 2.4f / static_cast<float>(size);
  for (int block = 0; block < size * size / 16; ++block)
    for (int i = 0; i < 16; ++i) {
      const int x = block % (size / 4) * 4 + i % 4, y = block / (size / 4) * 4 + i / 4;
      const float a = (static_cast<float>(x) + 0.5f) * step - 1.2f, b = (static_cast<float>(y) + 0.5f) * step - 1.2f;
      Point from = {a, b, -1.5f + 0.1f * a * b}, to = light;
      for (float& c : to) c += light_size * random.uniform(-1, 1);
      for (float& c : from) c *= scale;
      for (float& c : to) c *= scale;
      rays.push_back(ray_between(from, to));
      rays.back().t_max = 1;
    }
  return rays;
}

struct Tally {
  size_t packets = 0, rays = 0, hits = 0, shut_boxes = 0, other_masks = 0;
};

void judge(const PacketCase& c, const Hits& hits, const BundleProbe& probe, Tally& tally) {
  ++tally.packets;
  tally.other_masks += probe.other_masks;
  for (uint32_t rays = probe.taken; rays != 0; rays &= rays - 1) {
    const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
    ++tally.rays;
    for (int lane = 0; lane < 8; ++lane) {
      const auto& hit = hits[ray][lane];
      const bool inside = (probe.inside[lane] >> ray & 1) != 0;
      tally.shut_boxes += !inside;
      if (!hit || hit->t <= c.rays[ray].t_min || hit->t > c.rays[ray].t_max) continue;
      ++tally.hits;
      REQUIRE((probe.boxes >> lane & 1) != 0);
      REQUIRE(inside);
    }
  }
}

}  // namespace

TEST_CASE("a bundle's boxes lose no hit, and its rays test triangles as they do alone") {
  constexpr int cases = 3000;
  for (const auto& target : targets()) {
    CAPTURE(isa_name(target.isa));
    Tally tally;
    Random random(72);
    const float apart[] = {0, 1e-6f, 1e-3f, 0.05f, 0.5f};
    for (int i = 0; i < cases; ++i) {
      CAPTURE(i);
      PacketCase c = random_packet(random, apart[random.below(5)]);
      PacketQuestion question = question_of(c, random);
      const Hits hits = exact_hits(c);
      limit(c, hits, random, question);
      for (size_t ray = 0; ray < c.rays.size(); ++ray)
        c.rays[ray].t_max = std::max(c.rays[ray].t_min, question.t_far[ray]);
      BundleProbe probe;
      {
        const FloatEnvironment environment;
        target.functions.probe(question, probe);
      }
      if (probe.taken != 0) judge(c, hits, probe, tally);
    }
    std::printf("%s: %zu bundles, %zu rays, %zu hits, %zu boxes shut\n", isa_name(target.isa).data(), tally.packets,
                tally.rays, tally.hits, tally.shut_boxes);
    CHECK(tally.other_masks == 0);
    CHECK(tally.packets > cases / 4);
    CHECK(tally.hits > 5000);
    CHECK(tally.shut_boxes > 5000);
  }
}

TEST_CASE("shadow rays go in packets and hit what single rays hit") {
  Random random(8);
  size_t all = 0, hits = 0;
  for (const Mesh& mesh : {bumpy_sphere(4), torus(60, 30, 0.3f), cube(4)}) {
    const Block block = build_mesh(mesh);
    const auto rays = shadows(64, {0.3f, 0.2f, 4}, 0.05f, random);
    const Outcomes outcomes = compare(block, rays);
    CHECK(outcomes.in_packets > rays.size() / 2);
    CHECK(outcomes.hits > rays.size() / 10);
    all += rays.size();
    hits += outcomes.hits;
  }
  CHECK(hits < all);
}

TEST_CASE("shadow rays at huge and tiny scales, far away, and of parallel light") {
  Random random(9);
  for (const float scale : {1e-20f, 1e-9f, 1.0f, 1e9f, 1e15f}) {
    Mesh mesh = bumpy_sphere(3);
    for (Point& vertex : mesh.vertices)
      for (float& c : vertex) c *= scale;
    auto rays = shadows(32, {0.3f, 0.2f, 4}, 0.05f, random, scale);
    const Outcomes outcomes = compare(build_mesh(mesh), rays);
    CHECK(outcomes.hits > rays.size() / 10);
    if (scale > 1e-15f && scale < 1e12f) CHECK(outcomes.in_packets > rays.size() / 2);
    for (Ray& ray : rays) {
      ray.direction[0] = 0.1f, ray.direction[1] = 0, ray.direction[2] = 1;
      ray.t_max = infinity;
    }
    CHECK(compare(build_mesh(mesh), rays).hits > 0);
  }
}

TEST_CASE("shadow rays with limits of t at what they would hit") {
  const Block block = build_mesh(bumpy_sphere(3));
  Random random(10);
  auto rays = shadows(64, {0.3f, 0.2f, 4}, 0.05f, random);
  for (Ray& ray : rays) {
    const Hit hit = trace({}, request_for(block, ray));
    if (!hit) continue;
    const float at[] = {hit.t, std::nextafter(hit.t, 2.0f), std::nextafter(hit.t, 0.0f)};
    (random.chance(2) ? ray.t_max : ray.t_min) = at[random.below(3)];
  }
  const Outcomes outcomes = compare(block, rays);
  CHECK(outcomes.in_packets > rays.size() / 2);
  CHECK(outcomes.hits > rays.size() / 20);
}

TEST_CASE("shadow rays obey culling and opacity flags") {
  const Mesh near = bumpy_sphere(3), far = torus(40, 20, 0.3f);
  const Block block = build_geometries(std::vector{near.geometry(), far.geometry(geometry_flag::none)});
  Random random(11);
  const auto rays = shadows(64, {0.3f, 0.2f, 4}, 0.02f, random);
  const size_t all = compare(block, rays).hits;
  for (const uint32_t flags :
       {ray_flag::cull_back_facing_triangles, ray_flag::cull_front_facing_triangles, ray_flag::cull_opaque,
        ray_flag::cull_non_opaque, ray_flag::force_opaque | ray_flag::cull_non_opaque}) {
    const Outcomes outcomes = compare(block, rays, flags);
    CHECK(outcomes.in_packets > rays.size() / 2);
    CHECK(outcomes.hits > 0);
    CHECK(outcomes.hits <= all);
  }
}

TEST_CASE("shadow rays among rays that do not go together") {
  const Block block = build_mesh(bumpy_sphere(3));
  Random random(12);
  auto rays = shadows(64, {0.3f, 0.2f, 4}, 0.05f, random);
  for (size_t i = 0; i < rays.size(); ++i) {
    const size_t run = i / 96 % 4;
    if (run == 1)
      for (float& x : rays[i].direction) x = random.uniform(-1, 1);
    if (run == 2 && random.chance(3)) rays[i].direction[0] *= -1;
    if (run == 3 && random.chance(8)) rays[i].origin[random.below(3)] = random.chance(2) ? infinity : NAN;  // misses
    if (run == 3 && random.chance(8)) rays[i].origin[random.below(3)] += 3;
  }
  rays.resize(rays.size() - 5);
  const Outcomes outcomes = compare(block, rays);
  CHECK(outcomes.in_packets > rays.size() / 8);
  CHECK(outcomes.in_packets < rays.size() * 9 / 10);
}

TEST_CASE("shadow rays of needles and of axis-parallel grids") {
  Random random(13);
  CHECK(compare(build_mesh(needles(3000, 1e-2f, 1e-3f, random)), shadows(64, {0.3f, 0.2f, 4}, 0.05f, random)).hits >
        100);
  std::vector<Ray> rays;
  for (int i = 0; i < 1024; ++i) {
    const auto column = static_cast<float>(i % 32), row = static_cast<float>(i / 32);
    Ray ray{{column / 64 - 0.25f, row / 64 - 0.25f, -2}, 0, {0, 0, 1}, infinity};  // through edges and diagonals
    rays.push_back(ray);
  }
  const Outcomes outcomes = compare(build_mesh(cube(4)), rays);
  CHECK(outcomes.in_packets > rays.size() / 2);
  CHECK(outcomes.hits == rays.size());
}

}  // namespace rayloom::accel

#endif  // HWY_ONCE
