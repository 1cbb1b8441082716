#pragma once

#include "bsdf/describe.h"
#include "sampling/warp.h"

namespace faceta {

/// Two lobes of microfacets with free tails, free Fresnel curves and free stretch over a diffuse
/// base: what fits to measured reflectance need beyond the textbook models.
template <class T> struct HazyGloss {
  /// One lobe. All its numbers are free; see describe().
  struct Lobe {
    Color<T> normal, grazing;
    T fresnel, alpha, tail, along, across, masking;
  };

  Color<T> diffuse_reflectance{T(0.2)};
  Color<T> gloss_normal{T(0.04)}, gloss_grazing{T(0.8)};
  T gloss_fresnel{T(5)}, gloss_alpha{T(0.05)}, gloss_tail{T(3)};
  T gloss_along{T(0)}, gloss_across{T(0)}, gloss_masking{T(0)};
  Color<T> haze_normal{T(0.04)}, haze_grazing{T(0.4)};
  T haze_fresnel{T(5)}, haze_alpha{T(0.2)}, haze_tail{T(2)};
  T haze_along{T(0)}, haze_across{T(0)}, haze_masking{T(0)};

  template <class D> static void describe(D& d) {
    using M = HazyGloss;
    d.model("hazygloss", "Gloss with haze, as measured")
        .equation(
            "f = rho/pi + gloss + haze;  a lobe: F D G / (4 cos_i cos_o),  c = cos theta_d = wi.h\n"
            "F = F0 + (F90 - F0) (1 - c)^p,  G = G1(i) G1(o) (cos_i cos_o)^q, G1: GGX's of alpha\n"
            "D = (1 + s^2/((g - 1) alpha^2))^-g / (pi alpha^2 cos^4 theta_h),\n"
            "s^2 = (tan theta_h)^2 (c^2a cos^2 x + c^2b sin^2 x),  x: angle between h and wi - wo "
            "on the surface\n"
            "normal F0, grazing F90, fresnel p, tail g, along a, across b, masking q")
        .reference("Ribardiere et al. 2017, STD: Student's t-Distribution of Slopes for "
                   "Microfacet Based BSDFs, eq. 8")
        .reference("Schlick 1994, An Inexpensive BRDF Model for Physically-based Rendering")
        .reference("Low et al. 2012, BRDF Models for Accurate and Efficient Rendering of Glossy "
                   "Surfaces")
        .note("tail 2 is GGX, large ones come close to Beckmann, smaller ones have more haze")
        .note(
            "a = b = 0 is a microfacet surface, whose highlights stretch at grazing angles; a = 0, "
            "b = 1 keeps them as round as Phong's; a = b = 1 is the shift invariance of smooth "
            "surfaces. Measured ones lie between and outside of these")
        .note("powers of c stop at c = 0.001")
        .reflectance("diffuse_reflectance", &M::diffuse_reflectance, "albedo rho of the base");
    describe_gloss(d);
    describe_haze(d);
    d.traits({.lobes = kReflection, .reciprocal = true, .albedo_bound = kInfinity})
        .excuse("energy",
                "a sum fitted to measurements: lobes and base do not share the light, and the "
                "stretch at grazing angles is not normalised",
                "the equation above");
    describe_proof(d);
  }
  template <class D> static FACETA_INLINE void describe_gloss(D& d) {
    using M = HazyGloss;
    d.reflectance("gloss_normal", &M::gloss_normal, "F0 of the gloss: facing reflectance")
        .reflectance("gloss_grazing", &M::gloss_grazing, "F90 of the gloss: grazing reflectance")
        .number("gloss_fresnel", &M::gloss_fresnel, {0.5, 20}, {1, 10}, "",
                "exponent p of its Fresnel curve; 5 is Schlick's")
        .scalar("gloss_alpha", &M::gloss_alpha, {0, 1}, {0.001, 1}, "RMS slope",
                "roughness of the gloss; at least 0.001")
        .number("gloss_tail", &M::gloss_tail, {1.05, 100}, {1.05, 30}, "",
                "exponent g of its distribution of slopes; 2 is GGX")
        .number("gloss_along", &M::gloss_along, {-2, 2}, {-1.5, 1.5}, "",
                "exponent a of its width in the plane of incidence")
        .number("gloss_across", &M::gloss_across, {-2, 2}, {-1.5, 1.5}, "",
                "exponent b of its width across the plane of incidence")
        .number("gloss_masking", &M::gloss_masking, {0, 4}, {0, 3}, "",
                "exponent q of what a layer above it absorbs at grazing angles");
  }
  template <class D> static FACETA_INLINE void describe_haze(D& d) {
    using M = HazyGloss;
    d.reflectance("haze_normal", &M::haze_normal, "F0 of the haze")
        .reflectance("haze_grazing", &M::haze_grazing, "F90 of the haze")
        .number("haze_fresnel", &M::haze_fresnel, {0.5, 20}, {1, 10}, "",
                "exponent p of the haze's Fresnel curve")
        .scalar("haze_alpha", &M::haze_alpha, {0, 1}, {0.001, 1}, "RMS slope",
                "roughness of the haze; at least 0.001")
        .number("haze_tail", &M::haze_tail, {1.05, 100}, {1.05, 30}, "",
                "exponent g of the haze's distribution of slopes")
        .number("haze_along", &M::haze_along, {-2, 2}, {-1.5, 1.5}, "",
                "exponent a of the haze's width in the plane of incidence")
        .number("haze_across", &M::haze_across, {-2, 2}, {-1.5, 1.5}, "",
                "exponent b of the haze's width across the plane of incidence")
        .number("haze_masking", &M::haze_masking, {0, 4}, {0, 3}, "",
                "exponent q of what a layer above the haze absorbs");
  }

  /// The parameter sets to prove.
  template <class D> static FACETA_INLINE void describe_proof(D& d) {
    d.limit({{"diffuse_reflectance", "0"},
             {"gloss_normal", "1"},
             {"gloss_grazing", "1"},
             {"gloss_alpha", "0.3"},
             {"gloss_tail", "2"},
             {"haze_normal", "0"},
             {"haze_grazing", "0"}},
            "roughconductor", {{"material", "none"}, {"distribution", "ggx"}, {"alpha", "0.3"}},
            1e-3)
        .limit({{"diffuse_reflectance", "0.9,0.4,0.1"},
                {"gloss_normal", "0"},
                {"gloss_grazing", "0"},
                {"haze_normal", "0"},
                {"haze_grazing", "0"}},
               "diffuse", {{"reflectance", "0.9,0.4,0.1"}}, 1e-3)
        .exemplar("default", {})
        .exemplar("blue silk vinyl", {{"diffuse_reflectance", "0.021,0.003,0.045"},
                                      {"gloss_normal", "0,0.055,0.32"},
                                      {"gloss_grazing", "0,0.008,0"},
                                      {"gloss_fresnel", "2.24"},
                                      {"gloss_alpha", "0.069"},
                                      {"gloss_tail", "4.06"},
                                      {"gloss_along", "0.675"},
                                      {"gloss_across", "1.79"},
                                      {"gloss_masking", "1.5"},
                                      {"haze_normal", "0,0.033,0.085"},
                                      {"haze_grazing", "0.281,0.239,0.205"},
                                      {"haze_fresnel", "2.8"},
                                      {"haze_alpha", "0.176"},
                                      {"haze_tail", "3.2"},
                                      {"haze_along", "-0.35"},
                                      {"haze_across", "-0.07"}})
        .exemplar("chrome with a veil", {{"diffuse_reflectance", "0"},
                                         {"gloss_normal", "0.5,0.52,0.55"},
                                         {"gloss_grazing", "0.9"},
                                         {"gloss_alpha", "0.01"},
                                         {"gloss_tail", "1.6"},
                                         {"haze_normal", "0.1"},
                                         {"haze_tail", "1.3"}})
        .exemplar("sharpest", {{"gloss_alpha", "0.001"}, {"haze_alpha", "0.05"}})
        .exemplar("roughest", {{"gloss_alpha", "1"}, {"haze_alpha", "1"}, {"haze_tail", "50"}})
        .exemplar("stretched", {{"gloss_alpha", "0.2"},
                                {"gloss_along", "-1"},
                                {"gloss_across", "1"},
                                {"haze_along", "1"},
                                {"haze_across", "-1"},
                                {"haze_masking", "2"}})
        .exemplar("black", {{"diffuse_reflectance", "0"},
                            {"gloss_normal", "0"},
                            {"gloss_grazing", "0"},
                            {"haze_normal", "0"},
                            {"haze_grazing", "0"}});
  }

  FACETA_INLINE Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(1e-18)) & (wi.z > T(1e-18));
    Pair pair(wo, wi);
    Choice p = choice(wo);
    T pdf = fma(p.gloss, Proposal(gloss(), wo).pdf(pair),
                fma(p.haze, Proposal(haze(), wo).pdf(pair), p.diffuse * wi.z * T(kInvPi)));
    Color<T> value = reflected(pair, wo, wi);
    return {value.map([&](const T& v) { return select(above, v, T(0)); }),
            select(above, pdf, T(0))};
  }
  /// The value of eval() alone, of directions above the surface: what a fit needs.
  FACETA_INLINE Color<T> value(const Vec3<T>& wo, const Vec3<T>& wi) const {
    return reflected(Pair(wo, wi), wo, wi);
  }

  FACETA_INLINE Sample<T> sample(const Vec3<T>& wo, const Random<T>& random,
                                 const Context<T>& context) const {
    Choice p = choice(wo);
    auto is_gloss = random.uc < p.gloss;
    auto is_diffuse = random.uc >= p.gloss + p.haze;
    Proposal g(gloss(), wo), h(haze(), wo);
    Proposal l;
    l.core_u = select(is_gloss, g.core_u, h.core_u);
    l.core_v = select(is_gloss, g.core_v, h.core_v);
    l.tail = select(is_gloss, g.tail, h.tail);
    l.x = g.x;
    l.y = g.y;
    Vec3<T> m = l.sample(random.u);
    Sample<T> s;
    s.wi = select(is_diffuse, cosine_hemisphere(random.u), reflect(wo, m));
    s.lobe = kReflection;
    s.valid = (wo.z > T(0)) & (s.wi.z > T(0));
    finish_sample(s, eval(wo, s.wi, context));
    return s;
  }

