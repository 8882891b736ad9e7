#include <rayloom/tools/channels.h>

#include <rayloom/base/error.h>

#include <algorithm>

#include <fmt/format.h>

namespace rayloom::tools {
namespace {

constexpr const char* variance_names[] = {"Variance.R", "Variance.G", "Variance.B"};

std::vector<std::string> all_channels() {
  std::vector<std::string> names = shaders::aov_channel_names();
  names.insert(names.end(), std::begin(variance_names), std::end(variance_names));
  return names;
}

std::string layer_of(const std::string& channel) { return channel.substr(0, channel.find('.')); }

template <class Vector>
Channel component(const char* name, const std::vector<Vector>& pixels, int index) {
  std::vector<float> values(pixels.size());
  std::transform(pixels.begin(), pixels.end(), values.begin(), [=](const Vector& pixel) { return pixel[index]; });
  return {name, std::move(values)};
}

Channel to_channel(shaders::AovChannel&& aov) {
  if (aov.ids.empty()) return {std::move(aov.name), std::move(aov.values)};
  return {std::move(aov.name), std::move(aov.ids)};
}

}  // namespace

std::string channel_layers() {
  std::vector<std::string> layers;
  for (const std::string& channel : all_channels()) {
    if (layers.empty() || layers.back() != layer_of(channel)) layers.push_back(layer_of(channel));
  }
  return fmt::format("{}", fmt::join(layers, " "));
}

std::vector<std::string> expand_channels(const std::string& option, const std::vector<std::string>& names) {
  std::vector<std::string> expanded;
  for (const std::string& name : names) {
    const size_t before = expanded.size();
    for (const std::string& channel : all_channels()) {
      const bool chosen = channel == name || layer_of(channel) == name;
      const bool is_new = std::find(expanded.begin(), expanded.end(), channel) == expanded.end();
      if (chosen && is_new) expanded.push_back(channel);
    }
    if (expanded.size() == before) {
      throw UsageError(
          fmt::format("{}: '{}' is no further channel or layer; there are {}", option, name, channel_layers()));
    }
  }
  return expanded;
}

Image make_image(shaders::Renderer& renderer, const std::vector<std::string>& channels) {
  const shaders::Picture picture = renderer.picture();
  Image image{picture.width, picture.height, {}, {}};
  constexpr const char* beauty[] = {"R", "G", "B", "A"};
  for (int i = 0; i < 4; ++i) image.channels.push_back(component(beauty[i], picture.rgba, i));
  if (channels.empty()) return image;

  std::vector<Channel> available;
  for (shaders::AovChannel& aov : renderer.aov_channels()) available.push_back(to_channel(std::move(aov)));
  for (int i = 0; i < 3; ++i) available.push_back(component(variance_names[i], picture.variance, i));
  for (const std::string& name : channels) {
    const auto found =
        std::find_if(available.begin(), available.end(), [&](const Channel& channel) { return channel.name == name; });
    if (found == available.end()) throw std::logic_error("the renderer gave no channel " + name);
    image.channels.push_back(std::move(*found));
  }
  return image;
}

}  // namespace rayloom::tools
