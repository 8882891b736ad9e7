#include <rayloom/tools/cli_values.h>

#include <rayloom/base/error.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <CLI/CLI.hpp>

#include <fmt/format.h>

namespace rayloom::tools {
namespace {

[[noreturn]] void reject(const std::string& option, const std::string& text, const std::string& rule) {
  throw UsageError(fmt::format("{}: '{}' is not {}", option, text, rule));
}

/// The whole of `text` as a number, or nothing.
template <class Number>
std::optional<Number> whole(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class Number>
std::optional<std::pair<Number, Number>> whole_pair(const std::string& text, char separator) {
  const size_t at = text.find(separator);
  if (at == std::string::npos) return std::nullopt;
  const auto first = whole<Number>(std::string_view(text).substr(0, at));
  const auto second = whole<Number>(std::string_view(text).substr(at + 1));
  if (!first || !second) return std::nullopt;
  return std::pair(*first, *second);
}

}  // namespace

uint64_t parse_count(const std::string& option, const std::string& text, uint64_t low, uint64_t high) {
  const auto value = whole<uint64_t>(text);
  if (!value || *value < low || *value > high) {
    reject(option, text, fmt::format("a whole number from {} to {}", low, high));
  }
  return *value;
}

double parse_real(const std::string& option, const std::string& text, double low, double high) {
  const auto value = whole<double>(text);
  if (!value || !std::isfinite(*value) || *value < low || *value > high) {
    const bool open_ended = high == std::numeric_limits<double>::max();
    reject(option, text,
           open_ended ? fmt::format("a number of at least {}", low) : fmt::format("a number from {} to {}", low, high));
  }
  return *value;
}

Size parse_size(const std::string& option, const std::string& text) {
  const auto pair = whole_pair<uint64_t>(text, 'x');
  const auto side_ok = [](uint64_t side) { return side >= 1 && side <= max_side; };
  if (!pair || !side_ok(pair->first) || !side_ok(pair->second) || pair->first * pair->second > max_pixels) {
    reject(option, text, fmt::format("a size WxH with sides from 1 to {} and at most {} pixels", max_side, max_pixels));
  }
  return {static_cast<uint32_t>(pair->first), static_cast<uint32_t>(pair->second)};
}

Pixel parse_pixel(const std::string& option, const std::string& text) {
  const auto pair = whole_pair<uint32_t>(text, ',');
  if (!pair) reject(option, text, "a pixel x,y (column and row from the top left, from 0)");
  return {pair->first, pair->second};
}

std::vector<std::string> parse_names(const std::string& option, const std::string& text) {
  std::vector<std::string> names;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    if (name.empty()) reject(option, text, "a list of names separated by commas");
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      reject(option, text, fmt::format("a list of different names ('{}' stands twice)", name));
    }
    names.push_back(name);
    begin = end + 1;
  }
  return names;
}

void add_count(CLI::App& app, const std::string& name, uint64_t& target, uint64_t low, uint64_t high,
               const std::string& description) {
  const auto store = [&target, name, low, high](const std::string& text) {
    target = parse_count(name, text, low, high);
  };
  app.add_option_function<std::string>(name, store, fmt::format("{} [{}]", description, target))
      ->type_name(high == UINT64_MAX ? "N" : fmt::format("{}..{}", low, high));
}

}  // namespace rayloom::tools
