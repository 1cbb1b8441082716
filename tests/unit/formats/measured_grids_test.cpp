#include "formats/measured_merl.h"
#include "formats/measured_tensor.h"
#include "image/image.h"
#include "image/io.h"
#include "measured_test_tools.h"

using namespace faceta;

namespace {

constexpr double kPi = std::numbers::pi;

// ---------------------------------------------------------------------------------------------
// MERL

std::string merl_header(int32_t a, int32_t b, int32_t c) {
  std::string bytes;
  for (int32_t size : {a, b, c})
    put(bytes, size);
  return bytes;
}

std::string merl_file(int32_t a, int32_t b, int32_t c, double (*raw)(size_t cell, size_t channel)) {
  std::string bytes = merl_header(a, b, c);
  const auto cells = static_cast<size_t>(a * b * c);
  bytes.reserve(bytes.size() + 24 * cells);
  for (size_t channel = 0; channel < 3; ++channel)
    for (size_t i = 0; i < cells; ++i)
      put(bytes, raw(i, channel));
  return bytes;
}

double number_of_cell(size_t cell, size_t channel) {
  return static_cast<double>(cell + channel);
}

// The difference direction and its place in a MERL file, as the format's own page has it.
size_t merl_index(const Direction& wi, const Direction& wo) {
  double hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;
  double length = std::sqrt(hx * hx + hy * hy + hz * hz);
  double theta_h = std::acos(hz / length), phi_h = std::atan2(hy, hx);
  double x = std::cos(phi_h) * wi.x + std::sin(phi_h) * wi.y;
  double dy = -std::sin(phi_h) * wi.x + std::cos(phi_h) * wi.y;
  double dx = std::cos(theta_h) * x - std::sin(theta_h) * wi.z;
  double dz = std::sin(theta_h) * x + std::cos(theta_h) * wi.z;
  double theta_d = std::acos(std::min(dz, 1.0)), phi_d = std::atan2(dy, dx);
  if (phi_d < 0)
    phi_d += kPi;
  auto clamped = [](double v, int n) { return static_cast<size_t>(std::clamp(int(v), 0, n - 1)); };
  return clamped(phi_d / kPi * 180, 180) +
         180 * (clamped(theta_d * 2 / kPi * 90, 90) +
                90 * clamped(std::sqrt(theta_h / (kPi / 2)) * 90, 90));
}

TEST(Merl, CellsLieWhereTheFormatPutsThem) {
  MeasuredGrid grid = parse_grid(merl_file(90, 90, 180, number_of_cell));
  ASSERT_EQ(grid.coordinates, MeasuredCoordinates::half_difference);
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    Direction wi = random_direction(random), wo = random_direction(random);
    size_t index = merl_index(wi, wo);
    // The angles once more, by dot and cross products instead of rotations.
    double hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;
    double h = std::hypot(hx, hy, hz), xy = std::hypot(hx, hy);
    double theta_h = std::atan2(xy, hz);
    double theta_d = std::acos((wi.x * hx + wi.y * hy + wi.z * hz) / h);
    double along_b = (-hy * wi.x + hx * wi.y) / xy;
    double along_t = (hz * (hx * wi.x + hy * wi.y) / xy - xy * wi.z) / h;
    double phi_d = std::atan2(along_b, along_t);
    const float* rgb = cell(grid, {nearest(grid.axes[0], theta_h), nearest(grid.axes[1], theta_d),
                                   nearest(grid.axes[2], phi_d)});
    const double scale[3] = {1 / 1500.0, 1.15 / 1500, 1.66 / 1500};
    for (size_t c = 0; c < 3; ++c)
      ASSERT_FLOAT_EQ(rgb[c], static_cast<float>(static_cast<double>(index + c) * scale[c]));
  }
}

