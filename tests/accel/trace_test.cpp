#include <rayloom/accel/walk.h>

#include <catch2/catch.hpp>

#include <cfenv>
#include <set>

#include "brute_force.h"
#include "random.h"
#include "recorder.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

constexpr float infinity = Box::infinity;

Ray random_ray(Random& random, float reach) {
  const auto any = [&] { return random.uniform(-reach, reach); };
  return ray_between({any(), any(), any()}, {any(), any(), any()});
}

std::vector<Ray> random_rays(uint64_t seed, size_t count, float reach) {
  Random random(seed);
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) rays.push_back(random_ray(random, reach));
  return rays;
}

void compare_with_brute_force(const Mesh& mesh, const std::vector<Ray>& rays) {
  const Block block = build_mesh(mesh);
  const auto triangles = all_triangles({mesh.geometry()});
  for_each_isa([&](Isa isa) {
    REQUIRE(current_isa() == isa);
    size_t different = 0, hits = 0;
    for (const Ray& ray : rays) {
      const Hit hit = trace({}, request_for(block, ray));
      hits += hit.type == HitType::triangle;
      different += !same_bits(hit, closest_of(all_hits(triangles, ray), ray));
    }
    CHECK(different == 0);
    CHECK(hits > rays.size() / 10);
  });
}

/// Two triangles over the origin, perpendicular to z, at the given distances; the second geometry has no opaque flag.
struct Layers {
  Layers(float near, float far) {
    opaque.add_triangle({-1, -1, near}, {0, 2, near}, {1, -1, near});
    other.add_triangle({-1, -1, far}, {0, 2, far}, {1, -1, far});
    block =
        std::make_unique<Block>(build_geometries(std::vector{opaque.geometry(), other.geometry(geometry_flag::none)}));
  }
  Mesh opaque, other;
  std::unique_ptr<Block> block;
};

Ray along_z(float t_min, float t_max, float speed = 1) { return {{0, 0, 0}, t_min, {0, 0, speed}, t_max}; }

}  // namespace

TEST_CASE("closest hits equal brute force bit for bit") {
  compare_with_brute_force(bumpy_sphere(3), random_rays(1, 1500, 1.5f));
  compare_with_brute_force(torus(40, 20, 0.3f), random_rays(2, 1500, 1.5f));
  compare_with_brute_force(cube(3), random_rays(3, 1500, 1.5f));
}

TEST_CASE("axis-parallel rays on an integer grid equal brute force") {
  const Mesh mesh = grid(12, 2);
  Random random(4);
  std::vector<Ray> rays;
  for (int i = 0; i < 1000; ++i) {
    const auto half = [&] { return 0.5f * static_cast<float>(random.below(25)); };
    const float zero = random.chance(2) ? -0.0f : 0.0f;
    rays.push_back({{half(), half(), random.chance(2) ? 0.f : 4.f}, 0, {zero, -zero, 0}, infinity});
    rays.back().direction[2] = rays.back().origin[2] == 0 ? 1.f : -1.f;
  }
  compare_with_brute_force(mesh, rays);
}

TEST_CASE("rejecting every candidate shows every hit once") {
  const Mesh mesh = bumpy_sphere(3);
  const Block block = build_mesh(mesh, geometry_flag::none);
  const auto triangles = all_triangles({mesh.geometry()});
  for_each_isa([&](Isa) {
    size_t different = 0;
    for (const Ray& ray : random_rays(5, 1000, 1.5f)) {
      Recorder recorder;
      const Hit hit = trace({}, recorder.request(block, ray));
      std::set<uint32_t> seen, expected;
      for (const Candidate& c : recorder.candidates) seen.insert(c.primitive_index);
      for (const Hit& h : all_hits(triangles, ray)) expected.insert(h.primitive_index);
      different += hit || seen != expected || recorder.candidates.size() != expected.size();
    }
    CHECK(different == 0);
  });
}

