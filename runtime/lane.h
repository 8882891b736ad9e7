#pragma once

// One lane of a warp: a ray generation thread and every shader that descends from it.

#include <rayloom/base/fiber_context.h>
#include <rayloom/runtime/dispatch_context.h>
#include <rayloom/runtime/invocation.h>

#include <exception>
#include <string>
#include <utility>

namespace rayloom::detail {

class Warp;
struct RayFrame;

/// Host stack left for a shader's own frames and for what it calls in the engine.
inline constexpr uint64_t host_stack_reserve = 32 * 1024;

/// Warp::begin() sets what makes it this thread of the grid and no other.
struct Lane : LaneIdentity {
  Warp* warp = nullptr;
  const DispatchContext* context = nullptr;
  DispatchStatistics* counts = nullptr;  ///< of its warp
  Fiber::Context* fiber = nullptr;       ///< null in direct mode
  RayFrame* pending = nullptr;           ///< the ray this lane waits for
  std::exception_ptr failure;            ///< why the lane died; its first failure stays
  uint64_t stack_used = 0;               ///< of the pipeline stack size, in declared bytes (RC-05)
  uintptr_t stack_limit = 0;             ///< lowest host stack address shaders may reach
  uint32_t trace_depth = 0;
  uint32_t number = 0;  ///< in the warp
  uint64_t linear_index = 0;
  uint64_t exception_state[2] = {};  ///< the C++ runtime's per-thread state (exceptions being handled) of this lane
  LaneObserver observer{};

  const DispatchContext& dispatch() const { return *context; }

  /// Throws the failure again for shaders that swallowed it.
  void check_alive() const {
    if (failure) [[unlikely]]
      std::rethrow_exception(failure);
  }
  [[noreturn]] void remove_device(const std::string& reason);
  /// Room on the host stack for one more shader of this declared size (RC-08).
  void check_host_stack(uint64_t shader_bytes) {
    const auto here = reinterpret_cast<uintptr_t>(__builtin_frame_address(0));
    if (here < stack_limit + host_stack_reserve + 2 * shader_bytes) [[unlikely]]
      low_host_stack();
  }

  template <class Text>
  void report(std::string_view row, Text text) const {
    if (dispatch().validates) [[unlikely]]
      dispatch().log.add(row, linear_index, text());
  }

 private:
  void low_host_stack();
};

inline Lane& lane_of(const Invocation& invocation) { return static_cast<Lane&>(*invocation.lane); }

}  // namespace rayloom::detail
