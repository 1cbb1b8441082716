#include "formats/measured_common.h"
#include "formats/measured_lattice.h"
#include "formats/measured_text.h"
#include "formats/measured_text_formats.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <numbers>

namespace faceta {

namespace {

constexpr double kPi = std::numbers::pi;

struct Header {
  int in = 0, out = 0, intervals = 0; ///< #DIM, #VS
  std::string param_in, param_out;
  bool binary = false, little_endian = true;
  int64_t sample_count = -1;
  const char* where_in = nullptr;
  const char* where_out = nullptr;
  const char* where_dim = nullptr;
};

/// A pair of directions in the order of ALTA: the viewer first.
struct Pair {
  double view[3], light[3];
};

void set_spherical(double (&out)[3], double theta, double phi) {
  out[0] = std::sin(theta) * std::cos(phi);
  out[1] = std::sin(theta) * std::sin(phi);
  out[2] = std::cos(theta);
}

/// Both directions of a half vector and a difference vector (Rusinkiewicz 1998).
Pair from_half(double theta_h, double phi_h, double theta_d, double phi_d) {
  double h[3];
  set_spherical(h, theta_h, phi_h);
  double d[3];
  set_spherical(d, theta_d, phi_d);
  double x = d[0] * std::cos(theta_h) + d[2] * std::sin(theta_h);
  double z = -d[0] * std::sin(theta_h) + d[2] * std::cos(theta_h);
  Pair out{};
  out.view[0] = x * std::cos(phi_h) - d[1] * std::sin(phi_h);
  out.view[1] = x * std::sin(phi_h) + d[1] * std::cos(phi_h);
  out.view[2] = z;
  for (int k = 0; k < 3; ++k)
    out.light[k] = 2 * std::cos(theta_d) * h[k] - out.view[k];
  return out;
}

double acos_clamped(double x) {
  return std::acos(std::clamp(x, -1.0, 1.0));
}

/// How a parametrisation of ALTA turns into directions (params.h of ALTA 1.0).
struct Parametrisation {
  const char* name;
  int dimension;
  bool isotropic;
  Pair (*directions)(const double* x);
};

const Parametrisation kParametrisations[] = {
    {"RUSIN_TH_PH_TD_PD", 4, false,
     [](const double* x) { return from_half(x[0], x[1], x[2], x[3]); }},
    {"RUSIN_TH_TD_PD", 3, true, [](const double* x) { return from_half(x[0], 0, x[1], x[2]); }},
    {"RUSIN_TH_TD", 2, true, [](const double* x) { return from_half(x[0], 0, x[1], kPi / 2); }},
    {"COS_TH_TD", 2, true,
     [](const double* x) { return from_half(acos_clamped(x[0]), 0, acos_clamped(x[1]), kPi / 2); }},
    {"COS_TH", 1, true, [](const double* x) { return from_half(acos_clamped(x[0]), 0, 0, 0); }},
    {"SPHERICAL_TL_PL_TV_PV", 4, false,
     [](const double* x) {
       Pair p{};
       set_spherical(p.light, x[0], x[1]);
       set_spherical(p.view, x[2], x[3]);
       return p;
     }},
    {"ISOTROPIC_TV_TL_DPHI", 3, true,
     [](const double* x) {
       Pair p{};
       set_spherical(p.view, x[0], 0);
       set_spherical(p.light, x[1], x[2]);
       return p;
     }},
    {"ISOTROPIC_TL_TV_PROJ_DPHI", 3, true,
     [](const double* x) {
       Pair p{};
       set_spherical(p.light, x[0], 0);
       set_spherical(p.view, std::hypot(x[1], x[2]), std::atan2(x[2], x[1]));
       return p;
     }},
    {"ISOTROPIC_TV_PROJ_DPHI", 2, true,
     [](const double* x) {
       Pair p{};
       set_spherical(p.light, 0, 0);
       set_spherical(p.view, std::hypot(x[0], x[1]), std::atan2(x[1], x[0]));
       return p;
     }},
    {"RETRO_TL_TVL_PROJ_DPHI", 3, true,
     [](const double* x) {
       // the viewer, at an angle from the light; azimuth 0 is towards the normal
       double angle = std::hypot(x[1], x[2]), phi = std::atan2(x[2], x[1]);
       Pair p{};
       set_spherical(p.light, x[0], 0);
       double up[3];
       set_spherical(up, x[0] - kPi / 2, 0);
       for (int k = 0; k < 3; ++k)
         p.view[k] = std::cos(angle) * p.light[k] + std::sin(angle) * std::cos(phi) * up[k];
       p.view[1] += std::sin(angle) * std::sin(phi);
       return p;
     }},
    {"CARTESIAN", 6, false,
     [](const double* x) {
       Pair p{};
       std::copy_n(x, 3, p.view);
       std::copy_n(x + 3, 3, p.light);
       return p;
     }},
};

std::string supported_parametrisations() {
  std::string names;
  for (const Parametrisation& p : kParametrisations)
    names += (names.empty() ? "" : ", ") + std::string(p.name);
  return names;
}

Header read_header(TextScanner& scanner, const InputText& input) {
  Header header;
  while (!scanner.at_end() && scanner.peek().starts_with('#')) {
    std::string key(scanner.word().substr(0, 60));
    if (key == "#DIM") {
      header.where_dim = scanner.last();
      header.in = static_cast<int>(scanner.integer("the dimension of the angles", 1, 6));
      header.out = static_cast<int>(scanner.integer("the dimension of the values", 1, 2000));
    } else if (key == "#PARAM_IN") {
      header.param_in = scanner.word().substr(0, 60);
      header.where_in = scanner.last();
    } else if (key == "#PARAM_OUT") {
      header.param_out = scanner.word().substr(0, 60);
      header.where_out = scanner.last();
    } else if (key == "#VS") {
      header.intervals = static_cast<int>(scanner.integer("#VS", 0, 2));
    } else if (key == "#FORMAT") {
      header.binary = scanner.word() == "binary";
    } else if (key == "#ENDIAN") {
      header.little_endian = scanner.word() != "big";
    } else if (key == "#PRECISION") {
      if (scanner.word() != "ieee754-double")
        throw scanner.error("unknown precision", "ieee754-double");
    } else if (key == "#SAMPLE_COUNT") {
      header.sample_count = scanner.integer("#SAMPLE_COUNT", 1, int64_t(1) << 40);
    } else if (key == "#BEGIN_STREAM") {
      break;
    }
    // not next_line(): the bytes behind #BEGIN_STREAM are no text
    while (!scanner.at_line_end())
      scanner.word();
  }
  if (header.where_dim == nullptr)
    throw input.error(scanner.position(), "the line #DIM is missing", "#DIM 3 1");
  return header;
}

struct Rows {
  std::vector<double> numbers; ///< `width` of a row
  size_t width = 0;
  std::vector<const char*> where;
};

Rows read_text_rows(TextScanner& scanner, const Header& header) {
  Rows rows;
  rows.width = static_cast<size_t>(header.in + header.out);
  // ALTA gives an interval for the first value only; two numbers a value are the most there can be
  size_t most = rows.width + (header.intervals > 0 ? 2 * static_cast<size_t>(header.out) : 0);
  while (!scanner.at_end()) {
    if (scanner.peek().starts_with('#')) {
      scanner.next_line();
      continue;
    }
    rows.where.push_back(scanner.position());
    size_t count = 0;
    for (; !scanner.at_line_end(); ++count) {
      double value = scanner.number("a number");
      if (count < rows.width)
        rows.numbers.push_back(value);
    }
    if (count < rows.width || count > most) {
      scanner.move_to(rows.where.back());
      scanner.word();
      throw scanner.error(fmt::format("the row has {} numbers, not {}", count, rows.width));
    }
  }
  return rows;
}

Rows read_binary_rows(TextScanner& scanner, const Header& header, const InputText& input) {
  Rows rows;
  rows.width = static_cast<size_t>(header.in + header.out * (1 + header.intervals));
  const char* start = scanner.last() + std::strlen("#BEGIN_STREAM");
  const char* end = input.text.data() + input.text.size();
  start += start != end && *start == '\r';
  start += start != end && *start == '\n';
  if (header.sample_count < 0)
    throw input.error_at_byte(start, "#SAMPLE_COUNT is missing");
  size_t count = static_cast<size_t>(header.sample_count);
  if (count > static_cast<size_t>(end - start) / (8 * rows.width))
    throw input.error_at_byte(start,
                              fmt::format("{} samples of {} numbers are declared, {} bytes follow",
                                          count, rows.width, end - start));
  rows.numbers.resize(count * rows.width);
  for (size_t i = 0; i < rows.numbers.size(); ++i) {
    uint64_t bits = 0;
    std::memcpy(&bits, start + 8 * i, 8);
    rows.numbers[i] = std::bit_cast<double>(header.little_endian ? bits : __builtin_bswap64(bits));
    if (!std::isfinite(rows.numbers[i]))
      throw input.error_at_byte(start + 8 * i, "a number is not finite");
    if (i % rows.width == 0)
      rows.where.push_back(start + 8 * i);
  }
  return rows;
}

/// Half-angle data keep their own angles if they lie on a grid.
std::optional<MeasuredLattice> half_lattice(const Header& header,
                                            const std::vector<LatticeRow>& rgb, const Rows& rows) {
  bool cosines = header.param_in.starts_with("COS_TH");
  if (!cosines && header.param_in != "RUSIN_TH_TD_PD" && header.param_in != "RUSIN_TH_TD")
    return std::nullopt;
  std::vector<LatticeRow> out = rgb;
  for (size_t i = 0; i < out.size(); ++i) {
    for (int k = 0; k < header.in; ++k) {
      double x = rows.numbers[i * rows.width + static_cast<size_t>(k)];
      out[i].angles[k] = cosines ? acos_clamped(x) : x;
    }
    if (out[i].angles[0] < 0 || out[i].angles[0] > kPi / 2 + 1e-4 || out[i].angles[1] < 0)
      return std::nullopt;
  }
  return lattice_from_rows(MeasuredCoordinates::half_difference, std::move(out), true);
}

MeasuredColumns value_columns(const Header& header, const InputText& input) {
  MeasuredColumns columns;
  const std::string& out = header.param_out;
  if (out == "RGB_COLOR" && header.out == 3)
    columns.kind = MeasuredColumns::kRgb;
  else if (out == "XYZ_COLOR" && header.out == 3)
    columns.kind = MeasuredColumns::kXyz;
  else if ((out == "INV_STERADIAN" || out == "INV_STERADIAN_COSINE_FACTOR") && header.out == 3)
    columns.kind = MeasuredColumns::kRgb;
  else if ((out == "INV_STERADIAN" || out == "INV_STERADIAN_COSINE_FACTOR") && header.out == 1)
    columns.kind = MeasuredColumns::kGrey;
  else
    throw input.error(
        header.where_out == nullptr ? header.where_dim : header.where_out,
        fmt::format("PARAM_OUT '{}' with {} values is not supported", out, header.out),
        "RGB_COLOR or XYZ_COLOR with 3; INV_STERADIAN or "
        "INV_STERADIAN_COSINE_FACTOR with 1 or 3");
  return columns;
}

} // namespace

bool is_alta(std::string_view bytes) {
  return has_line_with(bytes.substr(0, 4096), "#DIM") || bytes.starts_with("#ALTA");
}

MeasuredFile read_alta(const InputText& input, const MeasuredOptions& options) {
  expect_one_material(input, options);
  TextScanner scanner(input, 0);
  Header header = read_header(scanner, input);
  auto found = std::find_if(std::begin(kParametrisations), std::end(kParametrisations),
                            [&](const Parametrisation& p) { return p.name == header.param_in; });
  if (found == std::end(kParametrisations))
    throw input.error(header.where_in == nullptr ? header.where_dim : header.where_in,
                      fmt::format("PARAM_IN '{}' is not supported", header.param_in),
                      supported_parametrisations());
  if (found->dimension != header.in)
    throw input.error(header.where_dim, fmt::format("{} has {} angles, #DIM says {}", found->name,
                                                    found->dimension, header.in));
  MeasuredColors colors(value_columns(header, input), options, input, header.where_dim);
  Rows rows =
      header.binary ? read_binary_rows(scanner, header, input) : read_text_rows(scanner, header);

  MeasuredInfo info;
  info.description = header.param_in + " to " + header.param_out;
  bool with_cosine = header.param_out == "INV_STERADIAN_COSINE_FACTOR";
  std::vector<MeasuredSample> samples;
  std::vector<LatticeRow> half;
  int64_t grazing = 0;
  for (size_t i = 0; i < rows.where.size(); ++i) {
    const double* row = &rows.numbers[i * rows.width];
    Pair p = found->directions(row);
    std::vector<double> values(row + header.in, row + header.in + header.out);
    if (with_cosine)
      for (double& v : values)
        v /= std::max(p.light[2], 1e-3);
    LatticeRow entry{{}, colors.rgb(values.data(), info.negative)};
    half.push_back(entry);
    // pairs below the horizon count in grids of half angles only
    if (p.light[2] < 0 || p.view[2] < 0 || (with_cosine && p.light[2] < 1e-3)) {
      ++grazing;
      continue;
    }
    auto theta = [](const double(&v)[3]) { return std::atan2(std::hypot(v[0], v[1]), v[2]); };
    samples.push_back({theta(p.light), std::atan2(p.light[1], p.light[0]), theta(p.view),
                       std::atan2(p.view[1], p.view[0]), entry.rgb});
  }
  if (with_cosine)
    info.notes.push_back("divided by the cosine of the light");
  if (auto lattice = half_lattice(header, half, rows); lattice && !with_cosine) {
    info.cells = static_cast<int64_t>(half.size());
    info.holes = lattice->holes;
    info.resolution = describe_lattice(lattice->grid);
    info.interpolation = "linear between the measured angles, exact at them";
    info.symmetries = {"isotropic"};
    for (const MeasuredSample& s : samples)
      info.largest_theta = std::max({info.largest_theta, s.theta_i, s.theta_o});
    return {std::move(info), std::move(lattice->grid)};
  }
  if (grazing > 0)
    info.notes.push_back(fmt::format("{} rows at or below the horizon left out", grazing));
  bool isotropic =
      found->isotropic || std::all_of(samples.begin(), samples.end(), [&](const MeasuredSample& s) {
        return s.theta_i < 1e-5 || std::abs(s.phi_i - samples.front().phi_i) < 1e-5;
      });
  return file_from_samples(std::move(info), std::move(samples), isotropic, input);
}

} // namespace faceta
