#include "base/error.h"
#include "verify/plot_data.h"

#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace faceta;

Subject subject(const std::string& model, const Settings& settings = {}) {
  Parameters p = make_parameters(model, settings);
  return Subject(p.model(), p);
}

/// Fresnel reflectance of unpolarised light, from index 1 to n (Born and Wolf, 1.5.2).
double fresnel(double degrees, double n) {
  double i = degrees * kPi / 180, t = std::asin(std::sin(i) / n);
  if (i == 0)
    return std::pow((n - 1) / (n + 1), 2);
  double s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
  return (s * s + p * p) / 2;
}

TEST(Channel, Luminance) {
  Color<double> c(0.5, 0.25, 1);
  EXPECT_EQ(channel_of(c, PlotChannel::red), 0.5);
  EXPECT_EQ(channel_of(c, PlotChannel::green), 0.25);
  EXPECT_EQ(channel_of(c, PlotChannel::blue), 1);
  EXPECT_NEAR(channel_of(Color<double>(1, 1, 1), PlotChannel::luminance), 1, 1e-12);
  EXPECT_NEAR(channel_of(c, PlotChannel::luminance), 0.3573, 1e-12); // Rec. 709
}

TEST(Polar, LambertIsACosine) {
  auto radius = [](double v) { return v; };
  Subject s = subject("diffuse", {{"reflectance", "0.8,0.4,0.2"}});
  for (double theta : {0.0, 75.0}) {
    auto points = polar_curve(s, theta, 20, PlotChannel::green, radius, 1e-4);
    double last = -4;
    for (const auto& p : points) {
      EXPECT_GT(p.x, last);
      last = p.x;
      EXPECT_NEAR(p.y, 0.4 * std::max(0.0, std::cos(p.x)) / kPi, 1e-8);
    }
    EXPECT_NEAR(points.front().x, -kPi, 1e-12);
    EXPECT_NEAR(points.back().x, kPi, 1e-12);
  }
}

TEST(Polar, NarrowLobesAreFound) {
  auto radius = [](double v) { return v; };
  for (double theta : {0.0, 30.0, 75.0}) {
    Subject s = subject("roughconductor", {{"distribution", "ggx"}, {"alpha", "0.001"}});
    double largest = 0, where = 0;
    for (const auto& p : polar_curve(s, theta, 0, PlotChannel::luminance, radius, 1))
      if (p.y > largest)
        largest = p.y, where = p.x;
    EXPECT_NEAR(where, theta * kPi / 180, 2e-3); // the mirror direction
    // D(n) = 1 / (pi alpha^2), F <= 1 and above 0.85 for this metal, G nearly 1.
    double peak = 1 / (kPi * 1e-6) / (4 * std::cos(theta * kPi / 180));
    EXPECT_GT(largest, 0.8 * peak);
    EXPECT_LT(largest, 1.05 * peak);
  }
}

TEST(Delta, WeightsAreFresnels) {
  Subject s = subject("dielectric", {{"int_ior", "1.5"}, {"ext_ior", "1"}});
  for (double theta : {0.0, 40.0, 80.0}) {
    auto lobes = delta_lobes(s, plot_viewer(theta, 0), PlotChannel::luminance);
    ASSERT_EQ(lobes.size(), 2u);
    for (const DeltaLobe& l : lobes) {
      double r = fresnel(theta, 1.5), sine = std::sin(theta * kPi / 180);
      EXPECT_NEAR(l.weight, l.lobe == kReflection ? r : 1 - r, 1e-6);
      EXPECT_NEAR(l.wi.x, l.lobe == kReflection ? sine : sine / 1.5, 1e-6);
      EXPECT_EQ(l.wi.z > 0, l.lobe == kReflection);
    }
  }
  EXPECT_TRUE(delta_lobes(subject("diffuse"), {0, 0, 1}, PlotChannel::luminance).empty());
}

TEST(Albedo, LambertIsFlat) {
  Subject s = subject("diffuse", {{"reflectance", "0.8,0.3,0.05"}});
  for (double theta : {0.0, 30.0, 60.0, 89.0}) {
    Vec3<double> wo = plot_viewer(theta, 0);
    EXPECT_NEAR(directional_albedo(s, wo, PlotChannel::red).total(), 0.8, 1e-6);
    EXPECT_NEAR(directional_albedo(s, wo, PlotChannel::green).reflection, 0.3, 1e-6);
    EXPECT_EQ(directional_albedo(s, wo, PlotChannel::blue).transmission, 0);
  }
}

