#include <rayloom/tools/bench/chart.h>

#include <rayloom/base/csv.h>
#include <rayloom/tools/bench/process.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

/// gnuplot's single quotes take everything literally but themselves; a new line would end the command.
std::string quoted(std::string text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c == '\n' ? ' ' : c);
  return out + "'";
}

/// Inside a data block: double quotes hold spaces together, and have no escape for themselves.
std::string data_word(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return '"' + text + '"';
}

bool shown(const Chart& chart, const ChartPoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && !(chart.x.logarithmic && !(point.x > 0)) &&
         !(chart.y.logarithmic && !(point.y > 0));
}

bool has_spread(const Series& series) {
  return std::any_of(series.points.begin(), series.points.end(), [](const auto& p) { return p.low < p.high; });
}

bool has_labels(const Series& series) {
  return std::any_of(series.points.begin(), series.points.end(), [](const auto& p) { return !p.label.empty(); });
}

std::string data_block(const Chart& chart, size_t index) {
  std::string text = fmt::format("$data{} << END_OF_DATA\n", index);
  for (const ChartPoint& p : chart.series[index].points) {
    if (!shown(chart, p)) continue;
    const bool spread = p.low < p.high;
    text += fmt::format("{} {} {} {} {}\n", p.x, p.y, spread ? p.low : p.y, spread ? p.high : p.y, data_word(p.label));
  }
  return text + "END_OF_DATA\n";
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double value) { low = std::min(low, value), high = std::max(high, value); }
};

/// A little room on both sides: gnuplot drops marks and labels that lie on the frame.
Range widened(Range range, bool logarithmic) {
  if (logarithmic) return {range.low / 1.5, range.high * 1.5};
  const double pad = range.high > range.low ? (range.high - range.low) * 0.05 : std::max(1.0, std::fabs(range.low));
  return {range.low - pad, range.high + pad};
}

std::string superscript(int exponent) {
  static constexpr const char* digits[]{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(exponent))) text += digits[c - '0'];
  return text;
}

/// "3·10⁻⁴", "10⁶"; as people write it where that is short: "0.2".
std::string tic(int step, int exponent, bool plain) {
  if (plain) return fmt::format("{}", step * std::pow(10.0, exponent));
  return (step == 1 ? "" : fmt::format("{}·", step)) + "10" + superscript(exponent);
}

/// Powers of ten with their names; more between them where there are few.
std::string decades(const char* axis, Range range) {
  std::vector<std::string> tics;
  const int first = static_cast<int>(std::floor(std::log10(range.low)));
  const int last = static_cast<int>(std::ceil(std::log10(range.high)));
  const bool few = last - first <= 3, plain = few && first >= -2 && last <= 3;
  for (int e = first; e <= last; ++e)
    for (const int step : {1, 2, 5})
      if (step == 1 || few) tics.push_back(fmt::format("'{}' {}e{}", tic(step, e, plain), step, e));
  return fmt::format("set {}tics ({})\n", axis, fmt::join(tics, ", "));
}

std::string axis_commands(const char* axis, const Axis& description, Range data) {
  Range range = widened(data, description.logarithmic);
  if (description.from_zero && !description.logarithmic) range = {0, 1.05 * data.high};
  std::string text =
      fmt::format("set {0}label {1}\nset {0}range [{2}:{3}]\n", axis, quoted(description.label), range.low, range.high);
  if (description.logarithmic) text += fmt::format("set logscale {} 10\n", axis) + decades(axis, range);
  return text;
}

std::string axes(const Chart& chart) {
  Range x, y;
  for (const Series& series : chart.series) {
    for (const ChartPoint& p : series.points) {
      if (!shown(chart, p)) continue;
      x.add(p.x), y.add(p.y);
      if (p.low < p.high && !(chart.y.logarithmic && !(p.low > 0))) y.add(p.low), y.add(p.high);
    }
  }
  return axis_commands("x", chart.x, x) + axis_commands("y", chart.y, y);
}

/// gnuplot's colours but for the fifth, a yellow that is hardly seen on white.
size_t color_of(size_t series) {
  constexpr size_t colors[] = {1, 2, 3, 4, 6, 7, 8};
  return colors[series % std::size(colors)];
}

const char* with(const Series& series) {
  if (series.style == Style::line) return "lines";
  const bool line = series.style == Style::line_and_points;
  if (has_spread(series)) return line ? "yerrorlines" : "yerrorbars";
  return line ? "linespoints" : "points";
}

std::string plot_command(const Chart& chart) {
  std::vector<std::string> items;
  for (size_t i = 0; i < chart.series.size(); ++i) {
    const Series& series = chart.series[i];
    const char* columns = has_spread(series) && series.style != Style::line ? "1:2:3:4" : "1:2";
    const double size = series.style == Style::points ? 1.3 : 0.7;
    const std::string mark = series.style == Style::line ? "" : fmt::format(" pt {} ps {}", i % 13 + 4, size);
    items.push_back(fmt::format("$data{} using {} with {} lc {} lw 2{} title {}", i, columns, with(series), color_of(i),
                                mark, quoted(series.name)));
    if (!has_labels(series)) continue;
    items.push_back(fmt::format("$data{} using 1:2:5 with labels left offset 0.9,0.5 font ',11' notitle", i));
  }
  return fmt::format("plot {}\n", fmt::join(items, ", \\\n  "));
}

}  // namespace

std::string chart_csv(const Chart& chart) {
  CsvTable table({"series", "x", "y", "low", "high", "label"});
  for (const Series& series : chart.series) {
    for (const ChartPoint& p : series.points) table.add_row({series.name, p.x, p.y, p.low, p.high, p.label});
  }
  return table.text();
}

std::string gnuplot_script(const Chart& chart) {
  std::string script = fmt::format(
      "set terminal svg size 960,600 dynamic font 'sans-serif,14' background 'white' name {}\n"
      "set termoption noenhanced\nset encoding utf8\nset grid\nset key outside right top\nset title {}\n",
      quoted(chart.name), quoted(chart.title));
  script += axes(chart);
  for (size_t i = 0; i < chart.series.size(); ++i) script += data_block(chart, i);
  return script + plot_command(chart);
}

std::string chart_svg(const Chart& chart) {
  const auto drawable = [&](const Series& s) {
    return std::any_of(s.points.begin(), s.points.end(), [&](const ChartPoint& p) { return shown(chart, p); });
  };
  Chart visible = chart;
  std::erase_if(visible.series, [&](const Series& s) { return !drawable(s); });
  if (visible.series.empty()) return "<svg xmlns='http://www.w3.org/2000/svg' width='1' height='1'/>\n";
  const ProcessResult result = run_process("gnuplot", {}, gnuplot_script(visible), "gnuplot-nox");
  if (result.exit_code != 0 || result.out.find("</svg>") == std::string::npos) {
    throw std::runtime_error(fmt::format("gnuplot failed on chart '{}': {}", chart.name, result.err));
  }
  return result.out;
}

}  // namespace rayloom::bench
