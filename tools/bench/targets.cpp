#include <rayloom/tools/bench/targets.h>

#include <algorithm>

#include <fmt/format.h>

namespace rayloom::bench {

void Targets::at_least(std::string name, double value, double bound, std::string unit) {
  targets_.push_back({std::move(name), value, bound, true, std::move(unit)});
}

void Targets::at_most(std::string name, double value, double bound, std::string unit) {
  targets_.push_back({std::move(name), value, bound, false, std::move(unit)});
}

bool Targets::all_met() const {
  return std::all_of(targets_.begin(), targets_.end(), [](const Target& target) { return target.met(); });
}

std::string Targets::to_text() const {
  std::string text;
  for (const Target& t : targets_) {
    text += fmt::format("{}  {}: {:.4g}{}, target {} {:.4g}{}\n", t.met() ? "met   " : "MISSED", t.name, t.value,
                        t.unit, t.at_least ? "at least" : "at most", t.bound, t.unit);
  }
  return text;
}

Json Targets::to_json() const {
  Json json = Json::array();
  for (const Target& t : targets_) {
    json.push_back({{"name", t.name},
                    {"value", t.value},
                    {"bound", t.bound},
                    {"relation", t.at_least ? "at_least" : "at_most"},
                    {"unit", t.unit},
                    {"met", t.met()}});
  }
  return json;
}

}  // namespace rayloom::bench
