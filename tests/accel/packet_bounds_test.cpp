// The error bounds of packets against exact integers: edge functions, the tests of t and of boxes, the rounded hits
// (docs/numerics.md, "Packets"). Compiled per target as accel/simd/kernel_highway.cpp is.

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rayloom/tests/accel/packet_bounds_test.cpp"
#include <hwy/foreach_target.h>  // before highway.h

#include <hwy/highway.h>

#include "packet_question.h"

#include <rayloom/accel/simd/packet_triangle-inl.h>

#ifndef RAYLOOM_TESTS_ACCEL_PACKET_BOUNDS_TEST
#define RAYLOOM_TESTS_ACCEL_PACKET_BOUNDS_TEST

namespace rayloom::accel {

using test::most_packet_rays;
using test::PacketQuestion;

/// What a packet finds out about a leaf of eight triangles and a node of eight boxes. Masks of rays have a bit a ray.
struct PacketProbe {
  uint32_t taken = 0;                  ///< rays; 0: nothing else is set
  uint32_t axis = 0;                   ///< the dominant one
  float edge[8][3][most_packet_rays];  ///< by triangle and edge 01, 12, 20
  float bound[8];                      ///< on their errors
  uint32_t triangles = 0;              ///< that some ray may hit
  uint32_t undecided[8] = {}, certain[8] = {};
  float t[8][most_packet_rays], u[8][most_packet_rays], v[8][most_packet_rays];
  uint32_t known[8] = {}, front[8] = {};
  double depth[8], errors[8][4];  ///< PacketTriangle: t's determinant; on the errors of t's, u's, v's and the area's
  uint32_t boxes = 0;             ///< that some ray may meet
  uint32_t inside[8] = {};        ///< rays that meet each box
  size_t others = 0;              ///< hits that differ when every ray has a triangle of its own
};

using ProbeFunction = void (*)(const PacketQuestion&, PacketProbe&);

}  // namespace rayloom::accel

#endif

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

static_assert(PencilRays::size == most_packet_rays);

void store(PacketVector v, size_t r, float (&out)[most_packet_rays]) {
  alignas(64) float lanes[packet_size];
  hn::Store(v, PacketFloats(), lanes);
  std::copy(lanes, lanes + packet_size, out + r * packet_size);
}

PacketVector limits_of(const PacketQuestion& question, size_t r) {
  return hn::LoadU(PacketFloats(), question.t_far + r * packet_size);
}

float last_far(const PencilRays& rays, const PacketQuestion& question) {
  float last = 0;
  for (size_t r = 0; r < PencilRays::rows; ++r) {
    const PacketVector far = rays.far_limit(limits_of(question, r));
    last = std::max(last, hn::GetLane(hn::MaxOfLanes(PacketFloats(), far)));
  }
  return last;
}

void probe_triangle(const PencilRays& rays, size_t r, const PacketQuestion& question, const PacketLeaf& leaf,
                    uint32_t lane, PacketProbe& out) {
  const auto shift = r * packet_size;
  const PacketEdges edges(rays.frame[r], leaf, lane);
  for (int i = 0; i < 3; ++i) store(edges.edge[i], r, out.edge[lane][i]);
  const uint32_t taken = PencilRays::part_of(out.taken, r);
  const PacketMasks masks = test_triangle(rays, r, leaf, lane, taken, limits_of(question, r));
  out.undecided[lane] |= masks.undecided << shift;
  out.certain[lane] |= masks.certain << shift;
  const PacketHits hits = hit_triangles(rays, r, CommonCorners(question.leaf, lane), all_rays);
  store(hits.t, r, out.t[lane]);
  store(hits.u, r, out.u[lane]);
  store(hits.v, r, out.v[lane]);
  out.known[lane] |= hits.known << shift;
  out.front[lane] |= hits.front << shift;
}

void probe_errors(const PencilRays& rays, const PacketQuestion& question, uint32_t lane, PacketProbe& out) {
  const CommonCorners corners(question.leaf, lane);
  const PacketTriangle triangle(rays, corners.corner<0>(0), corners.corner<0>(1), corners.corner<0>(2));
  out.depth[lane] = hn::GetLane(triangle.depth);
  out.errors[lane][0] = hn::GetLane(triangle.depth_error);
  out.errors[lane][1] = hn::GetLane(triangle.u_error);
  out.errors[lane][2] = hn::GetLane(triangle.v_error);
  out.errors[lane][3] = hn::GetLane(triangle.area_error);
}

void probe_leaf(const PencilRays& rays, const PacketQuestion& question, PacketProbe& out) {
  PacketLeaf leaf;
  const float deepest = last_far(rays, question) * rays.depth_scale;
  out.triangles = leaf.load(rays, question.leaf, hn::Set(Floats(), deepest));
  for (uint32_t lane = 0; lane < 8; ++lane) {
    out.bound[lane] = leaf.bound[lane];
    probe_errors(rays, question, lane, out);
    for (size_t r = 0; r < PencilRays::rows; ++r) probe_triangle(rays, r, question, leaf, lane, out);
  }
}

