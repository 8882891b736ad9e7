#include <rayloom/tools/bench/peer_embree.h>

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/measure.h>

#include <algorithm>
#include <atomic>

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <pmmintrin.h>

namespace rayloom::bench {
namespace {

/// Flushes denormals while it lives, as Embree's manual asks of threads that trace.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

RTCRay to_embree(const accel::Ray& ray) {
  return {ray.origin[0],
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
}

struct Names {
  unsigned primitive, geometry, instance;
};

accel::Hit to_hit(float t, float u, float v, Names names, bool instanced) {
  accel::Hit hit;
  hit.t = t;
  if (names.geometry == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.type = accel::HitType::triangle;
  hit.u = u, hit.v = v;
  hit.primitive_index = names.primitive;
  hit.geometry_index = names.geometry;
  hit.instance_index = instanced ? names.instance : 0;
  return hit;
}

RTCBuildQuality build_quality(EmbreeQuality quality) {
  static constexpr RTCBuildQuality qualities[]{RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_HIGH};
  return qualities[static_cast<size_t>(quality)];
}

/// A device and its scenes: the top one is traced.
class Embree : public Peer {
 public:
  Embree(const PeerScene& scene, const EmbreeOptions& options);
  ~Embree() override;

  void closest_hits(std::span<const accel::Ray> rays, std::span<accel::Hit> hits) const override;
  void any_hits(std::span<const accel::Ray> rays, std::span<accel::Hit> hits) const override;
  void closest_hits_16(std::span<const accel::Ray> rays, std::span<accel::Hit> hits) const override;
  uint64_t bytes() const override { return static_cast<uint64_t>(bytes_.load()); }
  WorkTime build_time() const override { return build_time_; }

 private:
  RTCScene new_scene();
  void attach_mesh(RTCScene scene, const PeerMesh& mesh);
  void attach_instance(RTCScene bottom, const PeerInstance& instance);
  void build(const PeerScene& scene);
  void closest_hits_of_16(RTCIntersectContext& context, const accel::Ray* rays, accel::Hit* hits, size_t count) const;

  EmbreeOptions options_;
  std::atomic<int64_t> bytes_{0};
  bool instanced_ = false;
  WorkTime build_time_;
  RTCDevice device_ = nullptr;
  std::vector<RTCScene> scenes_;  // the last is the top
};

bool count_bytes(void* user, ssize_t bytes, bool) {
  *static_cast<std::atomic<int64_t>*>(user) += bytes;
  return true;
}

RTCDevice new_device(const EmbreeOptions& options) {
  // This release knows few server processors by model; without the level it would not use what they have.
  const std::string config = fmt::format("threads={},hugepages=1,frequency_level={}{}", options.threads,
                                         options.avx2 ? "simd256" : "simd512", options.avx2 ? ",isa=avx2" : "");
  RTCDevice device = rtcNewDevice(config.c_str());
  if (!device) throw InputError(fmt::format("Embree: no device for '{}'", config));
  return device;
}

Embree::Embree(const PeerScene& scene, const EmbreeOptions& options)
    : options_(options), instanced_(!scene.instances.empty()), device_(new_device(options)) {
  rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
  build_time_.add([&] { build(scene); });
  const RTCError error = rtcGetDeviceError(device_);
  if (error != RTC_ERROR_NONE) {
    throw InputError(fmt::format("Embree: error {} while building", static_cast<int>(error)));
  }
}

Embree::~Embree() {
  while (!scenes_.empty()) {
    rtcReleaseScene(scenes_.back());
    scenes_.pop_back();
  }
  rtcReleaseDevice(device_);
}

RTCScene Embree::new_scene() {
  RTCScene scene = scenes_.emplace_back(rtcNewScene(device_));
  rtcSetSceneBuildQuality(scene, build_quality(options_.quality));
  unsigned flags = RTC_SCENE_FLAG_NONE;
  if (options_.robust) flags |= RTC_SCENE_FLAG_ROBUST;
  if (options_.compact) flags |= RTC_SCENE_FLAG_COMPACT;
  rtcSetSceneFlags(scene, static_cast<RTCSceneFlags>(flags));
  return scene;
}

void Embree::attach_mesh(RTCScene scene, const PeerMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, build_quality(options_.quality));
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 0, 12,
                             mesh.vertices.size() / 3);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0, 12,
                             mesh.indices.size() / 3);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

void Embree::attach_instance(RTCScene bottom, const PeerInstance& instance) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, bottom);
  rtcSetGeometryTimeStepCount(geometry, 1);
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, instance.transform.data());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scenes_.back(), geometry);
  rtcReleaseGeometry(geometry);
}

