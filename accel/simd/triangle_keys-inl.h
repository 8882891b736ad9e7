// Places of triangles on a Morton curve, eight at a time, re-included once per target by Highway's foreach_target.h.
// Operation by operation what TriangleCurve and MortonCurve::upper_code compute.

// clang-format off: the guard flips for each target, and highway.h must come after foreach_target.h.
#if defined(RAYLOOM_ACCEL_TRIANGLE_KEYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_TRIANGLE_KEYS_INL_H_
#undef RAYLOOM_ACCEL_TRIANGLE_KEYS_INL_H_
#else
#define RAYLOOM_ACCEL_TRIANGLE_KEYS_INL_H_
#endif
// clang-format on

#include <rayloom/accel/simd/build_kernel.h>
#include <rayloom/accel/simd/triangle_lanes-inl.h>

#include <bit>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace rayloom::accel {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

/// Two zero bits after each of the low 11 bits.
HWY_INLINE WordLanes spread11(WordLanes x) {
  const Words d;
  x = hn::And(hn::Or(x, hn::ShiftLeft<16>(x)), hn::Set(d, 0x070000FFu));
  x = hn::And(hn::Or(x, hn::ShiftLeft<8>(x)), hn::Set(d, 0x0700F00Fu));
  x = hn::And(hn::Or(x, hn::ShiftLeft<4>(x)), hn::Set(d, 0x430C30C3u));
  return hn::And(hn::Or(x, hn::ShiftLeft<2>(x)), hn::Set(d, 0x49249249u));
}

/// The grid cells of MortonCurve::upper_code along one axis.
class UpperCells {
 public:
  HWY_INLINE UpperCells(double low, double scale) : low_(hn::Set(Doubles(), low)), scale_(hn::Set(Doubles(), scale)) {}
  HWY_INLINE WordLanes operator()(FloatLanes centre) const {
    const hn::FixedTag<float, 4> half;
    const auto low = cells(hn::LowerHalf(half, centre)), high = cells(hn::UpperHalf(half, centre));
    return hn::BitCast(Words(), hn::Combine(Ints(), high, low));
  }

 private:
  using Doubles = hn::FixedTag<double, 4>;
  HWY_INLINE hn::Vec<hn::FixedTag<int32_t, 4>> cells(hn::Vec<hn::FixedTag<float, 4>> centre) const {
    const auto place = hn::Mul(hn::Sub(hn::PromoteTo(Doubles(), centre), low_), scale_);
    return hn::DemoteTo(hn::FixedTag<int32_t, 4>(), place);
  }

  hn::Vec<Doubles> low_, scale_;
};

class KeyMaker {
 public:
  HWY_INLINE explicit KeyMaker(const KeyRange& range)
      : range_(range),
        reader_(*range.geometry),
        x_(range.curve->low(0), range.curve->upper_scale(0)),
        y_(range.curve->low(1), range.curve->upper_scale(1)),
        z_(range.curve->low(2), range.curve->upper_scale(2)) {
    for (int k = 0; k < 3; ++k) {
      low_[k] = hn::Set(Floats(), Box::infinity);
      high_[k] = hn::Set(Floats(), -Box::infinity);
    }
  }

  HWY_INLINE MortonKey* make_all(MortonKey* out) {
    for (uint32_t first = range_.begin; first < range_.end; first += triangle_lanes) {
      const uint32_t count = std::min(triangle_lanes, range_.end - first);
      const IndexLanes indices = reader_.sequence(first, count);
      if (!reader_.in_range(indices)) return nullptr;
      const CornerLanes triangles = reader_.corners(indices);
      const LaneMask keep = hn::And(kept(triangles, range_.keep_degenerate), hn::FirstN(Floats(), count));
      out = add(first, centre_of(box_of(triangles)), keep, out);
    }
    return out;
  }

  HWY_INLINE void extend(Box& box) const {
    for (int k = 0; k < 3; ++k) {
      box.min[k] = std::min(box.min[k], hn::GetLane(hn::MinOfLanes(Floats(), low_[k])));
      box.max[k] = std::max(box.max[k], hn::GetLane(hn::MaxOfLanes(Floats(), high_[k])));
    }
  }

