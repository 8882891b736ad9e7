#pragma once

// Pictures in files, through OpenImageIO. A file is encoded in memory and then written whole (base/output_file.h), so
// a full disk or a missing directory leaves nothing behind.

#include <rayloom/tools/image.h>

#include <string>
#include <string_view>

namespace rayloom::tools {

/// The bytes of an EXR: 32-bit float channels (so that a comparison is exact), 32-bit unsigned ids, ZIP. The same image
/// gives the same bytes: the header's date is EXIF's "unknown", not the clock.
std::string encode_exr(const Image& image);
std::string encode_png(const Preview& preview, const Metadata& metadata);

/// Writes an image as EXR. Throws InputError naming `path` when it cannot be written.
void write_exr(const std::string& path, const Image& image);
void write_png(const std::string& path, const Preview& preview, const Metadata& metadata);

/// Reads any format OpenImageIO knows; 32-bit unsigned channels become ids, all others floats (8-bit values over 255).
/// Channels of the second part of a file and later ones are named "part.channel". Throws InputError.
Image read_image(const std::string& path);

/// True when `path` ends in `extension` (".png"), whatever its case.
bool has_extension(const std::string& path, std::string_view extension);

}  // namespace rayloom::tools
