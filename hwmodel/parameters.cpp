#include <rayloom/base/error.h>
#include <rayloom/base/json.h>
#include <rayloom/hwmodel/parameters.h>
#include <rayloom/hwmodel/presets.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace rayloom::hwmodel {

namespace {

#define RAYLOOM_FIELD(member) [](GpuConfig& config) -> uint32_t& { return config.member; }

constexpr Parameter all_parameters[] = {
    {"clock.core_mhz", "MHz", 100, 10000, "clock of SMs, RT cores, caches and crossbar", RAYLOOM_FIELD(core_mhz)},
    {"dispatcher.launch_overhead", "clocks", 0, 10000000, "before a launch's first warp",
     RAYLOOM_FIELD(dispatcher.launch_overhead)},
    {"dispatcher.interval", "clocks", 0, 1000, "between warps handed out", RAYLOOM_FIELD(dispatcher.interval)},
    {"dispatcher.latency", "clocks", 0, 10000, "from dispatcher to SM", RAYLOOM_FIELD(dispatcher.latency)},
    {"sm.count", "SMs", 1, 1024, "SMs, each with an RT core and an L1", RAYLOOM_FIELD(sm.count)},
    {"sm.sub_partitions", "", 1, 16, "issue slots an SM", RAYLOOM_FIELD(sm.sub_partitions)},
    {"sm.warp_slots", "warps", 1, 128, "resident warps an SM", RAYLOOM_FIELD(sm.warp_slots)},
    {"sm.bundle", "instructions", 1, 256, "issued together", RAYLOOM_FIELD(sm.bundle)},
    {"sm.dependency_latency", "clocks", 1, 1000, "from one instruction of a warp to the next",
     RAYLOOM_FIELD(sm.dependency_latency)},
    {"sm.special_interval", "clocks", 1, 64, "issue slot taken by a special instruction",
     RAYLOOM_FIELD(sm.special_interval)},
    {"sm.memory_interval", "clocks", 1, 64, "issue slot taken by a load or store", RAYLOOM_FIELD(sm.memory_interval)},
    {"sm.trace_call_operations", "instructions", 0, 100000, "of a TraceRay besides its shaders",
     RAYLOOM_FIELD(sm.trace_call_operations)},
    {"sm.shader_call_operations", "instructions", 0, 100000, "to enter a shader",
     RAYLOOM_FIELD(sm.shader_call_operations)},
    {"rt.warp_entries", "warps", 1, 64, "warps in an RT core", RAYLOOM_FIELD(rt.warp_entries)},
    {"rt.scheduler", "", 0, 1, "0 oldest warp first, 1 round robin", RAYLOOM_FIELD(rt.scheduler)},
    {"rt.schedule_latency", "clocks", 0, 1000, "picked to L1 access", RAYLOOM_FIELD(rt.schedule_latency)},
    {"rt.ray_bytes", "bytes", 1, 1024, "read in for a ray", RAYLOOM_FIELD(rt.ray_bytes)},
    {"rt.accept_bytes_per_cycle", "bytes/clock", 1, 4096, "of rays read in", RAYLOOM_FIELD(rt.accept_bytes_per_cycle)},
    {"rt.fetch_bytes_per_cycle", "bytes/clock", 1, 4096, "of the node port", RAYLOOM_FIELD(rt.fetch_bytes_per_cycle)},
    {"rt.box_width", "boxes", 1, 64, "tested by one operation", RAYLOOM_FIELD(rt.box_width)},
    {"rt.box_interval", "clocks", 1, 64, "between box operations", RAYLOOM_FIELD(rt.box_interval)},
    {"rt.box_latency", "clocks", 1, 1000, "of a box operation", RAYLOOM_FIELD(rt.box_latency)},
    {"rt.triangle_rate", "triangles/clock", 1, 64, "tests begun", RAYLOOM_FIELD(rt.triangle_rate)},
    {"rt.triangle_latency", "clocks", 1, 1000, "of a triangle test", RAYLOOM_FIELD(rt.triangle_latency)},
    {"rt.transform_interval", "clocks", 1, 64, "between instance transforms", RAYLOOM_FIELD(rt.transform_interval)},
    {"rt.transform_latency", "clocks", 1, 1000, "of an instance transform", RAYLOOM_FIELD(rt.transform_latency)},
    {"rt.pop_cycles", "clocks", 0, 100, "to drop a stack entry beyond the hit", RAYLOOM_FIELD(rt.pop_cycles)},
    {"rt.callback_latency", "clocks", 0, 100000, "from RT core to SM for any-hit and intersection shaders, one way",
     RAYLOOM_FIELD(rt.callback_latency)},
    {"rt.return_interval", "clocks", 1, 1000, "between warps handed back", RAYLOOM_FIELD(rt.return_interval)},
    {"rt.return_latency", "clocks", 0, 1000, "to hand a warp back", RAYLOOM_FIELD(rt.return_latency)},
    {"l1.kilobytes", "KiB", 1, 65536, "size", RAYLOOM_FIELD(l1.kilobytes)},
    {"l1.line_bytes", "bytes", 32, 512, "line of every cache", RAYLOOM_FIELD(l1.line_bytes)},
    {"l1.ways", "", 1, 1024, "associativity", RAYLOOM_FIELD(l1.ways)},
    {"l1.latency", "clocks", 1, 10000, "hit, load to use", RAYLOOM_FIELD(l1.latency)},
    {"l1.access_interval", "clocks", 1, 64, "between lines", RAYLOOM_FIELD(l1.access_interval)},
    {"l1.mshr_entries", "lines", 1, 4096, "missing lines on their way", RAYLOOM_FIELD(l1.mshr_entries)},
    {"l1.mshr_waiters", "requests", 1, 4096, "waiting for one missing line", RAYLOOM_FIELD(l1.mshr_waiters)},
    {"crossbar.latency", "clocks", 1, 10000, "one way", RAYLOOM_FIELD(crossbar.latency)},
    {"crossbar.bytes_per_cycle", "bytes/clock", 1, 1024, "for each SM, each way",
     RAYLOOM_FIELD(crossbar.bytes_per_cycle)},
    {"l2.slices", "", 1, 1024, "by line address", RAYLOOM_FIELD(l2.slices)},
    {"l2.kilobytes_per_slice", "KiB", 1, 65536, "size of a slice", RAYLOOM_FIELD(l2.kilobytes_per_slice)},
    {"l2.ways", "", 1, 1024, "associativity", RAYLOOM_FIELD(l2.ways)},
    {"l2.latency", "clocks", 1, 10000, "hit, load to use", RAYLOOM_FIELD(l2.latency)},
    {"l2.bytes_per_cycle", "bytes/clock", 1, 1024, "of a slice", RAYLOOM_FIELD(l2.bytes_per_cycle)},
    {"l2.mshr_entries", "lines", 1, 4096, "missing lines on their way, a slice", RAYLOOM_FIELD(l2.mshr_entries)},
    {"l2.mshr_waiters", "requests", 1, 4096, "waiting for one missing line", RAYLOOM_FIELD(l2.mshr_waiters)},
    {"dram.channels", "", 1, 1024, "by line address", RAYLOOM_FIELD(dram.channels)},
    {"dram.latency", "clocks", 1, 100000, "unloaded, load to use", RAYLOOM_FIELD(dram.latency)},
    {"dram.bandwidth_mb_per_second", "MB/s", 1, 100000000, "all channels together",
     RAYLOOM_FIELD(dram.bandwidth_mb_per_second)},
};

#undef RAYLOOM_FIELD

uint32_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<uint32_t> row(b.size() + 1);
  for (uint32_t j = 0; j < row.size(); ++j) row[j] = j;
  for (uint32_t i = 1; i <= a.size(); ++i) {
    uint32_t diagonal = row[0];
    row[0] = i;
    for (uint32_t j = 1; j <= b.size(); ++j) {
      const uint32_t substitute = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row.back();
}

const Parameter& find_parameter(std::string_view key) {
  const auto exact = [&](const Parameter& p) { return p.key == key; };
  const auto found = std::find_if(std::begin(all_parameters), std::end(all_parameters), exact);
  if (found != std::end(all_parameters)) return *found;
  const auto nearer = [&](const Parameter& a, const Parameter& b) {
    return edit_distance(a.key, key) < edit_distance(b.key, key);
  };
  const auto nearest = std::min_element(std::begin(all_parameters), std::end(all_parameters), nearer);
  throw UsageError(fmt::format("no GPU parameter is called \"{}\"; did you mean \"{}\"?", key, nearest->key));
}

void assign(GpuPreset& preset, std::string_view key, uint64_t value, Provenance provenance) {
  const Parameter& parameter = find_parameter(key);
  if (value < parameter.min || value > parameter.max)
    throw UsageError(
        fmt::format("{}={} is out of range: {} to {} {}", key, value, parameter.min, parameter.max, parameter.unit));
  parameter.field(preset.config) = static_cast<uint32_t>(value);
  preset.provenance[static_cast<size_t>(&parameter - all_parameters)] = std::move(provenance);
}

const PresetDefinition& find_preset(std::string_view name) {
  std::string known;
  for (const PresetDefinition& definition : preset_definitions()) {
    if (definition.name == name) return definition;
    known += fmt::format("{}\"{}\"", known.empty() ? "" : ", ", definition.name);
  }
  throw UsageError(fmt::format("no GPU preset is called \"{}\"; there is {}", name, known));
}

}  // namespace

std::span<const Parameter> parameters() { return all_parameters; }

const char* confidence_name(Confidence confidence) {
  constexpr const char* names[] = {"vendor", "measured", "simulator", "derived", "assumed", "user"};
  return names[static_cast<size_t>(confidence)];
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const PresetDefinition& definition : preset_definitions()) names.emplace_back(definition.name);
  return names;
}

