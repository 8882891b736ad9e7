#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace rayloom::shaders {

/// How the numbers of one pixel's samples relate to each other. Each alone is uniform, and pictures have the same
/// expected value, with either.
enum class SamplerKind : uint32_t { owen_sobol, independent };

inline constexpr const char* sampler_names[] = {"owen-sobol", "independent"};

constexpr const char* name_of(SamplerKind kind) { return sampler_names[static_cast<size_t>(kind)]; }

constexpr std::optional<SamplerKind> find_sampler(std::string_view name) {
  for (const SamplerKind kind : {SamplerKind::owen_sobol, SamplerKind::independent})
    if (name == name_of(kind)) return kind;
  return std::nullopt;
}

}  // namespace rayloom::shaders
