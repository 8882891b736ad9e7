#pragma once

// A stack that may be left and gone back to, as AddressSanitizer and ThreadSanitizer want to be told.

#include <rayloom/base/float_modes.h>
#include <rayloom/base/stack_switch.h>

#if defined(__has_feature)
#define RAYLOOM_HAS_FEATURE(name) __has_feature(name)
#else
#define RAYLOOM_HAS_FEATURE(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || RAYLOOM_HAS_FEATURE(address_sanitizer)
#define RAYLOOM_ASAN 1
#include <sanitizer/common_interface_defs.h>
#endif
#if defined(__SANITIZE_THREAD__) || RAYLOOM_HAS_FEATURE(thread_sanitizer)
#define RAYLOOM_TSAN 1
#include <sanitizer/tsan_interface.h>
#endif

namespace rayloom::detail {

/// A stack as the sanitizers know it. leave_for() is called just before a switch, arrive_from() just after it.
class KnownStack {
 public:
  /// The stack of a thread that resumes a fiber; its extent is learnt at the first switch away from it.
  KnownStack() = default;
  /// A fiber's own stack.
  KnownStack([[maybe_unused]] const void* stack, [[maybe_unused]] std::size_t bytes) {
#if RAYLOOM_ASAN
    stack_ = stack;
    bytes_ = bytes;
#endif
#if RAYLOOM_TSAN
    thread_ = __tsan_create_fiber(0);
    owned_ = true;
#endif
  }
  ~KnownStack() {
#if RAYLOOM_TSAN
    if (owned_) __tsan_destroy_fiber(thread_);
#endif
  }
  KnownStack(const KnownStack&) = delete;
  KnownStack& operator=(const KnownStack&) = delete;

  void leave_for([[maybe_unused]] KnownStack& next) {
#if RAYLOOM_ASAN
    __sanitizer_start_switch_fiber(&fake_stack_, next.stack_, next.bytes_);
    next.predecessor_ = this;
#endif
#if RAYLOOM_TSAN
    if (!owned_) thread_ = __tsan_get_current_fiber();
    __tsan_switch_to_fiber(next.thread_, 0);
#endif
  }
  void arrive() {
#if RAYLOOM_ASAN
    __sanitizer_finish_switch_fiber(fake_stack_, &predecessor_->stack_, &predecessor_->bytes_);
#endif
  }

 private:
#if RAYLOOM_ASAN
  const void* stack_ = nullptr;
  std::size_t bytes_ = 0;
  void* fake_stack_ = nullptr;
  KnownStack* predecessor_ = nullptr;
#endif
#if RAYLOOM_TSAN
  void* thread_ = nullptr;
  bool owned_ = false;
#endif
};

/// What may be switched away from and back to: a fiber, or the frame of a resume() that waits for one.
struct Strand {
  Strand() = default;
  Strand(void* top, std::size_t bytes, StackEntry entry)
      : point(make_stack(top, bytes, entry)),
        modes(FloatModes::fixed()),
        known(static_cast<std::byte*>(top) - bytes, bytes) {}

  [[gnu::always_inline]] void switch_to(Strand& next, void* argument) {
    modes = FloatModes::current();
    if (!(modes == next.modes)) [[unlikely]]
      next.modes.set();
    switch_in_same_modes(next, argument);
    arrive_in_own_modes();
  }
  /// For strands that never change their FloatModes: to read them waits for all arithmetic before.
  [[gnu::always_inline]] void switch_in_same_modes(Strand& next, void* argument) {
    known.leave_for(next.known);
    switch_stack(point, next.point, argument);
    known.arrive();
  }

  /// On some processors fcontext keeps the modes it was left in, which are those of the strand that was switched to.
  [[gnu::always_inline]] void arrive_in_own_modes() const {
#if RAYLOOM_STACK_SWITCH_BY_BOOST
    modes.set();
#endif
  }

  StackPoint point;
  FloatModes modes;
  KnownStack known;
};

}  // namespace rayloom::detail
