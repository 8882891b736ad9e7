#pragma once

// A stackful coroutine for the lanes of a warp: a shader runs on its own stack, yields at TraceRay, and goes on when
// its hit is known. A switch costs two or three nanoseconds, and is told to AddressSanitizer, ThreadSanitizer and
// valgrind. This is the only place that switches stacks.

#include <cstddef>
#include <memory>

namespace rayloom {

/// Rules:
///  * No exception may leave the function: there is no frame above it to catch one. Catch inside, rethrow after
///  resume().
///  * Do not yield inside a catch handler. Go on in another thread only where no frame of the fiber keeps anything that
///  belongs to a thread.
///  * A fiber starts in the fixed FloatEnvironment and keeps its own rounding, masks and flush modes; the caller's are
///  back after each switch. Exception flags and the x87 belong to the thread.
///  * Destroying a fiber that has not finished drops its frames without running destructors.
/// Fibers may resume other fibers. A moved-from fiber may only be destroyed or assigned to.
class Fiber {
 public:
  using Function = void (*)(void* argument);

  /// Maps `stack_bytes` (rounded up to pages) with a guard page below. Throws std::bad_alloc. Fibers that take turns
  /// should be given different `color`s: their stacks then begin in different sets of the first level cache.
  explicit Fiber(std::size_t stack_bytes = 256 * 1024, std::size_t color = 0);
  ~Fiber();
  Fiber(Fiber&&) noexcept;
  Fiber& operator=(Fiber&&) noexcept;

  /// Arms a fresh or finished fiber: `function(argument)` begins at the next resume().
  void start(Function function, void* argument);
  /// Runs the fiber until it, or one it gave its turn to, yields or finishes. It must be armed or suspended.
  void resume();
  /// Called inside the fiber's function: goes back to whoever resumed it.
  void yield();
  /// Called inside the fiber's function: suspends it and goes on with `next`, which must be armed or suspended and from
  /// now on goes back to whoever resumed this fiber. One switch where yield() and resume() take two.
  void yield_to(Fiber& next);
  /// True unless the fiber is armed, running or suspended.
  bool done() const;

  /// For switches that are inlined (fiber_context.h).
  struct Context;
  Context& context() { return *context_; }

 private:
  struct GiveBack {
    void operator()(Context* context) const;
  };
  std::unique_ptr<Context, GiveBack> context_;  // lies at the top of its own stack
};

}  // namespace rayloom
