#pragma once

#include "bsdf/describe.h"
#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"

namespace faceta {

/// A rough interface between two dielectrics: reflection and refraction at microfacets.
template <class T> struct RoughDielectric {
  T int_ior = T(1.5046), ext_ior = T(1.000277);
  int distribution = kBeckmann;
  T alpha_u = T(0.1), alpha_v = T(0.1);
  int sample_visible = 1, height_correlated = 0;
  Color<T> specular_reflectance{T(1)}, specular_transmittance{T(1)};

  template <class D> static FACETA_INLINE void describe(D& d) {
    using M = RoughDielectric;
    d.model("roughdielectric", "Rough glass")
        .equation("f_r = F D G / (4 |cos theta_i cos theta_o|),  f_t = |wo.h wi.h| / |cos theta_i "
                  "cos theta_o| eta_i^2 (1 - F) D G / (eta_o wo.h + eta_i wi.h)^2")
        .reference("Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces, "
                   "eqs. 20 and 21")
        .reference("Heitz and d'Eon 2014, Importance Sampling Microfacet-Based BSDFs using the "
                   "Distribution of Visible Normals")
        .reference("Dupuy and Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps")
        .note("Light scattered more than once between facets is lost: the furnace is below 1.")
        .note("Radiance is scaled by (eta_o / eta_i)^2 when it is refracted; importance is not.")
        .note("With sample_visible=false all normals are sampled, of a surface that is rougher by "
              "1.2 - 0.2 sqrt|cos theta_o| (Walter et al. 2007, 5.3).")
        .note("height_correlated takes 1 / (1 + Lambda_o + Lambda_i) for refraction too, where a "
              "Smith surface has the smaller B(1 + Lambda_o, 1 + Lambda_i) (Heitz et al. 2016).")
        .ior("int_ior", &M::int_ior, "bk7", "index of refraction below the surface")
        .ior("ext_ior", &M::ext_ior, "air", "index of refraction above the surface")
        .choice("distribution", &M::distribution, {"beckmann", "ggx"}, "distribution of normals")
        .roughness(&M::alpha_u, &M::alpha_v, "roughness of the microfacets")
        .flag("sample_visible", &M::sample_visible, "sample visible normals only")
        .flag("height_correlated", &M::height_correlated,
              "masking and shadowing correlated by height")
        .reflectance("specular_reflectance", &M::specular_reflectance,
                     "factor on the reflection, 1 for real glass")
        .reflectance("specular_transmittance", &M::specular_transmittance,
                     "factor on the transmission, 1 for real glass")
        .traits({.lobes = kReflection | kTransmission, .two_sided = true})
        .limit({{"alpha", "0"}}, "dielectric", {}, 1e-3)
        .exemplar("frosted glass", {})
        .exemplar("almost smooth", {{"alpha", "0.001"}})
        .exemplar("brushed", {{"distribution", "ggx"}, {"alpha_u", "0.05"}, {"alpha_v", "0.3"}})
        .exemplar("very rough diamond",
                  {{"int_ior", "diamond"}, {"distribution", "ggx"}, {"alpha", "1"}})
        .exemplar("all normals", {{"alpha", "0.3"}, {"sample_visible", "false"}})
        .exemplar("air in water", {{"int_ior", "air"}, {"ext_ior", "water"}, {"alpha", "0.2"}})
        .exemplar("height-correlated", {{"alpha", "0.5"},
                                        {"height_correlated", "true"},
                                        {"specular_reflectance", "1,0.5,0.25"},
                                        {"specular_transmittance", "0.2,0.6,0.9"}});
  }

  /// Without a step of the index there is no half vector of transmission.
  static const char* validate(const RoughDielectric<double>& m) {
    return m.int_ior == m.ext_ior
               ? "int_ior and ext_ior of 'roughdielectric' must differ (no interface is left: use "
                 "'null' or 'dielectric')"
               : nullptr;
  }

  FACETA_INLINE Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi,
                             const Context<T>& context) const {
    Side side(*this, wo.z);
    Vec3<T> o = wo * side.sign, i = wi * side.sign; // o lies above the surface
    auto reflected = i.z > T(0);
    Vec3<T> m = fma(i, select(reflected, T(1), side.eta_it), o);
    m = m * copysign(T(1), m.z);
    T m_length2 = max(dot(m, m), T(1e-37)), m_length = sqrt(m_length2);
    T mo = dot(o, m), mi = dot(i, m); // times |m|
    // Refraction knows both cosines: near the critical angle Snell's law would lose digits.
    T cos_o = min(mo / m_length, T(1));
    T cos_t =
        select(reflected, snell_cosine_of_reflection(o, i, m_length2, side), abs(mi) / m_length);
    DielectricFresnel<T> f = fresnel_dielectric_between(cos_o, cos_t, side.eta_it, side.eta_ti);

    Microfacet<T> all = surface(T(1));
    T d = all.density(m);
    T g = all.masking_shadowing(o, {i.x, i.y, abs(i.z)});
    T eta2 = side.eta_it * side.eta_it;
    T to_radiance = context.mode == TransportMode::radiance ? side.eta_ti * side.eta_ti : T(1);
    // (wo.h + eta wi.h)^2 is |m|^2 for the m that is not normalised.
    T inverse2 = T(1) / m_length2;
    T jacobian = eta2 * abs(mi) * inverse2;
    T dg = d * g / o.z;
    T value = select(reflected, T(0.25) * f.reflectance * dg,
                     f.transmittance * dg * to_radiance * jacobian * mo * inverse2);

    T normal =
        sample_visible ? d * mo / all.projected_area(o) : surface(widening(o.z)).density(m) * m.z;
    T pdf = normal *
            select(reflected, f.reflectance / (T(4) * mo), f.transmittance * jacobian * inverse2);

    // Nearer to the horizon than this, products of cosines leave the range of single precision.
    T horizon = T(1e-10);
    auto ok = (o.z > horizon) & (abs(i.z) > horizon) & (mo > T(0)) &
              (reflected | ((i.z < T(0)) & (mi < T(0))));
    Eval<T> e;
    e.value =
        select(reflected, specular_reflectance, specular_transmittance) * select(ok, value, T(0));
    e.pdf = select(ok, pdf, T(0));
    return e;
  }