TEST(Merl, NodesAreCentresOrEdges) {
  std::string bytes = merl_file(9, 10, 20, number_of_cell);
  MeasuredGrid centres = parse_grid(bytes);
  EXPECT_TRUE(centres.axes[0].square_root);
  EXPECT_NEAR(centres.axes[0].nodes[4], 0.25 * kPi / 2, 1e-15);
  EXPECT_NEAR(centres.axes[1].nodes[4], 0.45 * kPi / 2, 1e-15);
  EXPECT_NEAR(centres.axes[2].nodes[19], 19.5 / 20 * kPi, 1e-15);
  EXPECT_EQ(centres.axes[2].period, kPi);
  MeasuredOptions options;
  options.merl_nodes = "edges";
  MeasuredGrid edges = parse_grid(bytes, options);
  EXPECT_EQ(edges.axes[0].nodes[0], 0);
  EXPECT_NEAR(edges.axes[0].nodes[3], kPi / 2 / 9, 1e-15);
  EXPECT_NEAR(edges.axes[1].nodes[5], kPi / 4, 1e-15);
  EXPECT_EQ(edges.axes[2].nodes[0], 0);
  EXPECT_EQ(edges.rgb, centres.rgb);
  options.merl_nodes = "middle";
  EXPECT_NE(refusal(bytes, options).find("merl_nodes cannot be 'middle'"), std::string::npos);
}

TEST(Merl, NegativeInAnyChannelIsAHole) {
  MeasuredFile file = parse(merl_file(3, 4, 5, [](size_t cell, size_t channel) {
    if (cell < 3)
      return channel == cell ? -1.0 : 7.0;
    if (cell == 5)
      return channel == 1 ? NAN : 1.0;
    if (cell == 6)
      return channel == 2 ? 1e300 : 1.0;
    return cell == 7 ? 0.0 : 1500.0;
  }));
  const auto& rgb = std::get<MeasuredGrid>(file.data).rgb;
  for (size_t cell : {0, 1, 2, 5, 6})
    EXPECT_TRUE(std::isnan(rgb[3 * cell])) << cell;
  EXPECT_EQ(rgb[3 * 7], 0);
  EXPECT_EQ(rgb[3 * 8 + 1], 1.15f);
  EXPECT_EQ(file.info.holes, 5);
  EXPECT_EQ(file.info.negative, 0);
  EXPECT_EQ(file.info.cells, 60);
}

TEST(Merl, WritesWhatItReads) {
  MeasuredGrid grid = parse_grid(merl_file(90, 90, 180, [](size_t cell, size_t channel) {
    return cell % 7 == 0 ? -1.0 : 0.001 * static_cast<double>(cell % 1000) + double(channel);
  }));
  TemporaryFolder folder;
  std::string path = folder.folder() + "/a.binary";
  write_merl(path, grid);
  EXPECT_EQ(std::filesystem::file_size(path), 34992012u);
  MeasuredFile again = read_measured(path);
  const auto& rgb = std::get<MeasuredGrid>(again.data).rgb;
  ASSERT_EQ(rgb.size(), grid.rgb.size());
  for (size_t i = 0; i < rgb.size(); ++i)
    ASSERT_TRUE(rgb[i] == grid.rgb[i] || (std::isnan(rgb[i]) && std::isnan(grid.rgb[i]))) << i;
  EXPECT_EQ(again.info.holes, (1458000 + 6) / 7);
  MeasuredGrid small = parse_grid(merl_file(3, 4, 5, number_of_cell));
  EXPECT_NE(error_of([&] { write_merl(path, small); }).find("90 x 90 x 180"), std::string::npos);
}

TEST(Merl, RefusesOtherSizes) {
  EXPECT_NE(refusal(merl_header(90, 90, 180) + std::string(100, 'x')).find("34992012 bytes"),
            std::string::npos);
  EXPECT_NE(refusal(merl_header(3, 4, 5) + std::string(1440 - 1, 'x')).find("not a file of"),
            std::string::npos);
  EXPECT_NE(refusal(merl_header(0, 4, 5)).find("not a file of"), std::string::npos);
  EXPECT_NE(refusal(merl_header(-3, -4, 5) + std::string(1440, 'x')).find("not a file of"),
            std::string::npos);
  std::string good = merl_file(3, 4, 5, number_of_cell);
  MeasuredOptions options;
  options.wavelength = 500;
  EXPECT_NE(refusal(good, options).find("no wavelength 500"), std::string::npos);
  options = {};
  options.index = 2;
  EXPECT_NE(refusal(good, options).find("no number 2"), std::string::npos);
  options = {};
  options.utia_color = "linear";
  EXPECT_NE(refusal(good, options).find("for files of format 'utia'"), std::string::npos);
  options = {};
  options.format = "rgl";
  EXPECT_NE(refusal(good, options).find("of format 'merl', not 'rgl'"), std::string::npos);
  damage(good, 2000);
}

// ---------------------------------------------------------------------------------------------
// pBSDF

