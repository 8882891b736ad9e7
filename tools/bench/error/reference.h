#pragma once

// The picture errors are measured against. It is itself an estimate, so it is rendered as independent parts whose
// spread tells its variance, whatever the sampler: of the squared distance to it, that much is the reference's own.

#include <rayloom/shaders/renderer.h>

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace rayloom::bench {

struct Reference {
  uint32_t width = 0, height = 0;
  std::vector<glm::vec3> half[2];       ///< means of the even and of the odd parts, a pixel each
  std::vector<glm::vec3> own_variance;  ///< of their mean: an unbiased estimate from the parts

  size_t pixel_count() const { return own_variance.size(); }
  glm::dvec3 pixel(size_t i) const { return 0.5 * (glm::dvec3(half[0][i]) + glm::dvec3(half[1][i])); }
};

inline constexpr uint32_t reference_parts = 16;

/// Seeds of the parts: from the upper half of all seeds, while measured pictures take theirs from the lower.
constexpr uint32_t reference_seed(uint32_t part) { return 0x80000000u + part; }

/// `samples` a pixel over all parts, rounded up to equal parts. `advance` is told the samples of each batch as they are
/// done. `renderer` keeps the last part's picture.
Reference render_reference(shaders::Renderer& renderer, uint64_t samples, const std::function<void(uint64_t)>& advance);

/// Adds the samples first .. end - 1 in batches of about a third of a second, so that progress shows and Ctrl-C counts
/// (Interrupted). Returns the seconds they took.
double render_range(shaders::Renderer& renderer, uint32_t end, const std::function<void(uint64_t)>& advance);

}  // namespace rayloom::bench
