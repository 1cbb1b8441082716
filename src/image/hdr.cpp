#include "base/error.h"
#include "image/codecs.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

/// Radiance pictures: G. Ward, "Real Pixels", Graphics Gems II (1991), and the Radiance file format
/// notes (Lawrence Berkeley National Laboratory, "filefmts").
namespace faceta::codec {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

constexpr std::size_t kAlwaysFinePixels = std::size_t(1) << 22, kPixelsPerByte = 1024;

struct Header {
  bool xyz = false;
  Metadata metadata;
  /// The slow axis first, as in the resolution line: its letter, sign and length, then the fast
  /// one.
  char slow_axis = 'Y', fast_axis = 'X';
  bool slow_down = true, fast_right = true;
  int slow = 0, fast = 0;
};

class Reader {
public:
  Reader(View file, const std::string& name) : file_(file), name_(name) {}

  std::string_view line() {
    const auto rest = file_.subspan(at_);
    const auto end = std::find(rest.begin(), rest.end(), '\n');
    if (end == rest.end())
      truncated();
    const auto length = static_cast<std::size_t>(end - rest.begin());
    at_ += length + 1;
    std::string_view text(reinterpret_cast<const char*>(rest.data()), length);
    if (text.ends_with('\r'))
      text.remove_suffix(1);
    return text;
  }
  std::uint8_t byte() {
    if (at_ >= file_.size())
      truncated();
    return file_[at_++];
  }
  Rgbe pixel() {
    if (file_.size() - at_ < 4)
      truncated();
    Rgbe p;
    std::memcpy(p.data(), file_.data() + at_, 4);
    at_ += 4;
    return p;
  }
  std::size_t left() const { return file_.size() - at_; }
  void back(std::size_t bytes) { at_ -= bytes; }

  [[noreturn]] void truncated() const { throw Error("the Radiance file is truncated", {name_}); }
  [[noreturn]] void malformed(const std::string& what) const {
    throw Error("malformed Radiance file: " + what, {name_});
  }

private:
  View file_;
  std::size_t at_ = 0;
  const std::string& name_;
};

void read_variable(std::string_view line, Header& header, Reader& in) {
  const auto equals = line.find('=');
  if (line.starts_with('#') || equals == std::string_view::npos)
    return;
  const std::string key(line.substr(0, equals)), value(line.substr(equals + 1));
  if (key == "FORMAT") {
    header.xyz = value == "32-bit_rle_xyze";
    if (!header.xyz && value != "32-bit_rle_rgbe")
      in.malformed(fmt::format("FORMAT={} is neither 32-bit_rle_rgbe nor 32-bit_rle_xyze", value));
  } else if (key == "EXPOSURE") {
    // Several lines multiply, says the format.
    double factor = 1;
    std::string_view digits(value);
    while (digits.starts_with(' '))
      digits.remove_prefix(1);
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), factor);
    if (result.ec != std::errc())
      in.malformed(fmt::format("EXPOSURE={} is no number", value));
    const auto [it, fresh] = header.metadata.try_emplace(key, factor);
    if (!fresh)
      std::get<double>(it->second) *= factor;
  } else if (header.metadata.size() < 1000) {
    header.metadata[key] = value;
  }
}

/// "-Y 480 +X 640" and the seven other orientations.
void read_resolution(std::string_view line, Header& header, Reader& in) {
  const auto wrong = [&] {
    in.malformed(
        fmt::format("'{}' is no resolution line such as '-Y 480 +X 640'", line.substr(0, 80)));
  };
  const auto axis = [&](char& letter, bool& plus, int& length) {
    if (line.size() < 4 || (line[0] != '+' && line[0] != '-') ||
        (line[1] != 'X' && line[1] != 'Y') || line[2] != ' ')
      wrong();
    plus = line[0] == '+', letter = line[1];
    const auto [end, code] = std::from_chars(line.data() + 3, line.data() + line.size(), length);
    if (code != std::errc())
      wrong();
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    while (line.starts_with(' '))
      line.remove_prefix(1);
  };
  bool plus = false;
  axis(header.slow_axis, plus, header.slow);
  header.slow_down = header.slow_axis == 'Y' ? !plus : plus;
  axis(header.fast_axis, plus, header.fast);
  header.fast_right = header.fast_axis == 'X' ? plus : !plus;
  if (!line.empty() || header.slow_axis == header.fast_axis)
    wrong();
}