struct Polarised {
  std::vector<float> theta_h = {0, 0.1f, 0.5f, 1.5f}, theta_d = {0, 0.6f, 1.2f}, phi_d;
  std::vector<uint16_t> wavelengths = {450, 500, 550, 600, 650};
  std::vector<float> mueller;
  uint64_t phis;

  explicit Polarised(size_t n = 9) : phis(n) {
    for (size_t i = 0; i < n; ++i)
      phi_d.push_back(static_cast<float>(-kPi + 2 * kPi * static_cast<double>(i) / 8));
    for (size_t i = 0; i < n * 3 * 4 * 5 * 16; ++i)
      mueller.push_back(i % 16 == 0 ? 0 : -77.0f);
  }
  float& m00(size_t phi, size_t d, size_t h, size_t w) {
    return mueller[16 * (((phi * 3 + d) * 4 + h) * 5 + w)];
  }
  std::string bytes() const {
    auto view = [](const auto& v) {
      return std::string_view(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(v[0]));
    };
    using enum TensorType;
    TemporaryFolder folder;
    std::string path = folder.folder() + "/a.pbsdf";
    write_tensor_file(path, {{"theta_h", f32, {1, 4}, view(theta_h)},
                             {"theta_d", f32, {1, 3}, view(theta_d)},
                             {"phi_d", f32, {1, phis}, view(phi_d)},
                             {"wvls", u16, {wavelengths.size()}, view(wavelengths)},
                             {"M", f32, {phis, 3, 4, 5, 4, 4}, view(mueller)}});
    return read_whole_file(path);
  }
};

TEST(Pbsdf, TurnsTheAxesAround) {
  Polarised file;
  auto value = [](size_t phi, size_t d, size_t h) {
    return static_cast<float>(phi % 8 + 10 * d + 100 * h) + 1;
  };
  for (size_t phi = 0; phi < 9; ++phi)
    for (size_t d = 0; d < 3; ++d)
      for (size_t h = 0; h < 4; ++h)
        for (size_t w = 0; w < 5; ++w)
          file.m00(phi, d, h, w) = value(phi, d, h);
  file.m00(2, 1, 3, 4) = NAN;
  file.m00(3, 2, 1, 0) = -INFINITY;
  MeasuredFile read = parse(file.bytes());
  const auto& grid = std::get<MeasuredGrid>(read.data);
  EXPECT_EQ(read.info.format, "pbsdf");
  EXPECT_EQ(read.info.holes, 2);
  EXPECT_EQ(read.info.wavelengths, (std::vector<double>{450, 500, 550, 600, 650}));
  ASSERT_EQ(grid.axes.size(), 3u);
  // The nodes at -pi and pi are one direction.
  EXPECT_EQ(grid.axes[2].nodes.size(), 8u);
  EXPECT_EQ(grid.axes[2].period, 2 * kPi);
  EXPECT_EQ(grid.axes[0].nodes[2], 0.5);
  EXPECT_EQ(grid.axes[1].nodes[1], double(0.6f));
  for (size_t h = 0; h < 4; ++h)
    for (size_t d = 0; d < 3; ++d)
      for (size_t phi = 0; phi < 8; ++phi) {
        const float* rgb = cell(grid, {h, d, phi});
        bool hole = (phi == 2 && d == 1 && h == 3) || (phi == 3 && d == 2 && h == 1);
        if (hole)
          EXPECT_TRUE(std::isnan(rgb[0]));
        else
          for (size_t c = 0; c < 3; ++c)
            EXPECT_FLOAT_EQ(rgb[c], value(phi, d, h));
      }
}

