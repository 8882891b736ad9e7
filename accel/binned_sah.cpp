#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/chunks.h>

#include <array>

namespace rayloom::accel {
namespace {

constexpr int max_bins = 32;

struct Bin {
  Box box;
  uint64_t count = 0;
  void merge(const Bin& other) {
    box.extend(other.box);
    count += other.count;
  }
};

using Axes = std::array<BinAxis, 3>;

struct Bins {
  Bin bins[3][max_bins];

  void add(const PrimitiveRef& ref, const Axes& axes) {
    for (int axis = 0; axis < 3; ++axis) {
      Bin& bin = bins[axis][axes[axis].bin(ref.centre(axis))];
      bin.box.extend(ref.min, ref.max);
      ++bin.count;
    }
  }
  void merge(const Bins& other) {
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < max_bins; ++i) bins[axis][i].merge(other.bins[axis][i]);
  }
};

int bin_count(size_t primitives) { return primitives > 256 ? 32 : 16; }

/// The factor below 1 keeps the largest centre out of the bin after the last.
BinAxis make_axis(const Box& centres, int axis, int count) {
  const double extent = centres.extent(axis);
  return {double{centres.min[axis]}, extent > 0 ? count * (1 - 0x1p-20) / extent : 0.0};
}

double part_cost(const Bin& part, uint32_t leaf_size) {
  return part.box.half_area() * static_cast<double>(blocks_for(part.count, leaf_size));
}

/// Sweeps the planes between the bins of one axis; keeps the best admissible one in `best`.
void sweep(const Bin* bins, int count, const Split& axis, uint32_t leaf_size, uint64_t block_budget,
           std::optional<Split>& best) {
  Bin right[max_bins];
  Bin part;
  for (int i = count; i-- > 1;) {
    part.merge(bins[i]);
    right[i] = part;
  }
  Bin left;
  for (int i = 1; i < count; ++i) {
    left.merge(bins[i - 1]);
    if (left.count == 0 || right[i].count == 0) continue;
    if (blocks_for(left.count, leaf_size) + blocks_for(right[i].count, leaf_size) > block_budget) continue;
    const double cost = part_cost(left, leaf_size) + part_cost(right[i], leaf_size);
    if (best && best->cost <= cost) continue;
    best = axis;
    best->bin = i;
    best->cost = cost;
  }
}

}  // namespace

void RangeBounds::add(const PrimitiveRef& ref) {
  box.extend(ref.min, ref.max);
  centres.extend({ref.centre(0), ref.centre(1), ref.centre(2)});
}

void RangeBounds::merge(const RangeBounds& other) {
  box.extend(other.box);
  centres.extend(other.centres);
}

RangeBounds bounds_of(std::span<const PrimitiveRef> refs) {
  return reduce_chunks<RangeBounds>(refs.size(), [&](size_t begin, size_t end) {
    RangeBounds bounds;
    for (const PrimitiveRef& ref : refs.subspan(begin, end - begin)) bounds.add(ref);
    return bounds;
  });
}

std::optional<Split> find_binned_split(std::span<const PrimitiveRef> refs, const Box& centres, uint32_t leaf_size,
                                       uint64_t block_budget) {
  const int count = bin_count(refs.size());
  const Axes axes{make_axis(centres, 0, count), make_axis(centres, 1, count), make_axis(centres, 2, count)};
  const Bins bins = reduce_chunks<Bins>(refs.size(), [&](size_t begin, size_t end) {
    Bins part;
    for (const PrimitiveRef& ref : refs.subspan(begin, end - begin)) part.add(ref, axes);
    return part;
  });
  std::optional<Split> best;
  for (int axis = 0; axis < 3; ++axis)
    sweep(bins.bins[axis], count, Split{axis, 0, axes[axis], 0}, leaf_size, block_budget, best);
  return best;
}

}  // namespace rayloom::accel
