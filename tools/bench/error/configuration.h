#pragma once

// What is compared: how the path tracer draws its random numbers, and how it estimates direct light.

#include <rayloom/shaders/path_tracer/settings.h>
#include <rayloom/shaders/sampler_kind.h>

#include <string>
#include <vector>

namespace rayloom::bench {

inline constexpr const char* estimator_names[] = {"mis", "light", "bsdf"};  // in shaders::Estimator's order

struct Configuration {
  shaders::SamplerKind sampler = shaders::SamplerKind::owen_sobol;
  shaders::Estimator estimator = shaders::Estimator::mis;

  std::string name() const;  ///< "owen-sobol mis"
};

/// Every sampler with every estimator, in the order of the names. UsageError for a name that is none.
std::vector<Configuration> make_configurations(const std::vector<std::string>& samplers,
                                               const std::vector<std::string>& estimators);

}  // namespace rayloom::bench
