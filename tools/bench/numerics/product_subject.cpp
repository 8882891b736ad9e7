#include <rayloom/accel/simd/lanes_scalar.h>
#include <rayloom/base/float_environment.h>
#include <rayloom/tests/accel/brute_force.h>
#include <rayloom/tools/bench/numerics/subject.h>

namespace rayloom::bench::numerics {
namespace {

using accel::test::Block;

class ProductTracer : public MeshTracer {
 public:
  ProductTracer(const std::vector<Mesh>& meshes, const std::vector<Transform3x4>& instances)
      : bottom_(build_bottom(meshes)) {
    if (instances.empty()) return;
    std::vector<accel::InstanceDesc> descs;
    for (const Transform3x4& m : instances) descs.push_back(accel::test::instance_of(bottom_, m));
    top_.emplace(accel::test::build_instances(descs));
  }
  accel::Hit closest(const Ray& ray) const override { return accel::trace({}, accel::test::request_for(root(), ray)); }
  uint32_t count(const Ray& ray) const override {
    accel::TraceRequest request = accel::test::request_for(root(), ray);
    uint32_t hits = 0;
    request.user = &hits;
    request.candidate = [](void* user, const accel::Candidate&) noexcept {
      ++*static_cast<uint32_t*>(user);
      return accel::Verdict{};
    };
    accel::trace({}, request);
    return hits;
  }

 private:
  static Block build_bottom(const std::vector<Mesh>& meshes) {
    std::vector<accel::TriangleGeometry> geometries;
    for (const Mesh& mesh : meshes)
      geometries.push_back(mesh.geometry(accel::geometry_flag::no_duplicate_anyhit));  // not opaque: to be counted
    return accel::test::build_geometries(geometries);
  }
  const Block& root() const { return top_ ? *top_ : bottom_; }

  Block bottom_;
  std::optional<Block> top_;
};

class ProductSubject : public Subject {
 public:
  std::optional<accel::TriangleHit> triangle(const Ray& ray, const Triangle& t) const override {
    const FloatEnvironment environment;
    const accel::PreparedRay prepared = accel::test::prepare_alone(ray);
    if (!prepared.valid) return std::nullopt;
    return accel::intersect_triangle(prepared, t[0].data(), t[1].data(), t[2].data(), ray.t_max);
  }
  std::unique_ptr<MeshTracer> tracer(const std::vector<Mesh>& meshes,
                                     const std::vector<Transform3x4>& instances) const override {
    return std::make_unique<ProductTracer>(meshes, instances);
  }
  bool enters(const Ray& ray, const accel::Box& box, const accel::Box& root, float t) const override {
    const FloatEnvironment environment;
    const accel::PreparedRay prepared = accel::prepare_ray(ray, root.min, root.max);
    accel::Node8 node{};
    for (int k = 0; k < 3; ++k) node.bounds[k][0][0] = box.min[k], node.bounds[k][1][0] = box.max[k];
    const float t_near = prepared.near_limit(ray.t_min), t_far = prepared.far_limit(t);
    return accel::scalar::test_node(accel::scalar::BoxLanes(prepared), node, t_near, t_far).mask & 1;
  }
  double spawn_scale() const override { return 1; }
};

}  // namespace

const Subject& product_subject() {
  static const ProductSubject subject;
  return subject;
}

}  // namespace rayloom::bench::numerics
