#include "spectrum/cie.h"
#include "spectrum/spectrum_curve.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

using namespace faceta;
using Triple = std::array<double, 3>;

namespace {

/// The message of the Error that f throws; empty if it throws none.
template <class F> std::string error_of(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

std::string parse_error(std::string_view text) {
  return error_of([&] { parse_spectrum(text, {"a.xml", 3, 7}); });
}

std::string text_error(std::string_view text) {
  return error_of([&] { parse_spectrum_text(text, "a.spd"); });
}

SpectrumCurve curve_of(std::string_view text) {
  return std::get<SpectrumCurve>(parse_spectrum(text));
}

struct RgbCase {
  const char* text;
  Triple reflectance, unbounded, emission;
};

// Origin: Mitsuba 3.9.1 (scalar_rgb): diffuse.reflectance, roughconductor.eta, constant.radiance.
// clang-format off
const RgbCase kRgbCases[] = {
{"400:0.1, 700:0.2", {0.17994903, 0.1476212, 0.11309512}, {0.17994903, 0.1476212, 0.11309512}, {0.21400005, 0.14042409, 0.10171396}},
{"400:0.1, 500:0.3, 600:0.2", {0.001106166, 0.27444646, 0.20479159}, {0.001106166, 0.27444646, 0.20479159}, {0.019696068, 0.26215363, 0.18333113}},
{"400:5, 700:9", {1.0, 1.0, 1.0}, {8.193303, 6.9046044, 5.518714}, {9.759695, 6.566484, 4.972002}},
{"360:1, 830:1", {0.9989853, 0.9988737, 0.9988016}, {0.9989853, 0.9988737, 0.9988016}, {1.2048837, 0.9482282, 0.9092668}},
{"300:1, 900:1", {0.9989853, 0.9988737, 0.9988016}, {0.9989853, 0.9988737, 0.9988016}, {1.2048837, 0.9482282, 0.9092668}},
{"500:1, 505:0", {0.0, 0.0173614, 0.0051065385}, {0.0, 0.0173614, 0.0051065385}, {0.0, 0.015755495, 0.0046329955}},
{"450:0.2, 452.5:0.9, 470:0.3, 561.3:0.7, 640:0.05", {0.2201488, 0.6124932, 0.24995838}, {0.2201488, 0.6124932, 0.24995838}, {0.27450594, 0.5901367, 0.2046501}},
{"600:0.6, 700:0.9", {0.5675971, 0.0, 0.0}, {0.5675971, 0.0, 0.0}, {0.65596676, 0.0, 0.0}},
{"400:-1, 700:-2", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}},
{"900:1, 1000:2", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}},
{"550:-0.2, 551:1, 600:0.5", {0.37496552, 0.32115224, 0.0}, {0.37496552, 0.32115224, 0.0}, {0.39803973, 0.32406467, 0.0}},
};
// clang-format on

class SpectrumFile : public testing::Test {
protected:
  void SetUp() override {
    std::string name = std::filesystem::temp_directory_path() / "faceta_spectrum_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(std::string_view text) {
    std::filesystem::path path = folder_ / "a.spd";
    std::ofstream(path, std::ios::binary).write(text.data(), std::streamsize(text.size()));
    return path;
  }

  std::filesystem::path folder_;
};

} // namespace

TEST(SpectrumParse, ReadsOneValue) {
  EXPECT_EQ(std::get<double>(parse_spectrum("0.5")), 0.5);
  EXPECT_EQ(std::get<double>(parse_spectrum("  +1e-2 ")), 0.01);
  EXPECT_EQ(std::get<double>(parse_spectrum("-3")), -3);
}

TEST(SpectrumParse, ReadsPairsSeparatedByCommasOrBlanks) {
  SpectrumCurve want{{400, 500, 700}, {0.1, 0.3, 0.2}};
  EXPECT_EQ(curve_of("400:0.1, 500:0.3, 700:0.2"), want);
  EXPECT_EQ(curve_of("400:0.1,500:.3 700:0.2,"), want);
  EXPECT_EQ(curve_of("\n400:0.1\t500:3e-1\n700:0.2"), want);
}

