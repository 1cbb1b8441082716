#pragma once

/// Reflectance of smooth interfaces, exact (no Schlick), and refraction.

#include "base/vec.h"
#include "spectrum/color.h"

namespace faceta {

/// What the reflectance of a conductor with complex index eta + i k relative to the outside needs
/// of the index n: Re(n^2) - 1, Im(n^2)^2, and 4 eta k.
template <class T> struct ConductorIndex {
  T real_minus_1, imaginary2, product4;

  ConductorIndex() = default;
  FACETA_INLINE ConductorIndex(const T& eta, const T& k)
      : real_minus_1(eta * eta - k * k - T(1)), imaginary2(sqr(T(2) * eta * k)),
        product4(T(4) * eta * k) {}

  /// Unpolarised reflectance from cos^2 of the angle of incidence. Born and Wolf, Principles of
  /// Optics, 14.2; F = (r_s + r_p) / 2 over a common denominator, so that one division and two
  /// roots are left.
  FACETA_INLINE T reflectance(const T& cos2) const {
    T sin2 = T(1) - cos2, difference = real_minus_1 + cos2;
    T modulus = sqrt(fma(difference, difference, imaginary2));
    // Of a and b in a + i b = sqrt((eta + i k)^2 - sin^2) the larger one is free of cancellation,
    // and their product is eta k. Where b is the larger one everything is scaled by 2 b cos.
    T root = sqrt(max((modulus + abs(difference)) * (T(2) * cos2), T(1e-36f)));
    auto a_is_larger = difference >= T(0);
    T scale = select(a_is_larger, T(1), root);
    T s_even = (modulus + cos2) * scale, s_odd = select(a_is_larger, root, product4 * cos2);
    // The tiny summand keeps 0/0 away where eta = k = 0 at normal incidence.
    T p_even = fma(cos2, modulus, fma(sin2, sin2, T(1e-30f))) * scale, p_odd = s_odd * sin2;
    return (s_even - s_odd) * p_even / ((s_even + s_odd) * (p_even + p_odd));
  }
};
/// The indices of the channels.
template <class T> struct ConductorIndices {
  ConductorIndex<T> channel[Color<T>::size()];

  ConductorIndices() = default;
  FACETA_INLINE ConductorIndices(const Color<T>& eta, const Color<T>& k) {
    for (int i = 0; i < Color<T>::size(); ++i)
      channel[i] = {eta[i], k[i]};
  }
  FACETA_INLINE Color<T> reflectance(const T& cos2) const {
    Color<T> r;
    for (int i = 0; i < Color<T>::size(); ++i)
      r[i] = channel[i].reflectance(cos2);
    return r;
  }
};

/// Unpolarised reflectance of a conductor from the cosine of the angle of incidence, in [0, 1].
template <class T> FACETA_INLINE T fresnel_conductor(const T& cos_i, const T& eta, const T& k) {
  return ConductorIndex<T>(eta, k).reflectance(cos_i * cos_i);
}
template <class T>
FACETA_INLINE Color<T> fresnel_conductor(const T& cos_i, const Color<T>& eta, const Color<T>& k) {
  return ConductorIndices<T>(eta, k).reflectance(cos_i * cos_i);
}

/// Mean of a conductor's reflectance over the hemisphere, weighted by the cosine, to 6e-4: Gauss
/// and Jacobi's rule with four nodes in the cosine.
template <class T>
FACETA_INLINE Color<T> fresnel_conductor_mean(const Color<T>& eta, const Color<T>& k) {
  constexpr double node[] = {0.13975986434378, 0.41640956763108, 0.72315698636188,
                             0.94289580388548};
  constexpr double weight[] = {0.062361941900016, 0.25969509521646, 0.40692913602054,
                               0.27101382686298};
  Color<T> sum;
  for (int i = 0; i < 4; ++i)
    sum += fresnel_conductor(T(node[i]), eta, k) * T(weight[i]);
  return sum;
}

/// What happens at a dielectric interface.
template <class T> struct DielectricFresnel {
  T reflectance;
  T transmittance; ///< 1 - reflectance, without its cancellation near total reflection
  T cos_t;  ///< cosine of the transmitted direction, sign opposite to cos_i; 0 if totally reflected
  T eta_it; ///< index of the transmitted side over that of the incident side
  T eta_ti; ///< its inverse
};

/// Unpolarised reflectance of a dielectric from both cosines >= 0, as far as they are known to obey
/// Snell's law (or cos_t = 0: total internal reflection, reflectance 1); eta_it is the index of the
/// far side over that of the near side, eta_ti its inverse.
template <class T> FACETA_INLINE DielectricFresnel<T>
fresnel_dielectric_between(const T& cos_i, const T& cos_t, const T& eta_it, const T& eta_ti) {
  const T &c = cos_i, &t = cos_t;
  T p = eta_it * t, q = eta_it * c;
  T s_difference = c - p, s_sum = c + p, p_difference = t - q, p_sum = t + q;
  T x = s_difference * p_sum, y = p_difference * s_sum, z = s_sum * p_sum;
  T denominator = z * z;
  auto regular = (denominator > T(0)) & (t > T(0)); // else total reflection, or grazing
  T inverse = T(1) / select(regular, denominator, T(1));
  auto matched = eta_it == T(1);
  T r = T(0.5) * fma(x, x, y * y) * inverse;
  r = select(matched, T(0), select(regular, min(r, T(1)), T(1)));
  T through = T(2) * q * t * fma(p_sum, p_sum, s_sum * s_sum) * inverse;
  through = select(matched, T(1), select(regular, min(through, T(1)), T(0)));
  return {r, through, -t, eta_it, eta_ti};
}

/// Cosine of the transmitted direction, 0 for total internal reflection: Snell's law without
/// forming 1 - cos^2 or 1 - eta^2 by cancellation.
template <class T> FACETA_INLINE T snell_cosine(const T& cos_i, const T& eta_it, const T& eta_ti) {
  return eta_ti * safe_sqrt(fma(eta_it - T(1), eta_it + T(1), cos_i * cos_i));
}

/// The same from cos_i in [0, 1] alone.
template <class T> FACETA_INLINE DielectricFresnel<T>
fresnel_dielectric_near(const T& cos_i, const T& eta_it, const T& eta_ti) {
  T c = min(cos_i, T(1));
  return fresnel_dielectric_between(c, snell_cosine(c, eta_it, eta_ti), eta_it, eta_ti);
}

/// The same for either side; eta > 0 is the index below the surface over the one above it. cos_i in
/// [-1, 1]: positive above.
template <class T>
FACETA_INLINE DielectricFresnel<T> fresnel_dielectric(const T& cos_i, const T& eta) {
  auto above = cos_i >= T(0);
  T inverse = T(1) / eta;
  DielectricFresnel<T> f =
      fresnel_dielectric_near(abs(cos_i), select(above, eta, inverse), select(above, inverse, eta));
  f.cos_t = select(above, f.cos_t, -f.cos_t);
  return f;
}

/// Transmitted direction at a surface with normal z: Snell's law with the right ratio,
/// (-eta_ti x, -eta_ti y, cos_t).
template <class T> FACETA_INLINE Vec3<T> refract(const Vec3<T>& w, const DielectricFresnel<T>& f) {
  return {-(f.eta_ti * w.x), -(f.eta_ti * w.y), f.cos_t};
}
/// Transmitted direction at a microfacet with unit normal m, f from fresnel_dielectric(w.m, eta).
template <class T> FACETA_INLINE Vec3<T> refract(const Vec3<T>& w, const Vec3<T>& m, const T& cos_i,
                                                 const DielectricFresnel<T>& f) {
  return fma(m, fma(cos_i, f.eta_ti, f.cos_t), w * -f.eta_ti);
}

/// Mean reflectance of a dielectric under uniform diffuse illumination, eta = far side over near
/// side. Polynomial fits as in the scene contract: Egan and Hilgeman 1973 below 1 (0.1 % for
/// 1/eta <= 1.5, 9.5 % at 5), d'Eon and Irving 2011 from 1 on (0.2 % up to 10).
template <class T> FACETA_INLINE T fresnel_diffuse_reflectance(const T& eta) {
  T inverse = T(1) / eta;
  T below = fma(T(0.0636), inverse, fma(eta, fma(eta, T(-1.4399), T(0.7099)), T(0.6681)));
  T above = T(-1.36881);
  for (double c : {4.98554, -7.80989, 6.75335, -3.4793, 0.919317})
    above = fma(above, inverse, T(c));
  return select(eta < T(1), below, above);
}

} // namespace faceta
