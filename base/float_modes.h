#pragma once

// The float state that code may set and must find again after a switch of stacks.

#include <rayloom/base/float_environment.h>

namespace rayloom {

/// What a program can set of the float state: rounding, masks, flush modes. Not the exception flags, nor the x87's
/// control word, which only long double reads.
class FloatModes {
 public:
#if defined(__x86_64__)
  static FloatModes fixed() { return {}; }
  static FloatModes current() { return FloatModes(_mm_getcsr() & ~exception_flags); }
  void set() const { _mm_setcsr(mxcsr_); }
#else
  static FloatModes fixed() { return {}; }
  static FloatModes current() { return FloatModes(std::fegetround()); }
  void set() const { std::fesetround(rounding_); }
#endif
  FloatModes() = default;
  friend bool operator==(const FloatModes&, const FloatModes&) = default;

 private:
#if defined(__x86_64__)
  static constexpr uint32_t exception_flags = 0x3F;
  explicit FloatModes(uint32_t mxcsr) : mxcsr_(mxcsr) {}
  uint32_t mxcsr_ = FloatEnvironment::fixed_mxcsr;
#else
  explicit FloatModes(int rounding) : rounding_(rounding) {}
  int rounding_ = FE_TONEAREST;
#endif
};

}  // namespace rayloom