 private:
  HWY_INLINE MortonKey* add(uint32_t first, const PointLanes& centre, LaneMask keep, MortonKey* out) {
    const Floats d;
    for (int k = 0; k < 3; ++k) {
      low_[k] = hn::IfThenElse(keep, hn::Min(low_[k], centre.axis[k]), low_[k]);
      high_[k] = hn::IfThenElse(keep, hn::Max(high_[k], centre.axis[k]), high_[k]);
    }
    const WordLanes x = spread11(x_(centre.axis[0])), y = spread11(y_(centre.axis[1])),
                    z = spread11(z_(centre.axis[2]));
    const WordLanes code = hn::Or(hn::Or(hn::ShiftLeft<1>(x), y), hn::ShiftLeft<2>(z));
    const WordLanes number = hn::Iota(Words(), range_.first_number + first);
    MortonKey keys[triangle_lanes];
    const uint32_t mask = mask_bits(keep);
    if (mask == 0xFF) {
      hn::StoreInterleaved2(code, number, Words(), reinterpret_cast<uint32_t*>(out));
      return out + triangle_lanes;
    }
    hn::StoreInterleaved2(code, number, Words(), reinterpret_cast<uint32_t*>(keys));
    for (uint32_t left = mask; left != 0; left &= left - 1) *out++ = keys[std::countr_zero(left)];
    return out;
  }

  const KeyRange& range_;
  TriangleReader reader_;
  UpperCells x_, y_, z_;
  FloatLanes low_[3], high_[3];
};

MortonKey* make_keys(const KeyRange& range, MortonKey* out, Box& centres) {
  KeyMaker maker(range);
  out = maker.make_all(out);
  maker.extend(centres);
  return out;
}

/// Eight vertices are three vectors, whose lanes keep their axes from one step to the next.
class VertexBounds {
 public:
  HWY_INLINE VertexBounds() {
    for (int k = 0; k < 3; ++k) {
      low_[k] = hn::Set(Floats(), Box::infinity);
      high_[k] = hn::Set(Floats(), -Box::infinity);
    }
  }

  /// Whether the vertices, all finite, were added.
  HWY_INLINE bool add_eight(const float* vertices) {
    const Floats d;
    FloatLanes part[3];
    FloatLanes none = hn::Zero(d);
    for (size_t i = 0; i < 3; ++i) {
      part[i] = hn::LoadU(d, vertices + triangle_lanes * i);
      none = hn::Add(none, hn::Sub(part[i], part[i]));
    }
    if (!hn::AllTrue(d, hn::Eq(none, none))) return false;
    for (int i = 0; i < 3; ++i) {
      low_[i] = hn::Min(low_[i], part[i]);
      high_[i] = hn::Max(high_[i], part[i]);
    }
    return true;
  }

  HWY_INLINE void extend(Box& box) const {
    float low[3 * triangle_lanes], high[3 * triangle_lanes];
    for (size_t i = 0; i < 3; ++i) {
      hn::StoreU(low_[i], Floats(), low + triangle_lanes * i);
      hn::StoreU(high_[i], Floats(), high + triangle_lanes * i);
    }
    for (size_t i = 0; i < 3 * triangle_lanes; ++i) {
      box.min[i % 3] = std::min(box.min[i % 3], low[i]);
      box.max[i % 3] = std::max(box.max[i % 3], high[i]);
    }
  }

 private:
  FloatLanes low_[3], high_[3];
};

Box vertex_bounds(const std::byte* vertices, size_t count) {
  VertexBounds bounds;
  Box others;
  const auto* const floats = reinterpret_cast<const float*>(vertices);
  for (size_t first = 0; first < count; first += triangle_lanes) {
    read_ahead_96(floats + 3 * first);
    if (first + triangle_lanes <= count && bounds.add_eight(floats + 3 * first)) continue;
    for (size_t i = first; i < std::min<size_t>(count, first + triangle_lanes); ++i) {
      float point[3];
      std::memcpy(point, vertices + sizeof(point) * i, sizeof(point));
      if (std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2])) others.extend(point);
    }
  }
  bounds.extend(others);
  return others;
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace rayloom::accel
HWY_AFTER_NAMESPACE();

#endif  // RAYLOOM_ACCEL_TRIANGLE_KEYS_INL_H_