TEST(SpectrumParse, RefusesWhatIsNoSpectrum) {
  EXPECT_EQ(parse_error("400:0.1, 400:0.2"),
            "a.xml:3:7: error: the wavelengths of a spectrum must increase strictly, '400:0.2' "
            "does not follow (list each wavelength once, shortest first)");
  EXPECT_NE(parse_error("500:1, 400:1").find("increase strictly"), std::string::npos);
  EXPECT_NE(parse_error("400:0.1").find("at least two wavelengths, this one has 1"),
            std::string::npos);
  EXPECT_NE(parse_error("").find("empty"), std::string::npos);
  EXPECT_NE(parse_error(" , ").find("empty"), std::string::npos);
  for (const char* text :
       {"abc", "0.5, 0.7", "400 :0.1, 700:0.2", "400:1:2 700:1", "400:a 700:1", "400: 700:1",
        ":1 700:1", "400:0.1;700:2", "400:0.1f, 700:0.2", "nan", "inf", "1e39", "1e999",
        "400:nan 700:1", "400:1 inf:1", "+-5", "++5", "0x10", "0.5:"})
    EXPECT_NE(parse_error(text).find("expected one number, or wavelength:value pairs"),
              std::string::npos)
        << text << " -> " << parse_error(text);
}

TEST(SpectrumText, ReadsLinesAndComments) {
  SpectrumCurve want{{400, 700}, {0.1, 0.2}};
  for (const char* text :
       {"400 0.1\n700 0.2\n", "# c\r\n400\t0.1\r\n700\t0.2\r\n", "  400   0.1 # c\n\n \n700 0.2",
        "\xef\xbb\xbf"
        "400 .1\n  # x\n700 .2#"})
    EXPECT_EQ(parse_spectrum_text(text, "a.spd"), want) << text;
}

TEST(SpectrumText, NamesThePlaceOfAFault) {
  EXPECT_EQ(text_error("# c\n400 0.1\n  500 abc\n"),
            "a.spd:3:7: error: 'abc' is not a finite number (expected a wavelength in nm and a "
            "value, \"550 0.3\")");
  EXPECT_NE(text_error("400 1\n abc 2").find("a.spd:2:2: error: 'abc'"), std::string::npos);
  EXPECT_NE(text_error("400 1\n500").find("a.spd:2:1: error: there is no value"),
            std::string::npos);
  EXPECT_NE(text_error("400 1\n500 1 7").find("a.spd:2:7: error: a third column"),
            std::string::npos);
  EXPECT_NE(text_error("500 1\n400 1").find("a.spd:2:1: error: the wavelengths"),
            std::string::npos);
  EXPECT_NE(text_error("400,0.1\n700,0.2").find("a.spd:1:1: error: there is no value"),
            std::string::npos);
  EXPECT_NE(text_error("400 1").find("at least two"), std::string::npos);
  EXPECT_NE(text_error("").find("at least two wavelengths, this one has 0"), std::string::npos);
}

TEST(SpectrumText, MutatedInputEndsInACurveOrAnError) {
  const std::string good = "# c\n400 0.1\n500.5 2e-1\r\n\t700 -0.2 # x\n";
  std::uint32_t state = 1;
  auto next = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
  int curves = 0, errors = 0;
  for (int i = 0; i < 4000; ++i) {
    std::string text = good.substr(0, next() % 8 ? good.size() : next() % good.size());
    for (std::uint32_t n = next() % 6; n > 0 && !text.empty(); --n)
      text[next() % text.size()] = static_cast<char>(next());
    try {
      SpectrumCurve curve = parse_spectrum_text(text, "a.spd");
      check_spectrum(curve);
      ++curves;
      for (double c : spectrum_to_rgb(curve, SpectrumUse::reflectance))
        ASSERT_TRUE(c >= 0 && c <= 1);
    } catch (const Error& e) {
      ++errors;
      ASSERT_LT(std::string(e.what()).size(), 300u);
    }
    error_of([&] { parse_spectrum(text); });
  }
  EXPECT_GT(curves, 100);
  EXPECT_GT(errors, 100);
}

TEST_F(SpectrumFile, IsRead) {
  EXPECT_EQ(read_spectrum_file(write("400 0.1\n700 0.2\n")), curve_of("400:0.1, 700:0.2"));
}

