// Rays of a batch that are no part of a packet. Re-included once per target as traverse-inl.h is.

// clang-format off: the guard flips for each target.
#if defined(RAYLOOM_ACCEL_RAYS_APART_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOOM_ACCEL_RAYS_APART_INL_H
#undef RAYLOOM_ACCEL_RAYS_APART_INL_H
#else
#define RAYLOOM_ACCEL_RAYS_APART_INL_H
#endif
// clang-format on

#include <rayloom/accel/interleave-inl.h>
#include <rayloom/accel/kept_array.h>
#include <rayloom/accel/ray_run.h>
#ifdef HWY_TARGET_INCLUDE
#include <rayloom/accel/simd/packet_vectors-inl.h>
#endif

#ifdef HWY_TARGET_INCLUDE
HWY_BEFORE_NAMESPACE();
#define RAYLOOM_LANES HWY_NAMESPACE
#else
#define RAYLOOM_LANES scalar
#endif

#if !defined(HWY_TARGET_INCLUDE) || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

namespace rayloom::accel::RAYLOOM_LANES {

/// In simd/alone_highway.cpp and kernel_scalar.cpp: compiled with the loops for batches it would be slower.
Hit trace_alone(AddressSpace addresses, const TraceRequest& request);

inline void trace_one_by_one(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  TraceRequest request = *rays.shared;
  for (size_t i = 0; i < rays.count; ++i) {
    request.ray = rays[i];
    hits[i] = trace_alone(addresses, request);
  }
}

template <Order order, class Result>
void interleave(AddressSpace addresses, const RayRun& rays, Result* results) {
  if (header_of(rays.shared->structure).kind == StructureKind::instances)
    Interleaver<order, true, Result>(addresses, rays, results).run();
  else
    Interleaver<order, false, Result>(addresses, rays, results).run();
}

/// Closest hits of rays that may find something and do not go together.
inline void trace_apart(AddressSpace addresses, const RayRun& rays, uint8_t* results) {
  interleave<Order::stored>(addresses, rays, results);
}
inline void trace_apart(AddressSpace addresses, const RayRun& rays, Hit* hits) {
  constexpr size_t worth_interleaving = 4;
  if (rays.count < worth_interleaving)
    trace_one_by_one(addresses, rays, hits);
  else
    interleave<Order::distance>(addresses, rays, hits);
}

#ifdef HWY_TARGET_INCLUDE
/// Rays that are no part of a packet: long runs are traced where they lie, those of short runs are brought together, so
/// that they have company. Result: Hit or, for rays that only want to know whether they hit anything, a byte.
template <class Result>
class RaysApart {
 public:
  RaysApart(AddressSpace addresses, const RayRun& rays, Result* results)
      : addresses_(addresses), rays_(rays), results_(results), strays_(std::min(rays.count, most_strays)) {}

  /// In ascending order.
  void add(size_t begin, size_t count) {
    if (begin != end_) trace_run_so_far(begin);
    end_ = begin + count;
  }

  /// What has not been traced yet.
  void finish() {
    trace_run_so_far(end_);
    if (!strays_.empty()) trace_strays();
  }

  size_t count() const { return count_; }

 private:
  static constexpr size_t long_run = 8 * packet_size, most_strays = 2048;
  struct Stray {
    Ray ray;
    Result* result;
  };

  /// The next one begins at `next`.
  void trace_run_so_far(size_t next) {
    const size_t length = end_ - begin_;
    count_ += length;
    if (length >= long_run || length == rays_.count)
      trace_apart(addresses_, rays_.part(begin_, length), &results_[begin_]);
    else
      for (; begin_ != end_; ++begin_) add_stray(begin_);
    begin_ = end_ = next;
  }

  void add_stray(size_t i) {
    strays_.emplace_back(rays_[i], &results_[i]);
    if (strays_.size() == most_strays) trace_strays();
  }

  void trace_strays() {
    KeptArray<Result> found(strays_.size());
    trace_apart(addresses_, {rays_.shared, &strays_[0].ray, sizeof(Stray), strays_.size()}, found.begin());
    for (size_t i = 0; i < strays_.size(); ++i) *strays_[i].result = found[i];
    strays_.clear();
  }

  AddressSpace addresses_;
  RayRun rays_;
  Result* results_;
  size_t count_ = 0;
  size_t begin_ = 0, end_ = 0;  ///< of the run so far
  KeptArray<Stray> strays_;
};
#endif

}  // namespace rayloom::accel::RAYLOOM_LANES
#endif  // target

#undef RAYLOOM_LANES
#ifdef HWY_TARGET_INCLUDE
HWY_AFTER_NAMESPACE();
#endif

#endif  // once a target
