#pragma once

// The float state that code may set and must find again after a switch of stacks.

#include <rayloom/base/float_environment.h>

namespace rayloom {

/// What a program can set of the float state: rounding, masks, flush modes; not the exception flags.
class FloatModes {
 public:
#if defined(__x86_64__)
  static FloatModes fixed() { return {FloatEnvironment::fixed_mxcsr, FloatEnvironment::fixed_x87}; }
  static FloatModes current() {
    uint16_t x87;
    asm volatile("fnstcw %0" : "=m"(x87));
    return {_mm_getcsr() & ~exception_flags, x87};
  }
  void set() const {
    _mm_setcsr(mxcsr_);
    asm volatile("fldcw %0" : : "m"(x87_));
  }
  friend bool operator==(const FloatModes&, const FloatModes&) = default;

  FloatModes() = default;

 private:
  static constexpr uint32_t exception_flags = 0x3F;
  FloatModes(uint32_t mxcsr, uint16_t x87) : mxcsr_(mxcsr), x87_(x87) {}

  uint32_t mxcsr_ = FloatEnvironment::fixed_mxcsr;
  uint16_t x87_ = FloatEnvironment::fixed_x87;
#else
  static FloatModes fixed() { return {}; }
  static FloatModes current() { return {std::fegetround()}; }
  void set() const { std::fesetround(rounding_); }
  friend bool operator==(const FloatModes&, const FloatModes&) = default;

  FloatModes() = default;

 private:
  explicit FloatModes(int rounding) : rounding_(rounding) {}
  int rounding_ = FE_TONEAREST;
#endif
};

}  // namespace rayloom
