#pragma once

// The FLIP error map of two pictures of linear light (HDR-FLIP: Andersson et al., "Visualizing Errors in Rendered High
// Dynamic Range Images", Eurographics 2021): the worst LDR map of a row of exposures, each tone mapped by the ACES
// curve (Narkowicz's fit, with its exposure factor 0.6).

#include <rayloom/tools/flip_plane.h>

namespace rayloom::tools::flip {

/// `count` exposures, evenly from `start` to `stop` in stops.
struct Exposures {
  double start = 0, stop = 0;
  uint32_t count = 1;

  double at(uint32_t i) const { return count < 2 ? start : start + (stop - start) * i / (count - 1); }
};

/// From the exposure that takes the reference's brightest luminance to 85 % of white up to the one that takes its
/// median there, about a stop apart, at least two. Infinite pixels do not count. The median counts as at least 2^-16 of
/// the brightest, so that a mostly black reference has no endless row; one that is black altogether has one exposure,
/// 0.
Exposures choose_exposures(const Planes& reference);

/// ACES curve of a linear value, at least 0 and perhaps infinite, clamped to [0,1].
float tone_map_aces(float linear);

/// The error map over all exposures. Takes linear RGB, at least 0.
Plane hdr_error_map(const Planes& picture, const Planes& reference, double pixels_per_degree,
                    const Exposures& exposures);

}  // namespace rayloom::tools::flip
