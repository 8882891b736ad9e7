#pragma once

// What a subcommand prints: one JSON document with a schema name and version, or a text table, on standard output.

#include <rayloom/base/json.h>
#include <rayloom/tools/common_options.h>

#include <string>
#include <vector>

namespace rayloom::tools {

/// A document of schema "rayloom.<subcommand>" that says which program, on which instruction set, wrote it.
Json new_report(const std::string& subcommand, unsigned schema_version = 1);

/// Writes `report` where --json said, and `text` to standard output unless the JSON goes there.
void print_report(const CommonOptions& common, const Json& report, const std::string& text);

/// Throws InputError now rather than after hours of work when `path` cannot be written.
void check_writable(const std::string& path);
/// The same for the file --json names, if any.
void check_json_output(const CommonOptions& common);

/// A text table: first column left, the others right aligned, two spaces apart.
std::string format_table(const std::vector<std::vector<std::string>>& rows);

/// 1234567 -> "1,234,567".
std::string with_commas(uint64_t value);
/// "12.3 MiB".
std::string format_bytes(uint64_t bytes);
/// "4.21 s", "13.2 ms".
std::string format_ns(uint64_t nanoseconds);

}  // namespace rayloom::tools
