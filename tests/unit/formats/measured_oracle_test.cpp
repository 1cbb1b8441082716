// Real files against the numbers that others' code gives of them: brdf-loader (powitacq) on the RGL
// files, and the sampling of every real file.

#include "bsdf/columns.h"
#include "formats/measured_loader.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>

namespace faceta {
namespace {

namespace fs = std::filesystem;

const fs::path kData = fs::path(FACETA_SHARED_DATA) / "measured";

#define FACETA_NEEDS_DATA()                                                                        \
  if (!fs::exists(kData / "rgl"))                                                                  \
  GTEST_SKIP() << "the shared folder of measured files is absent"

struct Row {
  std::string file;
  std::vector<double> numbers;
};

std::vector<Row> read_rows(const std::string& name) {
  std::ifstream in(kData / "oracle" / name);
  std::string line;
  std::getline(in, line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    Row row;
    std::getline(fields, row.file, ',');
    for (std::string field; std::getline(fields, field, ',');)
      row.numbers.push_back(std::stod(field));
    rows.push_back(row);
  }
  return rows;
}

ColumnMaterial material_of(const fs::path& file) {
  load_measured_files();
  return column_material(make_parameters("measured", {{"filename", file.string()}}));
}

ColumnMaterial& rgl_material(const std::string& file) {
  static std::map<std::string, ColumnMaterial> known;
  auto found = known.find(file);
  if (found == known.end())
    found = known.emplace(file, material_of(kData / "rgl" / file)).first;
  return found->second;
}

double relative(double value, double truth) {
  return std::abs(value - truth) / (std::abs(truth) + 1e-4);
}

double luminance_of(const SampleColumns& s, size_t i) {
  return 0.2126 * s.weight[0][i] + 0.7152 * s.weight[1][i] + 0.0722 * s.weight[2][i];
}

/// The samples of a viewer for n points of a sequence of low discrepancy (Roberts 2018, R2).
SampleColumns sampled(const ColumnMaterial& material, double degrees, int n) {
  SampleColumns s(n);
  double theta = degrees * kPi / 180;
  auto fraction = [](double x) { return float(x - std::floor(x)) * 0x1.fffffep-1f; };
  for (int k = 0; k < n; ++k) {
    size_t i = size_t(k);
    s.wo[0][i] = float(std::sin(theta) * std::cos(0.3));
    s.wo[1][i] = float(std::sin(theta) * std::sin(0.3));
    s.wo[2][i] = float(std::cos(theta));
    s.u[0][i] = fraction(0.7548776662466927 * k);
    s.u[1][i] = fraction(0.5698402909980532 * k);
    s.uc[i] = fraction(0.6180339887498949 * k);
  }
  material.sample(s);
  return s;
}

/// Standard deviation of the weights' luminance over its mean.
double variation(const SampleColumns& s) {
  double first = 0, second = 0;
  for (size_t i = 0; i < size_t(s.count); ++i) {
    double w = s.flags[i] & kValidFlag ? luminance_of(s, i) : 0;
    first += w;
    second += w * w;
  }
  return std::sqrt(std::max(0.0, second * s.count / (first * first) - 1));
}

TEST(MeasuredOracle, ValuesAndDensitiesOfRglFiles) {
  FACETA_NEEDS_DATA();
  std::vector<Row> rows = read_rows("rgl_eval.csv");
  ASSERT_EQ(rows.size(), 896u);
  for (const Row& row : rows) {
    EvalColumns e(1);
    for (size_t k = 0; k < 3; ++k) { // their wi is the viewer
      e.wo[k][0] = float(row.numbers[k]);
      e.wi[k][0] = float(row.numbers[3 + k]);
    }
    rgl_material(row.file).eval(e);
    for (size_t k = 0; k < 3; ++k)
      EXPECT_LT(relative(e.value[k][0], row.numbers[6 + k]), 1e-3) << row.file;
    EXPECT_LT(relative(e.pdf[0], row.numbers[9]), 1e-3) << row.file;
  }
}

TEST(MeasuredOracle, SamplesOfRglFiles) {
  FACETA_NEEDS_DATA();
  std::vector<Row> rows = read_rows("rgl_sample.csv");
  ASSERT_EQ(rows.size(), 448u);
  int below = 0;
  for (const Row& row : rows) {
    SampleColumns s(1);
    s.u[0][0] = float(row.numbers[0]);
    s.u[1][0] = float(row.numbers[1]);
    for (size_t k = 0; k < 3; ++k)
      s.wo[k][0] = float(row.numbers[2 + k]);
    rgl_material(row.file).sample(s);
    if (row.numbers[8] == 0) {
      EXPECT_EQ(s.flags[0] & kValidFlag, 0) << row.file;
      ++below;
      continue;
    }
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(s.wi[k][0], row.numbers[5 + k], 1e-3) << row.file;
      EXPECT_LT(relative(s.weight[k][0], row.numbers[9 + k]), 1e-3) << row.file;
    }
    EXPECT_LT(relative(s.pdf[0], row.numbers[8]), 1e-3) << row.file;
  }
  EXPECT_EQ(below, 2);
}

// The oracle integrated over a grid of angles, too wide for the narrowest lobes: how far is seen in
// its integral of the density, which should be the share of samples above the surface.
TEST(MeasuredOracle, AlbedosAndVariationOfRglFiles) {
  FACETA_NEEDS_DATA();
  std::vector<Row> rows = read_rows("rgl_albedo.csv");
  ASSERT_EQ(rows.size(), 84u);
  double mean = 0;
  int close = 0;
  for (const Row& row : rows) {
    const int n = 1 << 17;
    SampleColumns s = sampled(rgl_material(row.file), row.numbers[0], n);
    double albedo[3] = {0, 0, 0}, above = 0, error = 0;
    for (size_t i = 0; i < size_t(n); ++i) {
      above += (s.flags[i] & kValidFlag ? 1.0 : 0.0) / n;
      for (size_t k = 0; k < 3; ++k)
        albedo[k] += s.weight[k][i] / n;
    }
    for (size_t k = 0; k < 3; ++k)
      error = std::max(error, relative(albedo[k], row.numbers[1 + k]));
    double doubt = std::abs(row.numbers[4] - above);
    EXPECT_LT(error, 1e-3 + 10 * doubt) << row.file << " at " << row.numbers[0];
    close += error < 1e-3;
    double cv = variation(s);
    mean += cv / double(rows.size());
    EXPECT_LT(cv, 0.35) << row.file << " at " << row.numbers[0];
  }
  EXPECT_GE(close, 55);
  EXPECT_LT(mean, 0.10);
  RecordProperty("variation", std::to_string(mean));
}

TEST(MeasuredOracle, VariationOfOtherFiles) {
  FACETA_NEEDS_DATA();
  for (const char* folder : {"mdl", "cornell"})
    for (const auto& entry : fs::directory_iterator(kData / folder)) {
      ColumnMaterial material = material_of(entry.path());
      for (double degrees : {0, 15, 30, 45, 60, 75})
        EXPECT_LE(variation(sampled(material, degrees, 1 << 14)), 0.5)
            << entry.path() << " at " << degrees;
    }
}

} // namespace
} // namespace faceta
