#include "image.h"

#include <rayloom/base/error.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <memory>

namespace rayloom::scenes {
namespace {

std::atomic<uint64_t> decoded_count{0};

constexpr uint64_t max_pixels = uint64_t{1} << 28;

/// Grey, grey and alpha, RGB or RGBA to RGBA.
template <typename T>
std::vector<T> to_rgba(const std::vector<T>& source, size_t channels, T one) {
  std::vector<T> rgba(source.size() / channels * 4);
  for (size_t i = 0, pixels = source.size() / channels; i < pixels; ++i) {
    const T* from = &source[i * channels];
    for (size_t c = 0; c < 3; ++c) rgba[4 * i + c] = from[channels >= 3 ? c : 0];
    rgba[4 * i + 3] = channels == 2 ? from[1] : channels >= 4 ? from[3] : one;
  }
  return rgba;
}

[[noreturn]] void fail_decoding(const std::string& name, const std::string& reason) {
  throw InputError(name, "", "cannot be decoded: " + reason);
}

template <typename T>
std::vector<T> read_channels(OIIO::ImageInput& input, OIIO::TypeDesc type, const std::string& name) {
  const OIIO::ImageSpec spec = input.spec();
  std::vector<T> values(static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height) *
                        static_cast<size_t>(spec.nchannels));
  if (!input.read_image(0, 0, 0, spec.nchannels, type, values.data())) {
    fail_decoding(name, input.geterror());
  }
  return values;
}

void check_size(const OIIO::ImageSpec& spec, const std::string& name) {
  const auto pixels = static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height);
  if (spec.width > 0 && spec.height > 0 && spec.depth <= 1 && spec.nchannels > 0 && spec.nchannels <= 16 &&
      pixels <= max_pixels) {
    return;
  }
  throw InputError(
      name, "",
      fmt::format("{} x {} pixels with {} channels are not supported", spec.width, spec.height, spec.nchannels));
}

Pixels read_pixels(OIIO::ImageInput& input, const std::string& name) {
  const OIIO::ImageSpec& spec = input.spec();
  check_size(spec, name);
  Pixels pixels;
  pixels.width = static_cast<uint32_t>(spec.width);
  pixels.height = static_cast<uint32_t>(spec.height);
  const auto channels = static_cast<size_t>(spec.nchannels);
  if (spec.format == OIIO::TypeDesc::UINT8) {
    pixels.bytes = to_rgba<uint8_t>(read_channels<uint8_t>(input, OIIO::TypeDesc::UINT8, name), channels, 255);
  } else {
    pixels.floats = to_rgba<float>(read_channels<float>(input, OIIO::TypeDesc::FLOAT, name), channels, 1.0f);
  }
  return pixels;
}

/// Alpha is coverage in glTF, not premultiplied: readers must leave the colours alone.
OIIO::ImageSpec open_options() {
  OIIO::ImageSpec options;
  options.attribute("oiio:UnassociatedAlpha", 1);
  return options;
}

/// The reader is chosen by a file's extension, so encoded bytes get the one their first bytes tell.
const char* pretend_name(const std::vector<std::byte>& bytes) {
  const auto starts = [&](std::initializer_list<int> magic) {
    size_t i = 0;
    for (const int byte : magic) {
      if (i >= bytes.size() || std::to_integer<int>(bytes[i]) != byte) return false;
      ++i;
    }
    return true;
  };
  if (starts({0x89, 'P', 'N', 'G'})) return "image.png";
  if (starts({0xFF, 0xD8})) return "image.jpg";
  if (starts({0x76, 0x2F, 0x31, 0x01})) return "image.exr";
  if (starts({'#', '?'})) return "image.hdr";
  if (starts({'B', 'M'})) return "image.bmp";
  if (starts({'R', 'I', 'F', 'F'})) return "image.webp";
  return nullptr;
}

Pixels decode_bytes(const std::vector<std::byte>& bytes, const std::string& name) {
  const char* file = pretend_name(bytes);
  if (!file) throw InputError(name, "", "is neither PNG nor JPEG nor another image format we know");
  OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes.data()), bytes.size());
  OIIO::Filesystem::IOProxy* proxy = &memory;
  OIIO::ImageSpec options = open_options();
  options.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto input = OIIO::ImageInput::open(file, &options);
  if (!input) fail_decoding(name, OIIO::geterror());
  return read_pixels(*input, name);
}

Pixels decode_file(const std::string& path) {
  const OIIO::ImageSpec options = open_options();
  const auto input = OIIO::ImageInput::open(path, &options);
  if (!input) fail_decoding(path, OIIO::geterror());
  return read_pixels(*input, path);
}

}  // namespace

Image Image::from_encoded(std::string name, std::vector<std::byte> encoded) {
  Image image(std::move(name), Source::encoded);
  image.encoded_ = std::move(encoded);
  return image;
}

Image Image::from_file(std::string path) { return Image(std::move(path), Source::file); }

Image Image::from_pixels(std::string name, Pixels pixels) {
  const uint64_t values = uint64_t{4} * pixels.width * pixels.height;
  const bool bytes = pixels.bytes.size() == values && pixels.floats.empty();
  const bool floats = pixels.floats.size() == values && pixels.bytes.empty();
  if (values == 0 || (!bytes && !floats)) throw InputError(name, "", "pixel count does not match width and height");
  Image image(std::move(name), Source::pixels);
  image.pixels_ = std::move(pixels);
  image.ready_ = true;
  return image;
}

Image::Image(Image&& other) noexcept
    : name_(std::move(other.name_)),
      source_(other.source_),
      encoded_(std::move(other.encoded_)),
      ready_(other.ready_.load()),
      pixels_(std::move(other.pixels_)) {}

const Pixels& Image::pixels() const {
  if (ready_.load(std::memory_order_acquire)) return pixels_;
  const std::lock_guard lock(mutex_);
  if (!ready_.load(std::memory_order_relaxed)) {
    pixels_ = source_ == Source::file ? decode_file(name_) : decode_bytes(encoded_, name_);
    decoded_count.fetch_add(1, std::memory_order_relaxed);
    ready_.store(true, std::memory_order_release);
  }
  return pixels_;
}

uint64_t Image::memory_bytes() const {
  return encoded_.size() +
         (ready_.load(std::memory_order_acquire) ? pixels_.bytes.size() + pixels_.floats.size() * sizeof(float) : 0);
}

uint64_t images_decoded() { return decoded_count.load(std::memory_order_relaxed); }

}  // namespace rayloom::scenes