TEST(Pbsdf, WavelengthsBecomeColours) {
  Polarised file(8);
  for (size_t w = 0; w < 5; ++w) {
    file.m00(1, 1, 1, w) = w == 1 ? 1.0f : 0.0f; // 500 nm alone: outside of sRGB
    file.m00(1, 1, 2, w) = static_cast<float>(w);
    file.m00(1, 1, 3, w) = w == 4 ? NAN : 1 - 2 * float(w == 2);
  }
  MeasuredFile read = parse(file.bytes());
  const auto& grid = std::get<MeasuredGrid>(read.data);
  EXPECT_EQ(grid.axes[2].nodes.size(), 8u);
  const float* green = cell(grid, {1, 1, 1});
  EXPECT_EQ(green[0], 0);
  EXPECT_GT(green[1], 0.1f);
  const float* warm = cell(grid, {2, 1, 1});
  EXPECT_GT(warm[0], warm[1]);
  EXPECT_GT(warm[1], warm[2]);
  EXPECT_EQ(read.info.negative, 1);

  MeasuredOptions options;
  options.wavelength = 525;
  MeasuredFile one = parse(file.bytes(), options);
  const auto& grey = std::get<MeasuredGrid>(one.data);
  EXPECT_EQ(cell(grey, {1, 1, 1})[2], 0.5f);
  EXPECT_EQ(cell(grey, {2, 1, 1})[0], 1.5f);
  // The hole is at 650 nm, which does not count; the negative value at 550 nm is 0.
  EXPECT_EQ(cell(grey, {3, 1, 1})[0], 0.5f);
  EXPECT_EQ(one.info.holes, 0);
  options.wavelength = 449;
  EXPECT_NE(refusal(file.bytes(), options).find("449 nm was not measured"), std::string::npos);
}

TEST(Pbsdf, RefusesWhatDoesNotFit) {
  Polarised part(6);
  EXPECT_NE(refusal(part.bytes()).find("go once around"), std::string::npos);
  Polarised file;
  file.wavelengths[2] = 500;
  EXPECT_NE(refusal(file.bytes()).find("'wvls'"), std::string::npos);
  file = Polarised();
  file.theta_d[2] = 2;
  EXPECT_NE(refusal(file.bytes()).find("between 0 and pi/2"), std::string::npos);
  file = Polarised();
  file.wavelengths.push_back(700);
  EXPECT_NE(refusal(file.bytes()).find("field 'M'"), std::string::npos);
  damage(Polarised().bytes(), 1500);
}

// ---------------------------------------------------------------------------------------------
// UTIA

constexpr size_t kDirections = 288, kUtiaCells = kDirections * kDirections;

double utia_number(size_t cell, size_t channel) {
  return 0.001 * static_cast<double>(cell % 10007) + 20 * static_cast<double>(channel);
}

std::string utia_file(double (*value)(size_t cell, size_t channel) = utia_number) {
  std::string bytes;
  for (size_t channel = 0; channel < 3; ++channel)
    for (size_t i = 0; i < kUtiaCells; ++i)
      put(bytes, value(i, channel));
  return bytes;
}

TEST(Utia, CellsLieWhereTheFormatPutsThem) {
  MeasuredOptions options;
  options.utia_color = "linear";
  MeasuredFile file = parse(utia_file(), options);
  const auto& grid = std::get<MeasuredGrid>(file.data);
  EXPECT_EQ(file.info.format, "utia");
  EXPECT_EQ(grid.coordinates, MeasuredCoordinates::absolute);
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    size_t iti = random() % 6, ipi = random() % 48, itv = random() % 6, ipv = random() % 48;
    const size_t at[4] = {nearest(grid.axes[0], double(iti) * 15 * kPi / 180),
                          nearest(grid.axes[1], double(ipi) * 7.5 * kPi / 180 - 2 * kPi),
                          nearest(grid.axes[2], double(itv) * 15 * kPi / 180),
                          nearest(grid.axes[3], double(ipv) * 7.5 * kPi / 180 + 2 * kPi)};
    const float* rgb = cell(grid, {at[0], at[1], at[2], at[3]});
    size_t index = 288 * (48 * iti + ipi) + 48 * itv + ipv;
    for (size_t c = 0; c < 3; ++c)
      ASSERT_EQ(rgb[c], static_cast<float>(utia_number(index, c)));
  }
}

TEST(Utia, ColoursAreReadInThreeWays) {
  auto value = [](size_t cell, size_t channel) {
    return cell == 0 ? (channel == 1 ? -3.0 : 70.0) : cell == 1 ? (channel ? 1.0 : NAN) : 0.5;
  };
  std::string bytes = utia_file(value);
  // The sRGB curve at 0.5 and at 0.5 / 140, IEC 61966-2-1.
  const double at_half = std::pow((0.5 + 0.055) / 1.055, 2.4), small = 0.5 / 140 / 12.92;
  struct Case {
    const char* word;
    double first, third;
  };
  for (Case c : {Case{"scaled_srgb", 100 * at_half, 100 * small}, Case{"linear", 70, 0.5},
                 Case{"srgb", std::pow((70 + 0.055) / 1.055, 2.4), at_half}}) {
    SCOPED_TRACE(c.word);
    MeasuredOptions options;
    options.utia_color = c.word;
    MeasuredFile file = parse(bytes, options);
    const auto& rgb = std::get<MeasuredGrid>(file.data).rgb;
    EXPECT_NEAR(rgb[0], c.first, 1e-6 * c.first);
    EXPECT_EQ(rgb[1], 0);
    EXPECT_TRUE(std::isnan(rgb[3]));
    EXPECT_NEAR(rgb[6], c.third, 1e-6 * c.third);
    EXPECT_EQ(file.info.holes, 1);
    EXPECT_EQ(file.info.negative, 1);
  }
  EXPECT_EQ(std::get<MeasuredGrid>(parse(bytes).data).rgb[0], static_cast<float>(100 * at_half));
}

