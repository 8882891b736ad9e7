#include <rayloom/hwmodel/memory.h>

namespace rayloom::hwmodel {

namespace {

LineRequest& find_or_add(std::vector<LineRequest>& lines, uint64_t line) {
  for (LineRequest& request : lines)
    if (request.line == line) return request;
  return lines.emplace_back(LineRequest{line, 0});
}

}  // namespace

void add_lines(std::vector<LineRequest>& lines, uint64_t address, uint64_t bytes, uint32_t line_bytes) {
  if (bytes == 0) return;
  const uint64_t first = address / sector_bytes, last = (address + bytes - 1) / sector_bytes;
  const uint64_t sectors_per_line = line_bytes / sector_bytes;
  for (uint64_t sector = first; sector <= last; ++sector)
    find_or_add(lines, sector / sectors_per_line).sectors |= 1u << (sector % sectors_per_line);
}

}  // namespace rayloom::hwmodel