void Embree::build(const PeerScene& scene) {
  if (!instanced_) {
    RTCScene top = new_scene();
    for (const PeerMesh& mesh : scene.meshes) attach_mesh(top, mesh);
    return rtcCommitScene(top);
  }
  for (const PeerMesh& mesh : scene.meshes) {
    RTCScene bottom = new_scene();
    attach_mesh(bottom, mesh);
    rtcCommitScene(bottom);
  }
  RTCScene top = new_scene();
  for (const PeerInstance& instance : scene.instances) attach_instance(scenes_[instance.mesh], instance);
  rtcCommitScene(top);
}

void Embree::closest_hits(std::span<const accel::Ray> rays, std::span<accel::Hit> hits) const {
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (size_t i = 0; i < rays.size(); ++i) {
    RTCRayHit query;
    query.ray = to_embree(rays[i]);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scenes_.back(), &context, &query);
    const RTCHit& hit = query.hit;
    hits[i] = to_hit(query.ray.tfar, hit.u, hit.v, {hit.primID, hit.geomID, hit.instID[0]}, instanced_);
  }
}

void Embree::any_hits(std::span<const accel::Ray> rays, std::span<accel::Hit> hits) const {
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (size_t i = 0; i < rays.size(); ++i) {
    RTCRay query = to_embree(rays[i]);
    rtcOccluded1(scenes_.back(), &context, &query);
    hits[i].type = query.tfar < 0 ? accel::HitType::triangle : accel::HitType::none;
  }
}

void Embree::closest_hits_of_16(RTCIntersectContext& context, const accel::Ray* rays, accel::Hit* hits,
                                size_t count) const {
  alignas(64) int valid[16];
  alignas(64) RTCRayHit16 query;
  for (size_t i = 0; i < 16; ++i) {
    const accel::Ray& ray = rays[std::min(i, count - 1)];
    valid[i] = i < count ? -1 : 0;
    query.ray.org_x[i] = ray.origin[0], query.ray.org_y[i] = ray.origin[1], query.ray.org_z[i] = ray.origin[2];
    query.ray.dir_x[i] = ray.direction[0], query.ray.dir_y[i] = ray.direction[1], query.ray.dir_z[i] = ray.direction[2];
    query.ray.tnear[i] = ray.t_min, query.ray.tfar[i] = ray.t_max, query.ray.time[i] = 0;
    query.ray.mask[i] = 0xFFFFFFFFu, query.ray.id[i] = 0, query.ray.flags[i] = 0;
    query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  rtcIntersect16(valid, scenes_.back(), &context, &query);
  const RTCHit16& hit = query.hit;
  for (size_t i = 0; i < count; ++i) {
    hits[i] =
        to_hit(query.ray.tfar[i], hit.u[i], hit.v[i], {hit.primID[i], hit.geomID[i], hit.instID[0][i]}, instanced_);
  }
}

void Embree::closest_hits_16(std::span<const accel::Ray> rays, std::span<accel::Hit> hits) const {
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (size_t i = 0; i < rays.size(); i += 16) {
    closest_hits_of_16(context, &rays[i], &hits[i], std::min<size_t>(16, rays.size() - i));
  }
}

}  // namespace

std::string embree_version() { return RTC_VERSION_STRING; }

std::unique_ptr<Peer> make_embree(const PeerScene& scene, const EmbreeOptions& options) {
  return std::make_unique<Embree>(scene, options);
}

}  // namespace rayloom::bench
