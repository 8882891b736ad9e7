#pragma once

// Who is right where two tracers differ: the ray against the triangles both name, in rational numbers.

#include <rayloom/tools/bench/bench_scene.h>

namespace rayloom::bench {

enum class Verdict : uint8_t {
  ours,       ///< our answer is exact, theirs is not
  theirs,     ///< theirs is exact, ours is not
  tie,        ///< both are: on a shared edge, or at distances that are the same float
  undecided,  ///< neither answer names what would decide it
};

/// Both answers to one closest-hit question: type, instance and primitive of each count, and our t not at all. In a
/// scene of two levels the question is put in object space, with the object-space ray that accel defines.
Verdict judge(const BenchScene& scene, const accel::Ray& ray, const accel::Hit& ours, const accel::Hit& theirs);

/// Where a ray meets one triangle's plane: strictly inside, exactly on its border, or outside; a hit outside
/// (t_min, t_max) after rounding t, and a triangle seen edge-on, count as outside.
enum class Position : uint8_t { outside, border, inside };
struct ExactHit {
  Position position = Position::outside;
  float t = 0;  ///< the exact quotient, rounded to nearest
};
ExactHit exact_hit(const accel::Ray& ray, const float (&corners)[3][3]);

}  // namespace rayloom::bench
