#pragma once

// Closed surfaces and rays at them: what topology says of such a ray needs no geometric oracle (O3).

#include <rayloom/tools/bench/numerics/lab.h>

#include <span>

namespace rayloom::bench::numerics {

/// A point the rays start from: how many hits a ray from it meets, up to even numbers.
struct Viewpoint {
  Point origin;
  bool inside;
};

struct ClosedMesh {
  std::string name;
  Mesh mesh;
  std::vector<Viewpoint> viewpoints;
  bool convex = false;  ///< from inside exactly one hit

  /// Adds a viewpoint, inside or outside as brute force along directions of no significance says; nothing for a point
  /// of the surface itself.
  ClosedMesh& look_from(const Point& origin);
};

/// Turns a profile (radius, height) from pole to pole around the z axis; its ends must lie on the axis.
Mesh lathe(std::span<const std::array<double, 2>> profile, uint32_t sides);
Mesh bipyramid(uint32_t sides);
/// A sphere whose poles are fans of `sides` needles.
Mesh sphere_with_poles(uint32_t sides, uint32_t rings);
/// Klein's bottle as a ring of figures of eight: closed, one-sided, passing through itself.
Mesh klein_bottle(uint32_t rings, uint32_t sides);
/// Rings around the origin at radii from 1e-12 to 1e6, closed far below: detail of 1e-12 in a body of 1e6.
Mesh mixed_scales(uint32_t sides);

/// Moves mesh and viewpoints; whether these are inside is found anew where rounding may have changed it.
ClosedMesh placed(const ClosedMesh& closed, float scale, float offset);

/// Icosphere of `level`, bumpy sphere, subdivided cube, torus, Klein's bottle, each with viewpoints.
std::vector<ClosedMesh> closed_meshes(int level);
/// Fans of 3 to 1024 triangles, and poles of 2000 needles.
std::vector<ClosedMesh> fan_meshes();

enum class Aim { edge, vertex, anywhere };

/// Counters of a tally that shoot() fills.
enum ShotCounter : size_t { leaks, wrong_parity, not_one, closest_differs };

/// Shoots from all viewpoints at edges (a point lerp(edge, a) computed in float), vertices or triangles, the target
/// then moved by up to 4 ulp in each component.
Tally shoot(RowRun& run, const ClosedMesh& closed, Aim aim, Cases rays);

/// Closest hits at vertices against brute force with the exact test: counter 0 of `total` counts other t's (O1).
void compare_with_brute_force(RowRun& run, const ClosedMesh& closed, Cases rays, Tally& total);

/// Adds the figures of tallies that shoot() made.
void judge_shots(RowRun& run, const Tally& shots, const std::string& what);

/// The ray from `origin` towards the target.
Ray ray_between(const Point& origin, const Point& target);

}  // namespace rayloom::bench::numerics
