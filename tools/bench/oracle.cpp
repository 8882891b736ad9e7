#include <rayloom/tools/bench/oracle.h>

#include <rayloom/accel/instance_transform.h>

#include <cmath>
#include <cstring>

#include <boost/multiprecision/cpp_int.hpp>

namespace rayloom::bench {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Vector = std::array<Rational, 3>;

Vector exact(const float (&v)[3]) { return {Rational(v[0]), Rational(v[1]), Rational(v[2])}; }

Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Rational dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The float nearest to `value`: the candidates around its double are compared exactly.
float rounded(const Rational& value) {
  const float guess = static_cast<float>(value.convert_to<double>());
  float best = guess;
  for (const float other : {std::nextafter(guess, -INFINITY), std::nextafter(guess, INFINITY)}) {
    if (!std::isfinite(other) || !std::isfinite(best)) continue;
    if (abs(Rational(other) - value) < abs(Rational(best) - value)) best = other;
  }
  return best;
}

accel::Ray in_object_space(const PeerInstance& instance, const accel::Ray& ray) {
  accel::InstanceRecord record{};
  std::memcpy(record.object_to_world, instance.transform.data(), sizeof record.object_to_world);
  const auto inverse = accel::invert(record.object_to_world);
  if (!inverse) return ray;
  std::memcpy(record.world_to_object, inverse->matrix, sizeof record.world_to_object);
  return accel::object_ray(record, ray);
}

ExactHit exact_hit_of(const BenchScene& scene, const accel::Ray& ray, const accel::Hit& hit) {
  if (!hit) return {};
  const bool placed = scene.two_level();
  const BenchMesh& mesh = scene.meshes[placed ? scene.instances[hit.instance_index].mesh : 0];
  float corners[3][3];
  for (size_t i = 0; i < 3; ++i) {
    const size_t vertex = mesh.indices[size_t{hit.primitive_index} * 3 + i];
    std::memcpy(corners[i], &mesh.vertices[vertex * 3], sizeof corners[i]);
  }
  return exact_hit(placed ? in_object_space(scene.instances[hit.instance_index], ray) : ray, corners);
}

}  // namespace

ExactHit exact_hit(const accel::Ray& ray, const float (&corners)[3][3]) {
  const Vector origin = exact(ray.origin), direction = exact(ray.direction);
  Vector p[3];
  for (size_t i = 0; i < 3; ++i) p[i] = exact(corners[i]) - origin;
  int positive = 0, negative = 0, zero = 0;
  for (size_t i = 0; i < 3; ++i) {
    const Rational edge = dot(direction, cross(p[i], p[(i + 1) % 3]));
    edge > 0 ? ++positive : edge < 0 ? ++negative : ++zero;
  }
  const Vector normal = cross(p[1] - p[0], p[2] - p[0]);
  const Rational facing = dot(direction, normal);
  if (facing == 0 || (positive && negative)) return {};
  const float t = rounded(dot(p[0], normal) / facing);
  if (!(t > ray.t_min && t < ray.t_max)) return {};
  return {zero ? Position::border : Position::inside, t};
}

Verdict judge(const BenchScene& scene, const accel::Ray& ray, const accel::Hit& ours, const accel::Hit& theirs) {
  const ExactHit a = exact_hit_of(scene, ray, ours), b = exact_hit_of(scene, ray, theirs);
  if (ours && a.position == Position::outside)
    return b.position == Position::outside && theirs ? Verdict::undecided : Verdict::theirs;
  if (b.position == Position::outside) return Verdict::ours;  // they name a wrong triangle, or miss one
  if (ours && a.t < b.t) return Verdict::ours;
  if (ours && a.t == b.t) return Verdict::tie;
  return b.position == Position::border ? Verdict::tie : Verdict::theirs;
}

}  // namespace rayloom::bench
