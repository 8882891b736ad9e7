#pragma once

// Values on the command line. Each is checked where it is parsed; a bad one is a UsageError that names the option, the
// value and what would have been right.

#include <cstdint>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rayloom::tools {

struct Size {
  uint32_t width = 0, height = 0;
};

struct Pixel {
  uint32_t x = 0, y = 0;
};

/// No picture has more pixels than this (a 16384 x 16384 beauty alone is 4 GiB of floats).
inline constexpr uint32_t max_side = 65536;
inline constexpr uint64_t max_pixels = uint64_t{1} << 28;

/// A whole number in [low, high]. Decimal digits only: no sign, no exponent, no hexadecimal.
uint64_t parse_count(const std::string& option, const std::string& text, uint64_t low, uint64_t high);
/// A finite number in [low, high].
double parse_real(const std::string& option, const std::string& text, double low, double high);
/// "640x480": each side 1..max_side, together at most max_pixels.
Size parse_size(const std::string& option, const std::string& text);
/// "x,y": column and row from the top left.
Pixel parse_pixel(const std::string& option, const std::string& text);
/// "a,b,c": at least one name, none empty, none twice.
std::vector<std::string> parse_names(const std::string& option, const std::string& text);

/// Adds `--name N` with the range in its help text.
void add_count(CLI::App& app, const std::string& name, uint64_t& target, uint64_t low, uint64_t high,
               const std::string& description);

}  // namespace rayloom::tools
