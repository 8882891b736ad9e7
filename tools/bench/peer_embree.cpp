#include "peer_embree.h"

#include <embree3/rtcore.h>

namespace rayloom::bench {

Embree::Embree(const TriangleSoup& soup, bool robust)
    : device_(rtcNewDevice("frequency_level=simd512,hugepages=1")), scene_(rtcNewScene(device_)) {
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  if (robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, soup.vertices.data(), 0, 12,
                             soup.vertex_count());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, soup.indices.data(), 0, 12,
                             soup.triangle_count());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
}

Embree::~Embree() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

accel::Hit Embree::closest_hit(const accel::Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = {ray.origin[0],
               ray.origin[1],
               ray.origin[2],
               ray.t_min,
               ray.direction[0],
               ray.direction[1],
               ray.direction[2],
               0,
               ray.t_max,
               0xFFFFFFFFu,
               0,
               0};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_, &context, &query);
  accel::Hit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.type = accel::HitType::triangle;
  hit.t = query.ray.tfar;
  hit.primitive_index = query.hit.primID;
  return hit;
}

}  // namespace rayloom::bench
