#pragma once

// What of a picture the eye resolves: the contrast sensitivity filters of FLIP (Andersson et al. 2020, section 4.1.1,
// after Johnson and Fairchild 2003).

#include <rayloom/tools/flip_plane.h>

namespace rayloom::tools::flip {

/// A Gaussian a sqrt(pi/b) exp(-pi^2 d^2 / b) of the distance d in degrees.
struct Gaussian {
  double a, b;
};

inline constexpr Gaussian achromatic_filter{1, 0.0047};
inline constexpr Gaussian red_green_filter{1, 0.0053};
inline constexpr std::array<Gaussian, 2> blue_yellow_filter{{{34.1, 0.04}, {13.5, 0.025}}};

/// Of all three filters: three standard deviations of the widest Gaussian, in pixels, rounded up.
int contrast_radius(double pixels_per_degree);

/// Filters the three channels of a YCxCz picture, each with weights that add up to 1.
Planes filter_contrast(const Planes& ycxcz, double pixels_per_degree);

}  // namespace rayloom::tools::flip
