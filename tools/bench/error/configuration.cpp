#include <rayloom/tools/bench/error/configuration.h>

#include <rayloom/base/error.h>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

shaders::SamplerKind parse_sampler(const std::string& name) {
  if (const auto kind = shaders::find_sampler(name)) return *kind;
  throw UsageError(fmt::format("--sampler: '{}' is not one of {}", name, fmt::join(shaders::sampler_names, " ")));
}

shaders::Estimator parse_estimator(const std::string& name) {
  for (size_t i = 0; i < std::size(estimator_names); ++i) {
    if (name == estimator_names[i]) return static_cast<shaders::Estimator>(i);
  }
  throw UsageError(fmt::format("--estimator: '{}' is not one of {}", name, fmt::join(estimator_names, " ")));
}

}  // namespace

std::string Configuration::name() const {
  return fmt::format("{} {}", shaders::name_of(sampler), estimator_names[static_cast<size_t>(estimator)]);
}

std::vector<Configuration> make_configurations(const std::vector<std::string>& samplers,
                                               const std::vector<std::string>& estimators) {
  std::vector<Configuration> list;
  for (const std::string& estimator : estimators) {
    for (const std::string& sampler : samplers) list.push_back({parse_sampler(sampler), parse_estimator(estimator)});
  }
  return list;
}

}  // namespace rayloom::bench
