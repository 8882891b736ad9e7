#pragma once

// World boxes of instances that fit better than that of a turned box: a round thing's turned box is wider than it is.

#include <rayloom/accel/box.h>
#include <rayloom/accel/build_settings.h>

#include <cstddef>

namespace rayloom::accel {

/// How many levels of nodes below a bottom level's root the boxes of instances are fitted to.
int box_levels(const BuildSettings& settings);

/// The box of everything in the bottom level `block`, as world_box() makes it, but from the boxes so many levels below
/// its root instead of from its bounds: it lies within theirs. Structures that are lazy or have no inner node give
/// theirs.
Box close_world_box(const float (&object_to_world)[3][4], const std::byte* block, int levels);

}  // namespace rayloom::accel
