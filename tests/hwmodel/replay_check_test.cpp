// The replay computes (guarantee G6): whatever is dropped from a capture or altered in it must be noticed.

#include "synthetic.h"

#include <rayloom/accel/build.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <functional>

using namespace rayloom;
using namespace rayloom::hwmodel;
using namespace rayloom::hwmodel::test;

namespace {

/// A top level over a cloud of triangles, some not opaque, and a cloud of spheres' boxes, each in two instances.
struct Scene {
  Arena arena{8 << 20};
  uint64_t top_level = 0;

  /// `row`: the boxes lie along a diagonal instead.
  explicit Scene(const accel::BuildSettings& settings = 0, bool row = false);

 private:
  uint64_t build_triangles();
  uint64_t build_boxes(bool row);
};

uint64_t Scene::build_triangles() {
  std::vector<float> vertices;
  for (int i = 0; i < 300; ++i)
    for (int corner = 0; corner < 3; ++corner)
      for (int axis = 0; axis < 3; ++axis)
        vertices.push_back(static_cast<float>((i * 37 + corner * 11 + axis * 53 + i * corner * axis * 7) % 64) / 8 - 4);
  std::vector<accel::TriangleGeometry> geometries(2);
  for (size_t i = 0; i < 2; ++i) {
    geometries[i].vertices = reinterpret_cast<const std::byte*>(vertices.data() + i * 450 * 3);
    geometries[i].vertex_count = 450;
    geometries[i].triangle_count = 150;
    geometries[i].flags = i == 0 ? accel::geometry_flag::opaque : accel::geometry_flag::none;
  }
  const uint64_t bytes = accel::bottom_level_sizes(geometries, 0).result_bytes;
  const uint64_t address = arena.allocate(bytes);
  accel::build_bottom_level(geometries, 0, {&arena.at<std::byte>(address), bytes});
  return address;
}

uint64_t Scene::build_boxes(bool row) {
  std::vector<float> boxes;
  for (int i = 0; i < 40; ++i) {
    const float cloud[3] = {float(i * 7 % 11) - 5, float(i * 5 % 9) - 4, float(i * 3 % 13) - 6};
    const float line[3] = {float(i) / 4 - 5, float(i) / 5 - 4, float(i) / 3 - 6};
    for (const float half : {-0.5f, 0.5f})
      for (const float c : row ? line : cloud) boxes.push_back(c + half);
  }
  accel::AabbGeometry geometry;
  geometry.boxes = reinterpret_cast<const std::byte*>(boxes.data());
  geometry.box_count = 40;
  const uint64_t bytes = accel::bottom_level_sizes({&geometry, 1}, 0).result_bytes;
  const uint64_t address = arena.allocate(bytes);
  accel::build_bottom_level({&geometry, 1}, 0, {&arena.at<std::byte>(address), bytes});
  return address;
}

Scene::Scene(const accel::BuildSettings& settings, bool row) {
  const uint64_t blocks[] = {build_triangles(), build_boxes(row)};
  std::vector<accel::InstanceDesc> instances(4);
  for (size_t i = 0; i < 4; ++i) {
    instances[i] = {
        {{1, 0, 0, float(i) * 1.5f}, {0, 1, 0, 0}, {0, 0, 1, float(i) * 0.5f}}, 0, 0xFF, 0, 0, blocks[i % 2]};
  }
  instances[3].instance_mask = 0x0F;
  const uint64_t bytes = accel::top_level_sizes(4, settings).result_bytes;
  top_level = arena.allocate(bytes);
  accel::build_top_level(instances, arena.addresses(), settings, {&arena.at<std::byte>(top_level), bytes});
}

/// Shader: accepts every third candidate; procedural ones in the middle of what is left of the ray.
struct Decider {
  LaneScript* lane;
  uint32_t asked = 0;
  static accel::Verdict decide(void* user, const accel::Candidate& candidate) noexcept {
    auto& self = *static_cast<Decider*>(user);
    const bool procedural = candidate.type == accel::HitType::procedural;
    self.lane->begin(procedural ? 2 : 1, 64);
    self.lane->load(1024 + candidate.primitive_index * 4, 4);
    self.lane->end();
    const bool commit = self.asked++ % 3 == 0;
    return {commit, false, procedural ? candidate.t_current / 2 : 0, procedural ? 7u : 0u};
  }
};

constexpr uint64_t picture = 0x200000;

Capture capture_scene(const Scene& scene, uint32_t lanes = 200) {
  const std::vector<ShaderInfo> shaders{shader("raygen", 16), shader("any hit", 4, ShaderStage::any_hit),
                                        shader("sphere", 9, ShaderStage::intersection),
                                        shader("closest hit", 12, ShaderStage::closest_hit)};
  return capture_lanes(scene.arena, shaders, lanes, [&](LaneScript& lane, uint32_t index) {
    lane.begin(0, 32);
    for (uint32_t bounce = 0; bounce < 2; ++bounce) {
      const accel::Ray ray{
          {float(index % 20) / 2 - 5, float(index / 20) - 5, -9}, 0, {0.1f * float(bounce), 0.05f, 1}, 100};
      Decider decider{&lane};
      const uint32_t flags = bounce ? accel::ray_flag::accept_first_hit_and_end_search : 0;
      const accel::Hit hit = lane.trace(scene.top_level, ray, flags, Decider::decide, &decider);
      if (hit) lane.begin(3, 128), lane.load(4096 + hit.primitive_index * 16, 16), lane.end();
      uint32_t bits;
      std::memcpy(&bits, &hit.t, sizeof bits);
      lane.store(picture + (index * 2 + bounce) * 4, bits);
    }
    lane.end();
  });
}

GpuConfig small_gpu() {
  GpuConfig config;
  config.sm.count = 2;
  config.sm.warp_slots = 8;
  return config;
}

/// Replays with one thing changed; true: the replay refused.
bool refused(const Capture& capture, const std::function<void(WarpCapture&)>& alter) {
  Capture altered = capture;
  alter(altered.warps[1]);
  try {
    run(altered, small_gpu());
  } catch (const ReplayMismatch&) {
    return true;
  }
  return false;
}

/// Takes event `index` out, as if it had never been written.
void drop_event(WarpCapture& warp, size_t index) {
  warp.events.erase(warp.events.begin() + static_cast<std::ptrdiff_t>(index));
  for (RayCapture& ray : warp.rays) {
    if (ray.event_begin > index) {
      --ray.event_begin;
    } else if (index < size_t{ray.event_begin} + ray.event_count) {
      --ray.event_count;
    }
  }
}

}  // namespace

