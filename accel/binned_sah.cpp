#include <rayloom/accel/binned_sah.h>
#include <rayloom/accel/box_area.h>
#include <rayloom/accel/chunks.h>

#include <array>
#include <bit>
#include <cassert>

namespace rayloom::accel {
namespace {

struct Bounds4 {
  Box4 box, centres;
  void add(const Box4& ref) {
    box.extend(ref);
    const Float4 centre = centre4(ref);
    centres.extend(centre, centre);
  }
  void merge(const Bounds4& other) {
    box.extend(other.box);
    centres.extend(other.centres);
  }
};

/// BinAxis of all three axes.
struct BinGrid {
  using Int4 __attribute__((vector_size(16))) = int32_t;
  Float4 low, scale;
  Int4 bin(const Box4& ref) const {
    return __builtin_convertvector(((splat(0.25f) * ref.min + splat(0.25f) * ref.max) - low) * scale, Int4);
  }
  BinAxis axis(int k) const { return {low[k], scale[k]}; }
};

/// The factor below 1 keeps the largest centre out of the bin after the last.
float bins_per_unit(double half_extent, int count) {
  constexpr double largest = double{std::numeric_limits<float>::max()};
  return half_extent > 0 ? static_cast<float>(std::min(count * (1 - 0x1p-20) / half_extent, largest)) : 0.0f;
}

BinGrid make_grid(const Box& centres, int count) {
  BinGrid grid{};
  for (int axis = 0; axis < 3; ++axis) {
    grid.low[axis] = 0.5f * centres.min[axis];
    grid.scale[axis] = bins_per_unit(0.5 * centres.extent(axis), count);
  }
  return grid;
}

struct Bin {
  Box4 box;
  uint32_t count = 0;
  void merge(const Bin& other) {
    box.extend(other.box);
    count += other.count;
  }
};

template <int count>
struct Bins {
  std::array<std::array<Bin, count>, 3> bins;

  void add(const Box4& ref, const BinGrid& grid) {
    const auto index = grid.bin(ref);
    for (int axis = 0; axis < 3; ++axis) {
      Bin& bin = bins[axis][index[axis]];
      bin.box.extend(ref);
      ++bin.count;
    }
  }
  void merge(const Bins& other) {
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < count; ++i) bins[axis][i].merge(other.bins[axis][i]);
  }
};

template <size_t count>
Box box_of(const std::array<Bin, count>& bins) {
  Box4 all;
  for (const Bin& bin : bins) all.extend(bin.box);
  return all.box();
}

struct Candidate {
  float cost = 0;
  int axis = 0, bin = 0;  ///< bin 0: none
};

/// Sweeps the planes between bins.
class Sweep {
 public:
  Sweep(const BoxArea& area, uint32_t leaf_size, uint64_t block_budget)
      : area_(area), leaf_size_(leaf_size), shift_(std::countr_zero(leaf_size)), budget_(block_budget) {
    assert(std::has_single_bit(leaf_size));
  }

  /// Keeps the best admissible plane across `axis` in `best`.
  template <size_t count>
  void improve(int axis, const std::array<Bin, count>& bins, Candidate& best) const {
    std::array<float, count> right_area;
    std::array<uint32_t, count> right_count;
    Bin part;
    for (size_t i = count; i-- > 1;) {
      part.merge(bins[i]);
      right_area[i] = area_(part.box);
      right_count[i] = part.count;
    }
    part = {};
    for (size_t i = 1; i < count; ++i) {
      part.merge(bins[i - 1]);
      if (part.count == 0 || right_count[i] == 0) continue;
      const uint32_t left_blocks = blocks(part.count), right_blocks = blocks(right_count[i]);
      if (left_blocks + right_blocks > budget_) continue;
      const float cost =
          area_(part.box) * static_cast<float>(left_blocks) + right_area[i] * static_cast<float>(right_blocks);
      if (best.bin == 0 || cost < best.cost) best = {cost, axis, static_cast<int>(i)};
    }
  }

 private:
  uint32_t blocks(uint32_t primitives) const { return (primitives + leaf_size_ - 1) >> shift_; }

  const BoxArea& area_;
  uint32_t leaf_size_;
  int shift_;
  uint64_t budget_;
};

template <int count>
std::optional<Split> find_split(std::span<const PrimitiveRef> refs, const Box& centres, uint32_t leaf_size,
                                uint64_t block_budget) {
  const BinGrid grid = make_grid(centres, count);
  const auto all = reduce_chunks<Bins<count>>(refs.size(), [&](size_t begin, size_t end) {
    Bins<count> part;
    for (const PrimitiveRef& ref : refs.subspan(begin, end - begin)) part.add(box4(ref), grid);
    return part;
  });
  const BoxArea area(box_of(all.bins[0]));
  const Sweep sweep(area, leaf_size, block_budget);
  Candidate best;
  for (int axis = 0; axis < 3; ++axis) sweep.improve(axis, all.bins[axis], best);
  if (best.bin == 0) return std::nullopt;
  return Split{best.axis, best.bin, grid.axis(best.axis), double{best.cost} * area.unit()};
}

}  // namespace

RangeBounds bounds_of(std::span<const PrimitiveRef> refs) {
  const auto bounds = reduce_chunks<Bounds4>(refs.size(), [&](size_t begin, size_t end) {
    Bounds4 part;
    for (const PrimitiveRef& ref : refs.subspan(begin, end - begin)) part.add(box4(ref));
    return part;
  });
  return {bounds.box.box(), bounds.centres.box()};
}

std::optional<Split> find_binned_split(std::span<const PrimitiveRef> refs, const Box& centres, uint32_t leaf_size,
                                       uint64_t block_budget) {
  if (refs.size() > 256) return find_split<32>(refs, centres, leaf_size, block_budget);
  if (refs.size() > 64) return find_split<16>(refs, centres, leaf_size, block_budget);
  return find_split<8>(refs, centres, leaf_size, block_budget);
}

}  // namespace rayloom::accel
