#pragma once

#include <rayloom/accel/lazy_layout.h>
#include <rayloom/accel/tree_builder.h>
#include <rayloom/accel/triangle_curve.h>

#include <vector>

namespace rayloom::accel {

/// What a lazy structure keeps of its inputs. They stay in its block.
class LazyInput {
 public:
  explicit LazyInput(const std::byte* block);
  LazyInput(const LazyInput&) = delete;
  LazyInput& operator=(const LazyInput&) = delete;

  /// Triangles whose keys are at first, first + 1, ...
  TriangleCurve order(uint32_t first, uint32_t count) const;
  /// All of them.
  TriangleCurve order() const { return order(0, lazy_state(block_).key_count); }
  const TreeInput& tree_input() const { return input_; }

 private:
  TriangleGeometry geometry(size_t index) const;

  const std::byte* block_;
  std::vector<TriangleGeometry> geometries_;
  TreeInput input_;
};

}  // namespace rayloom::accel