TEST_CASE("an untouched capture replays, and holds events of every kind") {
  const Scene scene;
  const Capture capture = capture_scene(scene);
  const CaptureCounts counts = count(capture);
  CHECK(counts.nodes > 0);
  CHECK(counts.triangle_leaves > 0);
  CHECK(counts.procedural_leaves > 0);
  CHECK(counts.instances > 0);
  CHECK(counts.candidates > 0);
  CHECK(counts.rays == 400);
  CHECK_FALSE(refused(capture, [](WarpCapture&) {}));
}

TEST_CASE("instances entered at several nodes replay, and hit the same") {
  Scene plain(0, true), rebraided({accel::build_flag::none, accel::Builder::automatic, true}, true);
  const auto info = accel::structure_info(&rebraided.arena.at<std::byte>(rebraided.top_level));
  REQUIRE(info.leaves > info.active_primitives);
  const Capture capture = capture_scene(rebraided);
  CHECK_FALSE(refused(capture, [](WarpCapture&) {}));
  CHECK(count(capture).instances != count(capture_scene(plain)).instances);
  // The shaders of the other captures commit every third candidate, so that their hits depend on the order.
  const accel::Ray ray{{0.3f, 0.2f, -9}, 0, {0, 0.05f, 1}, 100};
  const auto hit = [&](Scene& scene) {
    return accel::trace(scene.arena.addresses(), {ray, &scene.arena.at<std::byte>(scene.top_level)});
  };
  CHECK(hit(plain));
  CHECK(hit(plain).t == hit(rebraided).t);
}

TEST_CASE("dropping any one event of a warp is noticed") {
  const Scene scene;
  const Capture capture = capture_scene(scene, 64);
  const size_t events = capture.warps[1].events.size();
  REQUIRE(events > 200);
  std::array<int, 6> kinds{};
  for (size_t i = 0; i < events; ++i) {
    ++kinds[static_cast<size_t>(capture.warps[1].events[i].kind)];
    INFO("event " << i << ", " << ray_event_kind_name(capture.warps[1].events[i].kind));
    REQUIRE(refused(capture, [&](WarpCapture& warp) { drop_event(warp, i); }));
  }
  for (const int kind : kinds) CHECK(kind > 0);
}