/// Ray i with triangle i + shift, against what each triangle gave for all rays.
void probe_own_corners(const PencilRays& rays, size_t r, const PacketQuestion& question, uint32_t shift,
                       PacketProbe& out) {
  const PacketWords w;
  const auto lanes = hn::And(hn::Add(hn::Iota(w, 0), hn::Set(w, shift)), hn::Set(w, 7));
  const PacketHits hits = hit_triangles(rays, r, OwnCorners(question.leaf, lanes), all_rays);
  float t[most_packet_rays], u[most_packet_rays], v[most_packet_rays];
  store(hits.t, 0, t);
  store(hits.u, 0, u);
  store(hits.v, 0, v);
  for (uint32_t i = 0; i < packet_size; ++i) {
    const uint32_t lane = (i + shift) & 7, ray = static_cast<uint32_t>(r * packet_size) + i;
    const bool known = (out.known[lane] >> ray & 1) != 0;
    const bool same = t[i] == out.t[lane][ray] && u[i] == out.u[lane][ray] && v[i] == out.v[lane][ray];
    out.others += known != ((hits.known >> i & 1) != 0) || (known && !same);
    out.others += (hits.front >> i & 1) != (out.front[lane] >> ray & 1);
  }
}

void probe_boxes(const PencilRays& rays, const PacketQuestion& question, PacketProbe& out) {
  PacketVector first = rays.near_limit(0);
  for (size_t r = 1; r < PencilRays::rows; ++r) first = hn::Min(first, rays.near_limit(r));
  const auto near = hn::Set(Floats(), hn::GetLane(hn::MinOfLanes(PacketFloats(), first)));
  out.boxes = test_boxes(rays, question.node, near, hn::Set(Floats(), last_far(rays, question))).mask;
  for (int lane = 0; lane < 8; ++lane)
    for (size_t r = 0; r < PencilRays::rows; ++r) {
      const PacketVector far = rays.far_limit(limits_of(question, r));
      const uint32_t inside = test_child(rays, rays.row[r], question.node, lane, rays.near_limit(r), far);
      out.inside[lane] |= inside << (r * packet_size);
    }
}

void probe(const PacketQuestion& question, PacketProbe& out) {
  const RayRun run{nullptr, question.rays, sizeof(Ray), PencilRays::size};
  PencilRays rays;
  out.taken = rays.load(run, PencilRays::everyone, question.header, 1);
  if (out.taken == 0) return;
  out.axis = rays.middle.axis[2];
  probe_leaf(rays, question, out);
  for (uint32_t shift = 0; shift < 8; ++shift)
    for (size_t r = 0; r < PencilRays::rows; ++r) probe_own_corners(rays, r, question, shift, out);
  probe_boxes(rays, question, out);
}

ProbeFunction probe_function() { return probe; }

#endif

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include "packet_cases.h"
#include "targets.h"

#include <rayloom/base/float_environment.h>

#include <catch2/catch.hpp>
#include <cstdio>

namespace rayloom::accel {
namespace {

using namespace test;

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

/// Against the bounds of docs/numerics.md, 2.2, for a direction whose dominant component is 1.
void judge_errors(const PacketCase& c, const PacketProbe& probe, int lane) {
  const auto& corners = c.triangles[lane];
  double edge1 = 0, edge2 = 0, point = 0;
  for (int k = 0; k < 3; ++k) {
    edge1 += std::fabs(double{corners[1][k]} - double{corners[0][k]});
    edge2 += std::fabs(double{corners[2][k]} - double{corners[0][k]});
    point += std::fabs(double{corners[0][k]} - double{c.rays[0].origin[k]});
  }
  const double edges = edge1 * edge2, reach = point + edge1 + edge2, rounding = 8 * 0x1p-53;
  const double proved[] = {rounding * (3 * edges * reach + std::fabs(probe.depth[lane])), rounding * edge2 * reach,
                           rounding * edge1 * reach, rounding * edges};
  for (int i = 0; i < 4; ++i) REQUIRE(std::fabs(probe.errors[lane][i] - proved[i]) <= 1e-14 * proved[i]);
}

void judge(const PacketCase& c, const Hits& hits, const PacketQuestion& question, const PacketProbe& probe,
           Tally& tally) {
  ++tally.packets;
  for (int lane = 0; lane < 8; ++lane) judge_errors(c, probe, lane);
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
  constexpr int cases = 1500;
  for (const auto& target : supported_targets(N_AVX2::probe_function(), N_AVX3::probe_function())) {
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
        target.functions(question, probe);
      }
      REQUIRE(probe.others == 0);
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
