// The error bounds of packets against exact integers: edge functions, the tests of t and of boxes, the rounded hits
// (docs/numerics.md, "Packets"). Compiled per target as accel/simd/kernel_highway.cpp is.

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/tests/accel/packet_bounds_test.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <hwy/highway.h>

#include <rayloom/accel/layout.h>
#include <rayloom/accel/simd/packet_triangle-inl.h>

#ifndef RAYLOOM_TESTS_ACCEL_PACKET_BOUNDS_TEST
#define RAYLOOM_TESTS_ACCEL_PACKET_BOUNDS_TEST

namespace rayloom::accel {

inline constexpr uint32_t most_rays = 16;

/// What a packet finds out about a leaf of eight triangles and a node of eight boxes. Masks of rays have a bit a ray.
struct PacketProbe {
  uint32_t taken = 0;           ///< rays; 0: nothing else is set
  uint32_t axis = 0;            ///< the dominant one
  float edge[8][3][most_rays];  ///< by triangle and edge 01, 12, 20
  float bound[8];               ///< on their errors
  uint32_t triangles = 0;       ///< that some ray may hit
  uint32_t undecided[8], certain[8];
  float t[8][most_rays], u[8][most_rays], v[8][most_rays];
  uint32_t known[8], front[8];
  uint32_t boxes = 0;  ///< that some ray may meet
  uint32_t inside[8];  ///< rays that meet each box
};

struct PacketQuestion {
  const Ray* rays;
  float t_far[most_rays];
  StructureHeader header;
  Node8 node;
  PlainTriangleLeaf leaf;
};

using ProbeFunction = void (*)(const PacketQuestion&, PacketProbe&);

}  // namespace rayloom::accel

#endif

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

void store(PacketVector v, float (&out)[most_rays]) {
  alignas(64) float lanes[packet_size];
  hn::Store(v, PacketFloats(), lanes);
  std::copy(lanes, lanes + packet_size, out);
}

void probe_leaf(const PacketRays& rays, const PacketQuestion& question, PacketVector t_far, PacketProbe& out) {
  const float last = hn::GetLane(hn::MaxOfLanes(PacketFloats(), rays.far_limit(t_far)));
  PacketLeaf leaf;
  out.triangles = leaf.load(rays, question.leaf, hn::Set(Floats(), last * rays.depth_scale));
  for (uint32_t lane = 0; lane < 8; ++lane) {
    const PacketEdges edges(rays, leaf, lane);
    for (int i = 0; i < 3; ++i) store(edges.edge[i], out.edge[lane][i]);
    out.bound[lane] = leaf.bound[lane];
    const PacketMasks masks = test_triangle(rays, leaf, lane, out.taken, t_far);
    out.undecided[lane] = masks.undecided;
    out.certain[lane] = masks.certain;
    const PacketHits hits = hit_triangle(rays, PacketCorners(question.leaf, lane), all_rays);
    store(hits.t, out.t[lane]);
    store(hits.u, out.u[lane]);
    store(hits.v, out.v[lane]);
    out.known[lane] = hits.known;
    out.front[lane] = hits.front;
  }
}

void probe_boxes(const PacketRays& rays, const Node8& node, PacketVector t_far, PacketProbe& out) {
  const PacketVector near = rays.near_limit(), far = rays.far_limit(t_far);
  const float first_near = hn::GetLane(hn::MinOfLanes(PacketFloats(), near));
  const float last_far = hn::GetLane(hn::MaxOfLanes(PacketFloats(), far));
  out.boxes = test_boxes(rays, node, hn::Set(Floats(), first_near), hn::Set(Floats(), last_far)).mask;
  for (int lane = 0; lane < 8; ++lane) out.inside[lane] = test_child(rays, node, lane, near, far);
}

void probe(const PacketQuestion& question, PacketProbe& out) {
  const RayRun run{nullptr, question.rays, sizeof(Ray), packet_size};
  PacketRays rays;
  out.taken = rays.load(run, all_rays, question.header, 1);
  if (out.taken == 0) return;
  out.axis = rays.middle.axis[2];
  const PacketVector t_far = hn::LoadU(PacketFloats(), question.t_far);
  probe_leaf(rays, question, t_far, out);
  probe_boxes(rays, question.node, t_far, out);
}

