#pragma once

// Sculptures: closed surfaces with smooth normals that stand on y = 0 around the origin, each `seed` another.

#include <rayloom/scenes/scene.h>

#include <array>

namespace rayloom::scenes::statues {

struct Kind {
  const char* name;
  /// At least `triangles` (at least 5000; fewer cannot show what is thin), mostly not a fifth more. Any size: see
  /// fit().
  Geometry (*make)(uint64_t triangles, uint32_t seed);
};

Geometry supershape(uint64_t triangles, uint32_t seed);  ///< after Gielis 2003, twisted
Geometry knot(uint64_t triangles, uint32_t seed);        ///< a torus knot of ribbed rope
Geometry column(uint64_t triangles, uint32_t seed);      ///< a twisted, swelling column
Geometry figure(uint64_t triangles, uint32_t seed);      ///< a standing draped figure
Geometry pierced(uint64_t triangles, uint32_t seed);     ///< a smooth stone with holes
Geometry lattice(uint64_t triangles, uint32_t seed);     ///< an ellipsoid cut from one side of a gyroid

inline constexpr std::array kinds = {Kind{"figure", figure}, Kind{"supershape", supershape},
                                     Kind{"knot", knot},     Kind{"pierced", pierced},
                                     Kind{"column", column}, Kind{"lattice", lattice}};

/// Scales and moves to fill the room of `height` above y = 0 and `width` around the y axis as far as it goes.
void fit(Geometry& geometry, float height, float width);

}  // namespace rayloom::scenes::statues
