// Reading what callgrind writes. That it counts at all is tested from outside, where valgrind is installed.

#include <rayloom/tools/bench/instructions.h>

#include <catch2/catch.hpp>

using namespace rayloom::bench;

TEST_CASE("A counted region is named by its trigger and counted by the smallest of its totals") {
  std::map<std::string, uint64_t> regions;
  add_counted_region(regions,
                     "version: 1\npart: 2\n\ndesc: Timerange: Basic block 1 - 2\n"
                     "desc: Trigger: Client Request: shadow; rtcOccluded1; batch\n\nevents: Ir\nsummary: 0\n\n"
                     "fn=(1) f\n0 12\n\ntotals: 12008\n");
  add_counted_region(regions, "desc: Trigger: Program termination\nsummary: 0\n\ntotals: 9\n");
  add_counted_region(regions, "desc: Trigger: Client Request: shadow; rtcOccluded1; batch\n\ntotals: 12100\n");
  add_counted_region(regions, "");
  CHECK(regions == std::map<std::string, uint64_t>{{"shadow; rtcOccluded1; batch", 12008}});
}

TEST_CASE("Outside of valgrind a region just runs, once and three times") {
  int runs = 0;
  count_region("work", [&] { ++runs; });
  CHECK(runs == 4);
}
