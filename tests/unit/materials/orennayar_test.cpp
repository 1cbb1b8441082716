#include "materials/diffuse.h"
#include "materials/orennayar.h"
#include "model_checks.h"

namespace faceta {
namespace {

using Model = OrenNayar<double>;

Model make(int variant, double sigma, double rho = 1) {
  Model m;
  m.model = variant;
  m.sigma = sigma;
  m.reflectance = Color<double>(rho);
  return prepared(m);
}

struct AlbedoRow {
  int variant;
  double sigma, cosine[3];
};

// Albedo for rho = 1 at cos theta = 1, 0.5, 0.1: the binding reference values of the project,
// integrated from the equations of Oren and Nayar 1994 independently of this code.
TEST(OrenNayar, AlbedoTable) {
  const AlbedoRow rows[] = {
      {Model::kFull, 0.2, {.986, .999, 1.026}},  {Model::kFull, 0.5, {.896, .927, .991}},
      {Model::kFull, 1.0, {.775, .813, .893}},   {Model::kSimple, 0.2, {.946, .987, 1.010}},
      {Model::kSimple, 0.5, {.785, .883, .939}}, {Model::kSimple, 1.0, {.624, .747, .816}}};
  for (const AlbedoRow& row : rows)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(albedo(make(row.variant, row.sigma), direction(k == 0   ? 1
                                                                 : k == 1 ? .5
                                                                          : .1))[0],
                  row.cosine[k], 1e-3)
          << "variant " << row.variant << " sigma " << row.sigma;
}

// The full model exceeds 1 most at sigma = 0.3 and grazing: 4.4 % at 89 degrees, about 5 % beyond.
TEST(OrenNayar, FullModelStaysBelowItsBound) {
  EXPECT_NEAR(albedo(make(Model::kFull, 0.3), direction(std::cos(89 * kPi / 180)))[0], 1.044, 1e-3);
  for (double sigma = 0; sigma <= 1.6; sigma += 0.1)
    for (double cosine : {1.0, 0.7, 0.4, 0.2, 0.05, 0.01})
      EXPECT_LT(albedo(make(Model::kFull, sigma), direction(cosine), 100)[0], 1.05)
          << sigma << " " << cosine;
  EXPECT_NEAR(albedo(make(Model::kFull, 0.3), direction(1e-3), 700)[0], 1.050, 1e-3);
}

TEST(OrenNayar, SmoothIsLambertExactly) {
  Diffuse<double> lambert;
  lambert.reflectance = Color<double>(0.7);
  for (int variant : {Model::kFull, Model::kSimple, Model::kEon})
    for (double zo : {1.0, 0.6, 0.01})
      for (double zi : {1.0, 0.3, 0.001}) {
        Direction wo = direction(zo), wi = direction(zi, 2.5);
        Eval<double> a = make(variant, 0, 0.7).eval(wo, wi, {}), b = lambert.eval(wo, wi, {});
        EXPECT_DOUBLE_EQ(a.value[0], b.value[0]);
        EXPECT_NEAR(a.pdf, b.pdf, 1e-15);
      }
}

// The paper's equations with angles from the inverse functions, as they are printed.
double printed_full(double rho, double sigma, double ti, double to, double dphi) {
  double a = std::max(ti, to), b = std::min(ti, to), s2 = sigma * sigma, c = std::cos(dphi);
  double c1 = 1 - 0.5 * s2 / (s2 + 0.33);
  double c2 =
      0.45 * s2 / (s2 + 0.09) * (c >= 0 ? std::sin(a) : std::sin(a) - std::pow(2 * b / kPi, 3));
  double c3 = 0.125 * s2 / (s2 + 0.09) * std::pow(4 * a * b / (kPi * kPi), 2);
  double f1 =
      rho / kPi * (c1 + c * c2 * std::tan(b) + (1 - std::abs(c)) * c3 * std::tan((a + b) / 2));
  double f2 = 0.17 * rho * rho / kPi * s2 / (s2 + 0.13) * (1 - c * std::pow(2 * b / kPi, 2));
  return std::max(f1 + f2, 0.02 * rho / kPi) * std::cos(ti);
}

TEST(OrenNayar, FullModelIsThePrintedOne) {
  int floored = 0;
  for (double sigma : {0.1, 0.3, 1.0, 1.5})
    for (double rho : {0.02, 0.5, 1.0})
      for (double to : {0.0, 0.3, 0.9, 1.4, 1.56})
        for (double ti : {0.0, 0.2, 0.8, 1.3, 1.57})
          for (double dphi : {0.0, 0.7, 1.5, 1.6, 2.5, 3.14}) {
            double value =
                make(Model::kFull, sigma, rho)
                    .eval(direction(std::cos(to), 0.2), direction(std::cos(ti), 0.2 + dphi), {})
                    .value[0];
            double expected = printed_full(rho, sigma, ti, to, dphi);
            EXPECT_NEAR(value, expected, 1e-12 + 1e-9 * expected);
            floored += expected < 0.021 * rho / kPi * std::cos(ti);
          }
  EXPECT_GT(floored, 0); // the floor under the fit is part of what was compared
}

TEST(OrenNayar, SimpleModelIsThePrintedOne) {
  for (double to : {0.0, 0.3, 1.4})
    for (double ti : {0.2, 1.3, 1.57})
      for (double dphi : {0.0, 0.7, 2.5}) {
        double s2 = 0.25, a = 1 - s2 / (2 * (s2 + 0.33)), b = 0.45 * s2 / (s2 + 0.09);
        double expected = 0.8 / kPi * std::cos(ti) *
                          (a + b * std::max(0.0, std::cos(dphi)) * std::sin(std::max(ti, to)) *
                                   std::tan(std::min(ti, to)));
        double value =
            make(Model::kSimple, 0.5, 0.8)
                .eval(direction(std::cos(to), 0.2), direction(std::cos(ti), 0.2 + dphi), {})
                .value[0];
        EXPECT_NEAR(value, expected, 1e-12);
      }
}

TEST(OrenNayar, EonLosesNothing) {
  for (double r : {0.0, 0.2, 0.5, 1.0})
    for (double cosine : {1.0, 0.8, 0.5, 0.1, 0.01})
      EXPECT_NEAR(albedo(make(Model::kEon, r), direction(cosine))[0], 1, 2e-4)
          << r << " " << cosine;
}

// Below rho = 1: E = rho E_F + rho_ms (1 - E_F), with the paper's closed form of E_F (JCGT 14(1)).
TEST(OrenNayar, EonAlbedoInClosedForm) {
  double k1 = 0.5 - 2 / (3 * kPi), k2 = 2.0 / 3 - 28 / (15 * kPi);
  for (double r : {0.3, 1.0})
    for (double mu : {0.9, 0.4, 0.05}) {
      double rho = 0.6, a = 1 / (1 + k1 * r), s = std::sqrt(1 - mu * mu);
      double g = s * (std::acos(mu) - s * mu) + 2.0 / 3 * (s / mu * (1 - s * s * s) - s);
      double single = a + r * a / kPi * g, average = a * (1 + k2 * r);
      double multiple = rho * rho * average / (1 - rho * (1 - average));
      EXPECT_NEAR(albedo(make(Model::kEon, r, rho), direction(mu))[0],
                  rho * single + multiple * (1 - single), 2e-4);
    }
}

TEST(OrenNayar, DensityIsTrue) {
  for (double cosine : {1.0, 0.5, 0.1}) {
    EXPECT_NEAR(expect_true_density(make(Model::kFull, 0.5), direction(cosine)), 1, 1e-3);
    EXPECT_NEAR(expect_true_density(make(Model::kEon, 0.3), direction(cosine)), 1, 1e-3);
    EXPECT_NEAR(expect_true_density(make(Model::kEon, 1), direction(cosine)), 1, 1e-3);
  }
}

// Weights of the fitted lobe vary little: the fit is the published one (its paper reports far less
// variance than cosine sampling has at grazing angles).
TEST(OrenNayar, EonSamplingBeatsTheCosine) {
  Model m = make(Model::kEon, 1);
  Direction wo = direction(0.05);
  double square = 0, square_cosine = 0;
  constexpr int n = 200;
  for (int i = 0; i < n * n; ++i) {
    Random<double> r{{(i % n + 0.5) / n, (i / n + 0.5) / n}, std::fmod(i * 0.61803398875, 1.0)};
    double weight = m.sample(wo, r, {}).weight[0];
    square += weight * weight / (n * n);
    Direction wi = cosine_hemisphere(r.u);
    double cosine_weight = m.eval(wo, wi, {}).value[0] * kPi / wi.z;
    square_cosine += cosine_weight * cosine_weight / (n * n);
  }
  EXPECT_LT(square - 1, 0.25 * (square_cosine - 1));
}

TEST(OrenNayar, FloatAgreesWithDouble) {
  auto wos = float_directions(400, 1), wis = float_directions(400, 2);
  for (int variant : {Model::kFull, Model::kSimple, Model::kEon})
    for (float sigma : {0.0f, 0.3f, 1.0f, 1.5f}) {
      OrenNayar<float> single;
      single.model = variant;
      single.sigma = sigma;
      single.reflectance = Color<float>(0.75f);
      expect_float_agrees(prepared(single), make(variant, sigma, 0.75), wos, wis);
    }
}

TEST(OrenNayar, NothingBelowTheSurface) {
  for (int variant : {Model::kFull, Model::kSimple, Model::kEon}) {
    Model m = make(variant, 0.5);
    Direction up = direction(0.5), down{up.x, up.y, -up.z};
    for (auto& e : {m.eval(up, down, {}), m.eval(down, up, {}), m.eval(down, down, {})}) {
      EXPECT_EQ(e.value[0], 0);
      EXPECT_EQ(e.pdf, 0);
    }
    EXPECT_FALSE(m.sample(down, {{0.3, 0.4}, 0.5}, {}).valid);
  }
}

} // namespace
} // namespace faceta
