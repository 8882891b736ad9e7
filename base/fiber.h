#pragma once

// A stackful coroutine for the lanes of a warp: a shader runs on its own stack, yields at TraceRay, and goes on when
// its hit is known. A switch costs a few nanoseconds (Boost.Context's fcontext), and is told to AddressSanitizer,
// ThreadSanitizer and valgrind. This is the only place that switches stacks.

#include <cstddef>
#include <memory>

namespace rayloom {

/// Rules:
///  * No exception may leave the function: there is no frame above it to catch one. Catch inside, rethrow after
///  resume().
///  * Do not yield inside a catch handler, and resume a fiber only from the thread that started it.
///  * A fiber starts in the fixed FloatEnvironment and keeps its own state; the caller's is back after each switch.
///  * Destroying a fiber that has not finished drops its frames without running destructors.
/// Fibers may resume other fibers. A moved-from fiber may only be destroyed or assigned to.
class Fiber {
 public:
  using Function = void (*)(void* argument);

  /// Maps `stack_bytes` (rounded up to pages) with a guard page below. Throws std::bad_alloc.
  explicit Fiber(std::size_t stack_bytes = 256 * 1024);
  ~Fiber();
  Fiber(Fiber&&) noexcept;
  Fiber& operator=(Fiber&&) noexcept;

  /// Arms a fresh or finished fiber: `function(argument)` begins at the next resume().
  void start(Function function, void* argument);
  /// Runs the fiber until it yields or finishes. It must be armed or suspended.
  void resume();
  /// Called inside the fiber's function: goes back to whoever resumed it.
  void yield();
  /// True unless the fiber is armed, running or suspended.
  bool done() const;

 private:
  struct Context;
  struct Unmap {
    void operator()(Context* context) const;
  };
  std::unique_ptr<Context, Unmap> context_;  // lies at the top of its own stack
};

}  // namespace rayloom