TEST(Albedo, GlassReflectsByFresnelAndLosesNothing) {
  Subject s = subject("dielectric", {{"int_ior", "1.5"}, {"ext_ior", "1"}});
  for (double theta : {0.0, 56.31, 85.0}) {
    Albedo a = directional_albedo(s, plot_viewer(theta, 0), PlotChannel::luminance);
    EXPECT_NEAR(a.reflection, fresnel(theta, 1.5), 1e-6);
    EXPECT_NEAR(a.total(), 1, 1e-6);
  }
  // Beyond the critical angle of 41.8 degrees nothing leaves the glass.
  Albedo inside = directional_albedo(s, plot_viewer(180 - 50, 0), PlotChannel::luminance);
  EXPECT_NEAR(inside.reflection, 1, 1e-6);
  EXPECT_NEAR(inside.transmission, 0, 1e-6);
}

TEST(Albedo, AgreesWithTheMeanOfSampledWeights) {
  const std::pair<const char*, Settings> cases[] = {
      {"roughconductor", {{"distribution", "ggx"}, {"alpha_u", "0.02"}, {"alpha_v", "0.4"}}},
      {"roughdielectric", {{"alpha", "0.001"}}},
      {"roughdielectric", {{"alpha", "0.5"}}},
      {"roughplastic", {{"alpha", "0.05"}}},
      {"orennayar", {{"sigma", "1"}}},
      {"plastic", {}},
  };
  constexpr int kSamples = 1 << 17;
  for (const auto& [model, settings] : cases)
    for (double theta : {0.0, 70.0}) {
      Subject s = subject(model, settings);
      Vec3<double> wo = plot_viewer(theta, 25);
      WeightStudy w = study_weights(s, wo, PlotChannel::luminance, kSamples, 5);
      double error = w.mean * w.variation / std::sqrt(double(kSamples));
      EXPECT_NEAR(directional_albedo(s, wo, PlotChannel::luminance).total(), w.mean,
                  5 * error + 2e-5)
          << model << " at " << theta;
    }
}

TEST(Weights, OfAPerfectSampler) {
  WeightStudy w = study_weights(subject("diffuse", {{"reflectance", "0.25"}}), {0, 0, 1},
                                PlotChannel::luminance, 4096, 1);
  EXPECT_NEAR(w.mean, 0.25, 1e-6);
  EXPECT_NEAR(w.variation, 0, 1e-5);
  for (double q : w.quantiles)
    EXPECT_NEAR(q, 0.25, 1e-6);
  EXPECT_TRUE(std::isnan(study_weights(subject("diffuse", {{"reflectance", "0"}}), {0, 0, 1},
                                       PlotChannel::luminance, 256, 1)
                             .variation));
}

TEST(Weights, QuantilesAreInOrder) {
  // Oren-Nayar's weights are spread; the median of a spread sample lies between its quartiles.
  WeightStudy w = study_weights(subject("orennayar", {{"sigma", "1"}}), plot_viewer(80, 0),
                                PlotChannel::luminance, 1 << 15, 1);
  for (int k = 1; k < 5; ++k)
    EXPECT_LT(w.quantiles[k - 1], w.quantiles[k]);
  EXPECT_GT(w.variation, 0.1);
}

TEST(Slice, LambertIsConstant) {
  for (double v :
       image_slice(subject("diffuse", {{"reflectance", "0.6"}}), 20, 30, PlotChannel::luminance))
    EXPECT_NEAR(v, 0.6 / kPi, 1e-8);
}

TEST(Slice, BottomRowIsTheNormalDistribution) {
  // Light and viewer together: f = F(0) D(h) G^2 / (4 cos^2), GGX by Walter et al. 2007.
  constexpr int kCells = 90;
  double alpha = 0.4, reflectance = 0.04; // of index 1.5 at the normal
  Subject s = subject("roughconductor",
                      {{"distribution", "ggx"}, {"alpha", "0.4"}, {"eta", "1.5"}, {"k", "0"}});
  std::vector<double> slice = image_slice(s, kCells, 0, PlotChannel::luminance);
  for (int column : {0, 20, 50, 80}) {
    double h = (column + 0.5) * kPi / 180, c2 = std::cos(h) * std::cos(h);
    double tan2 = (1 - c2) / c2;
    double d = 1 / (kPi * alpha * alpha * c2 * c2 * std::pow(1 + tan2 / (alpha * alpha), 2));
    double g1 = 2 / (1 + std::sqrt(1 + alpha * alpha * tan2));
    double expected = reflectance * d * g1 * g1 / (4 * c2);
    EXPECT_NEAR(slice[size_t(kCells - 1) * kCells + column] / expected, 1, 2e-3) << column;
  }
  // Towards grazing Fresnel grows: the top row is the brighter one.
  EXPECT_GT(slice[0], 10 * slice[size_t(kCells - 1) * kCells]);
}