GpuPreset make_preset(std::string_view name) {
  const PresetDefinition& definition = find_preset(name);
  GpuPreset preset{definition.name, definition.description, {}, {}};
  preset.provenance.resize(std::size(all_parameters));
  for (const PresetValue& row : definition.values) assign(preset, row.key, row.value, {row.source, row.confidence});
  return preset;
}

void set_parameter(GpuPreset& preset, std::string_view assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string_view::npos)
    throw UsageError(fmt::format("\"{}\": a GPU parameter is set as key=value", assignment));
  const std::string_view key = assignment.substr(0, equals), text = assignment.substr(equals + 1);
  find_parameter(key);
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw UsageError(fmt::format("{}: \"{}\" is no whole number", key, text));
  assign(preset, key, value, {"set by the user", Confidence::user});
}

uint32_t parameter_value(const GpuConfig& config, const Parameter& parameter) {
  GpuConfig copy = config;
  return parameter.field(copy);
}

std::string parameter_table(const GpuPreset& preset) {
  std::string text = fmt::format("preset {}: {}\n", preset.name, preset.description);
  for (size_t i = 0; i < std::size(all_parameters); ++i) {
    const Parameter& parameter = all_parameters[i];
    const auto& [source, confidence] = preset.provenance[i];
    text += fmt::format("  {:<28} {:>8} {:<16} {:<9}  {}\n", parameter.key, parameter_value(preset.config, parameter),
                        parameter.unit, confidence_name(confidence), source);
  }
  return text;
}

std::string parameter_json(const GpuPreset& preset) {
  Json values = Json::object();
  for (size_t i = 0; i < std::size(all_parameters); ++i) {
    const Parameter& parameter = all_parameters[i];
    values[parameter.key] = {{"value", parameter_value(preset.config, parameter)},
                             {"unit", parameter.unit},
                             {"meaning", parameter.meaning},
                             {"source", preset.provenance[i].source},
                             {"confidence", confidence_name(preset.provenance[i].confidence)}};
  }
  return json_text({{"preset", preset.name}, {"description", preset.description}, {"parameters", values}});
}

}  // namespace rayloom::hwmodel
