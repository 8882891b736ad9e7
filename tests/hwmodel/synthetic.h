#pragma once

// Structures written by hand and captures made of them without a runtime, so that times have closed forms.

#include <rayloom/accel/layout.h>
#include <rayloom/hwmodel/recording_tracer.h>
#include <rayloom/hwmodel/replay.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace rayloom::hwmodel::test {

/// Device memory with a bump allocator; nothing at address 0.
class Arena {
 public:
  explicit Arena(uint64_t bytes);
  uint64_t allocate(uint64_t bytes, uint64_t alignment = 256);
  accel::AddressSpace addresses() const { return {base_}; }
  template <class T>
  T& at(uint64_t address) {
    return *reinterpret_cast<T*>(base_ + address);
  }

 private:
  std::vector<std::byte> storage_;
  std::byte* base_;
  uint64_t used_ = 4096;
};

/// A bottom-level structure whose every box is [-1, 1]^3, nodes and leaves in 512-byte cells, so that each node lies in
/// one 256-byte line. A ray down the z axis meets every box.
struct Chain {
  uint64_t address = 0;
  std::vector<uint64_t> nodes;
};

/// `nodes` nodes one below the other, the last without children; below it, when `triangles` > 0, a leaf with so many
/// triangles around the z axis, at z = 0, 1/16, 2/16 ...
Chain make_chain(Arena& arena, uint32_t nodes, uint32_t triangles = 0, uint32_t geometry_flags = 1);
/// As before, but the leaf holds procedural boxes.
Chain make_procedural_chain(Arena& arena, uint32_t nodes, uint32_t boxes);

accel::Ray down_z();

/// What one lane does: called with the lane's scripted interface.
class LaneScript {
 public:
  LaneScript(WarpTracer& tracer, uint32_t lane) : tracer_(tracer), lane_(lane) {}
  void begin(uint32_t shader, uint64_t record = 0) { tracer_.begin_shader(lane_, shader, record); }
  void end() { tracer_.end_shader(lane_); }
  void call() { tracer_.call_shader(lane_, 0); }
  void branch(uint32_t signature) { tracer_.branch(lane_, signature); }
  void load(uint64_t address, uint32_t bytes) { tracer_.access(lane_, AccessKind::load, address, bytes, nullptr); }
  void store(uint64_t address, uint32_t value) { tracer_.access(lane_, AccessKind::store, address, 4, &value); }
  accel::Hit trace(uint64_t structure, const accel::Ray& ray = down_z(), uint32_t flags = 0,
                   accel::CandidateFunction candidate = nullptr, void* user = nullptr);

 private:
  WarpTracer& tracer_;
  uint32_t lane_;
};

/// Runs `script(lane script, launch index)` for `lanes` lanes and captures it.
Capture capture_lanes(const Arena& arena, std::vector<ShaderInfo> shaders, uint32_t lanes,
                      const std::function<void(LaneScript&, uint32_t)>& script, uint32_t warp_size = 32);

/// A ray generation shader that costs nothing.
std::vector<ShaderInfo> free_shader();
ShaderInfo shader(const char* name, uint32_t alu, ShaderStage stage = ShaderStage::ray_generation);

/// One SM, nothing in the way: no call costs, 256-byte lines and ports as wide, bandwidths out of reach.
GpuConfig plain_config();

inline ReplayResult run(const Capture& capture, const GpuConfig& config, Observer* observer = nullptr) {
  return replay({&capture, 1}, config, observer);
}

}  // namespace rayloom::hwmodel::test
