#include <rayloom/base/error.h>
#include <rayloom/hwmodel/gpu_config.h>

#include <string>

namespace rayloom::hwmodel {

namespace {

void require(bool holds, const std::string& rule) {
  if (!holds) throw UsageError("GPU configuration: " + rule);
}

void check_sets(const char* cache, uint32_t kilobytes, uint32_t line_bytes, uint32_t ways) {
  const uint64_t bytes = uint64_t{kilobytes} * 1024, way_bytes = uint64_t{line_bytes} * ways;
  require(bytes >= way_bytes && bytes % way_bytes == 0,
          std::string(cache) + ": its size is no multiple of line bytes times ways");
}

}  // namespace

void check_config(const GpuConfig& config) {
  const uint32_t line = config.l1.line_bytes;
  require(line >= sector_bytes && line <= 16 * sector_bytes && (line & (line - 1)) == 0,
          "l1.line_bytes is no power of two from 32 to 512");
  check_sets("l1", config.l1.kilobytes, line, config.l1.ways);
  check_sets("l2", config.l2.kilobytes_per_slice, line, config.l2.ways);
  require(config.l2.latency >= 2 * config.crossbar.latency, "l2.latency is shorter than two times crossbar.latency");
  require(config.dram.latency >= config.l2.latency, "dram.latency is shorter than l2.latency");
  require(config.sm.warp_slots >= config.sm.sub_partitions, "sm.warp_slots are fewer than sm.sub_partitions");
}

}  // namespace rayloom::hwmodel
