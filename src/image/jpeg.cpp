#include "base/error.h"
#include "image/codecs.h"

#include <algorithm>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>

// clang-format off: the second needs the first
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

/// libjpeg reports errors by longjmp, which must not skip a destructor: everything with one lives
/// in State, outside the functions that call setjmp.
namespace faceta::codec {
namespace {

/// A progressive file of a few kilobytes can ask for thousands of passes over a huge picture; real
/// ones have about ten. Few are allowed where a pass takes seconds.
constexpr std::int64_t kMaxScans = 200, kScansOfAnySize = 20,
                       kMaxScannedPixels = std::int64_t(1) << 32;

struct State {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf jump{};
  char message[JMSG_LENGTH_MAX] = "";
  Bitmap bitmap;
  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { jpeg_destroy_decompress(&jpeg); }
};

State& state_of(j_common_ptr jpeg) {
  return *static_cast<State*>(jpeg->client_data);
}

[[noreturn]] void on_error(j_common_ptr jpeg) {
  State& s = state_of(jpeg);
  jpeg->err->format_message(jpeg, s.message);
  std::longjmp(s.jump, 1);
}

/// libjpeg fills what is missing with grey and only warns; a picture half of which was invented is
/// an error here.
void on_message(j_common_ptr jpeg, int level) {
  if (level >= 0)
    return;
  switch (jpeg->err->msg_code) {
  case JWRN_JPEG_EOF:
  case JWRN_HIT_MARKER:
  case JWRN_HUFF_BAD_CODE:
  case JWRN_ARITH_BAD_CODE:
  case JWRN_BOGUS_PROGRESSION:
  case JWRN_MUST_RESYNC:
    on_error(jpeg);
  default:
    break;
  }
}
void on_output(j_common_ptr) {}

void on_progress(j_common_ptr jpeg) {
  State& s = state_of(jpeg);
  const std::int64_t pixels = std::int64_t(s.jpeg.image_width) * s.jpeg.image_height;
  const int limit =
      static_cast<int>(std::clamp(kMaxScannedPixels / pixels, kScansOfAnySize, kMaxScans));
  if (s.jpeg.input_scan_number <= limit)
    return;
  std::snprintf(s.message, sizeof s.message, "it has more than %d scans", limit);
  std::longjmp(s.jump, 1);
}

bool read_header(State& s, View file) {
  if (setjmp(s.jump))
    return false;
  jpeg_create_decompress(&s.jpeg);
  s.jpeg.client_data = &s;
  s.jpeg.progress = &s.progress;
  jpeg_mem_src(&s.jpeg, file.data(), static_cast<unsigned long>(file.size()));
  jpeg_read_header(&s.jpeg, TRUE);
  return true;
}

bool read_rows(State& s) {
  if (setjmp(s.jump))
    return false;
  s.jpeg.dct_method = JDCT_ISLOW;
  jpeg_start_decompress(&s.jpeg);
  const std::size_t row = std::size_t(s.jpeg.output_width) * std::size_t(s.jpeg.output_components);
  while (s.jpeg.output_scanline < s.jpeg.output_height) {
    JSAMPROW at = s.bitmap.bytes.data() + row * s.jpeg.output_scanline;
    jpeg_read_scanlines(&s.jpeg, &at, 1);
  }
  jpeg_finish_decompress(&s.jpeg);
  return true;
}

[[noreturn]] void fail(const std::string& message, const std::string& name) {
  throw Error("not a readable JPEG file: " + message, {name});
}

/// Chooses grey or RGB and checks the claimed size before anything of that size is allocated.
void prepare(State& s, View file, const std::string& name) {
  check_image_size(s.jpeg.image_width, s.jpeg.image_height, name);
  if (s.jpeg.jpeg_color_space == JCS_CMYK || s.jpeg.jpeg_color_space == JCS_YCCK)
    fail("its colours are CMYK (convert it to RGB)", name);
  const bool grey = s.jpeg.num_components == 1;
  if (!grey && s.jpeg.num_components != 3)
    fail(fmt::format("it has {} components, not 1 or 3", s.jpeg.num_components), name);
  s.jpeg.out_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
  // Huffman coding spends at least a bit on each block of 8 x 8 pixels; arithmetic coding can do
  // with a small fraction of that.
  const std::size_t pixels = std::size_t(s.jpeg.image_width) * s.jpeg.image_height;
  const std::size_t per_byte = 8 * 64 * (s.jpeg.arith_code ? 64u : 1u);
  if (pixels / per_byte > file.size())
    fail("the file is far too short for its size", name);
  s.bitmap.width = static_cast<int>(s.jpeg.image_width);
  s.bitmap.height = static_cast<int>(s.jpeg.image_height);
  s.bitmap.channels = grey ? 1 : 3;
  s.bitmap.channel_names =
      grey ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  s.bitmap.srgb_encoded = true;
  s.bitmap.bytes.resize(pixels * std::size_t(s.bitmap.channels));
}

} // namespace

bool is_jpeg(View file) {
  return file.size() >= 3 && file[0] == 0xff && file[1] == 0xd8 && file[2] == 0xff;
}

Decoded read_jpeg(View file, const std::string& name) {
  State s;
  s.jpeg.err = jpeg_std_error(&s.errors);
  s.errors.error_exit = on_error;
  s.errors.emit_message = on_message;
  s.errors.output_message = on_output;
  s.progress.progress_monitor = on_progress;
  s.jpeg.client_data = &s;
  if (!read_header(s, file))
    fail(s.message, name);
  prepare(s, file, name);
  if (!read_rows(s))
    fail(s.message, name);
  Decoded out;
  out.bitmap = std::move(s.bitmap);
  return out;
}

} // namespace faceta::codec
