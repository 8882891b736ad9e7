#pragma once

#include "triangle_soup.h"

#include <rayloom/accel/ray.h>

#include <memory>

struct RTCDeviceTy;
struct RTCSceneTy;

namespace rayloom::bench {

/// Embree 3.13 with one scene, high build quality, one thread a build.
class Embree {
 public:
  Embree(const TriangleSoup& soup, bool robust);
  ~Embree();
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  accel::Hit closest_hit(const accel::Ray& ray) const;

 private:
  RTCDeviceTy* device_;
  RTCSceneTy* scene_;
};

}  // namespace rayloom::bench
