#pragma once

// The FLIP metric for pictures from files: how visible the difference of two pictures is when they alternate on a
// screen.
//
// Bad samples: NaN and negative values count as 0, infinity as the brightest there is. A pixel with a sample that is
// NaN or infinite in one picture and not the same in the other is incomparable, as in image_compare.h: its error is 1.

#include <rayloom/tools/flip_hdr.h>
#include <rayloom/tools/image.h>

#include <optional>
#include <string>
#include <string_view>

namespace rayloom::tools {

/// ldr: as a screen shows the pictures, with values above 1 clipped. hdr: over all exposures the reference may want.
enum class FlipMode { ldr, hdr };

inline constexpr const char* flip_mode_names[] = {"ldr", "hdr"};

std::optional<FlipMode> find_flip_mode(std::string_view name);

struct FlipOptions {
  std::optional<FlipMode> mode;  ///< unset: hdr when both pictures hold linear floats, ldr when one is sRGB-encoded
  /// Of the observer: 67.0206 is a 0.7 m wide screen of 3840 pixels, seen from 0.7 m, as the metric's authors take it.
  double pixels_per_degree = 67.0206;
};

struct FlipResult {
  FlipMode mode = FlipMode::ldr;
  double pixels_per_degree = 0;
  flip::Exposures exposures;         ///< hdr only
  flip::Plane map;                   ///< the error of each pixel in [0,1]
  double mean = 0;                   ///< of the map, 0 when there are no pixels
  uint64_t incomparable_pixels = 0;  ///< see above
};

/// Compares channels R, G and B of pictures of one size. Throws InputError, naming the file, where one is missing or
/// holds ids.
FlipResult compute_flip(const Image& image, const std::string& image_name, const Image& reference,
                        const std::string& reference_name, const FlipOptions& options);

/// The map as a picture with the one channel "FLIP".
Image flip_image(const FlipResult& result);

}  // namespace rayloom::tools
