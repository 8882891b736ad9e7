#pragma once

// Statistics in words and numbers: text for people, JSON and CSV for scripts. All three print the same figures.

#include <rayloom/hwmodel/parameters.h>
#include <rayloom/hwmodel/replay.h>

#include <string>
#include <vector>

namespace rayloom::hwmodel {

/// A derived figure. The unit is in the name ("rt_box_utilisation_percent").
struct Metric {
  std::string name;
  double value;
};
std::vector<Metric> metrics(const GpuStats& stats);

/// Clocks by cause, each table summing to its total.
struct CycleTable {
  struct Row {
    std::string cause;
    uint64_t cycles;
  };
  std::string name;  ///< "sm_issue_slots", "sm_warp_slots", "rt_ray_slots"
  std::string unit;  ///< what is counted: "issue slots x clocks", ...
  uint64_t total;    ///< clocks times units
  std::vector<Row> rows;
};
std::vector<CycleTable> cycle_tables(const GpuStats& stats);

std::string report_text(const GpuStats& stats);
/// Schema rayloom.simulation: metrics, cycle tables, counters of every component, shaders; with the preset's
/// parameters.
std::string report_json(const GpuStats& stats, const GpuPreset& preset);
/// Columns name,value: the metrics, then every row of the cycle tables as table.cause.
std::string report_csv(const GpuStats& stats);

}  // namespace rayloom::hwmodel
