#pragma once

// Tables, graph and targets of the build bench.

#include <rayloom/tools/bench/build/builds.h>

namespace rayloom::bench {

/// Rows of all scenes.
void add_builds(BenchReport& report, const std::vector<BuildRow>& rows);

/// The lecture's graph for one scene's rows: effective rays a second against rays traced per build, a line a builder.
Chart effective_rate_chart(const std::vector<BuildRow>& rows);

/// How far our best builder is above Embree's best, at the point of the graph where that is least. 1: level.
double least_lead(const std::vector<BuildRow>& rows);

}  // namespace rayloom::bench
