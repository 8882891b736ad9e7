#include "container.h"
#include "importer.h"

#include <rayloom/base/det_math.h>
#include <fmt/format.h>

namespace rayloom::scenes::gltf {
namespace {

Wrap wrap_of(int gl_wrap) {
  switch (gl_wrap) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::clamp_to_edge;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::mirrored_repeat;
    default:
      return Wrap::repeat;
  }
}

Image import_image(const Importer& importer, size_t index) {
  const Document& document = importer.document;
  const ImageSource& source = document.images[index];
  const std::string object = fmt::format("images[{}]", index), name = document.file + ": " + object;
  if (source.buffer_view >= 0) {
    const auto& view = document.model.bufferViews[static_cast<size_t>(source.buffer_view)];
    const std::byte* bytes = document.buffers[static_cast<size_t>(view.buffer)].data() + view.byteOffset;
    return Image::from_encoded(name, {bytes, bytes + view.byteLength});
  }
  if (is_data_uri(source.uri)) return Image::from_encoded(name, decode_data_uri(source.uri, document.file, object));
  return Image::from_file(resolve_uri(source.uri, document.directory, document.file, object));
}

bool has_image(const Importer& importer, const tinygltf::Texture& texture) {
  return texture.source >= 0 && static_cast<size_t>(texture.source) < importer.document.images.size();
}

Texture import_texture(const Importer& importer, const tinygltf::Texture& source) {
  Texture texture;
  texture.name = source.name;
  texture.image = has_image(importer, source) ? static_cast<uint32_t>(source.source) : no_image;
  if (source.sampler < 0) return texture;
  const tinygltf::Sampler& sampler = importer.model().samplers[static_cast<size_t>(source.sampler)];
  texture.wrap_u = wrap_of(sampler.wrapS);
  texture.wrap_v = wrap_of(sampler.wrapT);
  texture.filter = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST ? Filter::nearest : Filter::linear;
  return texture;
}

glm::dvec2 vec2_member(const tinygltf::Value& object, const char* key, double missing) {
  if (!object.Has(key)) return glm::dvec2(missing);
  return {object.Get(key).Get(0).GetNumberAsDouble(), object.Get(key).Get(1).GetNumberAsDouble()};
}

/// KHR_texture_transform: translation * rotation * scale of (u, v, 1).
void apply_transform(const tinygltf::Value& transform, TextureRef& ref) {
  const glm::dvec2 offset = vec2_member(transform, "offset", 0), scale = vec2_member(transform, "scale", 1);
  const double angle = transform.Has("rotation") ? transform.Get("rotation").GetNumberAsDouble() : 0;
  const auto [sine, cosine] = det::sincos(angle);
  ref.row_u = {cosine * scale.x, sine * scale.y, offset.x};
  ref.row_v = {-sine * scale.x, cosine * scale.y, offset.y};
  if (transform.Has("texCoord")) ref.uv_set = static_cast<uint32_t>(transform.Get("texCoord").GetNumberAsInt());
}

template <typename Info>
TextureRef texture_ref(Importer& importer, const Info& info, const std::string& object) {
  TextureRef ref;
  if (info.index < 0) return ref;
  const tinygltf::Texture& texture = importer.model().textures[static_cast<size_t>(info.index)];
  if (texture.source >= 0 && !has_image(importer, texture)) {
    importer.fail(fmt::format("textures[{}].source", info.index),
                  fmt::format("index {} is out of range, the file has {} images", texture.source,
                              importer.document.images.size()));
  }
  if (texture.source < 0) {
    importer.warn(fmt::format("textures[{}] has no image of a supported kind and is left out", info.index));
    return ref;
  }
  if (info.texCoord > 1) {
    importer.warn(
        fmt::format("{}: texture coordinate set {} is not supported; the texture is left out", object, info.texCoord));
    return ref;
  }
  ref.texture = static_cast<uint32_t>(info.index);
  ref.uv_set = static_cast<uint32_t>(info.texCoord);
  const auto transform = info.extensions.find("KHR_texture_transform");
  if (transform != info.extensions.end()) apply_transform(transform->second, ref);
  return ref;
}

AlphaMode alpha_mode(const std::string& mode) {
  return mode == "MASK" ? AlphaMode::mask : mode == "BLEND" ? AlphaMode::blend : AlphaMode::opaque;
}

glm::vec3 emissive(const tinygltf::Material& source) {
  double strength = 1;
  const auto extension = source.extensions.find("KHR_materials_emissive_strength");
  if (extension != source.extensions.end() && extension->second.Has("emissiveStrength")) {
    strength = extension->second.Get("emissiveStrength").GetNumberAsDouble();
  }
  if (source.emissiveFactor.size() != 3) return glm::vec3(0);
  return {source.emissiveFactor[0] * strength, source.emissiveFactor[1] * strength,
          source.emissiveFactor[2] * strength};
}

Material import_material(Importer& importer, size_t index) {
  const tinygltf::Material& source = importer.model().materials[index];
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  const std::string object = fmt::format("materials[{}]", index);
  Material material;
  material.name = source.name;
  for (int i = 0; i < 4; ++i) material.base_color[i] = static_cast<float>(pbr.baseColorFactor[static_cast<size_t>(i)]);
  material.base_color_texture = texture_ref(importer, pbr.baseColorTexture, object);
  material.metallic = static_cast<float>(pbr.metallicFactor);
  material.roughness = static_cast<float>(pbr.roughnessFactor);
  material.metallic_roughness_texture = texture_ref(importer, pbr.metallicRoughnessTexture, object);
  material.normal_texture = texture_ref(importer, source.normalTexture, object);
  material.normal_scale = static_cast<float>(source.normalTexture.scale);
  material.occlusion_texture = texture_ref(importer, source.occlusionTexture, object);
  material.occlusion_strength = static_cast<float>(source.occlusionTexture.strength);
  material.emissive = emissive(source);
  material.emissive_texture = texture_ref(importer, source.emissiveTexture, object);
  material.alpha_mode = alpha_mode(source.alphaMode);
  material.alpha_cutoff = static_cast<float>(source.alphaCutoff);
  material.double_sided = source.doubleSided;
  if (!glm::all(glm::lessThan(material.emissive, glm::vec3(std::numeric_limits<float>::infinity())))) {
    importer.fail(object, "emissiveFactor times emissiveStrength is too large");
  }
  return material;
}

}  // namespace

void import_textures(Importer& importer) {
  for (size_t i = 0; i < importer.document.images.size(); ++i) {
    importer.scene.images.push_back(std::make_shared<const Image>(import_image(importer, i)));
  }
  for (const tinygltf::Texture& texture : importer.model().textures) {
    importer.scene.textures.push_back(import_texture(importer, texture));
    if (texture.source < 0 || has_image(importer, texture)) continue;
    importer.warn(fmt::format("textures[{}].source: index {} is out of range, the file has {} images",
                              importer.scene.textures.size() - 1, texture.source, importer.document.images.size()));
  }
}

void import_materials(Importer& importer) {
  for (size_t i = 0; i < importer.model().materials.size(); ++i) {
    importer.scene.materials.push_back(import_material(importer, i));
  }
  Material fallback;
  fallback.name = "default";
  importer.scene.materials.push_back(fallback);
}

}  // namespace rayloom::scenes::gltf