Header read_header(Reader& in) {
  Header header;
  in.line(); // the magic "#?RADIANCE" or "#?RGBE"
  for (auto line = in.line(); !line.empty(); line = in.line())
    read_variable(line, header, in);
  read_resolution(in.line(), header, in);
  return header;
}

/// The four bytes of all pixels separately, each as runs (count > 128: count - 128 copies) and
/// literals.
void read_separated(Reader& in, std::vector<Rgbe>& scanline) {
  for (std::size_t part = 0; part < 4; ++part)
    for (std::size_t x = 0; x < scanline.size();) {
      const std::uint8_t code = in.byte();
      const bool run = code > 128;
      const std::size_t count = run ? code - 128u : code;
      if (count == 0 || x + count > scanline.size())
        in.malformed("a run does not fit its scan line");
      const std::uint8_t value = run ? in.byte() : 0;
      for (std::size_t i = 0; i < count; ++i)
        scanline[x++][part] = run ? value : in.byte();
    }
}

/// Whole pixels, where the mantissas 1, 1, 1 repeat the pixel before: exponent times, successive
/// repeats being digits of base 256, lowest first.
void read_whole(Reader& in, std::vector<Rgbe>& scanline) {
  int shift = 0;
  for (std::size_t x = 0; x < scanline.size();) {
    const Rgbe p = in.pixel();
    if (p[0] != 1 || p[1] != 1 || p[2] != 1) {
      scanline[x++] = p;
      shift = 0;
      continue;
    }
    const std::size_t count = shift < 24 ? std::size_t(p[3]) << shift : scanline.size() + 1;
    if (x == 0 || x + count > scanline.size())
      in.malformed("a run does not fit its scan line");
    const Rgbe last = scanline[x - 1];
    std::fill_n(scanline.begin() + static_cast<std::ptrdiff_t>(x), count, last);
    x += count;
    shift += 8;
  }
}

void read_scanline(Reader& in, std::vector<Rgbe>& scanline) {
  if (scanline.size() >= 8 && scanline.size() < 32768) {
    const Rgbe start = in.pixel();
    if (start[0] == 2 && start[1] == 2 && start[2] < 128) {
      if (std::size_t(start[2]) * 256 + start[3] != scanline.size())
        in.malformed("a scan line has another length than the picture");
      read_separated(in, scanline);
      return;
    }
    in.back(4);
  }
  read_whole(in, scanline);
}

void store(const std::vector<Rgbe>& scanline, std::vector<float>& out) {
  for (const Rgbe& p : scanline) {
    const float scale = p[3] == 0 ? 0 : std::ldexp(1.0f, p[3] - 136);
    for (std::size_t c = 0; c < 3; ++c)
      out.push_back(static_cast<float>(p[c]) * scale);
  }
}

/// Brings the values, stored in the file's order, to rows from the top, left to right.
void orient(const Header& header, const std::vector<float>& in, Bitmap& bitmap) {
  bitmap.bytes.resize(in.size() * 4);
  for (int s = 0; s < header.slow; ++s)
    for (int f = 0; f < header.fast; ++f) {
      const int slow = header.slow_down ? s : header.slow - 1 - s;
      const int fast = header.fast_right ? f : header.fast - 1 - f;
      const bool rows = header.slow_axis == 'Y';
      const std::size_t x = std::size_t(rows ? fast : slow), y = std::size_t(rows ? slow : fast);
      const std::size_t from = (std::size_t(s) * std::size_t(header.fast) + std::size_t(f)) * 3;
      std::memcpy(bitmap.bytes.data() + (y * std::size_t(bitmap.width) + x) * 12, in.data() + from,
                  12);
    }
}

