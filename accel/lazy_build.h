#pragma once

// Lazy builds: triangles are sorted and cut into parts; the tree above the parts is built at once, that of a part when
// the first ray comes to its box. What is built does not depend on when, nor do hits (G3b).

#include <rayloom/accel/build.h>
#include <rayloom/accel/layout.h>

namespace rayloom::accel {

/// Whether a build with these settings is lazy. Throws InputError where they ask for updates, too.
bool builds_lazily(const BuildSettings& settings);

/// Writes all of a lazy structure but its header, which must name kind and counts and gets the rest. Throws InputError
/// for an index out of range.
void build_lazily(std::span<const TriangleGeometry> geometries, const BuildSettings& settings, StructureHeader& header,
                  std::byte* block);

}  // namespace rayloom::accel
