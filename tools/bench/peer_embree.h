#pragma once

// Embree 3.13, the packaged peer that every figure of speed is set beside. A build without it has the same functions:
// they say that it is missing.

#include <rayloom/accel/build_input.h>
#include <rayloom/accel/ray.h>
#include <rayloom/tools/bench/measure.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rayloom::bench {

/// "3.13.5"; "" in a build without Embree.
std::string embree_version();

/// Triangles in memory of the caller's that outlives the peer: three floats a vertex, followed by at least 16 readable
/// bytes, and three indices a triangle.
struct PeerMesh {
  std::span<const float> vertices;
  std::span<const uint32_t> indices;
};

/// A copy of mesh `mesh`, placed.
struct PeerInstance {
  uint32_t mesh = 0;
  accel::Transform3x4 transform = accel::identity_transform;
};

/// Without instances: all meshes in one structure, mesh i as geometry i. With them: a structure a mesh and one of the
/// instances over these.
struct PeerScene {
  std::vector<PeerMesh> meshes;
  std::vector<PeerInstance> instances;
};

enum class EmbreeQuality { low, medium, high };

struct EmbreeOptions {
  EmbreeQuality quality = EmbreeQuality::high;
  bool robust = false, compact = false;
  unsigned threads = 1;  ///< of the build
  bool avx2 = false;     ///< leave AVX-512 unused
};

/// "high", "medium robust", "high compact"
std::string describe(const EmbreeOptions& options);

/// A built scene. Rays are converted to the peer's layout inside each call, as a user would have to; calls may come
/// from several threads. hits.size() == rays.size(). Instance indices of scenes without instances are 0.
class Peer {
 public:
  virtual ~Peer() = default;
  /// rtcIntersect1, ray by ray.
  virtual void closest_hits(std::span<const accel::Ray> rays, std::span<accel::Hit> hits) const = 0;
  /// rtcOccluded1, ray by ray: only Hit::type is meant.
  virtual void any_hits(std::span<const accel::Ray> rays, std::span<accel::Hit> hits) const = 0;
  /// rtcIntersect16 with the coherent flag.
  virtual void closest_hits_16(std::span<const accel::Ray> rays, std::span<accel::Hit> hits) const = 0;
  /// What its memory monitor counts: everything but the caller's vertices and indices.
  virtual uint64_t bytes() const = 0;
  /// Of geometry and scene commits.
  virtual WorkTime build_time() const = 0;
};

/// InputError in a build without Embree, and when Embree reports an error.
std::unique_ptr<Peer> make_embree(const PeerScene& scene, const EmbreeOptions& options);

}  // namespace rayloom::bench
