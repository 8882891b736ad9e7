#pragma once

// The inside of a Fiber, for those who switch so often that a call counts. Switches are inlined into the function that
// waits: after a call the fiber would come back by a return, which the processor expects to lead to where another lane
// made its last call.

#include <rayloom/base/fiber.h>
#include <rayloom/base/strand.h>

namespace rayloom {

struct Fiber::Context {
  /// `memory` is from take_stack(memory_bytes).
  Context(std::byte* memory, std::size_t memory_bytes, std::byte* stack_top);
  ~Context();

  /// Fiber::resume().
  [[gnu::always_inline]] void resume() {
    detail::Strand here;
    caller = &here;
    here.switch_to(own, this);
  }
  [[gnu::always_inline]] void yield_to(Context& next) {
    next.caller = caller;
    own.switch_to(next.own, &next);
  }
  [[gnu::always_inline]] void yield() { own.switch_to(*caller, nullptr); }
  /// The same among strands that leave their FloatModes as they are.
  [[gnu::always_inline]] void resume_in_same_modes() {
    detail::Strand here;
    caller = &here;
    here.switch_in_same_modes(own, this);
  }
  [[gnu::always_inline]] void yield_in_same_modes_to(Context& next) {
    next.caller = caller;
    own.switch_in_same_modes(next.own, &next);
  }
  [[gnu::always_inline]] void yield_in_same_modes() { own.switch_in_same_modes(*caller, nullptr); }

  /// First frame of the stack; never returns. A finished fiber waits here for its next function.
  static void entry(void* argument);

  std::byte* begin;  // of the memory: stack, this object
  std::size_t bytes;
  unsigned valgrind_id;
  detail::Strand own;
  detail::Strand* caller = nullptr;
  Function function = nullptr;
  void* argument = nullptr;
  bool done = true;
};

}  // namespace rayloom