  FACETA_INLINE Sample<T> sample(const Vec3<T>& wo, const Random<T>& random,
                                 const Context<T>& context) const {
    Side side(*this, wo.z);
    Vec3<T> o = wo * side.sign;
    Vec3<T> m = sample_visible ? surface(T(1)).sample_visible(o, random.u)
                               : surface(widening(o.z)).sample_all(random.u);
    m = m * (T(1) / sqrt(max(dot(m, m), T(1e-37))));
    T cos_o = dot(o, m);
    DielectricFresnel<T> f = fresnel_dielectric_near(cos_o, side.eta_it, side.eta_ti);
    auto reflected = random.uc < f.reflectance;
    Vec3<T> i = select(reflected, reflect(o, m), refract(o, m, cos_o, f));
    Sample<T> s;
    s.wi = i * side.sign;
    s.lobe = select(reflected, IntOf<T>(kReflection), IntOf<T>(kTransmission));
    s.eta = select(reflected, T(1), side.eta_it);
    s.valid = (o.z > T(0)) & (cos_o > T(0)) & (select(reflected, i.z, -i.z) > T(0));
    finish_sample(s, eval(wo, s.wi, context));
    return s;
  }

private:
  /// The interface as seen from the side of wo.
  struct Side {
    T sign, eta_it, eta_ti;
    FACETA_INLINE Side(const RoughDielectric& m, const T& z) {
      auto above = z > T(0);
      T down = m.int_ior / m.ext_ior, up = m.ext_ior / m.int_ior;
      sign = select(above, T(1), T(-1));
      eta_it = select(above, down, up);
      eta_ti = select(above, up, down);
    }
  };
  /// snell_cosine() of the angle between h and the directions that h reflects into each other.
  static FACETA_INLINE T snell_cosine_of_reflection(const Vec3<T>& o, const Vec3<T>& i,
                                                    const T& m_length2, const Side& side) {
    // Near the critical angle the root magnifies each rounding of eta^2 - sin^2 = eta^2 - 1 +
    // cos^2: the smaller one of |o - i|^2 = 4 sin^2 and |m|^2 = 4 cos^2 has the smaller error.
    const T& eta = side.eta_it;
    Vec3<T> chord = o - i;
    T chord2 = dot(chord, chord);
    T steep = fma(eta, eta, T(-0.25) * chord2);
    T grazing = fma(eta - T(1), eta + T(1), T(0.25) * m_length2);
    return side.eta_ti * safe_sqrt(select(chord2 < m_length2, steep, grazing));
  }
  FACETA_INLINE Microfacet<T> surface(const T& widened) const {
    return {
        {distribution, sample_visible, height_correlated, 0}, alpha_u * widened, alpha_v * widened};
  }
  static FACETA_INLINE T widening(const T& cos_o) { return fma(T(-0.2), sqrt(abs(cos_o)), T(1.2)); }
};

} // namespace faceta
