#pragma once

// The result of a bench as files: a CSV a table and chart, an SVG a chart, and one self-contained HTML page.

#include <rayloom/tools/bench/chart.h>

#include <string>
#include <variant>
#include <vector>

namespace rayloom::bench {

/// Cells as text, the first row being the header. `name` is that of the CSV file.
struct PageTable {
  std::string name, title;
  std::vector<std::vector<std::string>> rows;
};

class Page {
 public:
  /// `name`: of the HTML file, without extension. `title`: its heading.
  Page(std::string name, std::string title) : name_(std::move(name)), title_(std::move(title)) {}

  void add_text(std::string paragraph) { parts_.emplace_back(std::move(paragraph)); }
  void add_table(PageTable table) { parts_.emplace_back(std::move(table)); }
  void add_chart(Chart chart) { parts_.emplace_back(std::move(chart)); }

  /// Writes everything into `directory`, which is made when missing. CSV files come first, so that they are there when
  /// a chart cannot be drawn (InputError: gnuplot is missing). Returns the files' paths.
  std::vector<std::string> write(const std::string& directory) const;

 private:
  using Part = std::variant<std::string, PageTable, Chart>;
  std::string name_, title_;
  std::vector<Part> parts_;
};

/// `text` with what HTML gives a meaning to replaced.
std::string html_escape(const std::string& text);

}  // namespace rayloom::bench
