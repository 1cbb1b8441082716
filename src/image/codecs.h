#pragma once

#include "image/bitmap.h"
#include "image/image.h"
#include "image/io.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// The formats one by one, between memory and memory. Only image/ itself uses these.
namespace faceta::codec {

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

/// A file's decoded content: texels as stored, and what goes with them.
struct Decoded {
  Bitmap bitmap;
  Metadata metadata;
  /// Exponent that turns a stored integer into linear light; 0: the sRGB curve.
  double decode_gamma = 0;
  int x = 0, y = 0, full_width = 0, full_height = 0;
};

/// The whole file. Error if it is missing, unreadable or not a regular file.
Bytes read_file(const std::filesystem::path& path);
/// Writes beside the target and renames; leaves nothing behind on failure. A target that exists and
/// is no regular file (a pipe, /dev/null) is written to directly.
void write_file(const std::filesystem::path& path, View bytes);

/// Reads whatever format the first bytes say. `name` is the file's, for messages.
Decoded decode(View file, const std::string& name);

bool is_exr(View file);
bool is_png(View file);
bool is_jpeg(View file);
bool is_hdr(View file);
bool is_pfm(View file);

Decoded read_exr(View file, const std::string& name);
Decoded read_png(View file, const std::string& name);
Decoded read_jpeg(View file, const std::string& name);
Decoded read_hdr(View file, const std::string& name);
Decoded read_pfm(View file, const std::string& name);

Bytes write_exr(const Image& image, const WriteOptions& options, const std::string& name);
Bytes write_png(const Image& image, const WriteOptions& options, const std::string& name);
Bytes write_hdr(const Image& image, const std::string& name);
Bytes write_pfm(const Image& image, const std::string& name);

/// Walks an EXR file's headers before OpenEXR sees them: every attribute must lie inside the file,
/// so that no length field makes the library allocate more than the file holds.
void check_exr_headers(View file, const std::string& name);

/// R, G, B, or Y, converted from X, Y, Z if need be, with A behind if `alpha` and the image has it.
Image picture_channels(const Image& image, bool alpha);

} // namespace faceta::codec
