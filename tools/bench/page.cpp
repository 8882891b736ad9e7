#include <rayloom/tools/bench/page.h>

#include <rayloom/base/csv.h>
#include <rayloom/base/error.h>
#include <rayloom/base/output_file.h>

#include <filesystem>
#include <map>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

constexpr const char* head =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>\n"
    "body {{ font-family: sans-serif; margin: 2em auto; max-width: 1100px; color: #222; }}\n"
    "table {{ border-collapse: collapse; font-size: 14px; }}\n"
    "th, td {{ padding: 2px 10px; text-align: right; border-bottom: 1px solid #ddd; }}\n"
    "th:first-child, td:first-child {{ text-align: left; }}\nsvg {{ max-width: 100%; height: auto; }}\n"
    "</style>\n</head>\n<body>\n<h1>{0}</h1>\n";

std::string table_csv(const PageTable& table) {
  CsvTable csv(table.rows.front());
  for (size_t i = 1; i < table.rows.size(); ++i) csv.add_row({table.rows[i].begin(), table.rows[i].end()});
  return csv.text();
}

std::string table_html(const PageTable& table) {
  std::string html = fmt::format("<h2>{}</h2>\n<table>\n", html_escape(table.title));
  for (const auto& row : table.rows) {
    const char* cell = &row == &table.rows.front() ? "th" : "td";
    html += "<tr>";
    for (const std::string& text : row) html += fmt::format("<{0}>{1}</{0}>", cell, html_escape(text));
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

/// The document without its XML declaration and doctype, which have no place inside a page.
std::string inline_svg(const std::string& svg) { return svg.substr(std::min(svg.find("<svg"), svg.size())); }

std::string make_directory(const std::string& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!std::filesystem::is_directory(directory)) {
    throw InputError(directory, "", "cannot make this directory: " + error.message());
  }
  return directory + "/";
}

}  // namespace

std::string html_escape(const std::string& text) {
  static const std::map<char, const char*> names{{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string out;
  for (const char c : text) {
    const auto name = names.find(c);
    name == names.end() ? out += c : out += name->second;
  }
  return out;
}

std::vector<std::string> Page::write(const std::string& directory) const {
  const std::string folder = make_directory(directory);
  std::vector<std::string> files;
  const auto put = [&](const std::string& file, const std::string& text) {
    write_file(folder + file, text);
    files.push_back(folder + file);
  };
  for (const Part& part : parts_) {
    if (const auto* table = std::get_if<PageTable>(&part)) put(table->name + ".csv", table_csv(*table));
    if (const auto* chart = std::get_if<Chart>(&part)) put(chart->name + ".csv", chart_csv(*chart));
  }
  std::string html = fmt::format(head, html_escape(title_));
  for (const Part& part : parts_) {
    if (const auto* text = std::get_if<std::string>(&part)) html += fmt::format("<p>{}</p>\n", html_escape(*text));
    if (const auto* table = std::get_if<PageTable>(&part)) html += table_html(*table);
    if (const auto* chart = std::get_if<Chart>(&part)) {
      const std::string svg = chart_svg(*chart);
      put(chart->name + ".svg", svg);
      html += inline_svg(svg);
    }
  }
  put(name_ + ".html", html + "</body>\n</html>\n");
  return files;
}

}  // namespace rayloom::bench
