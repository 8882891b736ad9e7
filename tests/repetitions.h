#pragma once

namespace rayloom::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr int repetitions_divisor = 4;
#else
inline constexpr int repetitions_divisor = 1;
#endif

/// How often to repeat what is repeated `full` times: fewer where a sanitizer makes each take ten times as long, since
/// there only the ways through the code count.
constexpr int repetitions(int full) { return (full + repetitions_divisor - 1) / repetitions_divisor; }

}  // namespace rayloom::test
