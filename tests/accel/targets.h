#pragma once

// Functions compiled per target by Highway's foreach_target.h, for the targets that this processor has.

#include <rayloom/accel/trace.h>

#include <vector>

namespace rayloom::accel::test {

template <class Functions>
struct Target {
  Isa isa;
  Functions functions;
  size_t packet_size;
};

template <class Functions>
std::vector<Target<Functions>> supported_targets(const Functions& avx2, const Functions& avx512) {
  std::vector<Target<Functions>> targets;
  if (isa_supported(Isa::avx2)) targets.push_back({Isa::avx2, avx2, 8});
  if (isa_supported(Isa::avx512)) targets.push_back({Isa::avx512, avx512, 16});
  return targets;
}

}  // namespace rayloom::accel::test
