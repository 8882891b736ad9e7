#pragma once

// What the laboratory puts to the test: the product, or a plain float tracer that it must find at fault.

#include <rayloom/accel/box.h>
#include <rayloom/accel/trace.h>
#include <rayloom/accel/triangle.h>
#include <rayloom/tests/accel/meshes.h>
#include <rayloom/tests/accel/rational_oracle.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rayloom::bench::numerics {

using accel::Ray;
using accel::Transform3x4;
using accel::test::Mesh;
using accel::test::Point;
using accel::test::Triangle;

/// Rays against meshes; safe from several threads.
class MeshTracer {
 public:
  virtual ~MeshTracer() = default;
  virtual accel::Hit closest(const Ray& ray) const = 0;
  /// How many hits an any-hit shader that ignores them all is asked about.
  virtual uint32_t count(const Ray& ray) const = 0;
};

class Subject {
 public:
  virtual ~Subject() = default;
  /// The hit with t_min < t <= t_max.
  virtual std::optional<accel::TriangleHit> triangle(const Ray& ray, const Triangle& triangle) const = 0;
  /// Over meshes as geometries of one bottom level; with `instances`, under a top level with one each.
  virtual std::unique_ptr<MeshTracer> tracer(const std::vector<Mesh>& geometries,
                                             const std::vector<Transform3x4>& instances = {}) const = 0;
  /// Whether the box test, in a structure with bounds `root`, lets a hit at t inside `box` through.
  virtual bool enters(const Ray& ray, const accel::Box& box, const accel::Box& root, float t) const = 0;
  /// What offsets of spawn points are multiplied by.
  virtual double spawn_scale() const = 0;
};

const Subject& product_subject();

/// Moeller-Trumbore in float over all triangles (the last of equal hits wins), boxes without pads, float transforms,
/// no spawn offset, no care for the caller's floating-point state.
const Subject& plain_subject();

/// What differs between the subject's answer and the exact one, correctly rounded; empty if nothing does.
std::string difference_from_exact(const Subject& subject, const Ray& ray, const Triangle& triangle);

/// The exact hit if its rounded t lies in (t_min, t_max].
std::optional<accel::test::RationalHit> exact_hit(const Ray& ray, const Triangle& triangle);

/// |value - exact| in units of value's last place.
double ulps_from(float value, const mpq_class& exact);

}  // namespace rayloom::bench::numerics
