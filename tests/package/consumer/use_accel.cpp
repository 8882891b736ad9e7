// Rayloom's acceleration structures alone, as a ray tracing library: one triangle, two rays.
#include <rayloom/accel/build.h>
#include <rayloom/accel/trace.h>

#include <cstdio>
#include <memory>
#include <new>

using namespace rayloom::accel;

int main() {
  const float vertices[] = {0, 0, 5, 1, 0, 5, 0, 1, 5};
  TriangleGeometry triangle;
  triangle.vertices = reinterpret_cast<const std::byte*>(vertices);
  triangle.vertex_count = 3;
  triangle.triangle_count = 1;
  const TriangleGeometry geometries[] = {triangle};

  const uint64_t bytes = bottom_level_sizes(geometries, build_flag::none).result_bytes;
  auto* const block = static_cast<std::byte*>(operator new (bytes, std::align_val_t{structure_alignment}));
  build_bottom_level(geometries, build_flag::none, {block, bytes});

  TraceRequest request;
  request.structure = block;
  request.ray = {{0.25f, 0.25f, 0}, 0, {0, 0, 1}, 100};
  const Hit hit = trace({}, request);
  request.ray.origin[0] = 2;
  const Hit miss = trace({}, request);
  std::printf("hit at %g (%g, %g), then %s\n", hit.t, hit.u, hit.v, miss ? "a hit" : "a miss");
  operator delete (block, std::align_val_t{structure_alignment});
  return hit && hit.t == 5 && hit.u == 0.25f && hit.v == 0.25f && !miss ? 0 : 1;
}
