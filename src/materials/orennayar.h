#pragma once

#include "bsdf/describe.h"
#include "sampling/warp.h"

namespace faceta {

/// Rough diffuse reflection: a surface of Lambertian V-grooves.
template <class T> struct OrenNayar {
  enum Variant { kFull, kSimple, kEon };
  int model = kFull;
  T sigma{T(0.3)};
  Color<T> reflectance{T(0.5)};

  template <class D> static void describe(D& d) {
    using M = OrenNayar;
    const char* kTable = "quadrature over 1500 x 1500 directions";
    d.model("orennayar", "Rough diffuse reflection")
        .equation("a = max(theta_i, theta_o), b = min(theta_i, theta_o), dphi = phi_i - phi_o\n"
                  "full: f = rho/pi [C1 + cos dphi C2 tan b + (1 - |cos dphi|) C3 tan((a+b)/2)]\n"
                  "          + 0.17 rho^2/pi s2/(s2+0.13) [1 - cos dphi (2b/pi)^2],  s2 = sigma^2\n"
                  "      C1 = 1 - 0.5 s2/(s2+0.33), C3 = 0.125 s2/(s2+0.09) (4ab/pi^2)^2,\n"
                  "      C2 = 0.45 s2/(s2+0.09) {sin a | sin a - (2b/pi)^3 where cos dphi < 0}\n"
                  "simple: f = rho/pi (A + B max(0, cos dphi) sin a tan b),\n"
                  "      A = 1 - s2/(2(s2+0.33)), B = 0.45 s2/(s2+0.09)\n"
                  "eon: f = rho/pi A (1 + r s/t) + rho_ms/pi (1-E(o))(1-E(i))/(1-<E>), r = "
                  "min(sigma, 1),\n"
                  "      s = sin i sin o cos dphi, t = max(cos i, cos o) where s > 0, else 1,\n"
                  "      A = 1/(1 + r(1/2 - 2/(3 pi))), rho_ms = rho^2 <E>/(1 - rho(1-<E>))")
        .reference("Oren and Nayar 1994, Generalization of Lambert's Reflectance Model, eqs. 27-30")
        .reference(
            "Portsmouth, Kutz and Hill 2025, EON: A Practical Energy-Preserving Rough Diffuse "
            "BRDF, JCGT 14(1)")
        .note("full is the paper's functional fit. For dark and very rough surfaces with both "
              "directions grazing and opposite the fit falls to 0 and turns negative; below 2 % of "
              "Lambert's law that much is taken instead")
        .note("eon takes sigma as its roughness r, from 0 to 1; above 1 it stays at r = 1. It is "
              "sampled by clipped linearly transformed cosines, the others by the cosine")
        .note("sigma = 0 is Lambert's law in every model")
        .choice("model", &M::model, {"full", "simple", "eon"},
                "full 1994 model with interreflection, its qualitative simplification, or the "
                "energy-preserving successor")
        .scalar("sigma", &M::sigma, {0, kInfinity}, {0, 0.5 * kPi}, "radians",
                "standard deviation of the groove angles; the roughness r of eon")
        .reflectance("reflectance", &M::reflectance, "albedo rho of a groove's facets")
        .traits({.lobes = kReflection, .reciprocal = true, .albedo_bound = 1.052})
        .excuse("energy",
                "the full 1994 model is a fit and reflects up to 5 % more than it receives "
                "at grazing angles (4.4 % at 89 degrees, 5.1 % in the limit, sigma = 0.3)",
                "Oren and Nayar 1994, Generalization of Lambert's Reflectance Model, eqs. 27-30")
        .limit({{"sigma", "0"}}, "diffuse", {}, 1e-6)
        .known_albedo({{"model", "full"}, {"sigma", "0.2"}, {"reflectance", "1"}}, 0.986, 0.999,
                      1.026, 1e-3, kTable)
        .known_albedo({{"model", "full"}, {"sigma", "0.5"}, {"reflectance", "1"}}, 0.896, 0.927,
                      0.991, 1e-3, kTable)
        .known_albedo({{"model", "full"}, {"sigma", "1"}, {"reflectance", "1"}}, 0.775, 0.813,
                      0.893, 1e-3, kTable)
        .known_albedo({{"model", "simple"}, {"sigma", "0.2"}, {"reflectance", "1"}}, 0.946, 0.987,
                      1.01, 1e-3, kTable)
        .known_albedo({{"model", "simple"}, {"sigma", "0.5"}, {"reflectance", "1"}}, 0.785, 0.883,
                      0.939, 1e-3, kTable)
        .known_albedo({{"model", "simple"}, {"sigma", "1"}, {"reflectance", "1"}}, 0.624, 0.747,
                      0.816, 1e-3, kTable)
        .exemplar("default", {})
        .exemplar("smooth white", {{"sigma", "0"}, {"reflectance", "1"}}, true)
        .exemplar("clay", {{"sigma", "1"}, {"reflectance", "0.6,0.35,0.2"}})
        .exemplar("roughest white", {{"sigma", "1.5707963"}, {"reflectance", "1"}})
        .exemplar("dark and rough", {{"sigma", "1"}, {"reflectance", "0.05,0.02,0"}})
        .exemplar("simple", {{"model", "simple"}, {"sigma", "0.5"}, {"reflectance", "0.9"}})
        .exemplar("eon", {{"model", "eon"}, {"sigma", "0.3"}, {"reflectance", "0.8,0.3,0.05"}})
        .exemplar("eon white", {{"model", "eon"}, {"sigma", "0.9"}, {"reflectance", "1"}}, true);
  }

  void prepare() {
    // Squares beyond 10^12 would overflow in the quotients; the model is long constant there.
    T s2 = sqr(min(sigma, T(1e6)));
    c1_ = fma(T(0.5), s2, T(0.33)) / (s2 + T(0.33));
    c2_ = T(0.45) * s2 / (s2 + T(0.09));
    c3_ = T(0.125) * s2 / (s2 + T(0.09));
    c4_ = T(0.17) * s2 / (s2 + T(0.13));
    r_ = min(max(T(0), sigma), T(1));
  }

  Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    T cosine = select(above, wi.z * T(kInvPi), T(0));
    T zo = max(wo.z, T(1e-9)), zi = max(wi.z, T(1e-9));
    if (model == kEon)
      return {eon(wo, wi, zo, zi) * cosine, select(above, eon_pdf(wo, wi, zo), T(0))};
    if (model == kSimple)
      return {reflectance * (cosine * simple(wo, wi, zo, zi)), cosine};
    return {full(wo, wi, zo, zi) * cosine, cosine};
  }

