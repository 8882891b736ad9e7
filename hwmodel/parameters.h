#pragma once

// The parameters of the simulated GPU by name: what each means, what it may be, and, in a preset, where its value comes
// from and how sure it is.

#include <rayloom/hwmodel/gpu_config.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rayloom::hwmodel {

struct Parameter {
  const char* key;  ///< dotted, "rt.box_latency"
  const char* unit;
  uint32_t min, max;
  const char* meaning;
  uint32_t& (*field)(GpuConfig&);
};
std::span<const Parameter> parameters();

/// How sure a value is: a vendor's document, somebody's measurement, another simulator's source,
/// arithmetic on these, a choice of ours that only calibration can settle, or the user's own.
enum class Confidence : uint8_t { vendor, measured, simulator, derived, assumed, user };
const char* confidence_name(Confidence confidence);

struct Provenance {
  std::string source;
  Confidence confidence{};
};

struct GpuPreset {
  std::string name, description;
  GpuConfig config;
  std::vector<Provenance> provenance;  ///< of parameters(), in order
};

std::vector<std::string> preset_names();
/// Throws UsageError for an unknown name.
GpuPreset make_preset(std::string_view name);

/// "rt.box_latency=12". Throws UsageError: no such key (names the nearest), no number, out of range.
void set_parameter(GpuPreset& preset, std::string_view assignment);
uint32_t parameter_value(const GpuConfig& config, const Parameter& parameter);

/// A line a parameter: key, value, unit, confidence, source.
std::string parameter_table(const GpuPreset& preset);
/// {"preset": ..., "parameters": {key: {"value": ..., "unit": ..., "source": ..., "confidence": ...}}} as JSON text.
std::string parameter_json(const GpuPreset& preset);

}  // namespace rayloom::hwmodel
