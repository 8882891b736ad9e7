#include <rayloom/accel/checks.h>
#include <rayloom/accel/procedural_input.h>
#include <rayloom/accel/refit.h>
#include <rayloom/accel/triangle_input.h>
#include <rayloom/base/error.h>
#include <rayloom/base/float_environment.h>

#include <cmath>
#include <limits>
#include <string>

namespace rayloom::accel {
namespace {

uint64_t count_of(const TriangleGeometry& geometry) { return geometry.triangle_count; }
uint64_t count_of(const AabbGeometry& geometry) { return geometry.box_count; }

/// The geometry a lane names. Throws InputError when the update's geometries are not those of the build (UP-02).
template <class Geometry>
const Geometry& geometry_of(std::span<const Geometry> geometries, uint32_t word, uint32_t primitive) {
  const uint32_t index = word & 0xFFFFFF;
  const auto fail = [&](const char* rule) {
    throw InputError("acceleration structure update", "geometries[" + std::to_string(index) + "]", rule);
  };
  if (primitive >= count_of(geometries[index])) fail("has fewer primitives than the source's (UP-02)");
  if (((geometries[index].flags ^ word >> 24) & geometry_flag::opaque) != 0)
    fail("has other flags than the source's (UP-02)");
  return geometries[index];
}

/// A triangle that has become inactive keeps its place, but cannot be hit.
void refit_lane(const InputTriangle& corners, uint32_t lane, PlainTriangleLeaf& leaf, Box& box) {
  const bool active = is_active(corners);
  for (int vertex = 0; vertex < 3; ++vertex) {
    for (int axis = 0; axis < 3; ++axis)
      leaf.vertex[axis][vertex][lane] = active ? corners.vertex[vertex][axis] : std::numeric_limits<float>::quiet_NaN();
    if (active) box.extend(corners.vertex[vertex]);
  }
}

Refitted whole(const Box& box) { return {box, box, 0, 0}; }

Refitted refit_leaf(std::span<const TriangleGeometry> geometries, PlainTriangleLeaf& leaf) {
  Box box;
  for (uint32_t lane = 0; lane < leaf.count; ++lane) {
    const TriangleGeometry& geometry = geometry_of(geometries, leaf.geometry_of(lane), leaf.primitive[lane]);
    const uint32_t index = leaf.geometry_of(lane) & 0xFFFFFF;
    refit_lane(read_checked_triangle(geometry, index, leaf.primitive[lane]), lane, leaf, box);
  }
  return whole(box);
}

Refitted refit_leaf(std::span<const AabbGeometry> geometries, ProceduralLeaf8& leaf) {
  Box sum;
  for (int lane = 0; lane < 8; ++lane) {
    if (leaf.primitive[lane] == no_index) continue;
    const AabbGeometry& geometry = geometry_of(geometries, leaf.geometry[lane], leaf.primitive[lane]);
    const Box box = read_box(geometry, leaf.primitive[lane]).value_or(Box{});
    for (int axis = 0; axis < 3; ++axis) {
      leaf.bounds[axis][0][lane] = box.min[axis];
      leaf.bounds[axis][1][lane] = box.max[axis];
    }
    sum.extend(box);
  }
  return whole(sum);
}

template <class Leaf, class Geometry>
uint64_t refit(std::span<const Geometry> geometries, StructureKind kind, const BuildSettings& settings,
               const std::byte* source, std::span<std::byte> result) {
  const FloatEnvironment environment;
  check_update(source, result, kind, checked_count(geometries), geometries.size(), settings);
  check_geometries(geometries);
  return update(source, result.data(), settings,
                [&](std::byte* address) { return refit_leaf(geometries, *reinterpret_cast<Leaf*>(address)); });
}

}  // namespace

uint64_t refit_bottom_level(std::span<const TriangleGeometry> geometries, const BuildSettings& settings,
                            const std::byte* source, std::span<std::byte> result) {
  return refit<PlainTriangleLeaf>(geometries, StructureKind::triangles, settings, source, result);
}

uint64_t refit_bottom_level(std::span<const AabbGeometry> geometries, const BuildSettings& settings,
                            const std::byte* source, std::span<std::byte> result) {
  return refit<ProceduralLeaf8>(geometries, StructureKind::procedurals, settings, source, result);
}

}  // namespace rayloom::accel
