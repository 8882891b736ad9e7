#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/chunks.h>
#include <rayloom/accel/spatial_bins.h>

namespace rayloom::accel {
namespace {

constexpr double infinite_cost = std::numeric_limits<double>::infinity();

double part_cost(const Box& box, uint64_t count, uint32_t leaf_size) {
  return box.half_area() * static_cast<double>(blocks_for(count, leaf_size));
}

/// The planes between the bins of one axis.
class Sweep {
 public:
  Sweep(const std::array<SpatialBin, spatial_bins>& bins, const SpatialAxis& planes) : bins_(bins), planes_(planes) {
    SpatialBin part;
    for (int i = spatial_bins; i-- > 1;) {
      part.merge(bins[i]);
      right_[i] = part;
    }
  }

  /// Keeps the best admissible plane.
  void improve(int axis, uint64_t count, const SplitLimits& limits, std::optional<SpatialSplit>& best) const {
    SpatialBin left;
    for (int i = 1; i < spatial_bins; ++i) {
      left.merge(bins_[i - 1]);
      const uint64_t left_count = left.enter, right_count = right_[i].leave;
      if (left_count == 0 || right_count == 0 || left_count >= count || right_count >= count) continue;
      if (left_count + right_count > limits.references) continue;
      if (blocks_for(left_count, limits.leaf_size) + blocks_for(right_count, limits.leaf_size) > limits.blocks)
        continue;
      const Box left_box = left.box.box(), right_box = right_[i].box.box();
      const double cost =
          part_cost(left_box, left_count, limits.leaf_size) + part_cost(right_box, right_count, limits.leaf_size);
      if (!(cost < (best ? best->cost : infinite_cost))) continue;  // no NaN passes
      best = {axis, planes_.plane(i), left_box, right_box, left_count, right_count, cost};
    }
  }

 private:
  const std::array<SpatialBin, spatial_bins>& bins_;
  const SpatialAxis& planes_;
  SpatialBin right_[spatial_bins];
};

double half_area_with(Box box, const PrimitiveRef& ref) {
  box.extend(ref.min, ref.max);
  return box.half_area();
}

/// Decides where one reference goes.
class Sorter {
 public:
  Sorter(const SpatialSplit& split, const SplittableTriangles& triangles)
      : split_(split),
        triangles_(triangles),
        left_area_(split.left.half_area()),
        right_area_(split.right.half_area()) {}

  enum class Side : uint8_t { left, right, both };

  /// By the box alone.
  Side side(const PrimitiveRef& ref) const {
    if (ref.max[split_.axis] <= split_.plane) return Side::left;
    if (ref.min[split_.axis] >= split_.plane) return Side::right;
    if (triangles_.can_split(ref)) return Side::both;
    return ref.centre(split_.axis) < split_.plane ? Side::left : Side::right;
  }

  struct Parts {
    Side side;
    PrimitiveRef left, right;
  };

  Parts clip(const PrimitiveRef& ref) const {
    Box cell;
    cell.extend(ref.min, ref.max);
    const Halves halves = clip_triangle(triangles_.read(ref), cell, split_.axis, split_.plane);
    Parts parts{Side::both, make_primitive_ref(halves.left, ref.geometry, ref.primitive),
                make_primitive_ref(halves.right, ref.geometry, ref.primitive)};
    if (halves.left.empty() || halves.right.empty()) {
      parts.side = halves.left.empty() ? Side::right : Side::left;
      if (halves.left.empty() && halves.right.empty()) parts.right = ref;
      return parts;
    }
    parts.side = cheapest(ref);
    if (parts.side != Side::both) parts.left = parts.right = ref;
    return parts;
  }