ProbeFunction probe_function() { return probe; }

#endif

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include "integer_oracle.h"
#include "lane_cases.h"
#include "structures.h"

#include <rayloom/base/float_environment.h>

#include <catch2/catch.hpp>
#include <cstdio>

namespace rayloom::accel {
namespace {

using namespace test;

constexpr float infinity = std::numeric_limits<float>::infinity();

struct Target {
  Isa isa;
  ProbeFunction probe;
};

std::vector<Target> targets() {
  std::vector<Target> all;
  if (isa_supported(Isa::avx2)) all.push_back({Isa::avx2, N_AVX2::probe_function()});
  if (isa_supported(Isa::avx512)) all.push_back({Isa::avx512, N_AVX3::probe_function()});
  return all;
}

/// Rays of one origin, and triangles that graze them, lie beside them by an edge or a corner, or behind.
struct PacketCase {
  std::vector<Ray> rays = std::vector<Ray>(most_rays);
  std::vector<Triangle> triangles;
};

/// Of any slope: in a plane of the axes, on a diagonal (where the dominant axis is a tie or nearly so), anywhere.
Point main_direction(Random& random) {
  Point d = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  const uint32_t style = random.below(4), axis = random.below(3);
  if (style == 0) d[axis] = random.chance(2) ? 0.0f : random.scaled(-40, -10);
  if (style == 1) d[axis] = random.nudged(std::copysign(d[(axis + 1) % 3], d[axis]), 2);
  if (style == 2) d[axis] = d[(axis + 1) % 3] = random.scaled(-30, -1);
  return d;
}

void aim(Random& random, float scale, PacketCase& out) {
  const float length = std::ldexp(1.0f, static_cast<int>(random.below(60)) - 30);
  const float spreads[] = {0, 1e-7f, 1e-4f, 0.01f, 0.05f};
  const float spread = spreads[random.below(5)], distance = random.chance(3) ? 1e3f : 1;
  const Point middle = main_direction(random);
  float origin[3];
  for (float& x : origin) x = random.uniform(-1, 1) * scale * distance;
  for (Ray& ray : out.rays) {
    std::copy_n(origin, 3, ray.origin);
    for (int k = 0; k < 3; ++k)
      ray.direction[k] = random.nudged(middle[k] * (1 + spread * random.uniform(-1, 1)), random.below(3)) * length;
    ray.t_min = 0;
    ray.t_max = infinity;
  }
}

/// Around a point of one of the rays.
Triangle beside(Random& random, const Ray& ray, float scale) {
  const float far = std::ldexp(scale, static_cast<int>(random.below(16)) - 8) * (random.chance(12) ? -1.0f : 1.0f);
  const float size = std::fabs(far) * std::ldexp(1.0f, static_cast<int>(random.below(28)) - 24);
  float dominant = 0;
  for (const float x : ray.direction) dominant = std::max(dominant, std::fabs(x));
  Point at, along;
  for (int k = 0; k < 3; ++k) along[k] = ray.direction[k] / dominant, at[k] = ray.origin[k] + along[k] * far;
  const auto off = [&](float by) {
    return Point{at[0] + by * random.uniform(-1, 1), at[1] + by * random.uniform(-1, 1),
                 at[2] + by * random.uniform(-1, 1)};
  };
  Triangle t = {off(size), off(size), off(size)};
  const uint32_t kind = random.below(6);
  if (kind == 0) t[random.below(3)] = at;
  if (kind == 1)  // an edge through the point
    for (int k = 0; k < 3; ++k) t[1][k] = at[k] - (t[0][k] - at[k]) * 0.5f;
  if (kind == 2)  // nearly edge on
    for (int k = 0; k < 3; ++k) {
      t[0][k] = at[k] - along[k] * size + 1e-6f * (t[0][k] - at[k]);
      t[1][k] = at[k] + along[k] * size + 1e-6f * (t[1][k] - at[k]);
      t[2][k] = at[k] + 1e-6f * (t[2][k] - at[k]);
    }
  if (kind == 4) {  // a sliver around the point: certainly hit, with hardly any area
    const float thin = std::ldexp(1.0f, -4 - static_cast<int>(random.below(20)));
    const Triangle wide = {off(8 * size), off(8 * size), off(8 * size)};
    for (int k = 0; k < 3; ++k) {
      const float across = thin * (wide[1][k] - at[k]);
      t[0][k] = wide[0][k] - across / 3;
      t[1][k] = at[k] - 0.7f * (wide[0][k] - at[k]) - across / 3;
      t[2][k] = at[k] + 0.1f * (wide[0][k] - at[k]) + across;
    }
  }
  if (kind == 3)  // large and close by
    for (Point& corner : t) corner = off(16 * std::fabs(far));
  return t;
}

PacketCase random_packet(Random& random) {
  PacketCase out;
  const float scale = std::ldexp(1.0f, static_cast<int>(random.below(64)) - 42);
  aim(random, scale, out);
  for (int i = 0; i < 8; ++i) out.triangles.push_back(beside(random, out.rays[random.below(most_rays)], scale));
  return out;
}

PacketQuestion question_of(const PacketCase& c, Random& random) {
  PacketQuestion question{c.rays.data(), {}, {}, {}, plain_leaf(8)};
  Box root;
  for (int lane = 0; lane < 8; ++lane) {
    Box box;
    for (int i = 0; i < 3; ++i) {
      const Point& p = c.triangles[lane][i];
      box.extend({p[0], p[1], p[2]});
      for (int k = 0; k < 3; ++k) question.leaf.vertex[k][i][lane] = p[k];
    }
    for (int k = 0; k < 3; ++k)
      question.node.bounds[k][0][lane] = box.min[k], question.node.bounds[k][1][lane] = box.max[k];
    root.extend(box.min, box.max);
  }
  for (int k = 0; k < 3; ++k) {
    const float more = random.chance(2) ? 0 : random.uniform(0, 4) * (root.max[k] - root.min[k]);
    question.header.bounds_min[k] = root.min[k] - more;
    question.header.bounds_max[k] = root.max[k] + more;
  }
  return question;
}

using Hits = std::vector<std::array<std::optional<IntegerHit>, 8>>;  ///< by ray and triangle

Hits exact_hits(const PacketCase& c) {
  Hits hits(c.rays.size());
  for (size_t i = 0; i < c.rays.size(); ++i)
    for (int lane = 0; lane < 8; ++lane) hits[i][lane] = integer_hit(c.rays[i], c.triangles[lane]);
  return hits;
}

/// Limits at hits, or a float beside them.
void limit(PacketCase& c, const Hits& hits, Random& random, PacketQuestion& question) {
  for (size_t i = 0; i < c.rays.size(); ++i) {
    question.t_far[i] = infinity;
    const auto& hit = hits[i][random.below(8)];
    if (!hit || !(hit->t > 0) || std::isinf(hit->t)) continue;
    const uint32_t kind = random.below(8);
    if (kind < 4) question.t_far[i] = kind == 0 ? std::nextafter(hit->t, 0.0f) : hit->t;
    if (kind == 4) c.rays[i].t_min = hit->t;
    if (kind == 5) c.rays[i].t_min = std::nextafter(hit->t, 0.0f);
  }
}

struct Tally {
  size_t packets = 0, rays = 0, hits = 0, certain = 0, undecided = 0, out_of_range = 0, known = 0, shut_boxes = 0;
  double worst = 0;  ///< error of an edge function over its bound
};

/// |computed - exact| / bound, exactly compared.
double error_of_bound(const PacketCase& c, const PacketProbe& probe, int lane, uint32_t ray, int edge) {
  const IntegerTest test(c.rays[ray], c.triangles[lane]);
  mpq_class exact(test.edge(edge, (edge + 1) % 3), test.d[probe.axis]);
  exact.canonicalize();
  exact /= mpq_class(mpz_class(1) << 298);
  const mpq_class error = abs(mpq_class(probe.edge[lane][edge][ray]) - exact);
  REQUIRE(error <= mpq_class(probe.bound[lane]));
  return mpq_class(error / mpq_class(probe.bound[lane])).get_d();
}

void judge_triangle(const PacketCase& c, const PacketProbe& probe, int lane, uint32_t ray,
                    const std::optional<IntegerHit>& hit, float t_far, Tally& tally) {
  const auto has = [&](uint32_t mask) { return (mask >> ray & 1) != 0; };
  const bool wanted = hit && c.rays[ray].t_min < hit->t && hit->t <= t_far;
  const bool seen = has(probe.certain[lane]) || has(probe.undecided[lane]);
  if (wanted) {
    REQUIRE(seen);
    REQUIRE((probe.triangles >> lane & 1) != 0);
    REQUIRE((probe.boxes >> lane & 1) != 0);
    REQUIRE(has(probe.inside[lane]));
  }
  if (has(probe.certain[lane])) {
    REQUIRE(hit);
    ++tally.certain;
    if (has(probe.known[lane])) {
      ++tally.known;
      REQUIRE(probe.t[lane][ray] == hit->t);
      REQUIRE(probe.u[lane][ray] == hit->u);
      REQUIRE(probe.v[lane][ray] == hit->v);
      REQUIRE(has(probe.front[lane]) == hit->front);
    }
  }
  tally.hits += wanted;
  tally.undecided += has(probe.undecided[lane]);
  tally.out_of_range += hit && !seen;
  tally.shut_boxes += !has(probe.inside[lane]);
}

void judge(const PacketCase& c, const Hits& hits, const PacketQuestion& question, const PacketProbe& probe,
           Tally& tally) {
  ++tally.packets;
  for (uint32_t rays = probe.taken; rays != 0; rays &= rays - 1) {
    const auto ray = static_cast<uint32_t>(std::countr_zero(rays));
    ++tally.rays;
    for (int lane = 0; lane < 8; ++lane) {
      for (int edge = 0; edge < 3; ++edge)
        tally.worst = std::max(tally.worst, error_of_bound(c, probe, lane, ray, edge));
      judge_triangle(c, probe, lane, ray, hits[ray][lane], question.t_far[ray], tally);
    }
  }
}

}  // namespace

TEST_CASE("what a packet says of triangles and boxes is true of every ray in it") {
  constexpr int cases = 3000;
  for (const Target& target : targets()) {
    CAPTURE(isa_name(target.isa));
    Tally tally;
    Random random(71);
    for (int i = 0; i < cases; ++i) {
      CAPTURE(i);
      PacketCase c = random_packet(random);
      PacketQuestion question = question_of(c, random);
      const Hits hits = exact_hits(c);
      limit(c, hits, random, question);
      PacketProbe probe;
      {
        const FloatEnvironment environment;
        target.probe(question, probe);
      }
      if (probe.taken != 0) judge(c, hits, question, probe, tally);
    }
    std::printf(
        "%s: %zu packets, %zu rays, %zu hits, %zu certain (%zu rounded), %zu undecided, %zu hits out of range "
        "left out, %zu boxes shut, error over bound %.3f\n",
        isa_name(target.isa).data(), tally.packets, tally.rays, tally.hits, tally.certain, tally.known, tally.undecided,
        tally.out_of_range, tally.shut_boxes, tally.worst);
    CHECK(tally.packets > cases / 3);
    CHECK(tally.hits > 10000);
    CHECK(tally.certain > 10000);
    CHECK(tally.undecided > 1000);
    CHECK(tally.out_of_range > 1000);
    CHECK(tally.shut_boxes > 10000);
    CHECK(tally.known > tally.certain * 9 / 10);
    CHECK(tally.worst > 0.05);
  }
}

}  // namespace rayloom::accel

#endif  // HWY_ONCE
