#include <rayloom/tools/bench/error/reference.h>

#include <rayloom/tools/bench/measure.h>
#include <rayloom/tools/interrupt.h>

#include <algorithm>

namespace rayloom::bench {
namespace {

constexpr double batch_seconds = 0.3;

/// Sums over parts, from which mean and variance follow.
struct PartSums {
  glm::dvec3 half[2] = {glm::dvec3(0), glm::dvec3(0)};
  glm::dvec3 squares{0};
};

constexpr double parts = reference_parts;

glm::vec3 variance_of_mean(const PartSums& sums) {
  const glm::dvec3 total = sums.half[0] + sums.half[1];
  return glm::vec3(glm::max(sums.squares - total * total / parts, glm::dvec3(0)) / (parts * (parts - 1)));
}

}  // namespace

double render_range(shaders::Renderer& renderer, uint32_t end, const std::function<void(uint64_t)>& advance) {
  double total = 0;
  uint32_t batch = std::max(1u, renderer.samples());  // what was quick before is no longer than that now
  while (renderer.samples() < end) {
    tools::throw_if_interrupted();
    const uint32_t count = std::min(batch, end - renderer.samples());
    const double begin = now(Clock::wall);
    renderer.render(renderer.samples(), count);
    const double seconds = now(Clock::wall) - begin;
    total += seconds;
    batch = seconds > batch_seconds ? std::max(1u, count / 2) : count * 2;
    advance(count);
  }
  return total;
}

Reference render_reference(shaders::Renderer& renderer, uint64_t samples,
                           const std::function<void(uint64_t)>& advance) {
  const auto samples_per_part = static_cast<uint32_t>((samples + reference_parts - 1) / reference_parts);
  std::vector<PartSums> sums(uint64_t{renderer.window().width} * renderer.window().height);
  for (uint32_t part = 0; part < reference_parts; ++part) {
    renderer.restart(reference_seed(part), shaders::SamplerKind::owen_sobol);
    render_range(renderer, samples_per_part, advance);
    const shaders::Picture picture = renderer.picture();
    for (size_t i = 0; i < sums.size(); ++i) {
      const glm::dvec3 value(picture.rgba[i]);
      sums[i].half[part % 2] += value;
      sums[i].squares += value * value;
    }
  }
  Reference reference{renderer.window().width, renderer.window().height, {}, {}};
  for (const PartSums& pixel : sums) {
    for (int h = 0; h < 2; ++h) reference.half[h].push_back(glm::vec3(pixel.half[h] / (parts / 2)));
    reference.own_variance.push_back(variance_of_mean(pixel));
  }
  return reference;
}

}  // namespace rayloom::bench
