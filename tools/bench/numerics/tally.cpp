#include <rayloom/tools/bench/numerics/tally.h>

#include <algorithm>

namespace rayloom::bench::numerics {

void Tally::merge(const Tally& other) {
  cases += other.cases;
  for (size_t i = 0; i < counters; ++i) {
    count[i] += other.count[i];
    most[i] = std::max(most[i], other.most[i]);
  }
  values.insert(values.end(), other.values.begin(), other.values.end());
  examples.insert(examples.end(), other.examples.begin(), other.examples.end());
  std::sort(examples.begin(), examples.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  if (examples.size() > most_examples) examples.resize(most_examples);
}

double Tally::quantile(double fraction) const {
  if (values.empty()) return 0;
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<size_t>(fraction * last)];
}

}  // namespace rayloom::bench::numerics
