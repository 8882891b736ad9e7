#pragma once

// One lane of a warp: a ray generation thread and every shader that descends from it.

#include <rayloom/base/fiber.h>
#include <rayloom/runtime/dispatch_context.h>
#include <rayloom/runtime/invocation.h>

#include <exception>
#include <string>
#include <utility>

namespace rayloom::detail {

class Warp;
struct RayFrame;

struct Lane : LaneIdentity {
  Warp* warp = nullptr;
  Fiber* fiber = nullptr;  ///< null in direct mode
  uint64_t linear_index = 0;
  uint32_t number = 0;  ///< in the warp
  uint32_t trace_depth = 0;
  uint64_t stack_used = 0;      ///< of the pipeline stack size, in declared bytes (RC-05)
  uintptr_t stack_limit = 0;    ///< lowest host stack address shaders may reach
  RayFrame* pending = nullptr;  ///< the ray this lane waits for
  std::exception_ptr failure;   ///< why the lane died; its first failure stays
  LaneObserver observer{};
  uint64_t exception_state[2] = {};  ///< the C++ runtime's per-thread state (exceptions being handled) of this fiber

  const DispatchContext& dispatch() const;
  DispatchStatistics& statistics() const;

  /// Throws the failure again for shaders that swallowed it.
  void check_alive() const {
    if (failure) [[unlikely]]
      std::rethrow_exception(failure);
  }
  [[noreturn]] void remove_device(const std::string& reason);
  /// Room on the host stack for one more shader of this declared size (RC-08).
  void check_host_stack(uint64_t shader_bytes);

  template <class Text>
  void report(std::string_view row, Text text) const {
    if (dispatch().log.enabled()) [[unlikely]]
      dispatch().log.add(row, linear_index, text());
  }
};

inline Lane& lane_of(const Invocation& invocation) { return static_cast<Lane&>(*invocation.lane); }

/// Runs a shader with stack accounting, statistics and observation.
HitDecision run_shader(Invocation& invocation, uint32_t shader, void* data, const void* attributes);

}  // namespace rayloom::detail