 private:
  /// Section 4.4 of the paper, with the areas that binning expects of both sides.
  Side cheapest(const PrimitiveRef& ref) const {
    const auto left = static_cast<double>(split_.left_count), right = static_cast<double>(split_.right_count);
    const double both = left_area_ * left + right_area_ * right;
    const double only_left = half_area_with(split_.left, ref) * left + right_area_ * (right - 1);
    const double only_right = left_area_ * (left - 1) + half_area_with(split_.right, ref) * right;
    if (both <= only_left && both <= only_right) return Side::both;
    return only_left <= only_right ? Side::left : Side::right;
  }

  const SpatialSplit& split_;
  const SplittableTriangles& triangles_;
  double left_area_, right_area_;
};

using Side = Sorter::Side;

/// What the references of one chunk come to.
struct ChunkParts {
  std::vector<Sorter::Parts> clipped;  ///< those whose boxes straddle the plane, in order
  size_t left = 0, right = 0;
  void count(Side side) {
    left += side != Side::right;
    right += side != Side::left;
  }
};

ChunkParts sort_chunk(std::span<const PrimitiveRef> refs, const Sorter& sorter) {
  ChunkParts parts;
  for (const PrimitiveRef& ref : refs) {
    Side side = sorter.side(ref);
    if (side == Side::both) side = parts.clipped.emplace_back(sorter.clip(ref)).side;
    parts.count(side);
  }
  return parts;
}

void write_chunk(std::span<const PrimitiveRef> refs, const Sorter& sorter, const ChunkParts& parts, PrimitiveRef* left,
                 PrimitiveRef* right) {
  auto clipped = parts.clipped.begin();
  for (const PrimitiveRef& ref : refs) {
    const Side side = sorter.side(ref);
    if (side == Side::left) *left++ = ref;
    if (side == Side::right) *right++ = ref;
    if (side != Side::both) continue;
    if (clipped->side != Side::right) *left++ = clipped->left;
    if (clipped->side != Side::left) *right++ = clipped->right;
    ++clipped;
  }
}

}  // namespace

std::optional<SpatialSplit> find_spatial_split(std::span<const PrimitiveRef> refs, const Box& box,
                                               const SplittableTriangles& triangles, const SplitLimits& limits) {
  const SpatialAxes axes{SpatialAxis(box, 0), SpatialAxis(box, 1), SpatialAxis(box, 2)};
  const SpatialBins bins = reduce_chunks<SpatialBins>(refs.size(), [&](size_t begin, size_t end) {
    SpatialBins part;
    for (const PrimitiveRef& ref : refs.subspan(begin, end - begin)) part.add(ref, axes, triangles);
    return part;
  });
  std::optional<SpatialSplit> best;
  for (int axis = 0; axis < 3; ++axis) Sweep(bins.bins[axis], axes[axis]).improve(axis, refs.size(), limits, best);
  return best;
}

std::optional<SpatialParts> partition_by_plane(std::span<const PrimitiveRef> refs, const SpatialSplit& split,
                                               const SplittableTriangles& triangles, std::span<PrimitiveRef> parts) {
  const Sorter sorter(split, triangles);
  std::vector<ChunkParts> chunks(chunk_count(refs.size()));
  for_each_chunk(refs.size(), [&](size_t chunk, size_t begin, size_t end) {
    chunks[chunk] = sort_chunk(refs.subspan(begin, end - begin), sorter);
  });
  SpatialParts total;
  for (const ChunkParts& chunk : chunks) {
    total.left += chunk.left;
    total.right += chunk.right;
  }
  if (total.left + total.right > parts.size()) return std::nullopt;
  std::vector<SpatialParts> begins(chunks.size(), {0, total.left});
  for (size_t i = 1; i < chunks.size(); ++i)
    begins[i] = {begins[i - 1].left + chunks[i - 1].left, begins[i - 1].right + chunks[i - 1].right};
  for_each_chunk(refs.size(), [&](size_t chunk, size_t begin, size_t end) {
    write_chunk(refs.subspan(begin, end - begin), sorter, chunks[chunk], parts.data() + begins[chunk].left,
                parts.data() + begins[chunk].right);
  });
  return total;
}

}  // namespace rayloom::accel
