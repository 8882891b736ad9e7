#pragma once

// The measurements of one scene, and what follows from them: means, slopes, times, comparisons.

#include <rayloom/tools/bench/error/configuration.h>
#include <rayloom/tools/bench/error/estimate.h>
#include <rayloom/tools/bench/error/picture_error.h>
#include <rayloom/tools/bench/measure.h>

namespace rayloom::bench {

/// One seed's picture at one sample count.
struct Measurement {
  PictureError error;
  FlipError flip;
  double seconds = 0;  ///< of rendering it from its first sample, without setting up
};

/// One configuration. Pictures of one seed grow: each continues the one of fewer samples.
struct ErrorCurve {
  Configuration configuration;
  std::vector<uint32_t> spp;                    ///< ascending
  std::vector<std::vector<Measurement>> seeds;  ///< [seed][index into spp]
  Bias bias;                                    ///< at the largest sample count

  /// Mean of a quantity over seeds.
  template <class Get>
  Estimate mean(size_t i, const Get& get) const {
    std::vector<double> values;
    for (const auto& seed : seeds) values.push_back(get(seed[i]));
    return mean_of(values);
  }
  Estimate mse(size_t i) const;
  Estimate relmse(size_t i) const;
  Estimate trimmed_relmse(size_t i) const;
  Spread seconds(size_t i) const;
};

struct SceneErrors {
  std::string scene;
  std::string reference_key;
  uint64_t reference_spp = 0;
  bool reference_cached = false, hdr = false;
  PictureError reference_error;
  FlipError reference_flip;
  std::vector<ErrorCurve> curves;
};

/// The log-log slope of a mean error against samples, by least squares over all sample counts; the standard error is
/// the jackknife's over seeds, since the pictures of one seed are not independent of each other.
Estimate mse_slope(const ErrorCurve& curve);
Estimate relmse_slope(const ErrorCurve& curve);

/// When the mean relMSE falls to a value: between measured points by log-log interpolation, never beyond them.
struct TimeToError {
  enum class Kind { within, before_first, after_last };
  Kind kind = Kind::within;
  double seconds = 0;  ///< within; else of the first or the last point
  double spp = 0;
};
TimeToError time_to_relmse(const ErrorCurve& curve, double target);

/// `curve` against `base` at the largest sample count: greater is worse for errors and time, better for efficiency, the
/// inverse of error times time, where the error is MSE or trimmed relMSE. The estimates' errors are over seeds; `time`
/// is of pairs of renders that followed each other.
struct CurveRatio {
  Estimate mse, relmse, trimmed_relmse, flip;
  Spread time;
  Estimate mse_efficiency, trimmed_efficiency;
};
CurveRatio compare(const ErrorCurve& curve, const ErrorCurve& base);

}  // namespace rayloom::bench
