#pragma once

// What the programs' set-ups share: from functors to a pipeline with its tables. A scene's hit kinds decide which hit
// groups exist; a program adds its functors for those alone.

#include <rayloom/shaders/alpha_test.h>
#include <rayloom/shaders/film.h>
#include <rayloom/shaders/program.h>
#include <rayloom/shaders/shadow_ray.h>
#include <rayloom/shaders/sphere.h>

#include <algorithm>
#include <utility>

namespace rayloom::shaders {

/// Costs declared to the hardware model, in warp instructions: rough counts of each functor's arithmetic.
namespace cost {
inline constexpr ShaderCost ray_generation{60, 4}, miss{8, 0}, sky{40, 6}, surface{180, 8}, path_vertex{420, 24},
    alpha{60, 0}, sphere{40, 3}, light{90, 8};
}

class PipelineBuilder {
 public:
  PipelineBuilder(Device& device, const DeviceScene& scene) : device_(device), scene_(scene) {}

  template <class F>
  void ray_generation(F functor, ShaderCost cost = cost::ray_generation) {
    ShaderOptions options{cost};
    options.global_root = root_type<FilmArguments>();
    library_.RayGeneration("RayGeneration", std::move(functor), options);
  }
  template <class F>
  void miss(const std::string& name, F functor, ShaderCost cost = cost::miss) {
    library_.Miss(name, std::move(functor), {cost});
    misses_.push_back(name);
  }
  template <class F>
  void callable(const std::string& name, F functor) {
    library_.Callable(name, std::move(functor), {cost::light});
    callables_.push_back(name);
  }

  /// Hit groups of radiance rays: closest-hit functors for triangles and spheres, the alpha test for `Payload`.
  template <class Payload, class TriangleHit, class SphereHit>
  void radiance(TriangleHit triangle_hit, SphereHit sphere_hit, ShaderCost cost = cost::surface) {
    library_.ClosestHit("TriangleHit", std::move(triangle_hit), with_local<TriangleRecord>(cost));
    payload_bytes_ = std::max<uint32_t>(payload_bytes_, sizeof(Payload));
    if (scene_.has(HitKind::opaque_triangles)) names_.radiance[0] = triangles("Opaque", "", "TriangleHit");
    if (scene_.has(HitKind::masked_triangles)) {
      library_.AnyHit("AlphaTest", AlphaTest<Payload>{scene_.view().materials},
                      with_local<TriangleRecord>(cost::alpha));
      names_.radiance[1] = triangles("Masked", "AlphaTest", "TriangleHit");
    }
    if (scene_.has(HitKind::spheres)) {
      library_.ClosestHit("SphereHit", std::move(sphere_hit), with_local<SphereRecord>(cost));
      library_.Intersection("SphereIntersection", SphereIntersection{}, with_local<SphereRecord>(cost::sphere));
      names_.radiance[2] = spheres("Sphere", "SphereHit");
    }
  }

  /// Hit groups and the miss shader of shadow rays; call after radiance() and its miss().
  void shadow();

  Program build();

 private:
  template <class Record>
  static ShaderOptions with_local(ShaderCost cost) {
    ShaderOptions options{cost};
    options.local_root = root_type<Record>();
    return options;
  }
  std::string triangles(const std::string& group, const std::string& any_hit, const std::string& closest_hit);
  std::string spheres(const std::string& group, const std::string& closest_hit);

  Device& device_;
  const DeviceScene& scene_;
  ShaderLibrary library_;
  HitGroupNames names_;
  std::vector<HIT_GROUP_DESC> groups_;
  std::vector<std::string> misses_, callables_, triangle_groups_, sphere_groups_;
  uint32_t payload_bytes_ = 0;
};

}  // namespace rayloom::shaders
