#pragma once

/// What the models made of a diffuse and a glossy lobe share: powers of cosines that stay exact at
/// sharp highlights, colours that never add up to more than 1, and the choice between the lobes.

#include "bsdf/bsdf.h"

namespace faceta {

/// log(1 - t) for t in [0, 1), without loss for small t; where t > 1/2, from u = 1 - t, which the
/// caller may know better.
template <class T> FACETA_INLINE T log_one_minus(const T& t, const T& u) {
  auto small = t < T(0.5);
  T v = T(1) - t, lost = (T(1) - v) - t; // what rounding took from 1 - t; the subtraction is exact
  return log(select(small, v, max(u, T(1e-30)))) + select(small, lost / v, T(0));
}
template <class T> FACETA_INLINE T log_one_minus(const T& t) {
  return log_one_minus(t, T(1) - t);
}

/// exp(x) - 1 for x <= 0, without loss near 0 (8 digits: for sampling).
template <class T> FACETA_INLINE T exp_minus_one(const T& x) {
  T series = T(1);
  for (int i = 7; i > 1; --i)
    series = fma(x * T(1.0 / i), series, T(1));
  return select(x > T(-0.3), x * series, exp(x) - T(1));
}

/// c^n for a cosine c that is given as t = 1 - c as well; 0 from 90 degrees on, whatever n is. A
/// highlight with n = 10^4 lives on t < 10^-3, where a float c holds only 4 digits of it.
template <class T> FACETA_INLINE T cosine_power(const T& c, const T& t, const T& n) {
  return select(c > T(0), exp(n * log_one_minus(t, c)), T(0));
}

/// A direction about z with density (n + 1) / (2 pi) cos^n.
template <class T> FACETA_INLINE Vec3<T> sample_cosine_power(const Vec2<T>& u, const T& n) {
  // cos = u^(1/(n+1))
  T t = -exp_minus_one(log(max(T(1) - u.x, T(1e-30))) / (n + T(1)));
  T sine = safe_sqrt(t * (T(2) - t));
  SinCos<T> azimuth = sincos(T(2 * kPi) * u.y);
  return {sine * azimuth.cos, sine * azimuth.sin, T(1) - t};
}

/// Diffuse and glossy reflectance, scaled per channel so that they add up to at most 1, and the
/// probability of choosing the diffuse lobe.
template <class T> struct TwoLobes {
  Color<T> diffuse, specular;
  T diffuse_probability = T(1), specular_probability = T(0);

  FACETA_INLINE void set(const Color<T>& rho_d, const Color<T>& rho_s) {
    Color<T> scale = (rho_d + rho_s).map([](const T& sum) { return T(1) / max(T(1), sum); });
    diffuse = rho_d * scale;
    specular = rho_s * scale;
    T d = mean(diffuse), s = mean(specular);
    auto black = !(d + s > T(0));
    T inverse = T(1) / select(black, T(1), d + s);
    diffuse_probability = select(black, T(1), d * inverse);
    specular_probability = select(black, T(0), s * inverse);
  }
  /// Value and density from the diffuse cosine/pi, the specular cosine-times-BRDF for white, and
  /// the density of the specular rule; zero where `above` is not set.
  FACETA_INLINE Eval<T> mix(const MaskOf<T>& above, const T& diffuse_pdf, const T& specular_value,
                            const T& specular_pdf) const {
    Eval<T> e;
    T zero(0);
    e.value =
        diffuse * select(above, diffuse_pdf, zero) + specular * select(above, specular_value, zero);
    e.pdf = select(
        above, fma(diffuse_probability, diffuse_pdf, specular_probability * specular_pdf), zero);
    return e;
  }
};

} // namespace faceta
