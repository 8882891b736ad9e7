#include <rayloom/base/float_environment.h>

#include <catch2/catch.hpp>

#include <cfenv>
#include <limits>

using rayloom::FloatEnvironment;

namespace {

// volatile: computed when the program runs, in the state of that moment.
float third() {
  const volatile float one = 1, three = 3;
  return one / three;
}

float half_of_smallest_normal() {
  const volatile float smallest = std::numeric_limits<float>::min(), half = 0.5f;
  return smallest * half;
}

}  // namespace

TEST_CASE("the fixed environment rounds to nearest and gives the caller's rounding back", "[float_environment]") {
  const float nearest = third();
  std::fesetround(FE_UPWARD);
  std::fesetround(FE_DOWNWARD);
  const float down = third();
  float inside = 0;
  {
    const FloatEnvironment fixed;
    inside = third();
  }
  const int after = std::fegetround();
  std::fesetround(FE_TONEAREST);
  CHECK(down != nearest);
  CHECK(inside == nearest);
  CHECK(after == FE_DOWNWARD);
}

#if defined(__x86_64__)
TEST_CASE("the fixed environment keeps denormals even where the caller flushes them", "[float_environment]") {
  const unsigned saved = _mm_getcsr();
  _mm_setcsr(saved | 0x8040);  // FTZ and DAZ
  const float flushed = half_of_smallest_normal();
  float inside = 0;
  {
    const FloatEnvironment fixed;
    inside = half_of_smallest_normal();
  }
  const unsigned after = _mm_getcsr();
  _mm_setcsr(saved);
  CHECK(flushed == 0);
  CHECK(inside == std::numeric_limits<float>::min() / 2);
  CHECK((after & 0x8040) == 0x8040);
}
#endif
