// A short run of everything that is shared between threads, for the thread sanitizer.

#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include "recorder.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

TEST_CASE("build and trace in parallel") {
  const ThreadLimit limit(4);
  const Mesh mesh = icosphere(5);  // 20,480 triangles: several chunks and tasks
  std::vector<Block> bottoms;
  bottoms.emplace_back(build_mesh(mesh));
  bottoms.emplace_back(build_mesh(bumpy_sphere(4)));
  std::vector<InstanceDesc> descs;
  for (int i = 0; i < 5000; ++i) {
    const float x = 3 * static_cast<float>(i % 70), y = 3 * static_cast<float>(i / 70);
    descs.push_back(instance_of(bottoms[i % 2], {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, 0}));
  }
  const Block top = build_instances(descs);
  std::vector<Hit> hits(4000);
  const auto trace_all = [&] {
    parallel_for(hits.size(), 50, [&](uint64_t begin, uint64_t end) {
      for (uint64_t i = begin; i < end; ++i) {
        const Point centre{3 * static_cast<float>(i % 70), 3 * static_cast<float>(i / 70), 0};
        hits[i] = trace({}, request_for(top, ray_between(centre, {centre[0], centre[1], 5})));
      }
    });
  };
  trace_all();
  for (int again = 0; threads_seen() == 1 && again < 50; ++again) trace_all();  // busy machine
  CHECK(threads_seen() > 1);
  size_t wrong = 0;
  for (size_t i = 0; i < hits.size(); ++i) wrong += hits[i].instance_index != i;
  CHECK(wrong == 0);
}

TEST_CASE("sizes may be asked for from many threads (PB-07)") {
  const Mesh mesh = icosphere(1);
  const TriangleGeometry geometry = mesh.geometry();
  std::vector<uint64_t> bytes(64);
  parallel_for(bytes.size(), 1, [&](uint64_t begin, uint64_t) {
    bytes[begin] = bottom_level_sizes({&geometry, 1}, build_flag::none).result_bytes;
  });
  for (const uint64_t b : bytes) CHECK(b == bytes[0]);
}
