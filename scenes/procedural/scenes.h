#pragma once

// The procedural scenes, one file each. Each asks `parameters` for what it understands.

#include <rayloom/scenes/procedural/parameters.h>
#include <rayloom/scenes/scene.h>

namespace rayloom::scenes {

/// One triangle and a white sky. The smallest scene there is.
Scene make_triangle(Parameters& parameters);

/// A box of 2 m with red and green walls, two blocks and an area light, after Goral et al. 1984 and the Cornell box.
Scene make_cornell(Parameters& parameters);

/// 488 spheres on a ground sphere, in the manner of Shirley's "Ray Tracing in One Weekend", placed by our own hash.
Scene make_spheres(Parameters& parameters);

/// A courtyard with arcades on two floors: at least 400,000 triangles stored, over a million instanced.
/// detail=1..4 (default 1): tessellation; triangles grow with its square.
Scene make_atrium(Parameters& parameters);

/// Trees of four species with masked leaves on hills, a path between them: over 100 million triangles instanced.
/// trees=1..1000000 (default 4000), the ground grows with them. seed=0..1000000 (default 1).
Scene make_forest(Parameters& parameters);

/// The atrium with statues that are all different: 4.8 million triangles stored.
/// statues=1..36 (default 36). triangles=5000..2000000 (default 120000): of each statue, at least.
Scene make_gallery(Parameters& parameters);

/// A bust with hair: strands that are closed three-sided tubes of 6 * segments triangles, most 100 to 200 times as long
/// as wide. strands=1..1000000 (default 40000). segments=4..128 (default 20) of each. micrometres=10..1000 (default
/// 80): thickness at the root. curl=0..100 (default 40).
Scene make_hair(Parameters& parameters);

/// Mountains, lakes and snow on a square of 4 km: 4.5 million triangles, all stored, in one mesh of four materials.
/// resolution=8..4096 (default 1500): cells along a side, two triangles each. seed=0..1000000 (default 1).
Scene make_terrain(Parameters& parameters);

}  // namespace rayloom::scenes
