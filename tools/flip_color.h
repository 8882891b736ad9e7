#pragma once

// Colour spaces of the FLIP metric (Andersson et al. 2020, sections 4.1.1 to 4.1.3). RGB is linear with the primaries
// and the D65 white of IEC 61966-2-1, in [0,1]; that white has luminance 1 and is neutral in both other spaces.

#include <array>

namespace rayloom::tools::flip {

using Color = std::array<float, 3>;

/// IEC 61966-2-1: an encoded value in [0,1] to a linear one.
float decode_srgb(float encoded);

/// Relative luminance (CIE Y) of linear RGB.
float luminance(const Color& rgb);

/// The linear opponent space in which the eye's filters act: achromatic Y in [-16,100], red-green Cx, blue-yellow Cz.
Color to_ycxcz(const Color& rgb);
Color from_ycxcz(const Color& ycxcz);

/// CIE L*a*b* with a and b scaled by L/100: chroma counts less in the dark (the Hunt effect).
Color to_hunt_lab(const Color& rgb);

/// HyAB distance of two L*a*b* colours: |dL| + sqrt(da^2 + db^2), which holds for large differences too.
float hyab(const Color& x, const Color& y);

}  // namespace rayloom::tools::flip
