#pragma once

// A configuration of the simulated GPU: the Config of each component. Latencies are load to use, seen from the SM.

#include <rayloom/hwmodel/dispatcher.h>
#include <rayloom/hwmodel/dram.h>
#include <rayloom/hwmodel/l1_cache.h>
#include <rayloom/hwmodel/l2_cache.h>
#include <rayloom/hwmodel/rt_core.h>
#include <rayloom/hwmodel/sm.h>

#include <cstdint>

namespace rayloom::hwmodel {

struct GpuConfig {
  uint32_t core_mhz = 1000;  ///< of everything but DRAM
  Dispatcher::Config dispatcher;
  Sm::Config sm;
  RtCore::Config rt;
  L1Cache::Config l1;
  CrossbarConfig crossbar;
  L2Cache::Config l2;
  Dram::Config dram;
};

/// Throws UsageError for values that contradict each other (a cache without a whole set, a latency shorter than the
/// ways it is made of).
void check_config(const GpuConfig& config);

}  // namespace rayloom::hwmodel
