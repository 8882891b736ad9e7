#pragma once

// Charts: named series of points on two axes, drawn by gnuplot as SVG.

#include <string>
#include <vector>

namespace rayloom::bench {

/// A point; low..high is its vertical spread where low < high; a label stands beside it.
struct ChartPoint {
  double x = 0, y = 0;
  double low = 0, high = 0;
  std::string label;
};

enum class Style { line, points, line_and_points };

struct Series {
  std::string name;
  std::vector<ChartPoint> points;
  Style style = Style::line_and_points;
};

/// Points that a logarithmic axis cannot show (0 and below) are left out of the picture, not out of the CSV.
struct Axis {
  std::string label;  ///< with its unit
  bool logarithmic = false;
  bool from_zero = false;  ///< a linear axis of positive values begins at 0
};

struct Chart {
  std::string name;  ///< of its files: letters, digits, '_', '-'
  std::string title;
  Axis x, y;
  std::vector<Series> series;
};

/// series,x,y,low,high,label: a row a point.
std::string chart_csv(const Chart& chart);

/// What gnuplot is given on its standard input.
std::string gnuplot_script(const Chart& chart);

/// A whole SVG document. InputError, naming the package, when gnuplot is missing.
std::string chart_svg(const Chart& chart);

}  // namespace rayloom::bench
