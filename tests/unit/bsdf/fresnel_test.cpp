#include "base/jet.h"
#include "bsdf/fresnel.h"

#include <complex>
#include <gtest/gtest.h>

namespace faceta {
namespace {

/// The definition: |r|^2 of both polarisations from complex Snell, independent of the closed form.
double conductor_by_definition(double cos_i, double eta, double k) {
  std::complex<double> n(eta, k);
  std::complex<double> cos_t = std::sqrt(1.0 - (1 - cos_i * cos_i) / (n * n));
  std::complex<double> s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
  std::complex<double> p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
  return 0.5 * (std::norm(s) + std::norm(p));
}

TEST(Fresnel, ConductorIsItsDefinition) {
  for (double eta : {0.05, 0.143245, 0.9, 1.5, 4.4})
    for (double k : {0.01, 0.5, 2.3847, 9.2})
      for (double c = 0; c <= 1; c += 0.0625) {
        double expected = conductor_by_definition(c, eta, k);
        EXPECT_NEAR(fresnel_conductor(c, eta, k), expected, 1e-12) << eta << " " << k << " " << c;
        EXPECT_NEAR(fresnel_conductor(float(c), float(eta), float(k)), expected, 2e-6);
      }
}

TEST(Fresnel, ConductorAtItsEnds) {
  // Normal incidence: ((eta-1)^2 + k^2) / ((eta+1)^2 + k^2); grazing: 1; no absorption: a
  // dielectric.
  EXPECT_NEAR(fresnel_conductor(1.0, 0.143245, 3.98479),
              (sqr(0.143245 - 1) + sqr(3.98479)) / (sqr(0.143245 + 1) + sqr(3.98479)), 1e-14);
  EXPECT_NEAR(fresnel_conductor(0.0, 0.4, 2.0), 1, 1e-12);
  for (double c = 0.05; c <= 1; c += 0.05)
    EXPECT_NEAR(fresnel_conductor(c, 1.5, 0.0), fresnel_dielectric(c, 1.5).reflectance, 1e-12);
  for (float c : {0.f, 0.3f, 1.f}) {
    EXPECT_EQ(fresnel_conductor(c, 0.f, 1.f), 1.f); // the perfect mirror exactly
    EXPECT_EQ(fresnel_conductor(c, 0.f, 0.f), 1.f); // no 0 / 0
  }
}

TEST(Fresnel, ConductorMeanIsTheIntegral) {
  Color<double> mean =
      fresnel_conductor_mean<double>({0.143245, 0.377423, 1.43919}, {3.98479, 2.3847, 1.60434});
  for (int channel = 0; channel < 3; ++channel) {
    double sum = 0;
    int n = 20000;
    for (int i = 0; i < n; ++i) {
      double c = (i + 0.5) / n;
      const double eta[] = {0.143245, 0.377423, 1.43919}, k[] = {3.98479, 2.3847, 1.60434};
      sum += 2 * c * conductor_by_definition(c, eta[channel], k[channel]) / n;
    }
    EXPECT_NEAR(mean[channel], sum, 1e-4);
  }
}

TEST(Fresnel, DielectricAtItsEnds) {
  EXPECT_NEAR(fresnel_dielectric(1.0, 1.5).reflectance, 0.04, 1e-15);
  EXPECT_NEAR(fresnel_dielectric(-1.0, 1.5).reflectance, 0.04, 1e-15);
  EXPECT_NEAR(fresnel_dielectric(1e-9, 1.5).reflectance, 1, 1e-8);
  EXPECT_EQ(fresnel_dielectric(0.f, 1.5f).reflectance, 1.f);
  EXPECT_EQ(fresnel_dielectric(0.f, 1.f).reflectance, 0.f);
  EXPECT_EQ(fresnel_dielectric(0.3f, 1.f).reflectance, 0.f);
  EXPECT_EQ(fresnel_dielectric(0.3f, 1.f).transmittance, 1.f);
}

TEST(Fresnel, BrewstersAngleReflectsOnePolarisation) {
  double eta = 1.5, c = 1 / std::sqrt(1 + eta * eta); // tan theta_B = eta
  // r_p = 0, and r_s = (1 - eta^2) / (1 + eta^2) there.
  double s = (1 - eta * eta) / (1 + eta * eta);
  EXPECT_NEAR(fresnel_dielectric(c, eta).reflectance, 0.5 * s * s, 1e-14);
}

TEST(Fresnel, TotalInternalReflection) {
  double eta = 1.5, critical = std::sqrt(1 - 1 / (eta * eta));
  for (double c : {0.0, 0.2, critical - 1e-9}) {
    EXPECT_EQ(fresnel_dielectric(-c - 1e-300, eta).reflectance, 1) << c;
    EXPECT_EQ(fresnel_dielectric(-c - 1e-300, eta).cos_t, 0) << c;
    EXPECT_EQ(fresnel_dielectric(-c - 1e-300, eta).transmittance, 0) << c;
  }
  EXPECT_LT(fresnel_dielectric(-critical - 1e-3, eta).reflectance, 0.9);
}

TEST(Fresnel, BothSidesAgreeAndTheSharesAddUp) {
  for (double eta : {1.0003, 1.33, 1.5046, 2.419, 0.7})
    for (double c = 0.01; c <= 1; c += 0.01) {
      DielectricFresnel<double> in = fresnel_dielectric(c, eta);
      EXPECT_NEAR(in.reflectance + in.transmittance, 1, 1e-14);
      EXPECT_NEAR(in.eta_it * in.eta_ti, 1, 1e-15);
      if (in.reflectance == 1)
        continue;
      EXPECT_LT(in.cos_t, 0);
      DielectricFresnel<double> back = fresnel_dielectric(in.cos_t, eta);
      EXPECT_NEAR(back.reflectance, in.reflectance, 1e-10);
      EXPECT_NEAR(back.cos_t, c, 1e-10);
    }
}

TEST(Fresnel, TransmittanceKeepsItsDigitsNearTheCriticalAngle) {
  float eta = 1.5f;
  double critical = std::sqrt(1 - 1 / 2.25);
  for (double above : {1e-3, 1e-5}) {
    float c = float(critical + above);
    double exact = fresnel_dielectric(-double(c), double(eta)).transmittance;
    EXPECT_NEAR(fresnel_dielectric(-c, eta).transmittance / exact, 1, 1e-7 / above);
  }
}

TEST(Fresnel, SnellsLaw) {
  for (double eta : {1.33, 2.419, 0.6})
    for (double c : {0.9, 0.5, 0.1, -0.95, -0.85}) {
      double sine = std::sqrt(1 - c * c);
      Vec3<double> w{sine * 0.6, sine * 0.8, c};
      DielectricFresnel<double> f = fresnel_dielectric(c, eta);
      if (f.reflectance == 1)
        continue;
      Vec3<double> t = refract(w, f);
      EXPECT_NEAR(dot(t, t), 1, 1e-14);
      EXPECT_LT(t.z * w.z, 0);
      double sine_t = std::sqrt(t.x * t.x + t.y * t.y);
      EXPECT_NEAR(sine, sine_t * f.eta_it, 1e-14); // eta_i sin i = eta_t sin t
      EXPECT_NEAR(t.x * w.y, t.y * w.x, 1e-15);    // one plane
      EXPECT_LT(t.x * w.x, 0);
      // The same through the general form, with the normal as a microfacet.
      Vec3<double> m{0, 0, 1}, g = refract(w, m, c, f);
      EXPECT_NEAR(length(g - t), 0, 1e-14);
      Vec3<float> single = refract(Vec3<float>{float(w.x), float(w.y), float(w.z)},
                                   fresnel_dielectric(float(c), float(eta)));
      EXPECT_NEAR(single.x, t.x, 1e-6);
      EXPECT_NEAR(single.z, t.z, 1e-6);
    }
}

// The course prints omega_t = (-(eta_t/eta_i) x, -(eta_t/eta_i) y, -cos theta_t): the ratio upside
// down, the sign of z left out.
TEST(Fresnel, ThePrintedTransmittedDirectionIsNoUnitVector) {
  double eta_i = 1, eta_t = 1.5, c = 0.6, x = 0.8;
  double cos_t = std::sqrt(1 - sqr(eta_i / eta_t) * (1 - c * c));
  Vec3<double> printed{-(eta_t / eta_i) * x, 0, -cos_t};
  EXPECT_GT(std::abs(length(printed) - 1), 0.3);
  Vec3<double> right = refract(Vec3<double>{x, 0, c}, fresnel_dielectric(c, eta_t / eta_i));
  EXPECT_NEAR(length(right), 1, 1e-15);
  EXPECT_NEAR(right.x, -(eta_i / eta_t) * x, 1e-15);
  // From below, the printed z would stay on the side the light came from.
  EXPECT_GT(
      refract(Vec3<double>{0.3, 0, -std::sqrt(0.91)}, fresnel_dielectric(-std::sqrt(0.91), 1.5)).z,
      0);
}

TEST(Fresnel, DiffuseReflectanceMatchesMitsuba) {
  // mitsuba 3.9.1, fresnel_diffuse_reflectance(eta), scalar_rgb.
  const double table[][2] = {
      {0.2, 1.0704840421676636},  {0.5, 0.790274977684021},     {0.66, 0.6057772040367126},
      {0.9, 0.2113576978445053},  {1.0, 0.0002067089080810547}, {1.3, 0.06111574545502663},
      {1.5, 0.09177427738904953}, {2, 0.16058915853500366},     {5, 0.4386506974697113}};
  for (auto& row : table) {
    EXPECT_NEAR(fresnel_diffuse_reflectance(row[0]), row[1], 1e-6) << row[0];
    EXPECT_NEAR(fresnel_diffuse_reflectance(float(row[0])), row[1], 1e-6) << row[0];
  }
}

TEST(Fresnel, DerivativesByJet) {
  using J = Jet<double, 1>;
  for (double c : {0.2, 0.7}) {
    double h = 1e-6;
    J eta(1.4, 0);
    double slope =
        (fresnel_dielectric(c, 1.4 + h).reflectance - fresnel_dielectric(c, 1.4 - h).reflectance) /
        (2 * h);
    EXPECT_NEAR(fresnel_dielectric(J(c), eta).reflectance.v[0], slope, 1e-8);
    slope = (fresnel_conductor(c, 1.4 + h, 2.0) - fresnel_conductor(c, 1.4 - h, 2.0)) / (2 * h);
    EXPECT_NEAR(fresnel_conductor(J(c), eta, J(2.0)).v[0], slope, 1e-8);
  }
}

} // namespace
} // namespace faceta
