// Fits find the parameters that data were made with, from exact derivatives.

#include "base/error.h"
#include "verify/fit.h"
#include "verify/fit_solver.h"

#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace faceta {
namespace {

/// A material as if it had been measured.
FitData measured(const std::string& model, const Settings& settings) {
  Parameters p = make_parameters(model, settings);
  Record record = p.record();
  const Model& m = p.model();
  return sample_fit_target({[&](const Vec3<double>& wo, const Vec3<double>& wi) {
    Color<double> v = m.eval(record, {wo, wi}).value;
    return std::array<double, 3>{v[0] / wi.z, v[1] / wi.z, v[2] / wi.z};
  }});
}

TEST(FitTransform, InverseAndSlope) {
  for (FitTransform t : {FitTransform{0, 1}, FitTransform{-1.5, 1.5}, FitTransform{1e-3, 1, true}})
    for (double x : {-4.0, -0.3, 0.0, 2.5}) {
      double y = t.value(x), h = 1e-6;
      EXPECT_GT(y, t.low);
      EXPECT_LT(y, t.high);
      EXPECT_NEAR(t.inverse(y), x, 1e-9);
      EXPECT_NEAR(t.slope(x), (t.value(x + h) - t.value(x - h)) / (2 * h), 1e-8);
    }
  FitTransform unit{0, 1};
  EXPECT_TRUE(std::isfinite(unit.inverse(0)) && std::isfinite(unit.inverse(1)));
}

struct Case {
  const char* model;
  int lobes;
};
class FitDerivatives : public testing::TestWithParam<Case> {};

TEST_P(FitDerivatives, AgreeWithCentralDifferences) {
  auto [name, lobes] = GetParam();
  FitModel model(name, lobes);
  FitData data = thin_out(measured("diffuse", {}), 997);
  std::vector<double> x = model.start();
  for (size_t j = 0; j < x.size(); ++j) // somewhere without a symmetry
    x[j] += 0.4 * std::sin(double(3 * j + 1));
  size_t count = 3 * data.rows.size(), n = x.size();
  std::vector<double> values(count), derivatives(count * n), up(count), down(count);
  model.evaluate(model.state(x), data.rows, values.data(), derivatives.data());
  const double h = 1e-5;
  for (size_t j = 0; j < n; ++j) {
    // What a table holds is remade at each step and has no derivative.
    bool tabled =
        std::string(name) == "roughplastic" && j < model.parameters().size() &&
        (model.parameters()[j].name == "alpha" || model.parameters()[j].name == "int_ior");
    if (tabled)
      continue;
    auto moved = [&](double by, std::vector<double>& out) {
      std::vector<double> y = x;
      y[j] += by;
      model.evaluate(model.state(y), data.rows, out.data(), nullptr);
    };
    moved(h, up);
    moved(-h, down);
    double largest = 0;
    for (size_t i = 0; i < count; ++i) {
      double slope = (up[i] - down[i]) / (2 * h), given = derivatives[i * n + j];
      ASSERT_NEAR(given, slope, 1e-5 * (std::abs(slope) + std::abs(values[i])) + 1e-12)
          << "number " << j << ", value " << i;
      largest = std::max(largest, std::abs(given));
    }
    EXPECT_GT(largest, 0) << "number " << j << " does nothing";
  }
}
INSTANTIATE_TEST_SUITE_P(Models, FitDerivatives,
                         testing::Values(Case{"hazygloss", 1}, Case{"hazygloss", 2},
                                         Case{"hazygloss", 3}, Case{"ggx", 2},
                                         Case{"roughconductor", 2}, Case{"roughplastic", 1},
                                         Case{"phong", 2}, Case{"blinnphong", 1}, Case{"ward", 2},
                                         Case{"orennayar", 1}, Case{"diffuse", 1}),
                         [](const auto& p) {
                           return p.param.model + std::to_string(p.param.lobes);
                         });

struct Known {
  const char* model;
  int lobes;
  const char* material;
  Settings settings;
};
class FitRecovery : public testing::TestWithParam<Known> {};

TEST_P(FitRecovery, FindsWhatTheDataWereMadeWith) {
  const Known& known = GetParam();
  FitData data = measured(known.material, known.settings);
  FitResult result = fit_material(data, {known.model, known.lobes});
  EXPECT_LT(result.errors.all[0], 1e-4);
  // The part that bears the settings, which are compared number by number.
  const Parameters& found = result.parts[0].parameters;
  Parameters wanted = make_parameters(known.material, known.settings);
  for (const auto& [name, text] : known.settings) {
    const ParamInfo& p = *wanted.descriptor().find(name);
    for (int k = 0; p.slot >= 0 && k < p.slots; ++k)
      EXPECT_NEAR(found.slots()[size_t(p.slot + k)], wanted.slots()[size_t(p.slot + k)],
                  0.02 * std::abs(wanted.slots()[size_t(p.slot + k)]) + 2e-3)
          << name;
  }
}
INSTANTIATE_TEST_SUITE_P(
    Models, FitRecovery,
    testing::Values(
        Known{"diffuse", 1, "diffuse", {{"reflectance", "0.7,0.2,0.05"}}},
        Known{"orennayar", 1, "orennayar", {{"reflectance", "0.7,0.2,0.05"}, {"sigma", "0.6"}}},
        Known{"phong",
              1,
              "phong",
              {{"exponent", "40"},
               {"diffuse_reflectance", "0.3,0.2,0.1"},
               {"specular_reflectance", "0.1,0.3,0.2"}}},
        Known{"blinnphong",
              1,
              "blinnphong",
              {{"exponent", "90"},
               {"diffuse_reflectance", "0.3,0.2,0.1"},
               {"specular_reflectance", "0.1,0.3,0.2"}}},
        Known{"ward",
              1,
              "ward",
              {{"alpha", "0.15"},
               {"diffuse_reflectance", "0.3,0.2,0.1"},
               {"specular_reflectance", "0.1,0.3,0.2"}}},
        Known{"roughplastic",
              1,
              "roughplastic",
              {{"distribution", "ggx"}, {"alpha", "0.2"}, {"diffuse_reflectance", "0.4,0.2,0.1"}}},
        Known{"ggx",
              1,
              "hazygloss",
              {{"diffuse_reflectance", "0.2,0.1,0.3"},
               {"gloss_normal", "0.2,0.3,0.1"},
               {"gloss_grazing", "0.9,0.8,0.7"},
               {"gloss_alpha", "0.12"},
               {"gloss_tail", "2"},
               {"haze_normal", "0"},
               {"haze_grazing", "0"}}},
        Known{"hazygloss",
              1,
              "hazygloss",
              {{"diffuse_reflectance", "0.2,0.1,0.3"},
               {"gloss_normal", "0.2,0.3,0.1"},
               {"gloss_grazing", "0.9,0.8,0.7"},
               {"gloss_fresnel", "4"},
               {"gloss_alpha", "0.12"},
               {"gloss_tail", "2.5"},
               {"gloss_along", "-0.3"},
               {"gloss_across", "0.5"},
               {"gloss_masking", "0.8"},
               {"haze_normal", "0"},
               {"haze_grazing", "0"}}}),
    [](const auto& p) { return std::string(p.param.model) + std::to_string(p.param.lobes); });

TEST(Fit, SumOfTwoKnownLobesIsFound) {
  FitData data = measured("hazygloss", {{"diffuse_reflectance", "0.1,0.2,0.05"},
                                        {"gloss_normal", "0.04"},
                                        {"gloss_grazing", "0.9"},
                                        {"gloss_alpha", "0.03"},
                                        {"gloss_tail", "3"},
                                        {"haze_normal", "0.2,0.1,0.05"},
                                        {"haze_grazing", "0.3"},
                                        {"haze_alpha", "0.25"},
                                        {"haze_tail", "2"}});
  FitResult result = fit_material(data, {"hazygloss", 2});
  EXPECT_EQ(result.parameters, 27);
  EXPECT_LT(result.errors.all[0], 2e-3);
}

TEST(Fit, RoughConductorWithBaseIsFound) {
  Parameters metal = make_parameters(
      "roughconductor", {{"material", "Au"}, {"distribution", "ggx"}, {"alpha", "0.2"}});
  Record record = metal.record();
  FitData data = sample_fit_target({[&](const Vec3<double>& wo, const Vec3<double>& wi) {
    Color<double> v = metal.model().eval(record, {wo, wi}).value;
    std::array<double, 3> f;
    for (int c = 0; c < 3; ++c)
      f[size_t(c)] = 0.6 * v[c] / wi.z + 0.4 * 0.3 * kInvPi;
    return f;
  }});
  FitResult result = fit_material(data, {"roughconductor", 1});
  EXPECT_LT(result.errors.all[0], 1e-3);
  ASSERT_EQ(result.parts.size(), 2u);
  EXPECT_NEAR(result.parts[0].share + result.parts[1].share, 1, 1e-12);
}

TEST(Fit, BicPrefersFewerNumbersWhereTheyDo) {
  FitData data = measured(
      "hazygloss",
      {{"haze_normal", "0"}, {"haze_grazing", "0"}, {"gloss_tail", "2"}, {"gloss_alpha", "0.3"}});
  FitResult one = fit_material(data, {"ggx", 0});
  ASSERT_EQ(one.candidates.size(), 2u);
  EXPECT_LT(one.candidates[0].parameters, one.candidates[1].parameters);
  EXPECT_LT(one.errors.all[0], 1e-3);
}

TEST(Fit, EachMetricIsLeastInItsOwn) {
  FitData data = measured("roughplastic", {{"alpha", "0.3"}}); // Beckmann: GGX cannot hit it
  std::array<FitErrors, 3> errors;
  for (int k = 0; k < 3; ++k)
    errors[size_t(k)] = fit_material(data, {"ggx", 1, static_cast<FitMetric>(k)}).errors.all;
  for (size_t k = 0; k < 3; ++k)
    for (size_t l = 0; l < 3; ++l)
      EXPECT_LE(errors[k][k], errors[l][k] * 1.01) << kFitMetricNames[k];
}

TEST(Fit, ResultIsTheSameForAnyNumberOfThreads) {
  FitData data = measured("ward", {{"alpha", "0.2"}});
  FitResult one = fit_material(data, {"ggx", 1, FitMetric::log, 1});
  FitResult two = fit_material(data, {"ggx", 1, FitMetric::log, 2});
  EXPECT_NEAR(one.errors.all[0], two.errors.all[0], 1e-6);
}

TEST(Fit, ErrorsAreThoseOfThePartsAsWritten) {
  FitData data = measured("ward", {{"alpha", "0.2"}});
  FitResult result = fit_material(data, {"phong", 2});
  std::vector<double> sum(3 * data.rows.size());
  for (const FitPart& part : result.parts) {
    Record record = part.parameters.record();
    for (size_t i = 0; i < data.rows.size(); ++i) {
      Color<double> v =
          part.parameters.model().eval(record, {data.rows[i].wo, data.rows[i].wi}).value;
      for (int c = 0; c < 3; ++c)
        sum[3 * i + size_t(c)] += part.share * v[c];
    }
  }
  EXPECT_NEAR(fit_errors(data, sum).all[0], result.errors.all[0], 1e-7);
}

TEST(Fit, NestedBlendsHaveThePartsShares) {
  FitData data = measured("ward", {{"alpha", "0.2"}});
  FitResult result = fit_material(data, {"phong", 3});
  ASSERT_EQ(result.parts.size(), 3u);
  std::shared_ptr<MaterialNode> node = fit_node(result);
  double left = 1; // blend: (1 - weight) first + weight second
  for (size_t k = 0; k < 3; ++k) {
    bool last = k == 2;
    ASSERT_EQ(node->kind, last ? MaterialNode::Kind::model : MaterialNode::Kind::blend);
    double weight = last ? 0 : node->weight.value[0];
    EXPECT_NEAR(left * (1 - weight), result.parts[k].share, 1e-12);
    const MaterialNode& leaf = last ? *node : *node->children[0];
    EXPECT_EQ(leaf.parameters->given(), result.parts[k].parameters.given());
    left *= weight;
    if (!last)
      node = node->children[1];
  }
}

TEST(Fit, JsonHoldsTheResult) {
  FitData data = measured("ward", {{"alpha", "0.2"}});
  FitResult result = fit_material(data, {"ggx", 0});
  auto json = nlohmann::json::parse(fit_json(result));
  EXPECT_EQ(json["errors"]["log"], result.errors.all[0]);
  EXPECT_EQ(json["free_parameters"], result.parameters);
  EXPECT_EQ(json["candidates"].size(), 2u);
  EXPECT_EQ(json["errors_by_theta_i"].size(), 8u);
  auto parameters = json["parts"][0]["material"]["parameters"];
  EXPECT_EQ(json["parts"][0]["material"]["model"], "hazygloss");
  const Parameters& p = result.parts[0].parameters;
  EXPECT_EQ(parameters["diffuse_reflectance"][1],
            p.slots()[size_t(p.descriptor().find("diffuse_reflectance")->slot) + 1]);
  EXPECT_EQ(parameters["gloss_alpha"], p.slots()[size_t(p.descriptor().find("gloss_alpha")->slot)]);
}

TEST(Fit, BadRequestsAreErrors) {
  FitData data = measured("diffuse", {});
  EXPECT_THROW(fit_material(data, {"mirror", 1}), Error);
  EXPECT_THROW(fit_material(data, {"diffuse", 2}), Error);
  EXPECT_THROW(FitModel("hazygloss", 4), Error);
}

TEST(Fit, FewRowsAreFitted) {
  FitData data = thin_out(measured("diffuse", {{"reflectance", "0.4"}}), 20000);
  ASSERT_LE(data.rows.size(), 3u);
  FitResult result = fit_material(data, {"diffuse", 1});
  EXPECT_NEAR(result.parts[0].parameters.slots()[0], 0.4, 1e-3);
}

} // namespace
} // namespace faceta
