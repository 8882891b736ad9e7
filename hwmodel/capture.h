#pragma once

// What a DispatchRays did, as plain data: the shader work of every lane and the traversal of every ray. A replay is a
// pure function of this, the bytes of the structures, and a configuration.
//
// A warp's arrays are flat; lanes, segments, rays and events refer into them by index. Nothing here depends on how many
// host threads ran the dispatch.

#include <rayloom/accel/trace.h>
#include <rayloom/runtime/tracer.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rayloom::hwmodel {

/// What memory traffic is for. Every cache and DRAM counter is split by it.
enum class RequestClass : uint8_t { top_node, bottom_node, leaf, instance, shader_record, shader_data };
inline constexpr size_t request_class_count = 6;
const char* request_class_name(RequestClass request_class);

/// One access of a shader to device memory (16 bytes).
struct MemoryAccess {
  uint64_t address = 0;
  uint32_t bytes : 24 = 0;
  uint32_t kind : 8 = 0;    ///< AccessKind
  uint32_t store_data = 0;  ///< offset into WarpCapture::store_data
};
static_assert(sizeof(MemoryAccess) == 16);

enum class SegmentEnd : uint8_t { trace, call, finish };

/// A stretch of one shader invocation between two points where the lane does something other than run it.
struct Segment {
  uint64_t signature = 0;  ///< digest of the shader's own branch marks in this stretch
  uint64_t record = 0;     ///< address of the shader record read to get here, 0 when none was
  uint32_t shader = 0;     ///< index into LaunchHeader::shaders
  uint32_t alu = 0, special = 0;
  uint32_t access_begin = 0, access_count = 0;
  uint32_t ray = 0;    ///< when end is trace: index into WarpCapture::rays
  uint16_t depth = 0;  ///< shaders on the lane's call stack below this one
  SegmentEnd end = SegmentEnd::finish;
  bool begins = false;  ///< first stretch of its invocation: carries the whole declared cost
};

/// Segments of one lane, in order. A stretch in which nothing happens (after a last TraceRay, say) is left out.
struct LaneCapture {
  uint32_t segment_begin = 0, segment_count = 0;
};

enum class RayEventKind : uint8_t { node, triangle_leaf, procedural_leaf, enter_instance, leave_instance, candidate };
const char* ray_event_kind_name(RayEventKind kind);

/// One step of a ray (16 bytes). A leaf's candidates come before the leaf itself, as traversal decides them.
///   node             address of the Node8; mask: children whose boxes the ray enters; digest of the entry distances
///   triangle_leaf    address of the leaf; mask: lanes hit, before any decision; digest of the lanes not ruled out
///   procedural_leaf  address of the leaf; mask: lanes whose boxes the ray enters; digest of the lanes offered
///   enter_instance   address of the InstanceRecord; digest of the object-space ray
///   leave_instance   address of the InstanceRecord
///   candidate        payload: index into WarpCapture::candidates; digest of the verdict
struct RayEvent {
  uint64_t address = 0;
  uint32_t payload = 0;
  RayEventKind kind{};
  uint8_t mask = 0;
  uint16_t digest = 0;

  friend bool operator==(const RayEvent&, const RayEvent&) = default;
};
static_assert(sizeof(RayEvent) == 16);

/// A decision traversal left to a shader: what was asked, the any-hit and intersection shaders that ran, the answer.
struct CandidateCapture {
  accel::HitType type{};
  bool opaque = false;
  uint32_t instance_index = 0, geometry_index = 0, primitive_index = 0;
  float t = 0, t_current = 0;
  uint32_t segment_begin = 0, segment_count = 0;  ///< into WarpCapture::segments; 0 when no shader ran
  accel::Verdict verdict;
};

struct RayCapture {
  accel::Ray ray{};
  uint64_t structure_address = 0;
  uint32_t ray_flags = 0;
  uint32_t event_begin = 0, event_count = 0;  ///< into WarpCapture::events
  uint32_t candidate_begin = 0;               ///< into WarpCapture::candidates
  uint16_t lane = 0;
  uint16_t depth = 0;  ///< TraceRay calls on the lane's call stack above this one: 0 from ray generation
  uint8_t instance_mask = 0xFF;
  bool asks_candidates = false;  ///< TraceRequest::candidate was set
  accel::Hit hit;
};

struct WarpCapture {
  std::vector<LaneCapture> lanes;
  std::vector<Segment> segments;
  std::vector<MemoryAccess> accesses;
  std::vector<std::byte> store_data;
  std::vector<RayCapture> rays;
  std::vector<RayEvent> events;
  std::vector<CandidateCapture> candidates;
};

struct StructureRange {
  uint64_t address = 0, bytes = 0;
  bool top_level = false;
};

struct LaunchHeader {
  uint32_t width = 0, height = 0, depth = 0;
  uint32_t warp_size = 32;
  std::vector<ShaderInfo> shaders;
  std::vector<StructureRange> structures;  ///< by address
  accel::AddressSpace addresses;           ///< where the structures' bytes lie on this host; they must not change
};

/// One DispatchRays.
struct Capture {
  LaunchHeader header;
  std::vector<WarpCapture>
      warps;  ///< lane l of warp w is thread w * warp_size + l in the order of runtime/grid_order.h
};

/// Totals a replay must reproduce.
struct CaptureCounts {
  uint64_t warps = 0, lanes = 0, segments = 0, accesses = 0, rays = 0;
  uint64_t nodes = 0, triangle_leaves = 0, procedural_leaves = 0, instances = 0, candidates = 0;
  uint64_t bytes = 0;  ///< memory the capture takes

  CaptureCounts& operator+=(const CaptureCounts& other);
  friend bool operator==(const CaptureCounts&, const CaptureCounts&) = default;
};
CaptureCounts count(const Capture& capture);

}  // namespace rayloom::hwmodel