TEST_CASE("candidates come in one order for every kernel, the batch and the walk") {
  const Mesh mesh = torus(30, 16, 0.4f);
  const Block block = build_mesh(mesh, geometry_flag::none);
  for (const uint32_t flags : {ray_flag::none, ray_flag::accept_first_hit_and_end_search}) {
    for (const Ray& ray : random_rays(6, 300, 1.5f)) {
      const auto accept_third = [](const Candidate& c) { return Verdict{c.primitive_index % 3 == 0, false, c.t, 0}; };
      Recorder walked(accept_third);
      Visitor visitor;
      const Hit expected = walk({}, walked.request(block, ray, flags), visitor);
      for_each_isa([&](Isa) {
        Recorder one(accept_third), many(accept_third);
        const Hit hit = trace({}, one.request(block, ray, flags));
        const TraceRequest requests[] = {many.request(block, ray, flags)};
        Hit hits[1];
        trace({}, requests, hits);
        REQUIRE(same_bits(hit, expected));
        REQUIRE(same_bits(hits[0], expected));
        REQUIRE(one.trail() == walked.trail());
        REQUIRE(many.trail() == walked.trail());
      });
    }
  }
}

TEST_CASE("no candidate lies beyond the committed hit (TR-07)") {
  const Mesh mesh = torus(30, 16, 0.4f);
  const Block block = build_mesh(mesh, geometry_flag::none);
  for (const Ray& ray : random_rays(7, 500, 1.5f)) {
    Recorder recorder([](const Candidate& c) { return Verdict{c.primitive_index % 2 == 0, false, 0, 0}; });
    trace({}, recorder.request(block, ray));
    for (const Candidate& c : recorder.candidates) REQUIRE(c.t <= c.t_current);
  }
}

TEST_CASE("triangles are hit strictly inside the interval (EXT-01, EXT-05, EXT-06, EXT-08)") {
  const Layers layers(1, 2);
  const auto t_of = [&](float t_min, float t_max, float speed = 1) {
    const Hit hit = trace({}, request_for(*layers.block, along_z(t_min, t_max, speed)));
    return hit ? hit.t : -1;
  };
  for_each_isa([&](Isa) {
    CHECK(t_of(0, infinity) == 1);
    CHECK(t_of(0, 1) == -1);
    CHECK(t_of(0, std::nextafter(1.0f, 2.0f)) == 1);
    CHECK(t_of(1, 3) == 2);
    CHECK(t_of(std::nextafter(1.0f, 0.0f), 3) == 1);
    CHECK(t_of(1, 2) == -1);
    CHECK(t_of(1, 1) == -1);
    CHECK(t_of(0, infinity, 2) == 0.5f);
    CHECK(t_of(infinity, infinity) == -1);
  });
  const Layers touching(0, 2);
  CHECK(trace({}, request_for(*touching.block, along_z(0, infinity))).t == 2);
}

