#include <rayloom/tools/report.h>

#include <rayloom/accel/trace.h>
#include <rayloom/base/output_file.h>
#include <rayloom/base/version.h>

#include <algorithm>

#include <fmt/format.h>

namespace rayloom::tools {
namespace {

std::string scaled(double value, const std::vector<std::pair<double, const char*>>& units) {
  for (const auto& [size, name] : units) {
    if (value >= size) return fmt::format("{:.3g} {}", value / size, name);
  }
  return fmt::format("{:.0f} {}", value, units.back().second);
}

}  // namespace

Json new_report(const std::string& subcommand, unsigned schema_version) {
  Json report = json_document("rayloom." + subcommand, schema_version);
  report["tool"] = {{"commit", version().commit},
                    {"compiler", version().compiler},
                    {"build_type", version().build_type},
                    {"isa", std::string(accel::isa_name(accel::current_isa()))}};
  return report;
}

void print_report(const CommonOptions& common, const Json& report, const std::string& text) {
  if (!common.json.empty()) write_json(common.json, report);
  if (!common.json_on_stdout()) write_file("-", text);
}

void check_writable(const std::string& path) { OutputFile probe(path); }

void check_json_output(const CommonOptions& common) {
  if (!common.json.empty() && !common.json_on_stdout()) check_writable(common.json);
}

std::string format_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (size_t i = 0; i < row.size(); ++i) {
      line += i == 0 ? fmt::format("{:<{}}", row[i], widths[i]) : fmt::format("  {:>{}}", row[i], widths[i]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

std::string with_commas(uint64_t value) {
  std::string digits = std::to_string(value);
  for (size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, ",");
  return digits;
}

std::string format_bytes(uint64_t bytes) {
  return scaled(static_cast<double>(bytes), {{1 << 30, "GiB"}, {1 << 20, "MiB"}, {1 << 10, "KiB"}, {1, "bytes"}});
}

std::string format_ns(uint64_t nanoseconds) {
  return scaled(static_cast<double>(nanoseconds), {{1e9, "s"}, {1e6, "ms"}, {1e3, "us"}, {1, "ns"}});
}

}  // namespace rayloom::tools