  Sample<T> sample(const Vec3<T>& wo, const Random<T>& random, const Context<T>& context) const {
    Sample<T> s;
    s.wi = cosine_hemisphere(random.u);
    if (model == kEon) {
      T zo = max(wo.z, T(1e-9));
      s.wi = select(random.uc < uniform_probability(zo), uniform_hemisphere(random.u),
                    sample_clipped_cosine(wo, zo, random.u));
    }
    s.lobe = kReflection;
    s.valid = (wo.z > T(0)) & (s.wi.z > T(0));
    finish_sample(s, eval(wo, s.wi, context));
    return s;
  }

private:
  static constexpr double kFloor = 0.02; ///< of Lambert's law, see the notes
  T c1_{}, c2_{}, c3_{}, c4_{}, r_{};

  // All three return pi f (simple: without rho). zo and zi are the cosines, kept off 0.
  FACETA_INLINE static T sine(const Vec3<T>& w) { return sqrt(sin_theta_squared(w)); }
  /// sin i sin o cos dphi.
  FACETA_INLINE static T horizontal(const Vec3<T>& wo, const Vec3<T>& wi) {
    return fma(wo.x, wi.x, wo.y * wi.y);
  }

  T simple(const Vec3<T>& wo, const Vec3<T>& wi, const T& zo, const T& zi) const {
    return fma(c2_, max(horizontal(wo, wi), T(0)) / max(zo, zi), c1_);
  }

  Color<T> full(const Vec3<T>& wo, const Vec3<T>& wi, const T& zo, const T& zi) const {
    T so = sine(wo), si = sine(wi), s = horizontal(wo, wi);
    auto o_is_steeper = zo > zi;
    T cos_b = select(o_is_steeper, zo, zi), cos_a = select(o_is_steeper, zi, zo);
    T sin_b = select(o_is_steeper, so, si), sin_a = select(o_is_steeper, si, so);
    T product = so * si;
    T inverse = T(1) / select(product > T(0), product, T(1));
    T cos_dphi = clamp(s * inverse, T(-1), T(1));
    // 1 - |cos| from the sine, by the cross product: the tangent magnifies it.
    T sin_dphi = fma(wo.x, wi.y, -(wo.y * wi.x)) * inverse;
    T aside = sqr(sin_dphi) / (T(1) + abs(cos_dphi));
    // Angles from both sine and cosine: neither alone keeps its digits at both ends.
    T a = T(2 * kInvPi) * atan2(sin_a, cos_a), b = T(2 * kInvPi) * atan2(sin_b, cos_b);
    T rest = T(2 * kInvPi) * atan2(cos_b, sin_b); // 1 - b
    // sin a - b^3 as (1 - b^3) - (1 - sin a), each from its small part: tan b magnifies it.
    T backward = rest * (T(3) - rest * (T(3) - rest)) - sqr(cos_a) / (T(1) + sin_a);
    T second = select(s < T(0), cos_dphi * (sin_b / cos_b) * backward, s / cos_b);
    T third = aside * sqr(a * b) * ((sin_a + sin_b) / (zo + zi));
    T direct = fma(c2_, second, fma(c3_, third, c1_));
    T interreflected = c4_ * (T(1) - cos_dphi * sqr(b));
    return reflectance * reflectance.map([&](const T& rho) {
      return max(fma(rho, interreflected, direct), T(kFloor));
    });
  }

