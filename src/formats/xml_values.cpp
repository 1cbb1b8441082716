#include "formats/xml_values.h"

#include "formats/xml_source.h"

#include <algorithm>
#include <charconv>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace faceta::xml {

namespace {

constexpr size_t kMaxSpectrumBytes = size_t{16} << 20;

bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_space(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && is_space(text.back()))
    text.remove_suffix(1);
  return text;
}

bool equals_ignoring_case(std::string_view text, std::string_view lower) {
  if (text.size() != lower.size())
    return false;
  for (size_t i = 0; i < text.size(); ++i)
    if ((text[i] >= 'A' && text[i] <= 'Z' ? text[i] + ('a' - 'A') : text[i]) != lower[i])
      return false;
  return true;
}

/// from_chars leaves the value alone when it is out of range; strtod says whether inf or zero.
double out_of_range_value(std::string_view text) {
  static const locale_t c_locale = newlocale(LC_ALL_MASK, "C", nullptr);
  return strtod_l(std::string(text).c_str(), nullptr, c_locale);
}

SpectrumValue checked(SpectrumValue spectrum, const SourcePosition& where) {
  if (spectrum.values.size() < 2)
    throw Error(fmt::format("a spectrum of wavelength:value pairs needs at least 2 of them, not {}",
                            spectrum.values.size()),
                where, "a uniform spectrum is one number without wavelength");
  for (size_t i = 0; i < spectrum.wavelengths.size(); ++i) {
    if (!std::isfinite(spectrum.wavelengths[i]))
      throw Error("a wavelength of the spectrum is not finite", where);
    if (i > 0 && spectrum.wavelengths[i] <= spectrum.wavelengths[i - 1])
      throw Error(fmt::format("wavelengths of the spectrum must increase, but {} follows {}",
                              spectrum.wavelengths[i], spectrum.wavelengths[i - 1]),
                  where);
  }
  return spectrum;
}

