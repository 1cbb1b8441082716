#pragma once

#include "image/bitmap.h"
#include "image/image.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace faceta {

/// Reads OpenEXR (every compression, scan lines and tiles, half, float and uint, all layers and
/// flat parts; luminance-chroma files become R, G, B), PNG (all kinds), JPEG (baseline and
/// progressive, grey or colour), Radiance HDR and PFM, told apart by content, as linear floats.
///
/// PNG and JPEG are decoded by the sRGB curve, or by the exponent of a PNG's gAMA chunk where that
/// is neither absent, sRGB's nor overruled by an sRGB chunk. Alpha is linear, and colours are not
/// multiplied by it. Radiance files with FORMAT=32-bit_rle_xyze have channels X, Y, Z. A PFM's
/// values are multiplied by |scale|; EXPOSURE of a Radiance file goes to the metadata, unapplied
/// (Mitsuba and OpenImageIO do the same in both cases).
///
/// EXR values stay in the primaries of the file, which the metadata name ("chromaticities"); R, G,
/// B of a file with the primaries of XYZ are called X, Y, Z.
///
/// Error with the file's name: missing, unknown, malformed, truncated, too large, deep data,
/// sub-sampled channels (but for luminance-chroma), CMYK.
Image read_image(const std::filesystem::path& path);

/// The same for the bytes of a file; `name` is for messages.
Image decode_image(std::span<const std::uint8_t> file, const std::string& name);

/// Reads the same files with the storage they have. Integers of PNG and JPEG are always taken as
/// sRGB-encoded, whatever a gAMA chunk says: the rule of Mitsuba's `bitmap` texture.
Bitmap read_bitmap(const std::filesystem::path& path);

/// How write_image stores an image. Every field says which formats it concerns.
struct WriteOptions {
  /// EXR: 16-bit floats (finite values are clamped to +-65504), otherwise 32-bit floats.
  bool half = true;
  /// PNG: exposure in stops before the sRGB curve. The other formats hold linear values, unscaled.
  double exposure = 0;
};

/// Writes .exr (ZIP; all channels by name, metadata as typed attributes, the place in the frame),
/// .png (8-bit sRGB, RGB or grey, with A if the image has it; NaN becomes 0, infinities 0 or 255),
/// .pfm (RGB or Y, little-endian) or .hdr (RGB, run-length encoded, negative values and NaN become
/// 0), by the ending of the path. PNG, PFM and HDR take R, G, B, or else Y, or else X, Y, Z
/// converted. Written beside the target under a temporary name and renamed; parent folders must
/// exist. Error: unknown ending, unfit channels, I/O.
void write_image(const std::filesystem::path& path, const Image& image,
                 const WriteOptions& options = {});

/// The bytes of the PNG file that write_image would write.
std::vector<std::uint8_t> encode_png(const Image& image, const WriteOptions& options = {});

/// True if write_image knows the ending.
bool can_write_image(const std::filesystem::path& path);

} // namespace faceta
