#include "bsdf/rough_interface.h"
#include "materials/plastic.h"
#include "materials/roughplastic.h"
#include "model_checks.h"

namespace faceta {
namespace {

struct Setting {
  int rough, ggx;
  double alpha;
  int nonlinear;
  double int_ior, ext_ior;
};
struct EvalRow {
  Setting setting;
  double cos_o, cos_i, dphi;
  double value[3];
};
struct WeightRow {
  Setting setting;
  double cos_o;
  double weight[3], error[3];
};
#include "plastic_mitsuba.inc"

/// A model with the tables it points into.
template <class M> struct Made {
  std::vector<float> arena;
  M model;

  explicit Made(const M& parameters) : model(parameters) {
    PrepareOnce once{arena};
    model.prepare_once(once);
    if constexpr (requires { model.transmittance; })
      model.transmittance.base = arena.data();
    model.prepare();
  }
};
template <class M> M with(const Setting& s) {
  M m;
  m.diffuse_reflectance = {0.6, 0.3, 0.05};
  m.specular_reflectance = {1, 0.7, 0.4};
  m.nonlinear = s.nonlinear;
  m.int_ior = s.int_ior;
  m.ext_ior = s.ext_ior;
  if constexpr (requires { m.alpha; }) {
    m.alpha = s.alpha;
    m.distribution = s.ggx;
  }
  return m;
}

TEST(Plastic, ValuesAreMitsubas) {
  for (const EvalRow& row : kEvals) {
    Direction wo = direction(row.cos_o, 0.3), wi = direction(row.cos_i, 0.3 + row.dphi);
    Eval<double> e =
        row.setting.rough
            ? Made<RoughPlastic<double>>(with<RoughPlastic<double>>(row.setting))
                  .model.eval(wo, wi, {})
            : Made<Plastic<double>>(with<Plastic<double>>(row.setting)).model.eval(wo, wi, {});
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(e.value[k], row.value[k], 1e-4 * row.value[k])
          << "rough " << row.setting.rough << " ggx " << row.setting.ggx << " alpha "
          << row.setting.alpha << " ior " << row.setting.int_ior << " cos_o " << row.cos_o;
  }
}

TEST(Plastic, MeanWeightsAreMitsubas) {
  for (const WeightRow& row : kWeights) {
    Direction wo = direction(row.cos_o, 0.3);
    Color<double> mean =
        row.setting.rough
            ? mean_sampled_weight(
                  Made<RoughPlastic<double>>(with<RoughPlastic<double>>(row.setting)).model, wo)
            : mean_sampled_weight(Made<Plastic<double>>(with<Plastic<double>>(row.setting)).model,
                                  wo);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(mean[k], row.weight[k], 4 * row.error[k] + 1e-3)
          << "rough " << row.setting.rough << " alpha " << row.setting.alpha << " cos_o "
          << row.cos_o;
  }
}

// By energy, (1 - R(eta)) / eta^2 = 1 - R(1/eta): a white base under a clear coat returns all
// light, up to the error of the fitted R (0.12 % here).
TEST(Plastic, WhiteReturnsAllLight) {
  for (double ior : {1.0, 1.33, 1.5, 1.9}) {
    Plastic<double> white;
    white.diffuse_reflectance = Color<double>(1.0);
    white.int_ior = ior;
    white.ext_ior = 1;
    Made<Plastic<double>> made(white);
    for (double cosine : {1.0, 0.5, 0.1}) {
      Direction wo = direction(cosine);
      double coat = fresnel_dielectric(cosine, ior).reflectance;
      EXPECT_NEAR(albedo(made.model, wo)[0] + coat, 1, 1.5e-3) << ior << " " << cosine;
    }
  }
}

TEST(Plastic, MirrorLobeIsADelta) {
  Made<Plastic<double>> made{Plastic<double>{}};
  Direction wo = direction(0.6);
  Sample<double> s = made.model.sample(wo, {{0.3, 0.7}, 0.0}, {});
  double f = fresnel_dielectric(0.6, 1.49 / 1.000277).reflectance;
  double p = f * 2 / (f * 2 + (1 - f)); // P ~ F s : (1 - F)(1 - s) with s = 2/3
  EXPECT_TRUE(s.delta && s.valid);
  EXPECT_DOUBLE_EQ(s.wi.x, -wo.x);
  EXPECT_NEAR(s.pdf, p, 1e-12);
  EXPECT_NEAR(s.weight[0], f / p, 1e-12);
  EXPECT_EQ(s.value[0], 0);
  // The same direction has only the diffuse value when asked for.
  EXPECT_NEAR(made.model.eval(wo, s.wi, {}).pdf, (1 - p) * 0.6 / kPi, 1e-12);
}

TEST(Plastic, MeansChooseTheLobe) {
  Plastic<double> m;
  m.diffuse_reflectance = {0.3, 0.6, 0.9};
  m.specular_reflectance = {0.1, 0.2, 0.3};
  EXPECT_NEAR(Made<Plastic<double>>(m).model.specular_share, 0.25, 1e-12);
  m.diffuse_reflectance = m.specular_reflectance = Color<double>(0.0);
  EXPECT_EQ(Made<Plastic<double>>(m).model.specular_share, 0.5);
}

TEST(RoughPlastic, DensityIsTrue) {
  for (int visible : {0, 1})
    for (int ggx : {0, 1}) {
      RoughPlastic<double> m;
      m.sample_visible = visible;
      m.distribution = ggx;
      m.alpha = 0.4;
      Made<RoughPlastic<double>> made(m);
      for (double cosine : {1.0, 0.5, 0.15})
        expect_true_density(made.model, direction(cosine));
    }
}

// Without an interface everything passes: T is the masking's mean, near 1 when smooth, and R is 0.
TEST(RoughInterface, Limits) {
  RoughInterface none = rough_interface(kGgx, 0.05, 1.0, 16);
  EXPECT_NEAR(none.internal_reflectance, 0, 1e-6);
  EXPECT_NEAR(none.transmittance[15], 1, 2e-3);
  // Smooth: the Fresnel transmittance, and its diffuse mean from inside (1.5: 0.596, Egan and
  // Hilgeman 1979).
  for (int distribution : {kBeckmann, kGgx}) {
    RoughInterface smooth = rough_interface(distribution, 1e-3, 1.5, 64);
    for (int k = 4; k < 64; k += 7) {
      double f = fresnel_dielectric(k / 63.0, 1.5).reflectance;
      EXPECT_NEAR(smooth.transmittance[k], 1 - f, 1e-3) << k;
    }
    EXPECT_NEAR(smooth.internal_reflectance, 0.596, 0.02); // 64 cosines sum coarsely
  }
}

TEST(Plastic, FloatAgreesWithDouble) {
  auto wos = float_directions(300, 11), wis = float_directions(300, 12);
  for (float diffuse : {0.0f, 0.5f}) {
    Plastic<float> single;
    Plastic<double> precise;
    single.diffuse_reflectance = Color<float>(diffuse);
    precise.diffuse_reflectance = Color<double>(diffuse);
    single.int_ior = 1.49f;
    precise.int_ior = 1.49f;
    single.ext_ior = 1.000277f;
    precise.ext_ior = 1.000277f;
    Made<Plastic<double>> made(precise);
    single.specular_share = float(made.model.specular_share);
    made.model.specular_share = single.specular_share;
    expect_float_agrees(prepared(single), made.model, wos, wis);
  }
}

} // namespace
} // namespace faceta
