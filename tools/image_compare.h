#pragma once

// How far a picture is from its reference. Float channels: the usual error measures, summed in double in pixel order.
// Id channels: 0 where the ids are equal and 1 where they differ, since ids have no distance.
//
// NaN and infinity: a sample that is NaN in both pictures, or the same infinity in both, counts as equal. A sample that
// is not finite in one picture only, or differently in each, makes every measure of its channel infinitely bad (psnr:
// minus infinity), so that no bound passes over it; `incomparable` counts such samples.

#include <rayloom/tools/image.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rayloom::tools {

/// mse: mean (x-r)^2; relmse: mean (x-r)^2 / (r^2 + 0.01); psnr: 10 log10(1 / mse) in dB, infinite when equal;
/// mae: mean |x-r|; max: largest |x-r|. x is the picture, r the reference.
enum class Metric { mse, relmse, psnr, mae, max };

inline constexpr const char* metric_names[] = {"mse", "relmse", "psnr", "mae", "max"};

std::optional<Metric> find_metric(std::string_view name);

/// The error of one channel, or of all of them together.
struct ChannelError {
  std::string name;
  uint64_t samples = 0;
  uint64_t different = 0;     ///< samples that are not equal (+0 equals -0, NaN equals NaN)
  uint64_t incomparable = 0;  ///< see above
  double sum_squared = 0, sum_relative = 0, sum_absolute = 0, largest = 0;

  double value(Metric metric) const;
};

struct Comparison {
  std::vector<ChannelError> channels;  ///< in the reference's order
  ChannelError overall;                ///< every sample of every channel
  bool bits_equal = true;              ///< stricter than different == 0: tells +0 from -0 and NaNs apart
};

/// Compares `image` from the file `image_name` with `reference`. Throws InputError, naming both files, when sizes or
/// sets of channels differ; the order of channels does not matter.
Comparison compare_images(const Image& image, const std::string& image_name, const Image& reference,
                          const std::string& reference_name);

/// |x-r| of every float channel and 0 or 1 for ids, under the channels' names; incomparable samples are infinite.
Image difference_image(const Image& image, const Image& reference);

/// True when `value` keeps within `bound`: at most it, for psnr at least it.
bool within_bound(Metric metric, double value, double bound);

}  // namespace rayloom::tools
