#include <rayloom/accel/checks.h>
#include <rayloom/accel/chunks.h>
#include <rayloom/accel/collect_refs.h>
#include <rayloom/accel/layout.h>
#include <rayloom/accel/simd/build_kernel.h>
#include <rayloom/accel/triangle_curve.h>
#include <rayloom/accel/triangle_input.h>

namespace rayloom::accel {
namespace {

/// How many keys ahead a triangle's indices and vertices are asked for.
constexpr size_t indices_ahead = 32, vertices_ahead = 16;

/// A frame so many times too large is made anew.
constexpr double largest_frame = 4;

struct Bounds {
  Box4 box;
  void merge(const Bounds& other) { box.extend(other.box); }
};

/// Of all finite vertices, whether triangles use them or not.
Bounds vertex_bounds(const TriangleGeometry& geometry) {
  const BuildKernel* const kernel = vectors_read(geometry) && geometry.vertex_stride == 12 ? build_kernel() : nullptr;
  return reduce_chunks<Bounds>(geometry.vertex_count, [&](size_t begin, size_t end) {
    if (kernel) return Bounds{box4(kernel->vertex_bounds(geometry.vertices + 12 * begin, end - begin))};
    Bounds part;
    for (size_t i = begin; i < end; ++i) {
      const Float4 vertex = load_vertex(geometry, static_cast<uint32_t>(i));
      if (detail::all(detail::finite(vertex))) part.box.extend(vertex, vertex);
    }
    return part;
  });
}

/// Of the triangles' vertices.
Bounds triangle_bounds(const TriangleGeometry& geometry, uint32_t index) {
  return reduce_chunks<Bounds>(geometry.triangle_count, [&](size_t begin, size_t end) {
    Bounds part;
    for (size_t i = begin; i < end; ++i) {
      const auto triangle = static_cast<uint32_t>(i);
      const Corners4 corners = load_corners(geometry, checked_indices(geometry, index, triangle));
      if (is_kept(corners, true)) part.box.extend(corners.box());
    }
    return part;
  });
}

/// Of the active triangles of a range; returns their end and extends `centres`.
MortonKey* make_keys_one_by_one(const KeyRange& range, uint32_t index, MortonKey* out, Box& centres) {
  const TriangleGeometry geometry = *range.geometry;
  const MortonCurve curve = *range.curve;
  Bounds part;
  for (uint32_t triangle = range.begin; triangle < range.end; ++triangle) {
    const Corners4 corners = load_corners(geometry, checked_indices(geometry, index, triangle));
    if (!is_kept(corners, range.keep_degenerate)) continue;
    const Float4 centre = centre4(corners.box());
    part.box.extend(centre, centre);
    *out++ = {curve.upper_code(centre), range.first_number + triangle};
  }
  centres.extend(part.box.box());
  return out;
}

/// Vectors leave it to the other loop to name an index out of range.
MortonKey* make_keys(const KeyRange& range, uint32_t index, MortonKey* out, Box& centres) {
  const BuildKernel* const kernel = vectors_read(*range.geometry) ? build_kernel() : nullptr;
  MortonKey* const end = kernel ? kernel->make_keys(range, out, centres) : nullptr;
  return end ? end : make_keys_one_by_one(range, index, out, centres);
}

}  // namespace

TriangleCurve::TriangleCurve(std::span<const TriangleGeometry> geometries, bool keep_degenerate)
    : numbers_(geometries), keep_degenerate_(keep_degenerate), curve_(frame()) {
  const Box centres = make_keys_on(curve_);
  if (const MortonCurve exact(centres); curve_.extent() > largest_frame * exact.extent()) {
    curve_ = exact;
    make_keys_on(curve_);
  }
  const KeyDetails details{[this](uint32_t number) { return code(number); }, [](uint32_t number) { return number; }};
  sort_keys(keys_, leaf_lanes, details);
}

/// A box around all centres, quick to have: of all vertices, where they are not many more than triangles.
Box TriangleCurve::frame() const {
  Bounds all;
  const auto geometries = numbers_.geometries();
  for (uint32_t g = 0; g < geometries.size(); ++g) {
    const bool few = geometries[g].vertex_count <= 3 * uint64_t{geometries[g].triangle_count};
    all.merge(few ? vertex_bounds(geometries[g]) : triangle_bounds(geometries[g], g));
  }
  return all.box.box();
}

/// Makes unsorted keys and returns the box of their centres.
Box TriangleCurve::make_keys_on(const MortonCurve& curve) {
  const auto geometries = numbers_.geometries();
  keys_.clear();
  keys_.reserve(checked_count(geometries));
  Box all;
  for (uint32_t g = 0; g < geometries.size(); ++g) {
    std::vector<Box> centres(chunk_count(geometries[g].triangle_count));
    append_chunks(keys_, geometries[g].triangle_count, [&](size_t chunk, size_t begin, size_t end, MortonKey* out) {
      const KeyRange range{
          &geometries[g], static_cast<uint32_t>(begin), static_cast<uint32_t>(end), numbers_.begin(g), keep_degenerate_,
          &curve};
      return make_keys(range, g, out, centres[chunk]);
    });
    for (const Box& box : centres) all.extend(box);
  }
  return all;
}

uint64_t TriangleCurve::code(uint32_t number) const {
  const auto [geometry, primitive] = numbers_.name(number);
  const TriangleGeometry& from = numbers_.geometries()[geometry];
  return curve_.code(centre4(load_corners(from, read_indices(from, primitive)).box()));
}

bool TriangleCurve::gather(std::span<const MortonKey> keys, PrimitiveRef* refs, const TriangleRows* rows) const {
  const auto geometries = numbers_.geometries();
  if (const BuildKernel* const kernel = build_kernel();
      kernel && geometries.size() == 1 && vectors_read(geometries[0])) {
    kernel->gather_refs({&geometries[0], 0, 0}, keys, refs, rows);
    return rows != nullptr;
  }
  for (size_t i = 0; i < keys.size(); ++i) {
    if (i + indices_ahead < keys.size()) prefetch_indices(keys[i + indices_ahead].index);
    if (i + vertices_ahead < keys.size()) prefetch_vertices(keys[i + vertices_ahead].index);
    const auto [geometry, primitive] = numbers_.name(keys[i].index);
    const TriangleGeometry& from = numbers_.geometries()[geometry];
    const Box4 box = load_corners(from, read_indices(from, primitive)).box();
    store(box, refs[i]);
    refs[i].geometry = geometry;
    refs[i].primitive = primitive;
  }
  return false;
}

void TriangleCurve::prefetch_indices(uint32_t number) const {
  const auto [geometry, primitive] = numbers_.name(number);
  const TriangleGeometry& from = numbers_.geometries()[geometry];
  const uint64_t stride = from.index_format == IndexFormat::uint16 ? 6 : 12;
  if (from.index_format != IndexFormat::none) __builtin_prefetch(from.indices + stride * primitive);
}

void TriangleCurve::prefetch_vertices(uint32_t number) const {
  const auto [geometry, primitive] = numbers_.name(number);
  const TriangleGeometry& from = numbers_.geometries()[geometry];
  const auto stride = static_cast<uint32_t>(from.vertex_stride);
  for (const uint32_t index : read_indices(from, primitive))
    __builtin_prefetch(from.vertices + uint64_t{index} * stride);
}

}  // namespace rayloom::accel