TEST(Utia, PicturesHoldTheSame) {
  Image image(288, 288);
  for (size_t i = 0; i < kUtiaCells; ++i)
    for (size_t c = 0; c < 3; ++c)
      image.data[3 * i + c] = static_cast<float>(utia_number(i, c));
  TemporaryFolder folder;
  std::string path = folder.folder() + "/a.exr";
  write_image(path, image, {.half = false});
  MeasuredOptions options;
  options.utia_color = "linear";
  EXPECT_EQ(parse_grid(read_whole_file(path), options).rgb, parse_grid(utia_file(), options).rgb);

  write_image(path, Image(288, 144), {});
  EXPECT_NE(refusal(read_whole_file(path)).find("288 x 144 pixels is no UTIA"), std::string::npos);
  write_image(path, Image(288, 288, {"Y"}), {});
  EXPECT_FALSE(refusal(read_whole_file(path)).empty());
  EXPECT_NE(refusal("\x76\x2f\x31\x01 and so on").find("OpenEXR"), std::string::npos);
}

TEST(Utia, RefusesOtherSizesAndContents) {
  std::string bytes = utia_file();
  EXPECT_NE(refusal(bytes.substr(1)).find("not a file of"), std::string::npos);
  EXPECT_NE(refusal(bytes + "x").find("not a file of"), std::string::npos);
  EXPECT_NE(refusal(std::string(bytes.size(), 'a')).find("not a file of"), std::string::npos);
}

// ---------------------------------------------------------------------------------------------
// Ngan

struct NganSizes {
  int32_t n[4];
  int32_t half = 0;
};

std::string ngan_file(const NganSizes& sizes, float (*value)(size_t cell, size_t channel)) {
  const int32_t header[16] = {sizes.n[0], sizes.n[1], sizes.n[2], sizes.n[3], 0, 0,
                              1,          0,          0,          sizes.half, 3};
  std::string bytes(reinterpret_cast<const char*>(header), sizeof(header));
  const auto cells = static_cast<size_t>(sizes.n[0] * sizes.n[1] * sizes.n[2] * sizes.n[3]);
  for (size_t channel = 0; channel < 3; ++channel)
    for (size_t i = 0; i < cells; ++i)
      put(bytes, value(i, channel));
  return bytes;
}

float ngan_number(size_t cell, size_t channel) {
  return static_cast<float>(2 * cell + channel);
}

// How the viewer of those who publish the reader finds a cell (azimuths of negated directions).
size_t ngan_index(const Direction& light, const Direction& view, const NganSizes& sizes) {
  auto floor_of = [](double angle, double range, int32_t n) {
    return static_cast<size_t>(std::clamp(int(angle / range * n), 0, n - 1));
  };
  double phi_out = std::atan2(-view.y, -view.x), phi_in = std::atan2(-light.y, -light.x);
  double difference = phi_out - phi_in;
  difference -= 2 * kPi * std::floor(difference / (2 * kPi));
  if (phi_in < 0)
    phi_in += 2 * kPi;
  if (sizes.half && difference > kPi)
    difference = 2 * kPi - difference;
  size_t index = floor_of(std::acos(light.z), kPi / 2, sizes.n[0]);
  index = index * size_t(sizes.n[1]) + floor_of(std::acos(view.z), kPi / 2, sizes.n[1]);
  index = index * size_t(sizes.n[2]) + floor_of(difference, sizes.half ? kPi : 2 * kPi, sizes.n[2]);
  return index * size_t(sizes.n[3]) + floor_of(phi_in, 2 * kPi, sizes.n[3]);
}

