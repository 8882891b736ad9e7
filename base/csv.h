#pragma once

// Tables as comma-separated values (RFC 4180): one header row, rows of the same length, text quoted where it must be.

#include <string>
#include <string_view>
#include <vector>

namespace rayloom {

/// A cell: text, or a number in the shortest form that reads back as the same value. NaN and infinities are "nan",
/// "inf".
class CsvCell {
 public:
  CsvCell(std::string_view text);
  CsvCell(const std::string& text) : CsvCell(std::string_view(text)) {}
  CsvCell(const char* text) : CsvCell(std::string_view(text)) {}
  CsvCell(double number);
  CsvCell(float number);
  CsvCell(int number) : CsvCell(static_cast<long long>(number)) {}
  CsvCell(unsigned number) : CsvCell(static_cast<unsigned long long>(number)) {}
  CsvCell(long number) : CsvCell(static_cast<long long>(number)) {}
  CsvCell(unsigned long number) : CsvCell(static_cast<unsigned long long>(number)) {}
  CsvCell(long long number);
  CsvCell(unsigned long long number);

  const std::string& text() const { return text_; }

 private:
  std::string text_;  // quoted
};

/// Collects rows; text() is the whole table, to be handed to write_file().
class CsvTable {
 public:
  /// Column names, with units ("time_ns").
  explicit CsvTable(const std::vector<std::string>& columns);
  /// One cell a column, else std::invalid_argument.
  void add_row(const std::vector<CsvCell>& cells);
  const std::string& text() const { return text_; }

 private:
  void append(const std::vector<CsvCell>& cells);

  std::size_t columns_;
  std::string text_;
};

}  // namespace rayloom
