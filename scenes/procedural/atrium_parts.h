#pragma once

// What the atrium is built of. Every part stands on y = 0 around the origin; `detail` multiplies the tessellation.

#include <rayloom/scenes/scene.h>

namespace rayloom::scenes::atrium {

inline constexpr float bay = 3;  ///< distance between columns, metres
inline constexpr float column_height = 3.2f;
inline constexpr float arch_rise = 1.3f;  ///< of the arch above its springing, to the crown of its band

/// Plinth, base, fluted shaft, capital and abacus.
Geometry column(uint32_t detail, uint32_t material);
/// A moulded half-circle band between two columns, springing at y = 0, centred on x = 0.
Geometry arch(uint32_t detail, uint32_t material);
/// The wall above an arch: a slab with the half circle cut out, up to `height` above the springing.
Geometry spandrel(uint32_t detail, float height, uint32_t material);
/// A coffered barrel vault over a walk: `length` along x, spanning `width` in z, springing at y = 0, facing down.
Geometry vault(uint32_t detail, float length, float width, uint32_t material);
/// A cloth hung from two corners at y = 0, `width` along x and `drop` long, with folds that differ by `seed`.
Geometry drape(uint32_t detail, float width, float drop, uint32_t seed, uint32_t material);
/// A round pot.
Geometry pot(uint32_t detail, uint32_t material);
/// A bush of leaf quads for a masked material, `height` high, different for each `seed`.
Geometry foliage(uint32_t detail, float height, uint32_t seed, uint32_t material);
/// A two-bowl fountain.
Geometry fountain(uint32_t detail, uint32_t material);
/// A sphere of triangles.
Geometry ball(uint32_t detail, float radius, uint32_t material);

}  // namespace rayloom::scenes::atrium