TEST(Ngan, CellsLieWhereTheFormatPutsThem) {
  for (int32_t half : {0, 1}) {
    NganSizes sizes{{9, 10, 18, 12}, half};
    MeasuredGrid grid = parse_grid(ngan_file(sizes, ngan_number));
    EXPECT_EQ(grid.coordinates, MeasuredCoordinates::relative_rotated);
    EXPECT_EQ(grid.axes[1].period, 2 * kPi);
    EXPECT_EQ(grid.axes[3].period, half ? 0 : 2 * kPi);
    std::mt19937 random(3);
    for (int i = 0; i < 2000; ++i) {
      Direction wi = random_direction(random), wo = random_direction(random);
      double phi_i = std::atan2(wi.y, wi.x), dphi = std::atan2(wo.y, wo.x) - phi_i;
      if (half)
        dphi = std::abs(std::remainder(dphi, 2 * kPi));
      const float* rgb =
          cell(grid, {nearest(grid.axes[0], std::acos(wi.z)), nearest(grid.axes[1], phi_i),
                      nearest(grid.axes[2], std::acos(wo.z)), nearest(grid.axes[3], dphi)});
      size_t index = ngan_index(wi, wo, sizes);
      for (size_t c = 0; c < 3; ++c)
        ASSERT_EQ(rgb[c], ngan_number(index, c));
    }
  }
}

TEST(Ngan, NegativeIsAHoleAndHeadersAreChecked) {
  std::string good = ngan_file({{2, 3, 4, 5}}, [](size_t cell, size_t channel) {
    return cell < 3 && channel == cell ? -1.0f : cell == 9 ? NAN : 1.0f;
  });
  MeasuredFile file = parse(good);
  EXPECT_EQ(file.info.format, "ngan");
  EXPECT_EQ(file.info.holes, 4);
  auto with = [&](size_t index, int32_t value) {
    std::string bytes = good;
    std::memcpy(&bytes[4 * index], &value, 4);
    return refusal(bytes);
  };
  EXPECT_NE(with(6, 0).find("parametrisation 0"), std::string::npos);
  EXPECT_NE(with(7, 1).find("cells of kind 1"), std::string::npos);
  EXPECT_NE(with(3, 6).find("2 x 3 x 4 x 6 cells take 1792 bytes"), std::string::npos);
  EXPECT_NE(with(10, 1).find("not a file of"), std::string::npos);
  EXPECT_NE(with(0, 10001).find("not a file of"), std::string::npos);
  std::string large = good;
  for (size_t i = 0; i < 4; ++i)
    std::memcpy(&large[4 * i], "\x10\x27\0\0", 4);
  EXPECT_NE(refusal(large).find("more than"), std::string::npos);
  damage(good, 2000);
}

// ---------------------------------------------------------------------------------------------
// mbsdf

std::string mbsdf_block(const std::string& name, uint32_t type, uint32_t thetas, uint32_t phis,
                        float first = 0, float step = 1) {
  std::string bytes = name;
  for (uint32_t v : {type, thetas, phis})
    put(bytes, v);
  for (uint32_t i = 0; i < thetas * thetas * phis * (type == 0 ? 1 : 3); ++i)
    put(bytes, first + step * static_cast<float>(i));
  return bytes;
}

const std::string kMbsdf = "NVIDIA ARC MBSDF V1\n";

TEST(Mbsdf, ReadsRealFiles) {
  struct Real {
    const char* name;
    int64_t negative;
    double sum, cell[3], specular[3];
  };
  // Of a numpy script: max(0, .5 (f[i][o] + f[o][i])), cells [3][17][60] and [20][20][89].
  const Real files[] = {{"carpaint_blue",
                         75159,
                         15820.2094,
                         {0, 0.01023692, 0.0387422},
                         {2.89590168, 2.97786927, 3.07006931}},
                        {"example_modules",
                         480,
                         28734.5702,
                         {0.0571463, 0.05022097, 0.03774133},
                         {3.71850491, 2.84636784, 2.29375362}}};
  if (!std::filesystem::exists(shared_file("mdl")))
    GTEST_SKIP() << "the shared data are not here";
  for (const Real& real : files) {
    SCOPED_TRACE(real.name);
    MeasuredFile file = read_measured(shared_file("mdl/" + std::string(real.name) + ".mbsdf"));
    ASSERT_EQ(unsound(file), "");
    const auto& grid = std::get<MeasuredGrid>(file.data);
    EXPECT_EQ(file.info.negative, real.negative);
    EXPECT_EQ(grid.coordinates, MeasuredCoordinates::relative);
    EXPECT_EQ(grid.axes[0].nodes.size(), 45u);
    EXPECT_EQ(grid.axes[2].nodes.size(), 90u);
    EXPECT_NEAR(grid.axes[1].nodes[2], 5 * kPi / 180, 1e-15);
    EXPECT_NEAR(grid.axes[2].nodes[89], 179 * kPi / 180, 1e-14);
    double sum = 0;
    for (float v : grid.rgb)
      sum += v;
    EXPECT_NEAR(sum, real.sum, 1e-7 * real.sum);
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(cell(grid, {3, 17, 60})[c], real.cell[c], 1e-7);
      EXPECT_NEAR(cell(grid, {17, 3, 60})[c], real.cell[c], 1e-7);
      EXPECT_NEAR(cell(grid, {20, 20, 89})[c], real.specular[c], 1e-7);
    }
  }
}

