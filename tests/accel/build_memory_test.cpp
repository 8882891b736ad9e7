// Builds when memory runs out, at whatever allocation: an exception, or, where something can do without, the bytes of
// every build; the next build is as good as new.

#include "failing_memory.h"

#include <rayloom/base/parallel.h>

#include <catch2/catch.hpp>

#include <cstring>

#include "structures.h"

using namespace rayloom;
using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

/// Whether bytes that a build wrote are those of another.
bool same_bytes(const Block& block, const Block& other) {
  const uint64_t bytes = other.header().bytes;
  return block.header().bytes == bytes && std::memcmp(block.data(), other.data(), bytes) == 0;
}

/// Builds with ever more allocations that succeed, until no more are made; returns how often the build failed. All of
/// the first allocations are tried, then some.
int failures_of(const Mesh& mesh, const BuildSettings& settings, int64_t failing) {
  const std::vector geometries{mesh.geometry()};
  const std::span<const TriangleGeometry> span(geometries);
  const uint64_t bytes = bottom_level_sizes(span, settings).result_bytes;
  std::vector<Block> built;
  int failures = 0;
  for (int64_t allowed = 0;; allowed += 1 + allowed / 4) {
    Block block(bytes);
    release_build_scratch();
    bool failed = false, enough = false;
    try {
      const AllocationLimit limit(allowed, failing);
      build_bottom_level(span, settings, block.span());
      enough = !limit.reached();
    } catch (const std::bad_alloc&) {
      failed = true;
    }
    failures += failed;
    if (!failed) built.push_back(std::move(block));
    if (enough) break;
  }
  const Block whole = build_mesh(mesh, geometry_flag::opaque, settings);
  for (const Block& block : built) CHECK(same_bytes(block, whole));
  return failures;
}

}  // namespace

TEST_CASE("out of memory anywhere in a build is an exception, for any number of threads") {
  const Mesh mesh = bumpy_sphere(6);  // scratch memory of more than a page of 2 MiB
  for (const unsigned threads : {1u, 3u}) {
    const ThreadLimit limit(threads);
    for (const Builder builder : all_builders())
      for (const int64_t failing : {unlimited, int64_t{1}}) {
        CAPTURE(threads, builder_name(builder), failing);
        CHECK(failures_of(mesh, {build_flag::none, builder}, failing) > 5);
      }
  }
}
