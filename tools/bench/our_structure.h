#pragma once

// A bench scene's structures as accel builds them, in memory of their own.

#include <rayloom/accel/build.h>
#include <rayloom/accel/build_settings.h>
#include <rayloom/accel/trace.h>
#include <rayloom/tools/bench/bench_scene.h>

#include <utility>

namespace rayloom::bench {

/// How many parts lazy structures have, and how many of them are built.
struct LazyParts {
  uint64_t all = 0, built = 0;
};

class OurStructure {
 public:
  /// One bottom level, or one a mesh and a top level over the instances. All geometries are opaque unless asked.
  explicit OurStructure(const BenchScene& scene, accel::BuildSettings settings = accel::build_flag::prefer_fast_trace,
                        uint32_t geometry_flags = accel::geometry_flag::opaque);

  /// What rays are traced against; its instance descs hold host addresses (AddressSpace{}).
  const std::byte* root() const { return blocks_.back().data; }
  /// Bytes used, all structures together.
  uint64_t bytes() const { return bytes_; }
  /// Of all builds together, without reserving memory.
  const WorkTime& build_time() const { return build_time_; }
  /// Of the structure that holds most triangles.
  const accel::StructureInfo& largest() const { return largest_; }
  /// Of all lazy bottom levels together, at this moment.
  LazyParts lazy_parts() const;
  accel::TraceRequest request(const accel::Ray& ray, uint32_t ray_flags = 0) const {
    return {.ray = ray, .structure = root(), .ray_flags = ray_flags};
  }

 private:
  class Block {
   public:
    explicit Block(uint64_t bytes);
    Block(Block&& other) noexcept
        : data(other.data), mapping_(std::exchange(other.mapping_, nullptr)), mapped_(other.mapped_) {}
    Block& operator=(Block&&) = delete;
    ~Block();
    std::byte* data;

   private:
    std::byte* mapping_;
    uint64_t mapped_;
  };
  template <class Sizes, class Build>
  void build(const Sizes& sizes, const Build& build);

  std::vector<Block> blocks_;
  uint64_t bytes_ = 0;
  WorkTime build_time_;
  accel::StructureInfo largest_;
};

}  // namespace rayloom::bench
