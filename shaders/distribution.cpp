#include <rayloom/shaders/distribution.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayloom::shaders {
namespace {

constexpr double steps = 0x1p24;

/// Moves boundaries so that each positive weight has at least one step: up from the front, then down from the back.
void separate(std::span<const float> weights, std::span<float> boundaries, bool all_equal) {
  const auto least = [&](size_t i) { return all_equal || weights[i] > 0 ? 1.0f : 0.0f; };
  for (size_t i = 0; i < weights.size(); ++i)
    boundaries[i + 1] =
        weights[i] > 0 || all_equal ? std::fmax(boundaries[i + 1], boundaries[i] + 1.0f) : boundaries[i];
  boundaries.back() = static_cast<float>(steps);
  for (size_t i = weights.size(); i-- > 0;) boundaries[i] = std::fmin(boundaries[i], boundaries[i + 1] - least(i));
}

}  // namespace

double append_cumulative(std::span<const float> weights, std::vector<float>& table) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  const bool all_equal = !(sum > 0);
  const double scale = steps / (all_equal ? static_cast<double>(weights.size()) : sum);
  const size_t first = table.size();
  table.push_back(0);
  double running = 0;
  for (const float weight : weights) {
    running += all_equal ? 1.0 : weight;
    table.push_back(static_cast<float>(std::min(steps, std::round(running * scale))));
  }
  const std::span boundaries = std::span(table).subspan(first);
  separate(weights, boundaries, all_equal);
  for (float& boundary : boundaries) boundary *= 0x1p-24f;
  return sum;
}

}  // namespace rayloom::shaders