TEST(Mbsdf, AveragesBothDirections) {
  MeasuredFile file =
      parse(kMbsdf + "author=\"me\"\n" + mbsdf_block("MBSDF_DATA=\n", 0, 2, 3, -4, 1));
  const auto& grid = std::get<MeasuredGrid>(file.data);
  EXPECT_EQ(file.info.description, "author=\"me\"");
  EXPECT_EQ(file.info.negative, 4);
  // -4 -3 -2 | -1 0 1 || 2 3 4 | 5 6 7
  const float expected[12] = {0, 0, 0, 0.5, 1.5, 2.5, 0.5, 1.5, 2.5, 5, 6, 7};
  for (size_t i = 0; i < 36; ++i)
    EXPECT_EQ(grid.rgb[i], expected[i / 3]) << i;
}

TEST(Mbsdf, TransmissionIsNotedOrRefused) {
  std::string reflection = mbsdf_block("MBSDF_DATA_REFLECTION=\n", 1, 2, 3);
  std::string transmission = mbsdf_block("MBSDF_DATA_TRANSMISSION=\n", 1, 2, 2);
  MeasuredFile both = parse(kMbsdf + reflection + transmission);
  ASSERT_EQ(both.info.notes.size(), 1u);
  EXPECT_NE(both.info.notes[0].find("NOT used"), std::string::npos);
  EXPECT_TRUE(parse(kMbsdf + reflection).info.notes.empty());
  EXPECT_NE(refusal(kMbsdf + transmission).find("transmission only"), std::string::npos);
  EXPECT_NE(refusal(kMbsdf + reflection + transmission + "x").find("something follows"),
            std::string::npos);
  EXPECT_NE(refusal(kMbsdf + reflection + reflection).find("something else"), std::string::npos);
  EXPECT_NE(refusal(kMbsdf + mbsdf_block("MBSDF_DATA=\n", 2, 2, 3)).find("kind of values 2"),
            std::string::npos);
  EXPECT_NE(refusal(kMbsdf + mbsdf_block("MBSDF_DATA=\n", 1, 0, 3)).find("without angles"),
            std::string::npos);
  EXPECT_NE(refusal("NVIDIA ARC MBSDF V2\n").find("first line"), std::string::npos);
  EXPECT_NE(refusal(kMbsdf + "a=b\n").find("ends before a block"), std::string::npos);
  std::string huge = kMbsdf + "MBSDF_DATA=\n";
  for (uint32_t v : {1u, 0xffffffffu, 0xffffffffu})
    put(huge, v);
  EXPECT_NE(refusal(huge).find("the file ends inside a block"), std::string::npos);
  damage(kMbsdf + "a=b\n" + reflection, 2000);
}

TEST(Measured, FilesAreMappedAndErrorsNameThem) {
  TemporaryFolder folder;
  EXPECT_NE(error_of([&] { read_measured(folder.folder() + "/none"); }).find("file not found"),
            std::string::npos);
  EXPECT_NE(error_of([&] { read_measured(folder.folder()); }).find("not a regular file"),
            std::string::npos);
  std::string empty = folder.write("empty", "");
  EXPECT_NE(error_of([&] { read_measured(empty); }).find(empty), std::string::npos);
  std::string path = folder.write("a", kMbsdf + mbsdf_block("MBSDF_DATA=\n", 0, 2, 3));
  EXPECT_EQ(read_measured(path).info.format, "mbsdf");
}

} // namespace
