#pragma once

#include "triangle_soup.h"

#include <rayloom/accel/ray.h>

#include <string>
#include <vector>

namespace rayloom::bench {

/// Primary rays of the scene's camera, size x size, in rows.
std::vector<accel::Ray> primary_rays(const std::string& scene_name, uint32_t size);

/// One cosine-distributed ray from the hit of each primary ray that hits, in the same order.
std::vector<accel::Ray> bounce_rays(const std::vector<accel::Ray>& primary, const TriangleSoup& soup,
                                    const Structure& structure);

}  // namespace rayloom::bench
