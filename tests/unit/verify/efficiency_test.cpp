#include "materials/builtin.h"
#include "verify/efficiency.h"

#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace faceta {
namespace {

constexpr int kSamples = 1 << 16;

EfficiencyPoint study(const char* model, const Settings& settings, double degrees,
                      int samples = kSamples) {
  Parameters p = make_parameters(model, settings);
  double theta = degrees * kPi / 180;
  return study_efficiency(Subject(p.model(), p),
                          {float(std::sin(theta)), 0, float(std::cos(theta))}, samples);
}

TEST(Efficiency, ConstantWeightsVaryByNothing) {
  for (double angle : {0.0, 60.0, 89.0}) {
    EfficiencyPoint p = study("diffuse", {{"reflectance", "0.8,0.3,0"}}, angle);
    EXPECT_NEAR(p.theta, angle, 1e-4);
    EXPECT_NEAR(p.variation, 0, 1e-3);
    EXPECT_NEAR(p.best, 0, 1e-3);
    EXPECT_NEAR(p.of_rule, 0, 1e-3);
    EXPECT_EQ(p.failed, 0);
    EXPECT_NEAR(p.mean[0], 0.8, 1e-6);
    EXPECT_EQ(p.mean[2], 0); // the black channel takes no part
  }
}

TEST(Efficiency, BlackHasNone) {
  EfficiencyPoint p = study("diffuse", {{"reflectance", "0"}}, 30);
  EXPECT_TRUE(std::isnan(p.variation) && std::isnan(p.best) && std::isnan(p.of_rule));
}

// At normal incidence Phong's lobe of exponent 0 has the value cos / pi and is sampled evenly over
// the hemisphere: weights 2 cos, E = 1, E of squares = 4/3.
TEST(Efficiency, IsTheVariationOfTheWeights) {
  Settings lobe{{"exponent", "0"}, {"diffuse_reflectance", "0"}, {"specular_reflectance", "1"}};
  EfficiencyPoint p = study("phong", lobe, 0);
  EXPECT_NEAR(p.variation, std::sqrt(1.0 / 3), 0.01);
  EXPECT_NEAR(p.best, 0, 1e-3);
  EXPECT_NEAR(p.of_rule, 0, 1e-3);
  EXPECT_NEAR(p.mean[1], 1, 0.01);
  // Seen along the horizon half of it lies below.
  p = study("phong", lobe, 89.99);
  EXPECT_NEAR(p.failed, 0.5, 0.01);
  EXPECT_NEAR(p.of_rule, 1, 0.02);
  EXPECT_GT(p.variation, p.of_rule);
}

// Two mirrors of different colours, weights r with probability f and t with 1 - f.
TEST(Efficiency, ColoursThatDisagreeLeaveABest) {
  EfficiencyPoint p = study("dielectric",
                            {{"int_ior", "3"},
                             {"ext_ior", "1"},
                             {"specular_reflectance", "1,0.5,0"},
                             {"specular_transmittance", "0.25,0.5,0.75"}},
                            0, 1 << 19);
  double f = 0.25, squares = 0, r2 = 0, t2 = 0;
  const double r[] = {1, 0.5, 0}, t[] = {0.25, 0.5, 0.75};
  for (int c = 0; c < 3; ++c) {
    double mean = f * r[c] + (1 - f) * t[c];
    squares += (f * r[c] * r[c] + (1 - f) * t[c] * t[c]) / (mean * mean) / 3;
    r2 += r[c] * r[c] / (mean * mean) / 3;
    t2 += t[c] * t[c] / (mean * mean) / 3;
  }
  double s = f * std::sqrt(r2) + (1 - f) * std::sqrt(t2);
  EXPECT_NEAR(p.variation, std::sqrt(squares - 1), 5e-3);
  EXPECT_NEAR(p.best, std::sqrt(s * s - 1), 5e-3);
  EXPECT_LT(p.best, p.variation);
}

// The project's goal.
TEST(Efficiency, MetalsOfRoughnessPointThreeStayBelow35Percent) {
  for (const char* distribution : {"beckmann", "ggx"})
    for (const char* metal : {"none", "Au", "Al", "Cu", "gold", "copper", "chromium", "W"})
      for (double angle : {0.0, 15.0, 30.0, 45.0, 60.0}) {
        EfficiencyPoint p =
            study("roughconductor",
                  {{"material", metal}, {"alpha", "0.3"}, {"distribution", distribution}}, angle);
        EXPECT_LE(p.variation, 0.35) << metal << " " << distribution << " " << angle;
      }
}

TEST(Efficiency, ReportsHaveEveryViewer) {
  std::vector<SuiteSubject> subjects;
  for (const char* name : {"dielectric", "diffuse"})
    for (SuiteSubject& s : exemplar_subjects(Registry::global().get(name)))
      subjects.push_back(std::move(s));
  EfficiencyReport report = study_efficiencies(subjects, 1 << 10, 7);
  EXPECT_EQ(efficiency_json(report, "1"),
            efficiency_json(study_efficiencies(subjects, 1 << 10, 7), "1"));
  nlohmann::json json = nlohmann::json::parse(efficiency_json(report, "1.2.3"));
  EXPECT_EQ(json["version"], "1.2.3");
  EXPECT_EQ(json["seed"], 7);
  ASSERT_EQ(json["subjects"].size(), subjects.size());
  EXPECT_EQ(json["subjects"][0]["points"].size(), 10u); // both sides
  EXPECT_EQ(json["subjects"].back()["points"].size(), 5u);
  EXPECT_NEAR(double(json["subjects"][0]["points"][9]["theta"]), 91, 1e-4);
  std::string text = efficiency_text(report);
  EXPECT_NE(text.find("from inside"), std::string::npos);
  for (size_t begin = 0; begin < text.size();) {
    size_t end = text.find('\n', begin);
    EXPECT_LE(end - begin, 100u + 10) << text.substr(begin, end - begin); // "°" has two bytes
    begin = end + 1;
  }
}

} // namespace
} // namespace faceta
