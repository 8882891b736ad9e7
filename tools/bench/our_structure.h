#pragma once

// A bench scene's structures as accel builds them, in memory of their own.

#include <rayloom/accel/build.h>
#include <rayloom/accel/build_settings.h>
#include <rayloom/accel/trace.h>
#include <rayloom/tools/bench/bench_scene.h>

namespace rayloom::bench {

class OurStructure {
 public:
  /// One bottom level, or one a mesh and a top level over the instances. All geometries are opaque unless asked.
  explicit OurStructure(const BenchScene& scene, accel::BuildSettings settings = accel::build_flag::prefer_fast_trace,
                        uint32_t geometry_flags = accel::geometry_flag::opaque);
  ~OurStructure();
  OurStructure(const OurStructure&) = delete;
  OurStructure& operator=(const OurStructure&) = delete;

  /// What rays are traced against; its instance descs hold host addresses (AddressSpace{}).
  const std::byte* root() const { return blocks_.back().memory; }
  /// Bytes used, all structures together.
  uint64_t bytes() const { return bytes_; }
  /// Of all builds together, without reserving memory.
  const WorkTime& build_time() const { return build_time_; }
  /// Of the structure that holds most triangles.
  const accel::StructureInfo& largest() const { return largest_; }
  accel::TraceRequest request(const accel::Ray& ray, uint32_t ray_flags = 0) const {
    return {.ray = ray, .structure = root(), .ray_flags = ray_flags};
  }

 private:
  struct Block {
    std::byte* memory;
    uint64_t mapped;
  };
  template <class Sizes, class Build>
  void build(const Sizes& sizes, const Build& build);

  std::vector<Block> blocks_;
  uint64_t bytes_ = 0;
  WorkTime build_time_;
  accel::StructureInfo largest_;
};

}  // namespace rayloom::bench