TEST_CASE("invalid rays miss and keep their t_max (TR-03, TR-17, TR-18)") {
  const Layers layers(1, 2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for_each_isa([&](Isa) {
    const auto misses = [&](const Ray& ray) { return !trace({}, request_for(*layers.block, ray)); };
    for (int k = 0; k < 3; ++k)
      for (const float bad : {nan, infinity, -infinity}) {
        Ray ray = along_z(0, infinity);
        ray.origin[k] = bad;
        CHECK(misses(ray));
        ray = along_z(0, infinity);
        ray.direction[k] = bad;
        CHECK(misses(ray));
      }
    CHECK(misses(along_z(nan, 3)));
    CHECK(misses(along_z(0, nan)));
    CHECK(misses(along_z(-1, 3)));
    CHECK(misses(along_z(3, 2)));
    CHECK(misses(along_z(0, infinity, 0)));
    TraceRequest null_structure = request_for(*layers.block, along_z(0, 7));
    null_structure.structure = nullptr;
    const Hit hit = trace({}, null_structure);
    CHECK(!hit);
    CHECK(hit.t == 7);
    CHECK(hit.instance_index == no_index);
    CHECK(hit.primitive_index == no_index);
  });
}

TEST_CASE("among equal triangles the smallest name wins, whatever the order of search (G3b)") {
  Mesh first, second;
  for (int i = 0; i < 40; ++i) first.add_triangle({-1, -1, 1}, {0, 2, 1}, {1, -1, 1});
  second = first;
  const Block swapped = build_geometries(std::vector{second.geometry(), first.geometry()});
  for_each_isa([&](Isa) {
    const Hit hit = trace({}, request_for(swapped, along_z(0, 5)));
    CHECK(hit.geometry_index == 0);
    CHECK(hit.primitive_index == 0);
  });
  const Block asked = build_geometries(std::vector{first.geometry(0), second.geometry(0)});
  Recorder recorder([](const Candidate& c) { return Verdict{c.geometry_index == 1 && c.primitive_index >= 7}; });
  const Hit hit = trace({}, recorder.request(asked, along_z(0, 5)));
  CHECK(hit.geometry_index == 1);
  CHECK(hit.primitive_index == 7);
}

TEST_CASE("without a candidate function non-opaque triangles count as opaque") {
  const Layers layers(2, 1);
  const Hit hit = trace({}, request_for(*layers.block, along_z(0, 5)));
  CHECK(hit.geometry_index == 1);
  CHECK(hit.t == 1);
}

TEST_CASE("ending the search keeps what is committed (TR-13, RF-04, RF-05)") {
  Mesh layers;
  for (const float z : {1.f, 2.f, 3.f}) layers.add_triangle({-1, -1, z}, {0, 2, z}, {1, -1, z});
  const Block block = build_mesh(layers, geometry_flag::none);
  Recorder end_at_once([](const Candidate&) { return Verdict{true, true}; });
  const Hit hit = trace({}, end_at_once.request(block, along_z(0, 9)));
  CHECK(hit);
  CHECK(end_at_once.candidates.size() == 1);
  CHECK(hit.primitive_index == end_at_once.candidates[0].primitive_index);

  Recorder ignore_then_end([](const Candidate&) { return Verdict{false, true}; });
  CHECK(!trace({}, ignore_then_end.request(block, along_z(0, 9))));
  CHECK(ignore_then_end.candidates.size() == 1);

  Recorder second_only([](const Candidate& c) { return Verdict{c.primitive_index == 1}; });
  CHECK(trace({}, second_only.request(block, along_z(0, 9), ray_flag::accept_first_hit_and_end_search)).t == 2);
}

TEST_CASE("the caller's rounding mode and flushing change nothing") {
  const Mesh mesh = moved(bumpy_sphere(2), 1e-3f, 1000);
  const Block block = build_mesh(mesh);
  Random random(8);
  std::vector<Ray> rays;
  for (int i = 0; i < 500; ++i) {
    const auto near = [&] { return 1000 + random.uniform(-1.5e-3f, 1.5e-3f); };
    rays.push_back(ray_between({near(), near(), near()}, {near(), near(), near()}));
  }
  std::vector<Hit> expected;
  for (const Ray& ray : rays) expected.push_back(trace({}, request_for(block, ray)));
  for_each_isa([&](Isa) {
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      std::fesetround(mode);
      const unsigned mxcsr = _mm_getcsr();
      _mm_setcsr(mxcsr | 0x8040);  // flush to zero, denormals are zero
      std::vector<Hit> hits;
      for (const Ray& ray : rays) hits.push_back(trace({}, request_for(block, ray)));
      const bool kept = std::fegetround() == mode && (_mm_getcsr() & 0x8040) == 0x8040;
      _mm_setcsr(mxcsr);
      std::fesetround(FE_TONEAREST);
      CHECK(kept);
      size_t different = 0;
      for (size_t i = 0; i < rays.size(); ++i) different += !same_bits(hits[i], expected[i]);
      CHECK(different == 0);
    }
  });
}

TEST_CASE("instruction sets have names and unsupported ones are refused") {
  CHECK(isa_name(Isa::scalar) == "scalar");
  CHECK(isa_name(Isa::avx2) == "avx2");
  CHECK(isa_name(Isa::avx512) == "avx512");
  CHECK(isa_supported(Isa::scalar));
  for (const Isa isa : {Isa::avx2, Isa::avx512})
    if (!isa_supported(isa)) CHECK_THROWS(set_isa(isa));
}

TEST_CASE("the walk sees what the trace does") {
  struct Counter : Visitor {
    void on_pop(uint32_t, float, bool culled) { culled ? ++culls : ++visits; }
    void on_node(const Node8*, uint32_t mask, const float (&)[8]) { ++nodes, children += std::popcount(mask); }
    void on_triangle_leaf(const TriangleLeaf*, uint32_t possible, uint32_t hit) {
      ++leaves;
      CHECK((hit & ~possible) == 0);
    }
    int visits = 0, culls = 0, nodes = 0, leaves = 0, children = 0;
  };
  const Block block = build_mesh(bumpy_sphere(3));
  for (const Ray& ray : random_rays(9, 200, 1.5f)) {
    Counter counter;
    walk({}, request_for(block, ray), counter);
    CHECK(counter.visits == counter.nodes + counter.leaves);
    CHECK(counter.visits + counter.culls == counter.children + 1);
  }
}
