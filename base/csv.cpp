#include <rayloom/base/csv.h>

#include <fmt/format.h>

#include <stdexcept>

namespace rayloom {

namespace {

std::string quoted(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

}  // namespace

CsvCell::CsvCell(std::string_view text) : text_(quoted(text)) {}
CsvCell::CsvCell(double number) : text_(fmt::format("{}", number)) {}
CsvCell::CsvCell(float number) : text_(fmt::format("{}", number)) {}
CsvCell::CsvCell(long long number) : text_(std::to_string(number)) {}
CsvCell::CsvCell(unsigned long long number) : text_(std::to_string(number)) {}

CsvTable::CsvTable(const std::vector<std::string>& columns) : columns_(columns.size()) {
  append({columns.begin(), columns.end()});
}

void CsvTable::add_row(const std::vector<CsvCell>& cells) {
  if (cells.size() != columns_) {
    throw std::invalid_argument(fmt::format("CSV row of {} cells in a table of {} columns", cells.size(), columns_));
  }
  append(cells);
}

void CsvTable::append(const std::vector<CsvCell>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) text_.append(i == 0 ? "" : ",").append(cells[i].text());
  text_ += '\n';
}

}  // namespace rayloom
