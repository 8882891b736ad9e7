#pragma once

// How far a picture is from a reference that is itself an estimate.

#include <rayloom/shaders/renderer.h>
#include <rayloom/tools/bench/error/reference.h>

#include <vector>

namespace rayloom::bench {

/// `mse`: mean over pixels and channels of (x - r)^2, `relmse`: of (x - r)^2 / (r^2 + 0.01), as `rayloom diff` has
/// them, each less the mean of the reference's own variance in that place: x and r being independent, the difference is
/// an unbiased estimate of the error against the true picture (for relmse up to the noise of the weights).
/// `trimmed_relmse` leaves out the thousandth of the pixels (rounded up) that are farthest off by relmse: a few bright
/// sparks decide the others where a scene has paths that are rarely found and carry much light.
struct PictureError {
  double mse = 0, relmse = 0, trimmed_relmse = 0;
};

PictureError picture_error(const shaders::Picture& picture, const Reference& reference);

/// The share of the above that is the reference's own, and was subtracted.
PictureError reference_error(const Reference& reference);

/// FLIP has no variance to subtract. `ldr` clips at white; `hdr` is 0 unless `has_hdr`.
struct FlipError {
  double ldr = 0, hdr = 0;
};
FlipError flip_error(const shaders::Picture& picture, const Reference& reference);
/// Between the reference's halves: they differ by twice its own standard deviation, so this bounds what its noise may
/// add to the FLIP of a picture.
FlipError reference_flip_error(const Reference& reference);
/// Whether the reference has pixels brighter than white, so that LDR-FLIP does not see all of it.
bool has_hdr(const Reference& reference);

/// What the spread between seeds does not explain of their error. Where the estimator's mean is the reference's, the
/// squared distance of the mean picture is its variance and the reference's: `value` is the rest, the square of the
/// bias under relmse's weights; `standard_error` comes from the scatter over pixels, which are independent.
struct Bias {
  double value = 0, standard_error = 0;
  double sigmas() const { return standard_error > 0 ? value / standard_error : 0; }
};

/// Of independent pictures with one sample count, added one by one.
class SeedSpread {
 public:
  void add(const shaders::Picture& picture);
  /// At least two pictures.
  Bias squared_bias(const Reference& reference) const;

 private:
  std::vector<glm::dvec3> sums_, squares_;
  double count_ = 0;
};

}  // namespace rayloom::bench
