#include <rayloom/accel/lazy_input.h>
#include <rayloom/accel/structure.h>

#include <cstring>

namespace rayloom::accel {

LazyInput::LazyInput(const std::byte* block) : block_(block), geometries_(header_of(block).geometry_count) {
  for (size_t g = 0; g < geometries_.size(); ++g) geometries_[g] = geometry(g);
  const StructureHeader& header = header_of(block);
  const BuildSettings settings(header.build_flags, static_cast<Builder>(header.builder));
  input_ = accel::tree_input(header.kind, header.primitive_count, settings);
  input_.triangles = geometries_;
}

TriangleCurve LazyInput::order(uint32_t first, uint32_t count) const {
  const LazyState& state = lazy_state(block_);
  const auto* const keys = reinterpret_cast<const MortonKey*>(block_ + state.keys);
  return {geometries_, state.curve, std::span(keys + first, count)};
}

TriangleGeometry LazyInput::geometry(size_t index) const {
  LazyGeometry stored;
  std::memcpy(&stored, block_ + lazy_state(block_).geometries + index * sizeof(stored), sizeof(stored));
  TriangleGeometry result;
  result.vertices = block_ + stored.vertices;
  result.vertex_count = stored.vertex_count;
  result.indices = block_ + stored.indices;
  result.index_format = stored.index_format;
  result.triangle_count = stored.triangle_count;
  result.flags = stored.flags;
  return result;
}

}  // namespace rayloom::accel
