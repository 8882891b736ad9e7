#pragma once

// One floating-point state for all code whose result must not depend on the caller: round to nearest, all exceptions
// masked, no flush to zero and no denormals-are-zero. Denormals stay, because the exact hit test (guarantee G1) relies
// on gradual underflow: x - y == 0 only if x == y.

#include <cstdint>

#if defined(__x86_64__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace rayloom {

/// Sets the fixed state for its scope and restores the caller's, exception flags included.
class FloatEnvironment {
 public:
#if defined(__x86_64__)
  static constexpr uint32_t fixed_mxcsr = 0x1F80;
  static constexpr uint16_t fixed_x87 = 0x037F;

  static void set() noexcept {
    _mm_setcsr(fixed_mxcsr);
    asm volatile("fldcw %0" : : "m"(fixed_x87));
  }
  FloatEnvironment() noexcept : mxcsr_(_mm_getcsr()) {
    asm volatile("fnstcw %0" : "=m"(x87_));
    set();
  }
  ~FloatEnvironment() {
    _mm_setcsr(mxcsr_);
    asm volatile("fldcw %0" : : "m"(x87_));
  }
#else
  static void set() noexcept { std::fesetenv(FE_DFL_ENV); }
  FloatEnvironment() noexcept {
    std::fegetenv(&caller_);
    set();
  }
  ~FloatEnvironment() { std::fesetenv(&caller_); }
#endif
  FloatEnvironment(const FloatEnvironment&) = delete;
  FloatEnvironment& operator=(const FloatEnvironment&) = delete;

 private:
#if defined(__x86_64__)
  uint32_t mxcsr_;
  uint16_t x87_ = 0;
#else
  std::fenv_t caller_;
#endif
};

}  // namespace rayloom
