#pragma once

// What a build checks of its arguments before it reads any geometry.

#include <rayloom/accel/build.h>

namespace rayloom::accel {

/// Primitives of all geometries together, inactive and degenerate ones included (PR-15). Throws InputError over the
/// limits of CAP-09.
uint64_t checked_count(std::span<const TriangleGeometry> geometries);
uint64_t checked_count(std::span<const AabbGeometry> geometries);
void check_instance_count(uint64_t count);

/// Throws InputError unless buffers are there, long enough for unindexed triangles, and formats are known.
void check_geometries(std::span<const TriangleGeometry> geometries);
void check_geometries(std::span<const AabbGeometry> geometries);

/// Throws InputError unless `result` is aligned and has `bytes` bytes.
void check_result(std::span<const std::byte> result, uint64_t bytes);

}  // namespace rayloom::accel