private:
  static constexpr double kLeastCosine = 1e-3;
  static constexpr double kLeastAlpha = 1e-3;
  /// Heaviest tail that is sampled: of heavier ones most normals would lie in the horizon. The
  /// cosine's share covers the rest.
  static constexpr double kHeaviestTail = 1.6;
  static constexpr double kCosineShare = 0.1;

  FACETA_INLINE Lobe gloss() const {
    return {gloss_normal, gloss_grazing, gloss_fresnel, max(gloss_alpha, T(kLeastAlpha)),
            gloss_tail,   gloss_along,   gloss_across,  gloss_masking};
  }
  FACETA_INLINE Lobe haze() const {
    return {haze_normal, haze_grazing, haze_fresnel, max(haze_alpha, T(kLeastAlpha)),
            haze_tail,   haze_along,   haze_across,  haze_masking};
  }

  /// What all lobes want to know of two directions: |h|^2 and h.z^2 of h = wo + wi, the squared
  /// slopes along and across the plane of incidence, log c, log(1 - c), log(cos_i cos_o).
  struct Pair {
    Vec3<T> h;
    T length2, z2, along2, across2, log_c, log_rise, log_cosines;

    FACETA_INLINE Pair(const Vec3<T>& wo, const Vec3<T>& wi) : h(wo + wi), length2(dot(h, h)) {
      z2 = max(sqr(h.z), T(1e-18));
      T inverse = T(1) / z2;
      T px = wi.x - wo.x, py = wi.y - wo.y, plane2 = fma(px, px, py * py);
      // h.p and h x p, with p = wi - wo on the surface, from differences that do not cancel.
      T dot_p = (wo.z - wi.z) * (wo.z + wi.z), cross_p = T(2) * fma(wo.x, wi.y, -(wo.y * wi.x));
      auto retro = !(plane2 > T(1e-10)); // c = 1 there: both directions are alike
      T scale = inverse / select(retro, T(1), plane2);
      along2 = select(retro, fma(h.x, h.x, h.y * h.y) * inverse, sqr(dot_p) * scale);
      across2 = select(retro, T(0), sqr(cross_p) * scale);
      T c2 = min(T(0.25) * length2, T(1));
      log_c = T(0.5) * log(max(c2, T(kLeastCosine * kLeastCosine)));
      log_rise = log(max(T(1) - sqrt(c2), T(1e-8)));
      log_cosines = log(max(wo.z * wi.z, T(1e-30)));
    }
  };

  /// A lobe's normals as they are drawn for a direction of view: slopes of a t-distribution whose
  /// widths are those that the lobe has about the mirror direction.
  struct Proposal {
    T core_u, core_v, tail; ///< (g - 1) alpha^2 along and across, exponent
    T x, y;                 ///< azimuth of wo

    Proposal() = default;
    FACETA_INLINE Proposal(const Lobe& l, const Vec3<T>& wo) {
      T s2 = sin_theta_squared(wo), inverse = T(1) / sqrt(max(s2, T(1e-30)));
      x = select(s2 > T(1e-20), wo.x * inverse, T(1));
      y = select(s2 > T(1e-20), wo.y * inverse, T(0));
      T core = (l.tail - T(1)) * sqr(l.alpha), log_c = log(max(wo.z, T(0.1)));
      core_u = core * exp(T(-2) * l.along * log_c);
      core_v = core * exp(T(-2) * l.across * log_c);
      tail = max(l.tail, T(kHeaviestTail));
    }
    FACETA_INLINE Vec3<T> sample(const Vec2<T>& u) const {
      T radius2 = exp(min(-log(max(T(1) - u.x, T(1e-30))) / (tail - T(1)), T(30))) - T(1);
      T radius = safe_sqrt(radius2);
      SinCos<T> angle = sincos(T(2 * kPi) * u.y);
      T a = sqrt(core_u) * radius * angle.cos, b = sqrt(core_v) * radius * angle.sin;
      return normalize(Vec3<T>{fma(x, a, -(y * b)), fma(y, a, x * b), T(1)});
    }
    /// Of the reflected direction: D cos theta_h / (4 wi.h).
    FACETA_INLINE T pdf(const Pair& p) const {
      T a = fma(x, p.h.x, y * p.h.y), b = fma(x, p.h.y, -(y * p.h.x));
      T s = (sqr(a) / core_u + sqr(b) / core_v) / p.z2;
      T d = exp(-tail * log(T(1) + s)) * (tail - T(1)) * T(kInvPi) / sqrt(core_u * core_v);
      return d * T(0.5) * p.length2 / (p.z2 * max(p.h.z, T(1e-9)));
    }
  };

  struct Choice {
    T gloss, haze, diffuse;
  };
  /// By the lobes' rough albedos towards the viewer, with a least share for the cosine.
  FACETA_INLINE Choice choice(const Vec3<T>& wo) const {
    T g = share(gloss(), wo), h = share(haze(), wo), d = mean(diffuse_reflectance);
    T sum = g + h + d;
    T scale = T(1 - kCosineShare) / max(sum, T(1e-20));
    return {g * scale, h * scale, T(1) - (g + h) * scale};
  }
  FACETA_INLINE T share(const Lobe& l, const Vec3<T>& wo) const {
    T c = max(wo.z, T(0.1));
    T rise = exp(l.fresnel * log(max(T(1) - c, T(1e-8))));
    T f = fma(mean(l.grazing) - mean(l.normal), rise, mean(l.normal));
    return f * exp((T(2) * l.masking - l.along - l.across) * log(c));
  }

  FACETA_INLINE Color<T> reflected(const Pair& pair, const Vec3<T>& wo, const Vec3<T>& wi) const {
    return diffuse_reflectance * (wi.z * T(kInvPi)) + lobe(gloss(), pair, wo, wi) +
           lobe(haze(), pair, wo, wi);
  }
  FACETA_INLINE static Color<T> lobe(const Lobe& l, const Pair& p, const Vec3<T>& wo,
                                     const Vec3<T>& wi) {
    T alpha2 = sqr(l.alpha), core = (l.tail - T(1)) * alpha2;
    T s = fma(p.along2, exp(T(2) * l.along * p.log_c), p.across2 * exp(T(2) * l.across * p.log_c));
    T d = exp(l.masking * p.log_cosines - l.tail * log(T(1) + s / core)) *
          (sqr(p.length2 / p.z2) * T(kInvPi));
    T value = d * wi.z / (projected(alpha2, wo.z) * projected(alpha2, wi.z) * alpha2);
    T rise = exp(l.fresnel * p.log_rise);
    return (l.normal + (l.grazing - l.normal) * rise) * value;
  }
  /// 2 cos / G1.
  FACETA_INLINE static T projected(const T& alpha2, const T& z) {
    return z + sqrt(fma(z, z, alpha2 * max(T(1) - z * z, T(0))));
  }
};

} // namespace faceta
