#include <rayloom/accel/instance_transform.h>
#include <rayloom/tools/bench/numerics/subject.h>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace rayloom::bench::numerics {
namespace {

glm::vec3 vec(const float (&p)[3]) { return {p[0], p[1], p[2]}; }
glm::vec3 vec(const Point& p) { return {p[0], p[1], p[2]}; }

/// Moeller and Trumbore 1997.
std::optional<accel::TriangleHit> moeller_trumbore(const Ray& ray, const Triangle& triangle) {
  const glm::vec3 v0 = vec(triangle[0]), e1 = vec(triangle[1]) - v0, e2 = vec(triangle[2]) - v0;
  const glm::vec3 d = vec(ray.direction), p = glm::cross(d, e2), s = vec(ray.origin) - v0, q = glm::cross(s, e1);
  const float determinant = glm::dot(e1, p);
  if (determinant == 0) return std::nullopt;
  const float inverse = 1 / determinant;
  const float u = glm::dot(s, p) * inverse, v = glm::dot(d, q) * inverse, t = glm::dot(e2, q) * inverse;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && t > ray.t_min && t <= ray.t_max)) return std::nullopt;
  return accel::TriangleHit{t, u, v, determinant > 0};
}

/// W o + W t with the inverse rounded to float, as much code does it.
Ray float_object_ray(const Transform3x4& m, const Ray& world) {
  float rows[3][4];
  std::copy_n(m.begin(), 12, &rows[0][0]);
  const auto inverse = accel::invert(rows);
  Ray ray = world;
  for (int k = 0; k < 3 && inverse; ++k) {
    const auto& w = inverse->matrix[k];
    const float row[4] = {static_cast<float>(w[0]), static_cast<float>(w[1]), static_cast<float>(w[2]),
                          static_cast<float>(w[3])};
    ray.origin[k] = row[0] * world.origin[0] + row[1] * world.origin[1] + row[2] * world.origin[2] + row[3];
    ray.direction[k] = row[0] * world.direction[0] + row[1] * world.direction[1] + row[2] * world.direction[2];
  }
  return ray;
}

class PlainTracer : public MeshTracer {
 public:
  PlainTracer(const std::vector<Mesh>& meshes, const std::vector<Transform3x4>& instances)
      : meshes_(meshes), instances_(instances) {}

  accel::Hit closest(const Ray& ray) const override {
    accel::Hit best;
    best.t = ray.t_max;
    for_each_hit(ray, [&](const accel::Hit& hit) {
      if (hit.t <= best.t) best = hit;
    });
    return best;
  }
  uint32_t count(const Ray& ray) const override {
    uint32_t hits = 0;
    for_each_hit(ray, [&](const accel::Hit&) { ++hits; });
    return hits;
  }

 private:
  template <class Body>
  void for_each_hit(const Ray& ray, const Body& body) const {
    if (instances_.empty()) return for_each_hit_in(ray, 0, body);
    for (uint32_t i = 0; i < instances_.size(); ++i) for_each_hit_in(float_object_ray(instances_[i], ray), i, body);
  }
  template <class Body>
  void for_each_hit_in(const Ray& ray, uint32_t instance, const Body& body) const {
    for (uint32_t g = 0; g < meshes_.size(); ++g)
      for (uint32_t i = 0; i < meshes_[g].triangles.size(); ++i) {
        const auto& [a, b, c] = meshes_[g].triangles[i];
        const auto hit =
            moeller_trumbore(ray, {meshes_[g].vertices[a], meshes_[g].vertices[b], meshes_[g].vertices[c]});
        if (hit) body(accel::Hit{hit->t, hit->u, hit->v, instance, g, i, hit->hit_kind(), accel::HitType::triangle});
      }
  }

  std::vector<Mesh> meshes_;
  std::vector<Transform3x4> instances_;
};

class PlainSubject : public Subject {
 public:
  std::optional<accel::TriangleHit> triangle(const Ray& ray, const Triangle& t) const override {
    return moeller_trumbore(ray, t);
  }
  std::unique_ptr<MeshTracer> tracer(const std::vector<Mesh>& meshes,
                                     const std::vector<Transform3x4>& instances) const override {
    return std::make_unique<PlainTracer>(meshes, instances);
  }
  /// Slabs in float, (plane - origin) / direction by a reciprocal, no pad.
  bool enters(const Ray& ray, const accel::Box& box, const accel::Box&, float t) const override {
    float entry = ray.t_min, exit = t;
    for (int k = 0; k < 3; ++k) {
      const float inverse = 1 / ray.direction[k];
      const float a = (box.min[k] - ray.origin[k]) * inverse, b = (box.max[k] - ray.origin[k]) * inverse;
      entry = std::max(entry, std::min(a, b));
      exit = std::min(exit, std::max(a, b));
    }
    return entry <= exit;
  }
  double spawn_scale() const override { return 0; }
};

}  // namespace

const Subject& plain_subject() {
  static const PlainSubject subject;
  return subject;
}

}  // namespace rayloom::bench::numerics
