#pragma once

/// Microfacet surfaces: Beckmann and GGX (Trowbridge-Reitz) distributions of normals, anisotropic,
/// with Smith's masking, and the sampling of all or of the visible normals.
///
/// Everything here takes directions above the surface (z > 0; transmission passes |z| by flipping
/// the frame) and normals m of ANY length with m.z > 0: the half vector need not be normalised,
/// which saves time and, at alpha = 0.001, the roundings that the distribution would blow up.

#include "bsdf/beckmann_slope.h"
#include "bsdf/bsdf.h"

namespace faceta {

namespace detail {

/// exp(-s) for s in [0, 87].
template <class T>
  requires(!SinglePrecision<T>)
T exp_minus(const T& s) {
  return exp(-s);
}
/// 2^Raised exp(-s) while that is a normal number, without what exp() does for arguments that do
/// not occur here; 1 ulp.
template <int Raised = 0, SinglePrecision T> FACETA_INLINE T exp_minus(const T& s) {
  // Rounds s log2 e to an integer in the low bits of a float.
  T shifted = fma(s, T(-1.44269504f), T(12582912.0f)), n = shifted - T(12582912.0f);
  T r = fma(n, T(-1.42860677e-6f), fma(n, T(-0.693145752f), -s));
  constexpr float c[] = {0.500000001f,  0.166666668f,   0.0416664645f,
                         0.0083332859f, 0.00139337018f, 0.000199076563f};
  T p = fma(polynomial(r, c), r * r, r) + T(1);
  return bits_float(float_bits(p) + (float_bits(shifted) << 23) + IntOf<T>(Raised << 23));
}

/// k exp(-s) for s >= 0.
template <class T> FACETA_INLINE T times_exp_minus(const T& k, const T& s) {
  return k * exp(-s);
}
template <SinglePrecision T> FACETA_INLINE T times_exp_minus(const T& k, const T& s) {
  // 2^64 too large until the end: results may be smaller than the smallest normal number.
  T raised = select(s < T(130), exp_minus<64>(min(s, T(130))), T(0));
  return k * raised * T(0x1p-64f);
}

} // namespace detail

enum Distribution : int { kBeckmann = 0, kGgx = 1 };

/// The uniform (never per lane) properties of a microfacet surface.
struct MicrofacetOptions {
  int distribution = kBeckmann;
  int sample_visible = 1;    ///< visible normals instead of all normals
  int height_correlated = 0; ///< masking and shadowing correlated by height instead of separable
  int bounded = 1;           ///< GGX reflection: sample only caps that can reflect upwards
};

/// A sampled direction wi (below the surface: a failure) and what weighing it can use of its
/// sampling: the half vector's cos^2 with it, and of Beckmann's visible normal (x, y, 1) the
/// squared length, its squared slope on the unit surface, and what BeckmannSlopes knows of wo.
template <class T> struct ReflectedDirection {
  Vec3<T> wi;
  T cos2_h = T(0), length2 = T(0), slope2 = T(0);
  T roughness = T(0), inverse_z = T(0), twice_area = T(0);
};

/// Value of the reflection without Fresnel over its density, the density, and the squared cosine
/// between either direction and the half vector.
template <class T> struct WeighedReflection {
  T weight, pdf, cos2_h;
};

/// Reflection without Fresnel: D G / (4 cos theta_o), |cos theta_i| included; its density; and the
/// squared cosine between either direction and the half vector.
template <class T> struct MicrofacetReflection {
  T value, pdf, cos2_h;

  FACETA_INLINE T cos_h() const { return sqrt(cos2_h); }
};

template <class T> struct Microfacet {
  MicrofacetOptions options;
  T alpha_u, alpha_v;
  T half_peak; ///< 1 / (2 pi alpha_u alpha_v), half of D's maximum

  Microfacet() = default;
  /// alpha: RMS slope along x and y, clamped to at least 1e-4 as in the scene contract.
  FACETA_INLINE Microfacet(const MicrofacetOptions& o, const T& u, const T& v)
      : options(o), alpha_u(max(u, T(1e-4))), alpha_v(max(v, T(1e-4))),
        half_peak(T(0.5 * kInvPi) / (alpha_u * alpha_v)) {}

  /// D(m): density of normals per solid angle, integral of D cos theta = 1.
  FACETA_INLINE T density(const Vec3<T>& m) const {
    T length2 = dot(m, m), area = alpha_u * alpha_v;
    if (options.distribution == kGgx) {
      T inverse = T(1) / area, x = m.x * (inverse * alpha_v), y = m.y * (inverse * alpha_u);
      T ratio = length2 / max(fma(m.z, m.z, fma(x, x, y * y)), T(1e-37));
      return inverse * T(kInvPi) * sqr(ratio);
    }
    // One division, of few roundings: the exponential blows up each of them.
    T x = m.x * alpha_v, y = m.y * alpha_u, q = area * m.z;
    T inverse = T(1) / max(q * q, T(1e-37));
    // Beyond the bound the exponential is 0, and 0 * inf must not arise.
    T secant2 = min(length2 * (area * inverse), T(1e14));
    return detail::times_exp_minus(area * T(kInvPi) * sqr(secant2), fma(x, x, y * y) * inverse);
  }

  /// Smith's masking G1(w), the scene contract's: exact for GGX, Walter's rational fit (0.35 %) for
  /// Beckmann. cos theta / projected_area(w) is the exact one of both.
  FACETA_INLINE T masking(const Vec3<T>& w) const {
    Ratio g = masking_ratio(w.z, roughness_towards(w));
    return g.numerator / g.denominator;
  }

  /// Joint masking and shadowing of two directions above the surface.
  FACETA_INLINE T masking_shadowing(const Vec3<T>& wo, const Vec3<T>& wi) const {
    Ratio g = masking_ratio(wo, wi);
    return g.numerator / g.denominator;
  }

  /// Projected area of the visible normals, cos theta (1 + Lambda), exact: the integral of
  /// D(m) max(0, w.m) over all m.
  FACETA_INLINE T projected_area(const Vec3<T>& w) const {
    return projected_area(w.z, roughness_towards(w));
  }

  /// A normal distributed as D(m) cos theta_m. Any length. Walter et al. 2007, eqs. 28 and 35.
  FACETA_INLINE Vec3<T> sample_all(const Vec2<T>& u) const {
    T radius2 = options.distribution == kGgx ? u.x / (T(1) - u.x) : -log(T(1) - u.x);
    T radius = sqrt(max(radius2, T(0)));
    SinCos<T> phi = sincos(T(2 * kPi) * u.y);
    return {alpha_u * radius * phi.cos, alpha_v * radius * phi.sin, T(1)};
  }
  FACETA_INLINE T pdf_all(const Vec3<T>& m) const { return density(m) * m.z / length(m); }

  /// A normal distributed as D(m) max(0, wo.m) / projected_area(wo). Any length.
  FACETA_INLINE Vec3<T> sample_visible(const Vec3<T>& wo, const Vec2<T>& u) const {
    if (options.distribution == kGgx)
      return sample_cap(wo, u, T(1));
    BeckmannSlopes<T> slopes(wo.z, roughness2_towards(wo), u.x);
    return turn(wo, slopes, slopes.draw(u.y));
  }
  FACETA_INLINE T pdf_visible(const Vec3<T>& wo, const Vec3<T>& m) const {
    return density(m) * max(dot(wo, m), T(0)) / (length(m) * projected_area(wo));
  }

  /// A normal by the chosen rule, and the density it has.
  FACETA_INLINE Vec3<T> sample_normal(const Vec3<T>& wo, const Vec2<T>& u) const {
    return options.sample_visible ? sample_visible(wo, u) : sample_all(u);
  }
  FACETA_INLINE T pdf_normal(const Vec3<T>& wo, const Vec3<T>& m) const {
    return options.sample_visible ? pdf_visible(wo, m) : pdf_all(m);
  }

  /// Samples the direction that the chosen normals reflect wo to; may fall below the surface (a
  /// failure, part of reflection()'s density).
  FACETA_INLINE Vec3<T> sample_reflection(const Vec3<T>& wo, const Vec2<T>& u) const {
    Vec3<T> m = options.sample_visible && options.distribution == kGgx
                    ? sample_cap(wo, u, cap_bound(wo))
                    : sample_normal(wo, u);
    T scale = T(2) * dot(wo, m) / max(dot(m, m), T(1e-37));
    return fma(m, scale, -wo);
  }

  /// The same in two steps, of which the second weighs the direction: cheaper than reflection().
  /// `third`: a third independent number, which saves Beckmann's normals a division.
  FACETA_INLINE ReflectedDirection<T> sample_direction(const Vec3<T>& wo, const Vec2<T>& u,
                                                       const T& third) const {
    if (options.distribution == kBeckmann && options.sample_visible)
      return sample_beckmann_direction(wo, u, third);
    ReflectedDirection<T> d;
    d.wi = sample_reflection(wo, u);
    return d;
  }
  FACETA_INLINE WeighedReflection<T> weigh(const Vec3<T>& wo,
                                           const ReflectedDirection<T>& d) const {
    if (options.distribution == kBeckmann && options.sample_visible)
      return weigh_beckmann(wo, d);
    MicrofacetReflection<T> r = reflection(wo, d.wi);
    return {r.value / max(r.pdf, T(1e-37)), r.pdf, r.cos2_h};
  }

  /// Value and density of the reflection from wo to wi; all 0 unless both lie above the surface (by
  /// a cosine whose square is still a float).
  FACETA_INLINE MicrofacetReflection<T> reflection(const Vec3<T>& wo, const Vec3<T>& wi) const {
    auto above = (wo.z > T(1e-18)) & (wi.z > T(1e-18));
    Vec3<T> m = wo + wi;
    T d = density(m), length2 = dot(m, m);
    T ro = roughness_towards(wo);
    Ratio g = masking_ratio(wo, wi);
    T value = d * g.numerator / (T(4) * wo.z * g.denominator);
    T pdf;
    if (!options.sample_visible)
      pdf = T(0.5) * d * m.z / length2; // wo.m = |m|^2 / 2
    else if (options.distribution == kGgx)
      pdf = T(0.5) * d / fma(cap_bound(wo), wo.z, sqrt(fma(wo.z, wo.z, ro * ro)));
    else
      pdf = T(0.25) * d / projected_area(wo.z, ro);
    T cos2_h = min(T(0.25) * length2, T(1)); // free of the cancellation in wo.(wo + wi)
    return {select(above, value, T(0)), select(above, pdf, T(0)), cos2_h};
  }

private:
  struct Ratio {
    T numerator, denominator;
  };

  /// The normal whose slopes on the unit surface are x along and y across the direction of view.
  FACETA_INLINE Vec3<T> turn(const Vec3<T>& wo, const BeckmannSlopes<T>& slopes,
                             const Vec2<T>& x) const {
    T c = select(slopes.tilted, alpha_u * wo.x * slopes.inverse_r, T(1));
    T s = select(slopes.tilted, alpha_v * wo.y * slopes.inverse_r, T(0));
    return {fma(x.x, alpha_u * c, -(x.y * (alpha_u * s))),
            fma(x.x, alpha_v * s, x.y * (alpha_v * c)), T(1)};
  }

  FACETA_INLINE ReflectedDirection<T> sample_beckmann_direction(const Vec3<T>& wo, const Vec2<T>& u,
                                                                const T& third) const {
    BeckmannSlopes<T> slopes(wo.z, roughness2_towards(wo), u.x);
    Vec2<T> x = slopes.draw(u.y, third);
    Vec3<T> m = turn(wo, slopes, x);
    T length2 = fma(m.x, m.x, fma(m.y, m.y, T(1)));
    T cosine = fma(wo.x, m.x, fma(wo.y, m.y, wo.z)), inverse_length2 = T(1) / length2;
    return {.wi = fma(m, T(2) * cosine * inverse_length2, -wo),
            .cos2_h = min(cosine * cosine * inverse_length2, T(1)),
            .length2 = length2,
            .slope2 = fma(x.x, x.x, x.y * x.y),
            .roughness = slopes.r,
            .inverse_z = slopes.inverse_z,
            .twice_area = slopes.twice_area};
  }
  /// D / (4 projected area) with D = exp(-slope^2) / (pi alpha_u alpha_v cos^4), which needs no
  /// half vector; and the weight G projected_area / cos theta_o, which needs no D.
  FACETA_INLINE WeighedReflection<T> weigh_beckmann(const Vec3<T>& wo,
                                                    const ReflectedDirection<T>& d) const {
    Ratio g = masking_ratio(wo, d.roughness, d.wi);
    T inverse = T(1) / (g.denominator * d.twice_area); // one division for both
    T weight = T(0.5) * d.inverse_z * sqr(d.twice_area) * (g.numerator * inverse);
    T pdf = detail::exp_minus(d.slope2) * sqr(d.length2) * half_peak * (g.denominator * inverse);
    return {weight, pdf, d.cos2_h};
  }

  /// sqrt((alpha_u x)^2 + (alpha_v y)^2) = alpha sin theta of the stretched surface.
  FACETA_INLINE T roughness_towards(const Vec3<T>& w) const { return sqrt(roughness2_towards(w)); }
  FACETA_INLINE T roughness2_towards(const Vec3<T>& w) const {
    T x = alpha_u * w.x, y = alpha_v * w.y;
    return fma(x, x, y * y);
  }
  FACETA_INLINE T projected_area(const T& z, const T& r) const {
    if (options.distribution == kGgx)
      return T(0.5) * (z + sqrt(fma(z, z, r * r)));
    T a = min(z * (T(1) / max(r, T(1e-30))), T(6));
    return fma(T(0.5) * r, detail::ierfc(a), z);
  }
  FACETA_INLINE Ratio masking_ratio(const T& z, const T& r) const {
    if (options.distribution == kGgx)
      return {z, projected_area(z, r)};
    auto flat = z >= T(1.6) * r; // in z and r instead of a = z / r: nothing to divide, no 0/0
    T z2 = z * z, zr = z * r;
    T numerator = fma(T(2.181), z2, T(3.535) * zr);
    T denominator = fma(T(2.577), z2, fma(T(2.276), zr, r * r));
    return {select(flat, T(1), numerator), select(flat, T(1), denominator)};
  }
  FACETA_INLINE Ratio masking_ratio(const Vec3<T>& wo, const Vec3<T>& wi) const {
    return masking_ratio(wo, roughness_towards(wo), wi);
  }
  FACETA_INLINE Ratio masking_ratio(const Vec3<T>& wo, const T& ro, const Vec3<T>& wi) const {
    T ri = roughness_towards(wi);
    if (options.height_correlated) { // 1 / (1 + Lambda_o + Lambda_i), both exact
      T ao = projected_area(wo.z, ro), ai = projected_area(wi.z, ri);
      T product = wo.z * wi.z;
      return {product, fma(ao, wi.z, fma(ai, wo.z, -product))};
    }
    Ratio o = masking_ratio(wo.z, ro), i = masking_ratio(wi.z, ri);
    return {o.numerator * i.numerator, o.denominator * i.denominator};
  }

  /// Spherical caps (Dupuy and Benyoub 2023): the visible normals of the stretched hemisphere are
  /// half vectors with a uniform cap z > -bound * wo_std.z.
  FACETA_INLINE Vec3<T> sample_cap(const Vec3<T>& wo, const Vec2<T>& u, const T& bound) const {
    Vec3<T> v{alpha_u * wo.x, alpha_v * wo.y, wo.z};
    v = v * (T(1) / sqrt(max(dot(v, v), T(1e-37))));
    T depth = u.x * fma(bound, v.z, T(1)); // 1 - z, kept apart from z: sin^2 = depth (2 - depth)
    T sine = safe_sqrt(depth * (T(2) - depth));
    SinCos<T> phi = sincos(T(2 * kPi) * u.y);
    return {alpha_u * fma(sine, phi.cos, v.x), alpha_v * fma(sine, phi.sin, v.y),
            max(v.z + (T(1) - depth), T(0))};
  }
  /// The factor k by which reflection bounds the cap (Eto and Tokuyoshi 2023, anisotropic as in
  /// Tokuyoshi and Eto 2024); 1: the whole cap.
  FACETA_INLINE T cap_bound(const Vec3<T>& wo) const {
    if (!options.bounded)
      return T(1);
    T a = min(min(alpha_u, alpha_v), T(1)), a2 = a * a;
    T s = T(1) + sqrt(sin_theta_squared(wo)), s2 = s * s;
    return (T(1) - a2) * s2 / fma(a2 * wo.z, wo.z, s2);
  }
};

} // namespace faceta
