#pragma once

// Required bounds of a bench, collected while it measures. --check makes a missed one exit code 1.

#include <rayloom/base/json.h>

#include <string>
#include <vector>

namespace rayloom::bench {

struct Target {
  std::string name;  ///< what is bounded: "atrium: diffuse bounce against Embree HIGH"
  double value = 0, bound = 0;
  bool at_least = true;  ///< false: at most
  std::string unit;      ///< "x", " bytes"; may be empty

  bool met() const { return at_least ? value >= bound : value <= bound; }  // a NaN meets nothing
};

class Targets {
 public:
  void at_least(std::string name, double value, double bound, std::string unit = {});
  void at_most(std::string name, double value, double bound, std::string unit = {});
  const std::vector<Target>& all() const { return targets_; }
  bool all_met() const;
  /// "met" or "MISSED" a line.
  std::string to_text() const;
  Json to_json() const;

 private:
  std::vector<Target> targets_;
};

}  // namespace rayloom::bench