Rgbe encode(const float* rgb) {
  std::array<double, 3> v{};
  for (std::size_t c = 0; c < 3; ++c)
    v[c] = rgb[c] > 0 ? std::min(static_cast<double>(rgb[c]), 1e38) : 0; // NaN becomes 0
  const double largest = std::max({v[0], v[1], v[2]});
  if (largest < 1e-38)
    return {0, 0, 0, 0};
  int exponent = 0;
  std::frexp(largest, &exponent);
  // Rounding to nearest may carry the largest mantissa to 256: then one exponent higher.
  if (std::lround(std::ldexp(largest, 8 - exponent)) > 255)
    ++exponent;
  Rgbe out{};
  for (std::size_t c = 0; c < 3; ++c)
    out[c] = static_cast<std::uint8_t>(std::lround(std::ldexp(v[c], 8 - exponent)));
  out[3] = static_cast<std::uint8_t>(exponent + 128);
  return out;
}

void write_part(const std::vector<Rgbe>& scanline, std::size_t part, Bytes& out) {
  const std::size_t n = scanline.size();
  const auto run_at = [&](std::size_t x) {
    std::size_t length = 1;
    while (x + length < n && length < 127 && scanline[x + length][part] == scanline[x][part])
      ++length;
    return length;
  };
  for (std::size_t x = 0; x < n;) {
    const std::size_t run = run_at(x);
    if (run >= 3) {
      out.push_back(static_cast<std::uint8_t>(128 + run));
      out.push_back(scanline[x][part]);
      x += run;
      continue;
    }
    const std::size_t begin = x;
    while (x < n && x - begin < 128 && run_at(x) < 3)
      ++x;
    out.push_back(static_cast<std::uint8_t>(x - begin));
    for (std::size_t i = begin; i < x; ++i)
      out.push_back(scanline[i][part]);
  }
}

} // namespace

bool is_hdr(View file) {
  return file.size() >= 2 && file[0] == '#' && file[1] == '?';
}

Decoded read_hdr(View file, const std::string& name) {
  Reader in(file, name);
  const Header header = read_header(in);
  check_image_size(header.slow, header.fast, name);
  // A run-length encoded scan line takes 4 bytes at the very least.
  if (in.left() / 4 < std::size_t(header.slow))
    in.truncated();
  // Separated runs shrink 64-fold at most; repeats of whole pixels nearly without bound, so a
  // generous figure that still stops a small file from asking for gigabytes.
  const std::size_t pixels = std::size_t(header.slow) * std::size_t(header.fast);
  if (pixels > kAlwaysFinePixels + kPixelsPerByte * in.left())
    in.malformed(fmt::format("{} bytes cannot hold {} pixels", in.left(), pixels));
  std::vector<float> values;
  std::vector<Rgbe> scanline(std::size_t(header.fast));
  for (int s = 0; s < header.slow; ++s) {
    read_scanline(in, scanline);
    store(scanline, values);
  }
  Decoded out;
  Bitmap& bitmap = out.bitmap;
  const bool rows = header.slow_axis == 'Y';
  bitmap.width = rows ? header.fast : header.slow;
  bitmap.height = rows ? header.slow : header.fast;
  bitmap.channels = 3;
  bitmap.channel_names = header.xyz ? std::vector<std::string>{"X", "Y", "Z"}
                                    : std::vector<std::string>{"R", "G", "B"};
  bitmap.type = Bitmap::Type::f32;
  orient(header, values, bitmap);
  out.metadata = header.metadata;
  return out;
}

Bytes write_hdr(const Image& image, const std::string&) {
  const Image out = picture_channels(image, false).rgb();
  const std::string header =
      fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", out.height, out.width);
  Bytes bytes(header.begin(), header.end());
  const bool encoded = out.width >= 8 && out.width < 32768;
  std::vector<Rgbe> scanline(std::size_t(out.width));
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x)
      scanline[std::size_t(x)] = encode(out.data.data() + out.offset(x, y));
    if (encoded) {
      bytes.insert(bytes.end(), {2, 2, static_cast<std::uint8_t>(out.width >> 8),
                                 static_cast<std::uint8_t>(out.width & 255)});
      for (std::size_t part = 0; part < 4; ++part)
        write_part(scanline, part, bytes);
    } else {
      // The largest mantissa is 128 or more, so no pixel can be mistaken for a repeat.
      for (const Rgbe& p : scanline)
        bytes.insert(bytes.end(), p.begin(), p.end());
    }
  }
  return bytes;
}

} // namespace faceta::codec