TEST(Projection, KeepsAreas) {
  for (double z : {1.0, 0.9, 0.5, 0.0, -0.3}) {
    double r = std::sqrt(1 - z * z);
    Vec2<double> p = project({0.6 * r, -0.8 * r, z});
    EXPECT_NEAR(p.x * p.x + p.y * p.y, 1 - std::abs(z), 1e-12); // a cap has the area 2 pi (1 - z)
    EXPECT_NEAR(p.x * -0.8, p.y * 0.6, 1e-12);
  }
}

TEST(Density, OfLambertIsTheCosineAndSumsToOne) {
  HemisphereMap map = density_map(subject("diffuse"), plot_viewer(60, 0), false, 40);
  EXPECT_NEAR(map.mass(), 1, 1e-4);
  for (int row = 5; row < 35; ++row)
    for (int column = 5; column < 35; ++column) {
      double x = -1 + (column + 0.5) / 20, y = 1 - (row + 0.5) / 20;
      if (std::hypot(x, y) < 0.9) {
        EXPECT_NEAR(map.cells[row * 40 + column], (1 - x * x - y * y) / kPi, 1e-3);
      }
    }
  EXPECT_TRUE(std::isnan(map.cells[0])); // the corner
}

TEST(Density, AgreesWithTheHistogram) {
  const std::pair<const char*, Settings> cases[] = {
      {"roughdielectric", {{"alpha", "0.3"}}},
      {"roughconductor", {{"distribution", "ggx"}, {"alpha_u", "0.05"}, {"alpha_v", "0.4"}}},
      {"roughconductor", {{"alpha", "0.002"}}},
  };
  constexpr long kSamples = 1 << 18;
  for (const auto& [model, settings] : cases) {
    Subject s = subject(model, settings);
    Vec3<double> wo = plot_viewer(50, 30);
    auto samples = sample_maps(s, wo, 24, kSamples, 3);
    double mass = 0, counted = 0;
    for (bool below : {false, true}) {
      if (below && !s.transmissive())
        continue;
      HemisphereMap map = density_map(s, wo, below, 24);
      mass += map.mass();
      counted += samples[below].mass();
      for (size_t i = 0; i < map.cells.size(); ++i) {
        ASSERT_EQ(std::isnan(map.cells[i]), std::isnan(samples[below].cells[i]));
        if (std::isnan(map.cells[i]))
          continue;
        double expected = map.cells[i] * map.solid_angle() * kSamples;
        double came = samples[below].cells[i] * map.solid_angle() * kSamples;
        EXPECT_NEAR(came, expected, 6 * std::sqrt(expected + 4)) << model << " cell " << i;
      }
    }
    EXPECT_NEAR(mass, counted, 5e-3) << model;
    EXPECT_LT(mass, 1.0005);
  }
}

TEST(Reciprocity, OfModels) {
  for (const char* model : {"diffuse", "roughconductor", "roughdielectric", "orennayar"}) {
    ReciprocityMap map = reciprocity_map(subject(model), 12);
    EXPECT_LT(map.largest, 1e-11) << model;
    EXPECT_EQ(map.high, std::string(model) == "roughdielectric" ? 180 : 90);
  }
}

TEST(Reciprocity, AOneWayModelIsSeen) {
  Model model = Registry::global().get("diffuse");
  model.eval = [](const Record&, const ReferenceQuery& q) {
    Eval<double> e; // f = cos of the viewer
    e.value = Color<double>(q.wo.z > 0 && q.wi.z > 0 ? q.wo.z * q.wi.z : 0.0);
    e.pdf = 1;
    return e;
  };
  Subject s(model, Parameters(model));
  ReciprocityMap map = reciprocity_map(s, 6);
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column) {
      double a = std::cos((column + 0.5) * 15 * kPi / 180);
      double b = std::cos((5 - row + 0.5) * 15 * kPi / 180);
      EXPECT_NEAR(map.cells[row * 6 + column], std::abs(a - b) / std::max(a, b), 1e-9);
    }
}

} // namespace
