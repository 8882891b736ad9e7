#include <rayloom/tools/flip_report.h>

#include <rayloom/tools/image_io.h>
#include <rayloom/tools/preview.h>
#include <rayloom/tools/report.h>

#include <fmt/format.h>

namespace rayloom::tools {
namespace {

const char* mode_name(const FlipResult& result) { return flip_mode_names[static_cast<size_t>(result.mode)]; }

Json to_json(const flip::Exposures& exposures) {
  return {{"start", exposures.start}, {"stop", exposures.stop}, {"count", exposures.count}};
}

}  // namespace

Json to_json(const FlipResult& result) {
  return {{"mode", mode_name(result)},
          {"mean", result.mean},
          {"pixels_per_degree", result.pixels_per_degree},
          {"incomparable_pixels", result.incomparable_pixels},
          {"exposures", result.mode == FlipMode::hdr ? to_json(result.exposures) : Json()}};
}

std::string to_text(const FlipResult& result) {
  std::string text = fmt::format("flip {:.6f} ({}", result.mean, mode_name(result));
  if (result.mode == FlipMode::hdr) {
    const auto& [start, stop, count] = result.exposures;
    text += fmt::format(", exposures {:.4f} to {:.4f} in {} steps", start, stop, count);
  }
  text += fmt::format(", {} pixels per degree)", result.pixels_per_degree);
  if (result.incomparable_pixels)
    text += fmt::format(", {} pixels not finite", with_commas(result.incomparable_pixels));
  return text + "\n";
}

void write_flip_map(const std::string& path, const FlipResult& result) {
  if (!has_extension(path, ".png")) return write_exr(path, flip_image(result));
  write_png(path, make_heat_map(result.map.width, result.map.height, result.map.values, 1), {});
}

}  // namespace rayloom::tools