TEST_F(SpectrumFile, ThatCannotBeReadIsAnError) {
  std::filesystem::path path = write("400 0.1\n700 x\n");
  EXPECT_NE(error_of([&] { read_spectrum_file(path); }).find(path.string() + ":2:5: error: 'x'"),
            std::string::npos);
  EXPECT_NE(error_of([&] { read_spectrum_file(folder_ / "none.spd"); }).find("does not exist"),
            std::string::npos);
  EXPECT_NE(error_of([&] { read_spectrum_file(folder_); }).find("not a regular file"),
            std::string::npos);
  EXPECT_NE(error_of([&] { read_spectrum_file(write("")); }).find("at least two"),
            std::string::npos);
  std::filesystem::resize_file(path, (64u << 20) + 1);
  EXPECT_NE(error_of([&] { read_spectrum_file(path); }).find("longer than"), std::string::npos);
}

TEST(SpectrumCurve, InterpolatesInsideAndIsZeroOutside) {
  SpectrumCurve curve = curve_of("400:1, 500:3, 520:2");
  EXPECT_EQ(spectrum_at(curve, 400), 1);
  EXPECT_EQ(spectrum_at(curve, 450), 2);
  EXPECT_EQ(spectrum_at(curve, 500), 3);
  EXPECT_EQ(spectrum_at(curve, 515), 2.25);
  EXPECT_EQ(spectrum_at(curve, 520), 2);
  EXPECT_EQ(spectrum_at(curve, 399.999), 0);
  EXPECT_EQ(spectrum_at(curve, 520.001), 0);
}

TEST(SpectrumCurve, IsChecked) {
  EXPECT_EQ(error_of([] { check_spectrum({{400, 500}, {1, 2}}); }), "");
  EXPECT_NE(error_of([] { check_spectrum({{400, 500}, {1}}); }).find("2 wavelengths but 1 values"),
            std::string::npos);
  EXPECT_NE(error_of([] { check_spectrum({{400}, {1}}); }).find("at least two"), std::string::npos);
  EXPECT_NE(error_of([] { check_spectrum({{400, 400}, {1, 1}}); }).find("increase strictly"),
            std::string::npos);
  EXPECT_NE(error_of([] { check_spectrum({{400, 500}, {1, NAN}}); }).find("entry 2"),
            std::string::npos);
}

TEST(SpectrumToRgb, AgreesWithMitsubaForPairs) {
  auto compare = [](const Triple& got, const Triple& want) {
    // Mitsuba sums 1000 terms in float and the matrix cancels: an absolute error of a few 1e-7.
    double scale = std::max({want[0], want[1], want[2]});
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(got[c], want[c], 2e-6 * scale) << "channel " << c;
  };
  for (const RgbCase& test : kRgbCases) {
    SCOPED_TRACE(test.text);
    SpectrumValue spectrum = parse_spectrum(test.text);
    compare(spectrum_to_rgb(spectrum, SpectrumUse::reflectance), test.reflectance);
    compare(spectrum_to_rgb(spectrum, SpectrumUse::unbounded), test.unbounded);
    compare(spectrum_to_rgb(spectrum, SpectrumUse::emission), test.emission);
  }
}

TEST(SpectrumToRgb, SingleValueIsGreyButForEmission) {
  // Origin: Mitsuba 3.9.1: 1.5 as reflectance and eta stays 1.5; as radiance as below.
  EXPECT_EQ(spectrum_to_rgb(1.5, SpectrumUse::reflectance), (Triple{1.5, 1.5, 1.5}));
  EXPECT_EQ(spectrum_to_rgb(1.5, SpectrumUse::unbounded), (Triple{1.5, 1.5, 1.5}));
  Triple emission = spectrum_to_rgb(1.5, SpectrumUse::emission);
  EXPECT_NEAR(emission[0], 1.8071909, 2e-7);
  EXPECT_NEAR(emission[1], 1.4224365, 2e-7);
  EXPECT_NEAR(emission[2], 1.3633741, 2e-7);
  EXPECT_EQ(d65_to_rgb(2), (Triple{2, 2, 2}));
}

TEST(SpectrumToXyz, OfOneIsOne) {
  Triple e = spectrum_to_xyz(curve_of("360:1, 830:1"), false);
  Triple d = spectrum_to_xyz(curve_of("360:1, 830:1"), true);
  EXPECT_NEAR(e[1], 1, 2e-5);
  for (double c : xyz_to_srgb(d)) // D65 is the white of sRGB
    EXPECT_NEAR(c, 1, 1.3e-3);
}
