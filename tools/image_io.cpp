#include <rayloom/tools/image_io.h>

#include <rayloom/base/error.h>
#include <rayloom/base/output_file.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

namespace rayloom::tools {
namespace {

/// OpenImageIO stamps the time of day into an EXR unless it finds a date; blanks are EXIF's way to say "unknown".
constexpr const char* unknown_date = "    :  :     :  :  ";

void add_metadata(OIIO::ImageSpec& spec, const Metadata& metadata) {
  for (const auto& [name, value] : metadata) spec.attribute(name, value);
}

/// Opens `format` in memory, writes `pixels` in `type` and returns the file's bytes.
std::string encode(const char* format, const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* pixels) {
  const auto output = OIIO::ImageOutput::create(format);
  if (!output) throw std::runtime_error(fmt::format("OpenImageIO writes no {}: {}", format, OIIO::geterror()));
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const bool done = output->set_ioproxy(&memory) && output->open(format, spec) && output->write_image(type, pixels) &&
                    output->close();
  if (!done) throw std::runtime_error(fmt::format("encoding {}: {}", format, output->geterror()));
  return std::string(bytes.begin(), bytes.end());
}

/// Pixels as EXR takes them: the channels of each pixel side by side, four bytes each.
std::vector<uint32_t> interleave(const Image& image) {
  const size_t stride = image.channels.size();
  std::vector<uint32_t> pixels(image.pixel_count() * stride);
  for (size_t c = 0; c < stride; ++c) {
    const auto place = [&](const auto& values) {
      for (size_t i = 0; i < values.size(); ++i) std::memcpy(&pixels[i * stride + c], &values[i], 4);
    };
    std::visit(place, image.channels[c].values);
  }
  return pixels;
}

std::string part_name(const OIIO::ImageSpec& spec, int part) {
  return std::string(spec.get_string_attribute("oiio:subimagename", std::to_string(part)));
}

/// Reads channel `c` of one part; asking for the type the file has keeps every bit.
Channel read_channel(OIIO::ImageInput& input, int part, int c, std::string name, const std::string& path) {
  const OIIO::ImageSpec spec = input.spec(part);
  const size_t count = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
  Channel channel{std::move(name), {}};
  const auto read = [&](auto values, OIIO::TypeDesc type) {
    values.resize(count);
    if (!input.read_image(part, 0, c, c + 1, type, values.data())) {
      throw InputError(path, "channel " + channel.name, "cannot be read: " + input.geterror());
    }
    channel.values = std::move(values);
  };
  if (spec.channelformat(c) == OIIO::TypeDesc::UINT32) {
    read(std::vector<uint32_t>(), OIIO::TypeDesc::UINT32);
  } else {
    read(std::vector<float>(), OIIO::TypeDesc::FLOAT);
  }
  return channel;
}

}  // namespace

std::string encode_exr(const Image& image) {
  OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height),
                       static_cast<int>(image.channels.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames.clear();
  for (const Channel& channel : image.channels) {
    spec.channelnames.push_back(channel.name);
    spec.channelformats.push_back(channel.is_id() ? OIIO::TypeDesc::UINT32 : OIIO::TypeDesc::FLOAT);
  }
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", unknown_date);
  add_metadata(spec, image.metadata);
  return encode("exr", spec, OIIO::TypeDesc::UNKNOWN, interleave(image).data());
}

std::string encode_png(const Preview& preview, const Metadata& metadata) {
  OIIO::ImageSpec spec(static_cast<int>(preview.width), static_cast<int>(preview.height), 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("png:compressionLevel", 9);
  add_metadata(spec, metadata);
  return encode("png", spec, OIIO::TypeDesc::UINT8, preview.rgb.data());
}

void write_exr(const std::string& path, const Image& image) { write_file(path, encode_exr(image)); }

void write_png(const std::string& path, const Preview& preview, const Metadata& metadata) {
  write_file(path, encode_png(preview, metadata));
}

Image read_image(const std::string& path) {
  std::error_code error;
  if (const auto status = std::filesystem::status(path, error); !std::filesystem::exists(status)) {
    throw InputError(path, "", "no such file");
  }
  const auto input = OIIO::ImageInput::open(path);
  if (!input) throw InputError(path, "", "cannot be read as a picture: " + OIIO::geterror());
  Image image;
  image.width = static_cast<uint32_t>(input->spec().width);
  image.height = static_cast<uint32_t>(input->spec().height);
  image.is_encoded = !input->spec().format.is_floating_point() && input->spec().format.basesize() < 4;
  for (int part = 0; input->seek_subimage(part, 0); ++part) {
    const OIIO::ImageSpec spec = input->spec();
    const std::string prefix = part == 0 ? std::string() : part_name(spec, part) + ".";
    if (spec.width != static_cast<int>(image.width) || spec.height != static_cast<int>(image.height)) {
      throw InputError(path, fmt::format("part {}", part), "has another size than the first part");
    }
    for (int c = 0; c < spec.nchannels; ++c) {
      image.channels.push_back(read_channel(*input, part, c, prefix + spec.channelnames[static_cast<size_t>(c)], path));
    }
  }
  return image;
}

bool has_extension(const std::string& path, std::string_view extension) {
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  return path.size() >= extension.size() &&
         std::equal(path.end() - static_cast<std::ptrdiff_t>(extension.size()), path.end(), extension.begin(), same);
}

}  // namespace rayloom::tools
