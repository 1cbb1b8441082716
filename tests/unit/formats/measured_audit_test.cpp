#include "formats/measured_audit.h"
#include "formats/measured_common.h"
#include "formats/measured_convert.h"
#include "materials/measured_demo.h"
#include "formats/measured_reader.h"
#include "formats/measured_repair.h"
#include "formats/reflector.h"

#include <filesystem>
#include <gtest/gtest.h>

namespace faceta {
namespace {

namespace fs = std::filesystem;
using Direction = Vec3<double>;

Color<double> grey(double v) {
  return Color<double>(v);
}

Reflectance lambert(double albedo) {
  return [=](const Direction&, const Direction& wi) { return grey(albedo * kInvPi * wi.z); };
}

/// A table over the inclinations 0, 5, ... 90 and azimuth differences 0, 10, ... 180.
MeasuredFile table_of(const Reflectance& f) {
  MeasuredGrid grid;
  grid.coordinates = MeasuredCoordinates::relative;
  grid.axes.resize(3);
  for (int k = 0; k <= 18; ++k) {
    grid.axes[0].nodes.push_back(std::min(5.0 * k, 89.9) * kDegree);
    grid.axes[2].nodes.push_back(10.0 * k * kDegree);
  }
  grid.axes[1] = grid.axes[0];
  tabulate(f, grid);
  MeasuredFile file;
  file.info.format = "test";
  file.info.cells = int64_t(grid.rgb.size() / 3);
  file.data = std::move(grid);
  return file;
}

MeasuredGrid& grid_of(MeasuredFile& file) {
  return std::get<MeasuredGrid>(file.data);
}

class MeasuredAuditTest : public testing::Test {
protected:
  MeasuredAuditTest() {
    folder_ = fs::temp_directory_path() /
              ("faceta_audit_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  ~MeasuredAuditTest() override { fs::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }

private:
  fs::path folder_;
};

TEST_F(MeasuredAuditTest, LambertIsClean) {
  MeasuredAudit audit = audit_measured(table_of(lambert(0.7)), "lambert");
  EXPECT_EQ(audit.holes, 0);
  for (const MeasuredAudit::Angle& a : audit.angles)
    for (double albedo : a.albedo)
      EXPECT_NEAR(albedo, 0.7, 2e-3) << a.theta;
  EXPECT_LT(audit.reciprocity.largest, 1e-6);
  EXPECT_NEAR(audit.most, 0.7 * kInvPi, 1e-6);
  EXPECT_NEAR(audit.smallest, 0.7 * kInvPi, 1e-6);
  EXPECT_TRUE(audit.clean());
}

// f = (1 + cos theta_i) / (2 pi) has the albedo 1/2 + 1/3, and ln f(a,b)/f(b,a) is
// ln (1 + b.z) / (1 + a.z): the mean of its magnitude over cosines uniform between cos 80 degrees
// and 1 is an integral done here by the midpoint rule.
TEST_F(MeasuredAuditTest, NonReciprocityIsMeasured) {
  MeasuredAudit audit = audit_measured(table_of([](const Direction&, const Direction& wi) {
                                         return grey((1 + wi.z) * 0.5 * kInvPi * wi.z);
                                       }),
                                       "one way");
  const double low = std::cos(80 * kDegree);
  double mean = 0;
  const int n = 500;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      auto cosine = [&](int k) { return low + (1 - low) * (k + 0.5) / n; };
      mean += std::abs(std::log((1 + cosine(i)) / (1 + cosine(j)))) / (n * n);
    }
  EXPECT_NEAR(audit.reciprocity.mean, mean, 0.003 * mean);
  EXPECT_NEAR(audit.reciprocity.largest, std::log(2 / (1 + low)), 0.06);
  for (const MeasuredAudit::Angle& a : audit.angles)
    EXPECT_NEAR(a.albedo[1], 5.0 / 6, 3e-3);
  EXPECT_FALSE(audit.clean());
}

TEST_F(MeasuredAuditTest, TooMuchLightIsSeen) {
  MeasuredAudit audit = audit_measured(table_of(lambert(1.3)), "too bright");
  EXPECT_NEAR(audit.angles[1].largest, 1.3, 4e-3);
  EXPECT_FALSE(audit.clean());
}

TEST_F(MeasuredAuditTest, CountsPlantedFaults) {
  MeasuredFile file = table_of(lambert(0.5));
  for (size_t cell : {100u, 101u, 2000u})
    grid_of(file).rgb[3 * cell] = NAN;
  file.info.negative = 7;
  MeasuredAudit audit = audit_measured(file, "holes");
  EXPECT_EQ(audit.holes, 3);
  EXPECT_EQ(audit.below, 0);
  EXPECT_EQ(audit.negative, 7);
  EXPECT_FALSE(audit.clean());
}

TEST_F(MeasuredAuditTest, RepeatedRowsEndWhatWasMeasured) {
  MeasuredFile file =
      table_of([](const Direction& wo, const Direction& wi) { return grey(wo.z * wi.z * wi.z); });
  std::vector<float>& rgb = grid_of(file).rgb;
  const size_t row = rgb.size() / 19;
  for (size_t k = 15; k < 19; ++k)
    std::copy_n(rgb.begin() + std::ptrdiff_t(14 * row), row, rgb.begin() + std::ptrdiff_t(k * row));
  EXPECT_NEAR(audit_measured(file, "cut").largest_theta, 70, 1e-9);
}

TEST_F(MeasuredAuditTest, HolesAreFilledHarmonically) {
  // Linear in every coordinate: the mean of the neighbours is the value itself.
  MeasuredFile file = table_of(lambert(0.5));
  MeasuredGrid& grid = grid_of(file);
  for (size_t cell = 0; cell < grid.rgb.size() / 3; ++cell)
    grid.rgb[3 * cell] = float(1 + cell / 361 + cell / 19 % 19 * 2 + cell % 19 * 3);
  const std::vector<float> whole = grid.rgb;
  const size_t middle = 9 * 361 + 9 * 19 + 9;
  for (size_t cell : {middle, middle + 1, middle + 19})
    grid.rgb[3 * cell] = NAN;
  EXPECT_EQ(fill_holes(grid), 3);
  for (size_t cell : {middle, middle + 1, middle + 19})
    EXPECT_NEAR(grid.rgb[3 * cell], whole[3 * cell], 1e-3);
}

// Not reciprocal, holes, and more light than there is: the file written is clean in every format.
TEST_F(MeasuredAuditTest, RepairedFilesAreClean) {
  MeasuredFile file = table_of([](const Direction& wo, const Direction& wi) {
    return grey((1.2 + 2 * wi.z * wi.z * (1 - wo.z)) * kInvPi * wi.z);
  });
  grid_of(file).rgb[3 * 400] = NAN;
  ASSERT_EQ(audit_measured(file, "broken").clean(), false);
  Repaired mended = repaired(file, "broken", {});
  EXPECT_EQ(mended.notes.size(), 3u);
  for (auto [name, target] :
       {std::pair{"a.bsdf", MeasuredTarget::rgl}, {"a.binary", MeasuredTarget::merl}}) {
    ConvertOptions options;
    options.target = target;
    write_reflectance(path(name), mended.value, options);
    MeasuredAudit audit = audit_measured(read_measured(path(name)), name);
    for (const MeasuredAudit::Finding& f : audit.findings)
      EXPECT_TRUE(f.good) << name << ": " << f.text;
  }
}

TEST_F(MeasuredAuditTest, MaxThetaKeepsTheHalfVector) {
  // A function of the half vector alone is what it was wherever that lies above the limit.
  auto of_half = [](const Direction& wo, const Direction& wi) {
    return grey(std::pow(normalize(wo + wi).z, 4) * 0.2 * wi.z);
  };
  Repaired mended = repaired(table_of(of_half), "half", {.symmetrise = false, .max_theta = 60});
  const Direction wo = direction_of(80 * kDegree, 0), wi = direction_of(75 * kDegree, 3.0);
  Reflectance plain = repaired(table_of(of_half), "half", {.symmetrise = false}).value;
  EXPECT_NEAR(mended.value(wo, wi)[0], plain(wo, wi)[0], 0.05 * plain(wo, wi)[0]);
  EXPECT_THROW(repaired(table_of(of_half), "half", {.max_theta = 95}), Error);
}

class Conversions : public MeasuredAuditTest,
                    public testing::WithParamInterface<std::pair<const char*, Settings>> {};

TEST_P(Conversions, KeepAlbedoAndValues) {
  const auto& [model, settings] = GetParam();
  const Reflector source(make_parameters(model, settings));
  const Reflectance f = [&](const Direction& wo, const Direction& wi) {
    return source.value(wo, wi);
  };
  Conversion made = write_reflectance(path("a.bsdf"), f, {});
  EXPECT_LT(made.error, 0.01);
  // Beside the report's word: the file as it is read, against the material.
  const Reflector result(read_measured(path("a.bsdf")), "a.bsdf");
  double apart = 0, all = 0;
  for (int k = 0; k < 2000; ++k) {
    Vec3<double> e = even_point(k);
    const Direction wo = direction_of(75 * kDegree * e.x, 2 * kPi * e.y);
    Sample<double> s = source.sample(wo, {{e.y, e.z}, e.x});
    if (!s.valid)
      continue;
    apart += std::abs(f(wo, s.wi)[1] - result.value(wo, s.wi)[1]) / s.pdf;
    all += f(wo, s.wi)[1] / s.pdf;
  }
  EXPECT_LT(apart, 0.04 * all);
}

INSTANTIATE_TEST_SUITE_P(
    Models, Conversions,
    testing::Values(std::pair<const char*, Settings>{"diffuse", {{"reflectance", "0.8"}}},
                    std::pair<const char*, Settings>{"roughconductor", {{"alpha", "0.05"}}},
                    std::pair<const char*, Settings>{"roughplastic", {{"alpha", "0.2"}}},
                    std::pair<const char*, Settings>{"roughconductor",
                                                     {{"alpha_u", "0.15"}, {"alpha_v", "0.4"}}}));

TEST_F(MeasuredAuditTest, RefusesWhatAFormatCannotHold) {
  const Reflector brushed(
      make_parameters("roughconductor", {{"alpha_u", "0.1"}, {"alpha_v", "0.4"}}));
  const Reflectance f = [&](const Direction& wo, const Direction& wi) {
    return brushed.value(wo, wi);
  };
  ConvertOptions merl;
  merl.target = MeasuredTarget::merl;
  EXPECT_THROW(write_reflectance(path("a.binary"), f, merl), Error);
  EXPECT_FALSE(fs::exists(path("a.binary")));
  EXPECT_THROW(Reflector(make_parameters("conductor", {})), Error);
  ConvertOptions fine;
  fine.resolution = 0.01;
  EXPECT_THROW(write_reflectance(path("a.bsdf"), lambert(0.5), fine), Error);
}

} // namespace
} // namespace faceta
