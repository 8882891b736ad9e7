#pragma once

// Edges and points of a picture (Andersson et al. 2020, section 4.2): where they differ, differences of colour catch
// the eye.

#include <rayloom/tools/flip_plane.h>

namespace rayloom::tools::flip {

/// Magnitudes of the first derivatives of a Gaussian (edges) and of its second ones (points), at least 0.
struct Features {
  Plane edges, points;
};

/// The Gaussian is 0.082 degrees wide, two standard deviations. `grey`: achromatic values in [0,1].
Features detect_features(const Plane& grey, double pixels_per_degree);

/// How far features differ, in [0,1]: the larger one of edges and points.
Plane feature_difference(const Features& x, const Features& y);

}  // namespace rayloom::tools::flip
