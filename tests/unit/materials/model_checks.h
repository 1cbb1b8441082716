#pragma once

/// Checks that need a model only: its albedo and its density, by quadrature over the hemisphere.

#include "bsdf/bsdf.h"

#include <array>
#include <gtest/gtest.h>
#include <random>

namespace faceta {

using Direction = Vec3<double>;

/// The direction with this cosine and azimuth.
inline Direction direction(double cosine, double azimuth = 0.4) {
  double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

/// A model over T with the double's parameters, ready to evaluate.
template <class Model> Model prepared(Model m) {
  m.prepare();
  return m;
}

/// Calls f(wi, solid angle) over a midpoint grid of the hemisphere: n rings in the polar angle, 2n
/// in azimuth.
template <class F> void over_hemisphere(int n, F f) {
  double step = 0.5 * kPi / n;
  for (int i = 0; i < n; ++i) {
    double theta = (i + 0.5) * step, ring = std::cos(theta - step / 2) - std::cos(theta + step / 2);
    for (int j = 0; j < 2 * n; ++j)
      f(direction(std::cos(theta), (j + 0.5) * kPi / n), ring * kPi / n);
  }
}

/// Directional albedo by a grid over the hemisphere: for lobes wider than a few cells.
template <class Model> Color<double> albedo(const Model& m, const Direction& wo, int n = 200) {
  Color<double> sum;
  over_hemisphere(n, [&](const Direction& wi, double solid_angle) {
    sum += m.eval(wo, wi, {}).value * solid_angle;
  });
  return sum;
}

/// Directional albedo as the mean weight of sample() over a grid of its random numbers: for narrow
/// lobes.
template <class Model>
Color<double> mean_weight(const Model& m, const Direction& wo, int n = 64, int choices = 64) {
  Color<double> sum;
  for (int k = 0; k < choices; ++k)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        Random<double> r{{(i + 0.5) / n, (j + 0.5) / n}, (k + 0.5) / choices};
        sum += m.sample(wo, r, {}).weight;
      }
  return sum * (1.0 / (double(n) * n * choices));
}

/// Mean weight of sample() over a low-discrepancy sequence in all three numbers (additive
/// recurrence with the powers of the root of x^4 = x + 1).
template <class Model> Color<double> mean_sampled_weight(const Model& m, const Direction& wo) {
  constexpr int kSamples = 50000;
  constexpr double kRoot = 1.2207440846057596;
  Color<double> sum;
  for (int i = 0; i < kSamples; ++i) {
    auto number = [&](double power) {
      double x = 0.5 + (i + 1) / power;
      return x - std::floor(x);
    };
    sum += m.sample(wo, {{number(kRoot), number(kRoot * kRoot)}, number(kRoot * kRoot * kRoot)}, {})
               .weight;
  }
  return sum * (1.0 / kSamples);
}

/// The density is that of sample(): the probability of success and the means of five functions of
/// the direction agree with their integrals against the density, within 5 standard errors. Delta
/// samples are left out on both sides. Returns the probability of success.
template <class Model> double expect_true_density(const Model& m, const Direction& wo) {
  auto features = [](const Direction& w) {
    return std::array<double, 6>{1, w.x, w.y, w.z, w.x * w.z, w.z * w.z * w.z};
  };
  std::array<double, 6> expected{}, mean{}, square{};
  over_hemisphere(250, [&](const Direction& wi, double solid_angle) {
    double pdf = m.eval(wo, wi, {}).pdf;
    for (int k = 0; k < 6; ++k)
      expected[k] += features(wi)[k] * pdf * solid_angle;
  });
  constexpr int kSamples = 100000;
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < kSamples; ++i) {
    Random<double> r;
    r.u.x = uniform(generator);
    r.u.y = uniform(generator);
    r.uc = uniform(generator);
    Sample<double> s = m.sample(wo, r, {});
    if (!s.valid || s.delta)
      continue;
    for (int k = 0; k < 6; ++k) {
      mean[k] += features(s.wi)[k] / kSamples;
      square[k] += features(s.wi)[k] * features(s.wi)[k] / kSamples;
    }
  }
  for (int k = 0; k < 6; ++k) {
    double error = std::sqrt(std::max(0.0, square[k] - mean[k] * mean[k]) / kSamples);
    EXPECT_NEAR(mean[k], expected[k], 5 * error + 3e-4) << "feature " << k << ", cos " << wo.z;
  }
  return mean[0];
}

/// Directions down to grazing, for float against double.
inline std::vector<Vec3<float>> float_directions(int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3<float>> list;
  for (int i = 0; i < count; ++i) {
    double z = uniform(generator);
    if (i % 4 == 0)
      z *= 0.01;
    if (i % 4 == 1)
      z = 1 - 0.001 * z;
    Direction d = direction(z, 2 * kPi * uniform(generator));
    list.push_back({float(d.x), float(d.y), float(d.z)});
  }
  return list;
}

inline Direction widen(const Vec3<float>& v) {
  return {v.x, v.y, v.z};
}

/// Float results agree with double ones to 1e-5 relative beyond what one ulp in any component of
/// the directions moves the latter.
template <class Single, class Double>
void expect_float_agrees(const Single& single, const Double& precise,
                         const std::vector<Vec3<float>>& wos, const std::vector<Vec3<float>>& wis) {
  auto numbers = [](const auto& e) {
    return std::array<double, 4>{double(e.value[0]), double(e.value[1]), double(e.value[2]),
                                 double(e.pdf)};
  };
  for (size_t i = 0; i < wos.size(); ++i) {
    auto low = numbers(single.eval(wos[i], wis[i], {}));
    auto high = numbers(precise.eval(widen(wos[i]), widen(wis[i]), {}));
    std::array<double, 4> moved{};
    for (int c = 0; c < 12; ++c) {
      Vec3<float> w[2] = {wos[i], wis[i]};
      float& x = (&w[c / 6].x)[c % 6 / 2];
      x = std::nextafter(x, c % 2 ? 2.0f : -2.0f);
      auto near = numbers(precise.eval(widen(w[0]), widen(w[1]), {}));
      for (int k = 0; k < 4; ++k)
        moved[k] = std::max(moved[k], std::abs(near[k] - high[k]));
    }
    for (int k = 0; k < 4; ++k)
      EXPECT_NEAR(low[k], high[k], 1e-5 * high[k] + moved[k] + 1e-35)
          << "output " << k << ", cos_o " << wos[i].z << ", cos_i " << wis[i].z;
  }
}

} // namespace faceta
