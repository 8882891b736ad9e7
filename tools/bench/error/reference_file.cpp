#include <rayloom/tools/bench/error/reference_file.h>

#include <rayloom/base/error.h>
#include <rayloom/base/hash.h>
#include <rayloom/tools/image_io.h>
#include <rayloom/tools/report.h>

#include <filesystem>

#include <fmt/format.h>

namespace rayloom::bench {
namespace {

constexpr uint32_t key_seed = 0x40000000u;
constexpr const char* layers[] = {"even", "odd", "variance"};

std::vector<glm::vec3>& values_of(Reference& reference, int layer) {
  return layer < 2 ? reference.half[layer] : reference.own_variance;
}

std::string channel_name(const std::string& key, int layer, int color) {
  return fmt::format("{}.{}.{}", key, layers[layer], "RGB"[color]);
}

}  // namespace

std::string reference_key(shaders::Renderer& renderer, const std::string& scene, uint64_t samples) {
  renderer.restart(key_seed, shaders::SamplerKind::owen_sobol);
  renderer.render(0, 1);
  Hash64 hash;
  hash.add(scene).add(renderer.options().max_bounces).add(samples).add(reference_parts);
  const shaders::Picture picture = renderer.picture();
  hash.add(picture.width).add(picture.height);
  for (const auto& pixel : picture.rgba) hash.add(pixel.x).add(pixel.y).add(pixel.z);
  return fmt::format("reference_{:016x}", hash.value());
}

ReferenceFile::ReferenceFile(std::string path, uint32_t width, uint32_t height)
    : path_(std::move(path)), image_{width, height, {}, {}} {
  if (path_.empty()) return;
  if (!tools::has_extension(path_, ".exr")) throw UsageError("--reference: '" + path_ + "' does not end in .exr");
  tools::check_writable(path_);
  if (!std::filesystem::exists(path_)) return;
  image_ = tools::read_image(path_);
  if (image_.width != width || image_.height != height) {
    throw InputError(path_, "",
                     fmt::format("holds references of {}x{}, not of {}x{}: another size needs another file",
                                 image_.width, image_.height, width, height));
  }
}

std::optional<Reference> ReferenceFile::find(const std::string& key) const {
  Reference reference{image_.width, image_.height, {}, {}};
  for (int layer = 0; layer < 3; ++layer) {
    std::vector<glm::vec3>& values = values_of(reference, layer);
    values.resize(image_.pixel_count());
    for (int color = 0; color < 3; ++color) {
      const tools::Channel* channel = image_.find(channel_name(key, layer, color));
      if (!channel || channel->is_id()) return std::nullopt;
      for (size_t i = 0; i < values.size(); ++i) values[i][color] = channel->floats()[i];
    }
  }
  return reference;
}

void ReferenceFile::add(const std::string& key, const Reference& reference) {
  if (path_.empty()) return;
  Reference copy = reference;
  for (int layer = 0; layer < 3; ++layer) {
    for (int color = 0; color < 3; ++color) {
      std::vector<float> values;
      for (const glm::vec3& pixel : values_of(copy, layer)) values.push_back(pixel[color]);
      image_.channels.push_back({channel_name(key, layer, color), std::move(values)});
    }
  }
  tools::write_exr(path_, image_);
}

}  // namespace rayloom::bench
