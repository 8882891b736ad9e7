// What gnuplot is told and what it draws.

#include <rayloom/base/error.h>
#include <rayloom/tools/bench/chart.h>

#include <cstdlib>

#include <catch2/catch.hpp>

using namespace rayloom::bench;

namespace {

Chart example() {
  return {"rates",
          "Rays' <speed> & 100 % \"cost\"",
          {"rays", true},
          {"rays/s", true},
          {{"binned SAH", {{1e4, 1e6, 0.9e6, 1.1e6, "first"}, {1e6, 2e6, 0, 0, ""}}, Style::line_and_points},
           {"Embree's low", {{1e4, 2e6, 0, 0, ""}, {0, 5, 0, 0, "not on a logarithmic axis"}}, Style::line}}};
}

}  // namespace

TEST_CASE("A chart's CSV has every point") {
  CHECK(chart_csv(example()) ==
        "series,x,y,low,high,label\n"
        "binned SAH,10000,1000000,900000,1100000,first\n"
        "binned SAH,1000000,2000000,0,0,\n"
        "Embree's low,10000,2000000,0,0,\n"
        "Embree's low,0,5,0,0,not on a logarithmic axis\n");
}

TEST_CASE("A script quotes names, and leaves out what a logarithmic axis cannot show") {
  const std::string script = gnuplot_script(example());
  CHECK_THAT(script, Catch::Contains("'Embree''s low'") && Catch::Contains("set logscale x 10"));
  CHECK_THAT(script, !Catch::Contains("not on a logarithmic axis"));
  CHECK_THAT(script, Catch::Contains("with yerrorlines") && Catch::Contains("with lines"));
}

TEST_CASE("The picture is an SVG with names, axes and labels") {
  const std::string svg = chart_svg(example());
  for (const char* text :
       {"<svg", "</svg>", "binned SAH", "Embree's low", "rays/s", "10⁵", "first", "&lt;speed> &amp;"}) {
    CAPTURE(text);
    CHECK(svg.find(text) != std::string::npos);
  }
}

TEST_CASE("A chart without points is an empty picture") {
  Chart chart = example();
  chart.series.clear();
  CHECK_THAT(chart_svg(chart), Catch::Contains("<svg"));
}

TEST_CASE("Without gnuplot the error names the package") {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  CHECK_THROWS_WITH(chart_svg(example()), Catch::Contains("gnuplot-nox"));
  setenv("PATH", path.c_str(), 1);
}