  // --- EON ---
  static constexpr double kE1 = 0.5 - 2.0 / 3.0 * kInvPi;         ///< 1/A = 1 + kE1 r
  static constexpr double kE2 = 2.0 / 3.0 - 28.0 / 15.0 * kInvPi; ///< <E> = A (1 + kE2 r)

  /// (1 - E(mu)) / (A r): what single scattering misses, arranged so that nothing cancels at
  /// grazing angles, where it goes to mu/pi.
  static T missing(const Vec3<T>& w, const T& mu) {
    T s = sine(w);
    T drop = sqr(mu) / (T(1) + s); // 1 - s
    T cubic = T(2.0 / 3.0) * s * mu * fma(s, T(1) + s, T(1)) / (T(1) + s);
    T h = fma(T(kPi * kE1), drop, fma(s, atan2(mu, s), sqr(s) * mu - cubic));
    return h * T(kInvPi);
  }

  Color<T> eon(const Vec3<T>& wo, const Vec3<T>& wi, const T& zo, const T& zi) const {
    T s = horizontal(wo, wi);
    T a = T(1) / fma(T(kE1), r_, T(1));
    T single = a * fma(r_, select(s > T(0), s / max(zo, zi), s), T(1));
    T average = a * fma(T(kE2), r_, T(1));
    T lost = a * r_ * T(1 / (kE1 - kE2)) * missing(wo, zo) * missing(wi, zi);
    T absorbed = a * r_ * T(kE1 - kE2); // 1 - average
    return reflectance.map([&](const T& rho) {
      T multiple = rho * rho * average / (T(1) - rho * absorbed);
      return fma(multiple, lost, rho * single);
    });
  }

  /// The share of uniform directions in the mixture.
  T uniform_probability(const T& mu) const {
    T p = fma(fma(fma(T(-0.290822), mu, T(0.538233)), mu, T(-0.372058)), mu, T(0.162925));
    return pow(r_, T(0.1)) * p;
  }

  /// Fitted matrix M = [a 0 b; 0 c 0; d 0 1] in the frame whose x axis is the azimuth of wo, and
  /// the visible share of the disc.
  struct Transform {
    T a, b, c, d, share;
    Vec2<T> axis;
  };
  Transform transform(const Vec3<T>& wo, const T& mu) const {
    const T& r = r_;
    Transform m;
    m.a = fma(r,
              fma(fma(T(0.111709), mu, T(-0.518982)), mu, T(0.303392)) +
                  fma(T(0.335918), mu, T(-0.276266)) * r,
              T(1));
    // The fit's polynomials in t = 1 - mu where they nearly vanish at mu = 1.
    T t = T(1) - mu;
    m.b = r * (fma(T(-1.15859), t, T(-0.00548)) + fma(T(0.150105), t, T(0.00071)) * r) /
          (mu * mu * mu - T(1.43545));
    m.c = fma(r, fma(fma(T(0.261777), mu, T(-0.506373)), mu, T(0.20013)), T(1));
    m.d = r * fma(fma(T(0.475392), t, T(0.065466)), t, T(-0.000006)) /
          fma(t - T(2.0725628), t, T(-0.0017372));
    m.share = T(0.5) + T(0.5) / sqrt(fma(m.d, m.d, T(1)));
    T s = sine(wo);
    auto tilted = s > T(0);
    T inverse = T(1) / select(tilted, s, T(1));
    m.axis = {select(tilted, wo.x * inverse, T(1)), select(tilted, wo.y * inverse, T(0))};
    return m;
  }

  Vec3<T> sample_clipped_cosine(const Vec3<T>& wo, const T& mu, const Vec2<T>& u) const {
    Transform m = transform(wo, mu);
    T radius = sqrt(u.x);
    SinCos<T> angle = sincos(T(2 * kPi) * u.y);
    T y = radius * angle.sin;
    // Squeezes the disc into the part that M maps above the horizon.
    T edge = safe_sqrt(T(1) - sqr(y));
    T x = -lerp(edge, radius * angle.cos, m.share);
    T z = safe_sqrt(T(1) - fma(x, x, y * y));
    Vec3<T> w = normalize(Vec3<T>{fma(m.a, x, m.b * z), m.c * y, fma(m.d, x, z)});
    return {m.axis.x * w.x - m.axis.y * w.y, fma(m.axis.y, w.x, m.axis.x * w.y), w.z};
  }

  T eon_pdf(const Vec3<T>& wo, const Vec3<T>& wi, const T& mu) const {
    Transform m = transform(wo, mu);
    T x = fma(m.axis.x, wi.x, m.axis.y * wi.y), y = m.axis.x * wi.y - m.axis.y * wi.x;
    // The adjugate of M takes wi back to the cosine lobe; det is that of M.
    T minor = m.a - m.b * m.d, det = m.c * minor;
    Vec3<T> h{m.c * (x - m.b * wi.z), minor * y, m.c * (m.a * wi.z - m.d * x)};
    T cosine = sqr(det / dot(h, h)) * max(h.z, T(0)) * T(kInvPi) / m.share;
    return lerp(cosine, T(kInvTwoPi), uniform_probability(mu));
  }
};

} // namespace faceta
