#include <rayloom/tools/environment_option.h>

#include <rayloom/base/error.h>
#include <rayloom/tools/cli_values.h>

#include <filesystem>
#include <optional>
#include <vector>

namespace rayloom::tools {
namespace {

constexpr double max_radiance = 1e6;

bool looks_like_color(const std::string& text) {
  return text.find_first_not_of("0123456789.,+-eE") == std::string::npos && text.find(',') != std::string::npos;
}

std::vector<std::string> split_at_commas(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) c == ',' ? parts.emplace_back() : parts.back() += c;
  return parts;
}

glm::vec3 parse_color(const std::string& text) {
  const std::vector<std::string> parts = split_at_commas(text);
  if (parts.size() != 3) throw UsageError("--environment: '" + text + "' is not a colour r,g,b");
  glm::vec3 color{0};
  for (int i = 0; i < 3; ++i)
    color[i] = static_cast<float>(parse_real("--environment", parts[static_cast<size_t>(i)], 0, max_radiance));
  return color;
}

scenes::Environment constant_environment(glm::vec3 radiance) {
  scenes::Environment environment;
  environment.kind = scenes::Environment::Kind::constant;
  environment.zenith = environment.horizon = environment.nadir = radiance;
  return environment;
}

scenes::Environment image_environment(scenes::Scene& scene, const std::string& file, double scale) {
  if (!std::filesystem::is_regular_file(file)) throw InputError(file, "", "no such file, for --environment");
  scenes::Environment environment;
  environment.kind = scenes::Environment::Kind::image;
  environment.image = static_cast<uint32_t>(scene.images.size());
  environment.scale = static_cast<float>(scale);
  scene.images.push_back(std::make_shared<const scenes::Image>(scenes::Image::from_file(file)));
  return environment;
}

}  // namespace

void apply_environment(scenes::Scene& scene, const std::string& text, double scale) {
  if (text.empty()) return;
  if (text == "none") {
    scene.environment = constant_environment(glm::vec3{0});
  } else if (looks_like_color(text)) {
    scene.environment = constant_environment(parse_color(text) * static_cast<float>(scale));
  } else {
    scene.environment = image_environment(scene, text, scale);
  }
}

}  // namespace rayloom::tools
