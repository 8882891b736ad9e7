// A lazy structure when memory runs out while rays build its parts.

#include "failing_memory.h"

#include <catch2/catch.hpp>

#include "structures.h"

using namespace rayloom::accel;
using namespace rayloom::accel::test;

namespace {

/// What the error said; empty if there was none.
std::string trace_without_memory(const Block& block, const Ray& ray) {
  char text[200] = {};
  const TraceRequest request = request_for(block, ray);
  try {
    const AllocationLimit none(0);
    trace({}, request);
  } catch (const std::bad_alloc& error) {
    std::strncpy(text, error.what(), sizeof(text) - 1);
  }
  return text;
}

}  // namespace

TEST_CASE("out of memory while a part is built: an error that says so, and the part can be built later") {
  const Mesh mesh = bumpy_sphere(4);
  const Block block = build_mesh(mesh, geometry_flag::opaque, build_flag::lazy), eager = build_mesh(mesh);
  const Ray ray = ray_between({3, 0.1f, 0.2f}, {0, 0, 0});
  const std::string error = trace_without_memory(block, ray);
  CHECK(error == "acceleration structure: out of memory while a part of a lazy structure is built for a ray");
  CHECK(structure_info(block.data()).built_parts == 0);
  const Hit hit = trace({}, request_for(block, ray));
  CHECK(hit);
  CHECK(same_bits(hit, trace({}, request_for(eager, ray))));
  CHECK(trace_without_memory(block, ray).empty());
}
