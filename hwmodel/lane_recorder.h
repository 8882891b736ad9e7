#pragma once

// Cuts what one lane does into segments.

#include <rayloom/hwmodel/capture.h>
#include <rayloom/runtime/tracer.h>

#include <cstdint>
#include <span>
#include <vector>

namespace rayloom::hwmodel {

class LaneRecorder {
 public:
  explicit LaneRecorder(std::span<const ShaderInfo> shaders) : shaders_(shaders) {}

  void begin_shader(uint32_t shader, uint64_t record_address);
  void end_shader();
  void access(const MemoryAccess& access);
  void branch(uint32_t signature);
  /// The shader stops at a TraceRay of ray `ray`.
  void trace(uint32_t ray);
  /// The shader stops at a CallShader, or its callback calls another.
  void call();

  uint16_t depth() const { return static_cast<uint16_t>(frames_.empty() ? 0 : frames_.size() - 1); }
  const std::vector<Segment>& segments() const { return segments_; }
  const std::vector<MemoryAccess>& accesses() const { return accesses_; }

 private:
  Segment& open();
  void close(SegmentEnd end);

  std::span<const ShaderInfo> shaders_;
  std::vector<uint32_t> frames_;  // shaders on the call stack
  std::vector<Segment> segments_;
  std::vector<MemoryAccess> accesses_;
  bool open_ = false;  // the last segment is still being written
};

}  // namespace rayloom::hwmodel
