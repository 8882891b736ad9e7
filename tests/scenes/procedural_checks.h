#pragma once

// What every procedural scene must be, for the tests of each.

#include <rayloom/scenes/scene.h>

#include <set>
#include <string>

namespace rayloom::scenes {

/// Of all geometry, instances, materials and pictures.
uint64_t hash_of(const Scene& scene);

/// Fails unless everything is finite, in range and sized as scene.h says, normals are unit vectors, and no triangle has
/// an area of 0 or, but for a hundredth of those named in `may_fold`, turns its back to its own normals.
void check_scene(const Scene& scene, const std::set<std::string>& may_fold = {});

/// The solid a closed surface encloses, signed: positive when faces look outwards.
double signed_volume(const Geometry& geometry);

/// Edges (by the positions of their ends) not used as often in one direction as in the other: 0 for a closed surface.
size_t open_edges(const Geometry& geometry);

/// Edges used more than once in one direction: where a surface touches itself.
size_t repeated_edges(const Geometry& geometry);

/// Fails unless the scene has the same bits for 1, 2, 3 and 7 threads.
void check_thread_counts(const std::string& name);

}  // namespace rayloom::scenes