Numbers3 cross(const Numbers3& a, const Numbers3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Numbers3 normalize(const Numbers3& v) {
  double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

/// The first tangent of the basis by Duff et al. 2017, "Building an orthonormal basis, revisited".
Numbers3 any_perpendicular(const Numbers3& n) {
  double sign = std::copysign(1.0, n[2]);
  double a = -1 / (sign + n[2]);
  return {1 + sign * n[0] * n[0] * a, sign * n[0] * n[1] * a, -sign * n[0]};
}

} // namespace

std::optional<double> parse_number(std::string_view text) {
  text = trim(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+')
    text.remove_prefix(1);
  // from_chars would take nan(payload)
  if (text.empty() || text.find('(') != text.npos)
    return {};
  double value = 0;
  auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument)
    return {};
  return error == std::errc::result_out_of_range ? out_of_range_value(text) : value;
}

std::optional<int64_t> parse_integer(std::string_view text) {
  text = trim(text);
  int64_t value = 0;
  auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    return {};
  return value;
}

std::optional<bool> parse_boolean(std::string_view text) {
  if (equals_ignoring_case(text, "true"))
    return true;
  if (equals_ignoring_case(text, "false"))
    return false;
  return {};
}

std::vector<std::string_view> split_list(std::string_view text) {
  std::vector<std::string_view> pieces;
  size_t begin = text.find_first_not_of(", ");
  while (begin != text.npos) {
    size_t end = std::min(text.find_first_of(", ", begin), text.size());
    pieces.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(", ", end);
  }
  return pieces;
}

std::vector<double> parse_numbers(std::string_view text, const SourcePosition& where) {
  std::vector<double> numbers;
  for (std::string_view piece : split_list(text)) {
    std::optional<double> number = parse_number(piece);
    if (!number)
      throw Error(fmt::format("'{}' is not a number", piece.substr(0, 80)), where,
                  "numbers are separated by commas or spaces");
    numbers.push_back(*number);
  }
  return numbers;
}

SpectrumValue parse_spectrum(std::string_view text, const SourcePosition& where) {
  SpectrumValue spectrum;
  std::vector<std::string_view> pieces = split_list(text);
  if (pieces.size() == 1 && pieces[0].find(':') == std::string_view::npos) {
    spectrum.values = parse_numbers(text, where);
    return spectrum;
  }
  for (std::string_view piece : pieces) {
    size_t colon = piece.find(':');
    std::optional<double> wavelength = parse_number(piece.substr(0, colon)), value;
    if (colon != piece.npos)
      value = parse_number(piece.substr(colon + 1));
    if (!wavelength || !value)
      throw Error(fmt::format("'{}' is not a wavelength:value pair", piece.substr(0, 80)), where,
                  "write one number, or pairs such as 400:0.1, 700:0.2");
    spectrum.wavelengths.push_back(*wavelength);
    spectrum.values.push_back(*value);
  }
  return checked(std::move(spectrum), where);
}

SpectrumValue read_spectrum_file(const std::filesystem::path& path, const SourcePosition& where,
                                 const Warn& warn) {
  std::string text = read_text_file(path, kMaxSpectrumBytes, where);
  std::string_view rest = text;
  if (rest.starts_with("\xEF\xBB\xBF"))
    rest.remove_prefix(3);
  SpectrumValue spectrum;
  bool warned = false;
  for (int line_number = 1; !rest.empty(); ++line_number) {
    size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    line = trim(line.substr(0, line.find('#')));
    if (line.empty())
      continue;
    std::vector<std::string_view> columns;
    while (!line.empty() && columns.size() < 3) {
      size_t stop = std::min(line.find_first_of(" \t\r\v\f"), line.size());
      columns.push_back(line.substr(0, stop));
      line = trim(line.substr(stop));
    }
    std::optional<double> wavelength = parse_number(columns[0]), value;
    if (columns.size() > 1)
      value = parse_number(columns[1]);
    if (!wavelength || !value)
      throw Error("not a line of a spectrum", {path.string(), line_number, 1},
                  "a line is: wavelength in nm, white space, value");
    if (columns.size() > 2 && !warned && warn) {
      warn(fmt::format("{}:{}:1: warning: only the first two columns of a spectrum file are read",
                       path.string(), line_number));
      warned = true;
    }
    spectrum.wavelengths.push_back(*wavelength);
    spectrum.values.push_back(*value);
  }
  return checked(std::move(spectrum), {path.string()});
}

Matrix4 multiply(const Matrix4& a, const Matrix4& b) {
  Matrix4 product{};
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      for (int k = 0; k < 4; ++k)
        product[4 * row + column] += a[4 * row + k] * b[4 * k + column];
  return product;
}

Matrix4 translation(const Numbers3& offset) {
  Matrix4 m = kIdentity;
  for (int i = 0; i < 3; ++i)
    m[4 * i + 3] = offset[i];
  return m;
}

Matrix4 scaling(const Numbers3& factors) {
  Matrix4 m = kIdentity;
  for (int i = 0; i < 3; ++i)
    m[5 * i] = factors[i];
  return m;
}

Matrix4 rotation(const Numbers3& axis, double degrees) {
  double radians = degrees * (M_PI / 180), c = std::cos(radians), s = std::sin(radians);
  Matrix4 m = kIdentity;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      m[4 * row + column] = axis[row] * axis[column] * (1 - c) + (row == column ? c : 0);
  m[1] -= axis[2] * s, m[4] += axis[2] * s;
  m[2] += axis[1] * s, m[8] -= axis[1] * s;
  m[6] -= axis[0] * s, m[9] += axis[0] * s;
  return m;
}

std::optional<Matrix4> look_at(const Numbers3& origin, const Numbers3& target, Numbers3 up) {
  Numbers3 direction =
      normalize({target[0] - origin[0], target[1] - origin[1], target[2] - origin[2]});
  if (up == Numbers3{0, 0, 0})
    up = any_perpendicular(direction);
  Numbers3 left = normalize(cross(up, direction));
  up = cross(direction, left);
  Matrix4 m = kIdentity;
  for (int i = 0; i < 3; ++i) {
    m[4 * i] = left[i];
    m[4 * i + 1] = up[i];
    m[4 * i + 2] = direction[i];
    m[4 * i + 3] = origin[i];
  }
  for (double element : m)
    if (!std::isfinite(element))
      return {};
  return m;
}

} // namespace faceta::xml
