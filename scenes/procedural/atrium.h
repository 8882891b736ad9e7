#pragma once

// The atrium as a setting for other scenes.

#include <rayloom/scenes/procedural/atrium_parts.h>
#include <rayloom/scenes/procedural/builder.h>

namespace rayloom::scenes {

namespace atrium {
inline constexpr int bays = 7;      ///< along x, `bay` metres each, centred on the origin; one more column than bays
inline constexpr float walk = 3;    ///< width of the covered walks behind the columns at z = +-3.5
inline constexpr float storey = 5;  ///< height of a floor
}  // namespace atrium

/// Everything but cameras: the building, its plants and drapes, sun and sky.
void add_atrium(SceneBuilder& builder, uint32_t detail);

}  // namespace rayloom::scenes
