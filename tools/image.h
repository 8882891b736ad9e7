#pragma once

// A picture in memory: named channels of 32-bit values, as EXR keeps them.

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rayloom::tools {

/// One channel, row by row from the top left. Floats for quantities, unsigned integers for ids, which have no mean and
/// no distance.
struct Channel {
  std::string name;  ///< dotted layers, "Albedo.R"
  std::variant<std::vector<float>, std::vector<uint32_t>> values;

  bool is_id() const { return values.index() == 1; }
  const std::vector<float>& floats() const { return std::get<0>(values); }
  const std::vector<uint32_t>& ids() const { return std::get<1>(values); }
};

/// Facts written into a file's header, in this order.
using Metadata = std::vector<std::pair<std::string, std::string>>;

struct Image {
  uint32_t width = 0, height = 0;
  std::vector<Channel> channels;
  Metadata metadata;
  bool is_encoded = false;  ///< floats were read from 8- or 16-bit integers: sRGB-encoded in [0,1], not linear light

  uint64_t pixel_count() const { return uint64_t{width} * height; }
  const Channel* find(std::string_view name) const {
    for (const Channel& channel : channels) {
      if (channel.name == name) return &channel;
    }
    return nullptr;
  }
};

/// 8-bit sRGB, three bytes a pixel, row by row from the top left.
struct Preview {
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgb;
};

}  // namespace rayloom::tools