TEST_CASE("altering any field of an event is noticed, every third event of a warp tried") {
  const Scene scene;
  const Capture capture = capture_scene(scene, 64);
  const std::pair<const char*, std::function<void(RayEvent&)>> alterations[] = {
      {"address", [](RayEvent& e) { e.address += 32; }},
      {"payload", [](RayEvent& e) { e.payload += 1; }},
      {"kind", [](RayEvent& e) { e.kind = static_cast<RayEventKind>((static_cast<int>(e.kind) + 1) % 6); }},
      {"mask", [](RayEvent& e) { e.mask ^= 1; }},
      {"digest", [](RayEvent& e) { e.digest ^= 0x100; }}};
  for (size_t i = 0; i < capture.warps[1].events.size(); i += 3)
    for (const auto& [name, alter] : alterations) {
      INFO("event " << i << ", " << name);
      REQUIRE(refused(capture, [&, &alter = alter](WarpCapture& warp) { alter(warp.events[i]); }));
    }
}

TEST_CASE("altering a verdict, a candidate, a hit or a ray is noticed") {
  const Scene scene;
  const Capture capture = capture_scene(scene, 64);
  const WarpCapture& warp = capture.warps[1];
  for (size_t i = 0; i < warp.candidates.size(); ++i) {
    INFO("candidate " << i);
    const auto candidate = [&](auto change) {
      return refused(capture, [&](WarpCapture& w) { change(w.candidates[i]); });
    };
    REQUIRE(candidate([](CandidateCapture& c) { c.verdict.commit = !c.verdict.commit; }));
    REQUIRE(candidate([](CandidateCapture& c) { c.verdict.end_search = !c.verdict.end_search; }));
    REQUIRE(candidate([](CandidateCapture& c) { c.verdict.t += 0.5f; }));
    REQUIRE(candidate([](CandidateCapture& c) { c.verdict.hit_kind ^= 1; }));
    REQUIRE(candidate([](CandidateCapture& c) { c.primitive_index ^= 1; }));
    REQUIRE(candidate([](CandidateCapture& c) { c.t_current += 1; }));
  }
  for (size_t i = 0; i < warp.rays.size(); ++i) {
    INFO("ray " << i);
    const auto ray = [&](auto change) { return refused(capture, [&](WarpCapture& w) { change(w.rays[i]); }); };
    REQUIRE(ray([](RayCapture& r) { r.hit.t = std::nextafter(r.hit.t, 0.0f); }));
    REQUIRE(ray([](RayCapture& r) { r.hit.u += 0.01f; }));
    REQUIRE(ray([](RayCapture& r) { r.hit.primitive_index ^= 1; }));
    REQUIRE(ray([](RayCapture& r) { r.hit.hit_kind ^= 1; }));
    REQUIRE(ray([](RayCapture& r) { r.structure_address += 256; }));
    // A ray that meets no box but the root's may move a little and do the same.
    if (warp.rays[i].event_count > 4) REQUIRE(ray([](RayCapture& r) { r.ray.origin[0] += 0.01f; }));
  }
}

TEST_CASE("a structure that changed after the capture is noticed") {
  Scene scene;
  const Capture capture = capture_scene(scene, 64);
  const RayEvent* node = nullptr;
  for (const RayEvent& event : capture.warps[1].events)
    if (event.kind == RayEventKind::node && event.mask) node = &event;
  REQUIRE(node);
  auto& bytes = scene.arena.at<accel::Node8>(node->address);
  for (float& plane : bytes.bounds[2][0]) plane += 0.25f;
  CHECK_THROWS_AS(run(capture, small_gpu()), ReplayMismatch);
}

TEST_CASE("the message names warp, lane, ray, event and the difference") {
  const Scene scene;
  Capture capture = capture_scene(scene, 64);
  WarpCapture& warp = capture.warps[1];
  const RayCapture& ray = warp.rays[5];
  REQUIRE(ray.event_count > 2);
  warp.events[ray.event_begin + 2].address += 64;
  CHECK_THROWS_WITH(run(capture, small_gpu()),
                    Catch::Contains("warp 1") && Catch::Contains("ray 5") &&
                        Catch::Contains("lane " + std::to_string(ray.lane)) && Catch::Contains("event 2") &&
                        Catch::Contains(std::to_string(warp.events[ray.event_begin + 2].address)));
}

