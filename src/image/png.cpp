#include "base/error.h"
#include "image/codecs.h"
#include "image/tonemap.h"

#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <fmt/format.h>
#include <png.h>

/// libpng reports errors by longjmp, which must not skip a destructor: everything with one lives in
/// ReadState or WriteState, outside the functions that call setjmp.
namespace faceta::codec {
namespace {

struct ReadState {
  View file;
  std::size_t at = 0;
  std::string message;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<png_bytep> rows;
  Decoded out;
  std::size_t stored_row_bytes = 0; ///< before palettes and small depths are expanded
  std::size_t row_bytes = 0;
  int colour_type = 0;
  ~ReadState() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct WriteState {
  Bytes bytes;
  std::string message;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<std::uint8_t> row;
  ~WriteState() { png_destroy_write_struct(&png, &info); }
};

template <class State> [[noreturn]] void on_error(png_structp png, png_const_charp message) {
  static_cast<State*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}
void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep to, std::size_t count) {
  auto& state = *static_cast<ReadState*>(png_get_io_ptr(png));
  if (state.file.size() - state.at < count)
    png_error(png, "the file is truncated");
  std::memcpy(to, state.file.data() + state.at, count);
  state.at += count;
}

void on_write(png_structp png, png_bytep from, std::size_t count) {
  auto& state = *static_cast<WriteState*>(png_get_io_ptr(png));
  bool ok = true;
  try {
    state.bytes.insert(state.bytes.end(), from, from + count);
  } catch (const std::bad_alloc&) {
    ok = false;
  }
  if (!ok)
    png_error(png, "out of memory");
}
void on_flush(png_structp) {}

/// Reads the header and asks for 8 or 16 bits of grey or colour. False after an error.
bool read_info(ReadState& s) {
  if (setjmp(png_jmpbuf(s.png)))
    return false;
  png_set_read_fn(s.png, &s, on_read);
  png_set_user_limits(s.png, kMaxDimension, kMaxDimension);
  png_set_chunk_malloc_max(s.png, 8u << 20);
  png_set_chunk_cache_max(s.png, 100);
  png_read_info(s.png, s.info);
  s.stored_row_bytes = png_get_rowbytes(s.png, s.info);
  png_set_expand(s.png); // palettes, 1, 2 and 4 bits, transparent colours
  if constexpr (std::endian::native == std::endian::little)
    png_set_swap(s.png);
  png_set_interlace_handling(s.png);
  png_read_update_info(s.png, s.info);
  s.row_bytes = png_get_rowbytes(s.png, s.info);
  s.colour_type = png_get_color_type(s.png, s.info);
  return true;
}

bool read_rows(ReadState& s) {
  if (setjmp(png_jmpbuf(s.png)))
    return false;
  png_read_image(s.png, s.rows.data());
  png_read_end(s.png, nullptr);
  return true;
}

/// The exponent that a gAMA chunk asks for; 0 where it, or its absence, means the sRGB curve.
double decode_gamma(const ReadState& s) {
  int intent = 0;
  double file_gamma = 0;
  if (png_get_sRGB(s.png, s.info, &intent) != 0)
    return 0;
  if (png_get_gAMA(s.png, s.info, &file_gamma) == 0 || file_gamma <= 0)
    return 0;
  return std::abs(file_gamma - 1 / 2.2) < 1e-3 ? 0 : 1 / file_gamma;
}

[[noreturn]] void fail(const std::string& message, const std::string& name) {
  throw Error("not a valid PNG file: " + message, {name});
}

void describe(ReadState& s, const std::string& name) {
  Bitmap& bitmap = s.out.bitmap;
  const auto width = png_get_image_width(s.png, s.info),
             height = png_get_image_height(s.png, s.info);
  check_image_size(width, height, name);
  bitmap.width = static_cast<int>(width), bitmap.height = static_cast<int>(height);
  bitmap.channels = png_get_channels(s.png, s.info);
  bitmap.type = png_get_bit_depth(s.png, s.info) == 16 ? Bitmap::Type::u16 : Bitmap::Type::u8;
  bitmap.srgb_encoded = true;
  bitmap.channel_names = (s.colour_type & PNG_COLOR_MASK_COLOR) != 0
                             ? std::vector<std::string>{"R", "G", "B"}
                             : std::vector<std::string>{"Y"};
  if ((s.colour_type & PNG_COLOR_MASK_ALPHA) != 0)
    bitmap.channel_names.push_back("A");
  s.out.decode_gamma = decode_gamma(s);
}

/// Rows of 8-bit sRGB, alpha linear.
void fill_row(const Image& image, int y, double exposure, std::vector<std::uint8_t>& row) {
  const std::size_t n = image.channels.size();
  for (std::size_t i = 0; i < row.size(); ++i) {
    const float v = image.data[image.offset(0, y) + i];
    row[i] = image.channels[i % n] == "A" ? to_u8(v) : linear_to_srgb8(v, exposure);
  }
}

bool write_start(WriteState& s, int width, int height, int colour_type) {
  if (setjmp(png_jmpbuf(s.png)))
    return false;
  png_set_write_fn(s.png, &s, on_write, on_flush);
  png_set_user_limits(s.png, kMaxDimension, kMaxDimension);
  png_set_compression_level(s.png, 6);
  png_set_IHDR(s.png, s.info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
               colour_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(s.png, s.info, PNG_sRGB_INTENT_RELATIVE);
  png_write_info(s.png, s.info);
  return true;
}

bool write_row(WriteState& s) {
  if (setjmp(png_jmpbuf(s.png)))
    return false;
  png_write_row(s.png, s.row.data());
  return true;
}

bool write_end(WriteState& s) {
  if (setjmp(png_jmpbuf(s.png)))
    return false;
  png_write_end(s.png, s.info);
  return true;
}

} // namespace

bool is_png(View file) {
  return file.size() >= 8 && png_sig_cmp(file.data(), 0, 8) == 0;
}

Decoded read_png(View file, const std::string& name) {
  ReadState s;
  s.file = file;
  s.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &s, on_error<ReadState>, on_warning);
  if (s.png != nullptr)
    s.info = png_create_info_struct(s.png);
  if (s.info == nullptr)
    throw Error("libpng cannot start", {name});
  if (!read_info(s))
    fail(s.message, name);
  describe(s, name);
  const std::size_t rows = std::size_t(s.out.bitmap.height), size = s.row_bytes * rows;
  // Deflate shrinks by 1032 at the very most.
  if (s.stored_row_bytes * rows / 1032 > file.size())
    fail("the file is far too short for its size", name);
  s.out.bitmap.bytes.resize(size);
  for (std::size_t y = 0; y < rows; ++y)
    s.rows.push_back(s.out.bitmap.bytes.data() + y * s.row_bytes);
  if (!read_rows(s))
    fail(s.message, name);
  return std::move(s.out);
}

Bytes write_png(const Image& image, const WriteOptions& options, const std::string& name) {
  const Image out = picture_channels(image, true);
  const bool colour = out.find_channel("R").has_value(), alpha = out.find_channel("A").has_value();
  WriteState s;
  s.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &s, on_error<WriteState>, on_warning);
  if (s.png != nullptr)
    s.info = png_create_info_struct(s.png);
  if (s.info == nullptr)
    throw Error("libpng cannot start", {name});
  s.row.resize(std::size_t(out.width) * out.channels.size());
  bool ok = write_start(s, out.width, out.height,
                        (colour ? PNG_COLOR_MASK_COLOR : 0) | (alpha ? PNG_COLOR_MASK_ALPHA : 0));
  for (int y = 0; ok && y < out.height; ++y) {
    fill_row(out, y, options.exposure, s.row);
    ok = write_row(s);
  }
  if (!ok || !write_end(s))
    throw Error("cannot encode the PNG: " + s.message, {name});
  return std::move(s.bytes);
}

} // namespace faceta::codec
