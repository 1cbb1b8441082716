#include "formats/measured_common.h"
#include "formats/measured_rgl.h"
#include "formats/measured_tensor.h"
#include "measured_test_tools.h"
#include "spectrum/spectrum_curve.h"

#include <fstream>

using namespace faceta;

namespace {

double sum(const std::vector<float>& values) {
  double total = 0;
  for (float v : values)
    total += v;
  return total;
}

// Small tables that fit together; what they mean does not matter.
RglTables small_tables(size_t phis) {
  RglTables t;
  for (size_t i = 0; i < phis; ++i)
    t.phi_i.push_back(static_cast<float>(i) - 3);
  t.theta_i = {0, 0.5f, 1.5f};
  auto fill = [](std::vector<float>& values, int(&size)[2], int rows, int columns, size_t depth) {
    size[0] = rows, size[1] = columns;
    for (size_t i = 0; i < depth * static_cast<size_t>(rows * columns); ++i)
      values.push_back(0.25f * static_cast<float>(i % 13));
  };
  fill(t.ndf, t.ndf_size, 2, 5, 1);
  fill(t.sigma, t.sigma_size, 3, 4, 1);
  fill(t.vndf, t.vndf_size, 4, 3, phis * 3);
  fill(t.luminance, t.luminance_size, 3, 3, phis * 3);
  for (size_t i = 0; i < phis * 3 * 3 * 3 * 3; ++i)
    t.rgb.push_back(0.125f * static_cast<float>(i) - 1);
  return t;
}

std::string bytes_of(const RglTables& tables, const std::string& description = "made up") {
  TemporaryFolder folder;
  std::string path = folder.folder() + "/a.bsdf";
  write_rgl(path, tables, description);
  return read_whole_file(path);
}

// A file made of fields of the last one, less some, with others.
std::string rewritten(const std::string& bytes, const std::vector<std::string>& without,
                      const std::vector<TensorField>& with) {
  InputText input{bytes, "a.bsdf"};
  TensorFile file(input);
  std::vector<TensorField> fields = with;
  for (const TensorField& field : file.fields())
    if (std::find(without.begin(), without.end(), field.name) == without.end())
      fields.push_back(field);
  TemporaryFolder folder;
  std::string path = folder.folder() + "/b.bsdf";
  write_tensor_file(path, fields);
  return read_whole_file(path);
}

template <class T> std::string_view view(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

void expect_same(const RglTables& a, const RglTables& b) {
  EXPECT_EQ(a.phi_i, b.phi_i);
  EXPECT_EQ(a.theta_i, b.theta_i);
  EXPECT_EQ(a.ndf, b.ndf);
  EXPECT_EQ(a.sigma, b.sigma);
  EXPECT_EQ(a.vndf, b.vndf);
  EXPECT_EQ(a.luminance, b.luminance);
  EXPECT_EQ(a.rgb, b.rgb);
  EXPECT_EQ(a.jacobian, b.jacobian);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(a.ndf_size[i], b.ndf_size[i]);
    EXPECT_EQ(a.sigma_size[i], b.sigma_size[i]);
    EXPECT_EQ(a.vndf_size[i], b.vndf_size[i]);
    EXPECT_EQ(a.luminance_size[i], b.luminance_size[i]);
  }
}

// Figures of a numpy script that unpacks the container by its own.
struct RealFile {
  const char* name;
  const char* description;
  int texels;
  double ndf, sigma, luminance, rgb; ///< sums
  int64_t negative;
  double texel[3];  ///< rgb[0][5][:][7][20]
  double others[4]; ///< luminance[0][5][7][20], vndf[0][3][100][17], ndf[1][77], sigma[0][9]
};

TEST(Rgl, ReadsRealFiles) {
  const RealFile files[] = {
      {"aurora_white_rgb",
       "TeckWrap vinyl wrapping film (Aurora White DCH02)",
       32,
       663.120147,
       204.19704,
       6063.94484,
       17839.9457,
       0,
       {0.76331747, 0.6698788, 0.65199},
       {0.6884594, 4.0702995e-05, 0.35453486, 0.9999689}},
      {"irid_flake_paint1_fine_rgb",
       "Iridescent flake car paint (\"Dupli-color flip flop ultra\") on top of aluminium with "
       "black "
       "primer",
       48,
       9157.56581,
       201.435827,
       2691.38051,
       8074.98674,
       1558,
       {0.09607106, 0.0869748, 0.06463946},
       {0.08729738, 0.00013165867, 0.16713983, 0.9999689}},
      {"ilm_solo_m_68_rgb",
       "Blue metallic m68-speeder material (from \"Solo: A Star Wars Story\", provided by ILM)",
       32,
       102941.368,
       202.229023,
       456.678573,
       1555.62348,
       2790,
       {0.00155163, -0.00205547, 0.02595888},
       {0.0007334172, 1.2489651e-05, 0.16927063, 0.9999691}}};
  if (!std::filesystem::exists(shared_file("rgl")))
    GTEST_SKIP() << "the shared data are not here";
  for (const RealFile& real : files) {
    SCOPED_TRACE(real.name);
    MeasuredFile file = read_measured(shared_file("rgl/" + std::string(real.name) + ".bsdf"));
    ASSERT_EQ(unsound(file), "");
    EXPECT_EQ(file.info.format, "rgl");
    EXPECT_EQ(file.info.description, real.description);
    EXPECT_EQ(file.info.negative, real.negative);
    EXPECT_EQ(file.info.cells, 8 * real.texels * real.texels);
    const auto& t = std::get<RglTables>(file.data);
    EXPECT_EQ(t.phi_i, std::vector<float>{0});
    EXPECT_EQ(t.theta_i.size(), 8u);
    EXPECT_EQ(t.theta_i.back(), 1.570796251296997f);
    EXPECT_TRUE(t.jacobian);
    EXPECT_EQ(t.luminance_size[0], real.texels);
    EXPECT_NEAR(sum(t.ndf), real.ndf, 1e-8 * real.ndf);
    EXPECT_NEAR(sum(t.sigma), real.sigma, 1e-8 * real.sigma);
    EXPECT_NEAR(sum(t.vndf), 8, 1e-6);
    EXPECT_NEAR(sum(t.luminance), real.luminance, 1e-8 * real.luminance);
    EXPECT_NEAR(sum(t.rgb), real.rgb, 1e-8 * real.rgb);
    const auto n = static_cast<size_t>(real.texels), texel = (5 * n + 7) * n + 20;
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(t.rgb[3 * texel + c], real.texel[c], 6e-9 + 1e-6 * std::abs(real.texel[c]));
    const double ours[4] = {t.luminance[texel], t.vndf[(3 * 128 + 100) * 128 + 17], t.ndf[128 + 77],
                            t.sigma[9]};
    for (size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(ours[i], real.others[i], 1e-6 * real.others[i]) << i;
  }
}

TEST(Rgl, WritesWhatItReads) {
  for (size_t phis : {1u, 4u}) {
    RglTables tables = small_tables(phis);
    tables.jacobian = phis == 1;
    MeasuredFile file = parse(bytes_of(tables));
    expect_same(std::get<RglTables>(file.data), tables);
    EXPECT_EQ(file.info.description, "made up");
    EXPECT_EQ(file.info.symmetries,
              std::vector<std::string>{phis == 1 ? "isotropic" : "anisotropic"});
  }
}

TEST(Rgl, WrittenRealFileHasTheSameFields) {
  std::string path = shared_file("rgl/vch_silk_blue_rgb.bsdf");
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "the shared data are not here";
  std::string theirs = read_whole_file(path);
  MeasuredFile file = parse(theirs);
  std::string ours = bytes_of(std::get<RglTables>(file.data), file.info.description);
  ASSERT_EQ(ours.size(), theirs.size());
  // All but the mask of texels that were measured, which comes last.
  EXPECT_EQ(ours.substr(0, ours.size() - 1024), theirs.substr(0, theirs.size() - 1024));
}

std::string spectral(const RglTables& t, const std::vector<float>& wavelengths,
                     const std::vector<float>& spectra) {
  std::string bytes = bytes_of(t);
  return rewritten(bytes, {"rgb"},
                   {{"wavelengths", TensorType::f32, {wavelengths.size()}, view(wavelengths)},
                    {"spectra", TensorType::f32, {1, 3, wavelengths.size(), 3, 3}, view(spectra)}});
}

// The spectrum of each texel is a curve of its own.
struct SpectralFile {
  std::vector<float> wavelengths, spectra;
  std::string bytes;

  template <class F> explicit SpectralFile(F value) {
    for (int i = 0; i < 195; ++i)
      wavelengths.push_back(358 + 644 * static_cast<float>(i) / 194);
    for (int table = 0; table < 3; ++table)
      for (float w : wavelengths)
        for (int texel = 0; texel < 9; ++texel)
          spectra.push_back(static_cast<float>(value(9 * table + texel, w)));
    bytes = spectral(small_tables(1), wavelengths, spectra);
  }
};

// The colour of a curve by the rule for scene files, which makes white of 1 up to 0.1 %; that
// share is taken off.
std::array<double, 3> white_balanced(const SpectrumCurve& curve) {
  auto rgb = spectrum_to_rgb(curve, SpectrumUse::unbounded);
  auto white = spectrum_to_rgb(SpectrumCurve{{300, 900}, {1, 1}}, SpectrumUse::unbounded);
  for (size_t c = 0; c < 3; ++c)
    rgb[c] /= white[c];
  return rgb;
}

TEST(Rgl, SpectraBecomeTheColoursOfTheirCurves) {
  auto value = [](int texel, double w) {
    return 0.5 + 0.4 * std::sin(0.011 * w + texel) * std::exp(-1e-5 * std::pow(w - 560, 2));
  };
  SpectralFile file(value);
  MeasuredFile read = parse(file.bytes);
  const auto& t = std::get<RglTables>(read.data);
  EXPECT_EQ(read.info.wavelengths.size(), 195u);
  for (int texel = 0; texel < 27; ++texel) {
    SpectrumCurve curve;
    for (float w : file.wavelengths) {
      curve.wavelengths.push_back(w);
      curve.values.push_back(value(texel, w));
    }
    auto expected = white_balanced(curve);
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(t.rgb[3 * static_cast<size_t>(texel) + c], expected[c], 1e-6) << texel;
  }
}

TEST(Rgl, FlatSpectraAreGreyAndNarrowOnesOutOfGamut) {
  SpectralFile file([](int texel, double w) {
    return texel < 9 ? 0.1 * (texel + 1) : std::exp(-0.01 * std::pow(w - 505, 2));
  });
  const auto t = std::get<RglTables>(parse(file.bytes).data);
  for (size_t texel = 0; texel < 9; ++texel)
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(t.rgb[3 * texel + c], 0.1 * static_cast<double>(texel + 1), 1e-7);
  EXPECT_LT(t.rgb[3 * 10], -0.02f);
  EXPECT_GT(t.rgb[3 * 10 + 1], 0.02f);
}

TEST(Rgl, OneWavelengthIsGreyAndLinear) {
  SpectralFile file([](int texel, double w) { return texel + w / 1000; });
  for (double wavelength : {358.0, 500.0, 700.25, 1002.0}) {
    MeasuredOptions options;
    options.wavelength = wavelength;
    const auto t = std::get<RglTables>(parse(file.bytes, options).data);
    for (size_t i = 0; i < t.rgb.size(); ++i)
      ASSERT_NEAR(t.rgb[i], static_cast<double>(i / 3) + wavelength / 1000, 3e-6);
  }
  for (double wavelength : {357.0, 1003.0}) {
    MeasuredOptions options;
    options.wavelength = wavelength;
    EXPECT_NE(refusal(file.bytes, options).find("was not measured"), std::string::npos);
  }
  MeasuredOptions options;
  options.wavelength = 500;
  EXPECT_NE(refusal(bytes_of(small_tables(1)), options).find("no wavelength"), std::string::npos);
}

TEST(Measured, WeightsOfWavelengths) {
  for (const std::vector<double>& w :
       {std::vector<double>{550}, {450, 500, 550, 600, 650}, {100, 200}, {900, 1000, 1100}}) {
    WavelengthWeights weights = wavelength_weights(w, -1, {});
    for (size_t c = 0; c < 3; ++c) {
      double total = 0;
      for (const auto& weight : weights)
        total += weight[c];
      EXPECT_NEAR(total, 1, 1e-14);
    }
  }
  // Constant beyond the ends: five wavelengths hold a curve that is flat outside of them.
  const std::vector<double> w = {450, 500, 550, 600, 650}, values = {0.2, 0.5, 0.9, 0.4, 0.3};
  auto expected =
      white_balanced({{300, 450, 500, 550, 600, 650, 900}, {0.2, 0.2, 0.5, 0.9, 0.4, 0.3, 0.3}});
  WavelengthWeights weights = wavelength_weights(w, -1, {});
  for (size_t c = 0; c < 3; ++c) {
    double colour = 0;
    for (size_t i = 0; i < 5; ++i)
      colour += weights[i][c] * values[i];
    EXPECT_NEAR(colour, expected[c], 1e-12);
  }
}

TEST(Rgl, RefusesWhatDoesNotFit) {
  const std::string good = bytes_of(small_tables(1));
  EXPECT_NE(refusal(rewritten(good, {"vndf"}, {})).find("no field 'vndf'"), std::string::npos);
  EXPECT_NE(refusal(rewritten(good, {"rgb"}, {})).find("no field 'wavelengths'"),
            std::string::npos);
  const std::vector<float> four = {0, 1, 2, 3}, down = {0, 2, 1}, steep = {0, 1, 2};
  const std::vector<float> hole = {0, NAN, 2}, many(1000, 1);
  auto with = [&](const char* name, std::vector<uint64_t> shape, const std::vector<float>& values) {
    return refusal(
        rewritten(good, {name}, {{name, TensorType::f32, std::move(shape), view(values)}}));
  };
  EXPECT_NE(with("theta_i", {4}, four).find("between 0 and pi/2"), std::string::npos);
  EXPECT_NE(with("theta_i", {3}, down).find("increase strictly"), std::string::npos);
  EXPECT_NE(with("theta_i", {3}, steep).find("between 0 and pi/2"), std::string::npos);
  EXPECT_NE(with("theta_i", {3}, hole).find("not finite, at byte"), std::string::npos);
  EXPECT_NE(with("theta_i", {2}, {0, 1}).find("field 'vndf' is 1 x 3 x 4 x 3 x f32"),
            std::string::npos);
  EXPECT_NE(with("luminance", {1, 3, 3, 2}, many).find("field 'rgb'"), std::string::npos);
  EXPECT_NE(with("ndf", {1, 4}, four).find("rows or columns"), std::string::npos);
  EXPECT_NE(with("jacobian", {1}, {1}).find("must be 1 x u8"), std::string::npos);
  RglTables tables = small_tables(1);
  tables.vndf[5] = -1e-9f;
  MeasuredFile mended = parse(bytes_of(tables));
  EXPECT_EQ(std::get<RglTables>(mended.data).vndf[5], 0);
  EXPECT_EQ(mended.info.notes.front(), "1 negative values of 'vndf': 0");
  tables.vndf.pop_back();
  EXPECT_NE(error_of([&] { bytes_of(tables); }).find("do not fit together"), std::string::npos);
}

TEST(TensorFile, RefusesHeadersThatLie) {
  auto header = [](uint32_t fields) {
    std::string bytes("tensor_file\0\1\0", 14);
    put(bytes, fields);
    return bytes;
  };
  auto field = [](std::string bytes, uint16_t axes, uint8_t type, uint64_t offset,
                  std::vector<uint64_t> shape) {
    put(bytes, uint16_t{3});
    bytes += "ndf";
    put(bytes, axes);
    put(bytes, type);
    put(bytes, offset);
    for (uint64_t size : shape)
      put(bytes, size);
    return bytes + std::string(8, '\0');
  };
  auto why = [](const std::string& bytes) {
    InputText input{bytes, "a.bsdf"};
    return error_of([&] { TensorFile file(input); });
  };
  constexpr uint64_t kHuge = uint64_t(1) << 63;
  EXPECT_NE(why("tensor_file").find("ends inside the header"), std::string::npos);
  EXPECT_NE(why(std::string("tensor_file\0\2\0\0\0\0\0", 18)).find("version 2.0"),
            std::string::npos);
  EXPECT_NE(why(header(2000000000)).find("2000000000 fields"), std::string::npos);
  EXPECT_NE(why(header(1)).find("ends inside the header"), std::string::npos);
  EXPECT_NE(why(field(header(1), 0, 12, 0, {})).find("unknown type 12"), std::string::npos);
  EXPECT_NE(why(field(header(1), 0, 0, 0, {})).find("unknown type 0"), std::string::npos);
  EXPECT_NE(why(field(header(1), 40000, 1, 0, {})).find("40000 axes"), std::string::npos);
  EXPECT_NE(why(field(header(1), 1, 1, kHuge, {1})).find("do not lie inside"), std::string::npos);
  EXPECT_NE(why(field(header(1), 1, 10, 0, {kHuge})).find("do not lie inside"), std::string::npos);
  EXPECT_NE(why(field(header(1), 2, 1, 0, {kHuge, 2})).find("do not lie inside"),
            std::string::npos);
  EXPECT_NE(why(field(header(1), 1, 1, 40, {60})).find("do not lie inside"), std::string::npos);
  std::string twice = field(header(2), 1, 1, 0, {1});
  twice.resize(twice.size() - 8);
  EXPECT_NE(why(field(twice, 1, 1, 0, {1})).find("there twice"), std::string::npos);
}

TEST(Rgl, SurvivesDamage) {
  damage(bytes_of(small_tables(3)), 4000);
  SpectralFile file([](int texel, double w) { return texel + w / 1000; });
  damage(file.bytes, 400);
}

} // namespace