TEST_CASE("stores make the picture; an altered value shows in it") {
  const Scene scene;
  Capture capture = capture_scene(scene);
  const auto picture_of = [&] {
    std::vector<uint32_t> pixels(400, 0xDEADBEEF);
    const ReplayResult result = run(capture, small_gpu());
    CHECK(result.memory.bytes_stored(picture, 1600) == 1600);
    result.memory.read(picture, std::as_writable_bytes(std::span(pixels)));
    return pixels;
  };
  const std::vector<uint32_t> pixels = picture_of();
  std::vector<float> native;
  for (const WarpCapture& warp : capture.warps)
    for (const RayCapture& ray : warp.rays) native.push_back(ray.hit.t);
  REQUIRE(native.size() == 400);
  CHECK(std::memcmp(native.data(), pixels.data(), 1600) == 0);
  capture.warps[2].store_data[9] ^= std::byte{1};
  CHECK(picture_of() != pixels);
}

namespace {

/// Digest of everything a run says.
std::vector<uint64_t> fingerprint(const ReplayResult& result) {
  std::vector<uint64_t> all{result.stats.cycles, result.stats.events};
  const auto add = [&](const auto& stats) {
    std::remove_cvref_t<decltype(stats)>::fields([&](const char*, auto member) {
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(stats.*member)>, uint64_t>) {
        all.push_back(stats.*member);
      } else if constexpr (requires { (stats.*member).cycles; }) {
        all.insert(all.end(), (stats.*member).cycles.begin(), (stats.*member).cycles.end());
      } else {
        all.insert(all.end(), (stats.*member).values.begin(), (stats.*member).values.end());
      }
    });
  };
  add(result.stats.sm), add(result.stats.rt), add(result.stats.l1), add(result.stats.l2), add(result.stats.dram);
  for (const auto& pixels : result.pixel_cycles) all.insert(all.end(), pixels.begin(), pixels.end());
  return all;
}

class CountingObserver : public Observer {
 public:
  void on_event(const Event& event, const Component&) override {
    ++events;
    in_order = in_order && event.time >= last;
    last = event.time;
  }
  uint64_t events = 0;
  Cycle last = 0;
  bool in_order = true;
};

}  // namespace

TEST_CASE("a run is a pure function of capture and configuration, watched or not") {
  const Scene scene;
  const Capture capture = capture_scene(scene);
  const ReplayResult first = run(capture, small_gpu());
  CountingObserver observer;
  CHECK(fingerprint(run(capture, small_gpu(), &observer)) == fingerprint(first));
  CHECK(observer.events == first.stats.events);
  CHECK(observer.in_order);
  GpuConfig other = small_gpu();
  other.rt.box_latency += 1;
  CHECK(fingerprint(run(capture, other)) != fingerprint(first));
}

TEST_CASE("a clock twice as fast on all sides takes the same clocks") {
  const Scene scene;
  const Capture capture = capture_scene(scene);
  GpuConfig config = small_gpu();
  const ReplayResult slow = run(capture, config);
  config.core_mhz *= 2;
  config.dram.bandwidth_mb_per_second *= 2;
  CHECK(fingerprint(run(capture, config)) == fingerprint(slow));
}

TEST_CASE("hits and pictures do not depend on the configuration") {
  const Scene scene;
  const Capture capture = capture_scene(scene);
  GpuConfig config = small_gpu();
  config.sm.count = GENERATE(1u, 5u);
  config.rt.warp_entries = GENERATE(1u, 8u);
  config.rt.scheduler = GENERATE(0u, 1u);
  config.l1.mshr_entries = GENERATE(1u, 64u);
  config.l1.mshr_waiters = 1;
  std::vector<std::byte> own(1600), reference(1600);
  run(capture, config).memory.read(picture, own);
  run(capture, small_gpu()).memory.read(picture, reference);
  CHECK(own == reference);
}

TEST_CASE("launches follow each other on warm caches") {
  const Scene scene;
  const std::vector<Capture> twice{capture_scene(scene), capture_scene(scene)};
  const ReplayResult both = replay(twice, small_gpu());
  const ReplayResult once = run(twice[0], small_gpu());
  CHECK(both.stats.cycles < 2 * once.stats.cycles);
  CHECK(both.stats.rt.rays == 2 * once.stats.rt.rays);
  CHECK(both.stats.l2.misses.total() < 2 * once.stats.l2.misses.total());
  CHECK(both.pixel_cycles.size() == 2);
}

TEST_CASE("an empty launch takes no time") {
  const Scene scene;
  Capture capture = capture_scene(scene);
  capture.warps.clear();
  capture.header.width = capture.header.height = capture.header.depth = 0;
  CHECK(run(capture, small_gpu()).stats.cycles == 0);
  CHECK(replay({}, small_gpu()).stats.cycles == 0);
}
