#pragma once

#include "bsdf/describe.h"
#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"
#include "bsdf/rough_interface.h"
#include "sampling/warp.h"

namespace faceta {

/// A diffuse base under a rough dielectric coat.
template <class T> struct RoughPlastic {
  Color<T> diffuse_reflectance{T(0.5)};
  Color<T> specular_reflectance{T(1)};
  T int_ior{T(1.49)}, ext_ior{T(1.000277)};
  T alpha{T(0.1)};
  int distribution = kBeckmann, sample_visible = 1, nonlinear = 0;
  T specular_share{T(2.0 / 3)}; ///< of the two mean colours
  T internal_reflectance{T(0)}; ///< R of the equation
  Table<T> transmittance;       ///< T of the equation, at kNodes equidistant cosines

  static constexpr int kNodes = 64;

  template <class D> static void describe(D& d) {
    using M = RoughPlastic;
    d.model("roughplastic", "Rough plastic")
        .equation("f = s F(wi.h) G(wi, wo) D(h) / (4 cos_i cos_o) "
                  "+ T(cos_o) T(cos_i) / (pi eta^2) {rho/(1 - R) | rho/(1 - rho R)}\n"
                  "T(mu): mean over the normals m visible from mu of (1 - F) G1(refracted, m); R: "
                  "2 int mu "
                  "<F G1> dmu from inside; the right-hand alternative if nonlinear")
        .reference("Jakob et al. 2022, Mitsuba 3: roughplastic")
        .reference("Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces")
        .note(
            "T and R are tabulated at 64 equidistant cosines when the material is made; roughness "
            "and indices therefore take no textures")
        .note("R, a mean over the 64 cosines as in the scene contract, is 1.5 % below plastic's: "
              "with "
              "alpha -> 0 a white base reflects 2 % less than there")
        .note("the coat's masked light is lost, and T counts what is refracted, not 1 - reflected")
        .reflectance("diffuse_reflectance", &M::diffuse_reflectance, "albedo rho of the base")
        .reflectance("specular_reflectance", &M::specular_reflectance,
                     "factor s on the coat's reflection; 1 is physical")
        .ior("int_ior", &M::int_ior, "polypropylene", "index of refraction of the coat")
        .ior("ext_ior", &M::ext_ior, "air", "index of refraction outside")
        .number("alpha", &M::alpha, {0, kInfinity}, {0.001, 1}, "RMS slope",
                "roughness of the coat, the same in all directions; at least 1e-4")
        .choice("distribution", &M::distribution, {"beckmann", "ggx"},
                "distribution of the coat's normals")
        .flag("sample_visible", &M::sample_visible, "sample visible normals instead of all")
        .flag("nonlinear", &M::nonlinear, "let internal scattering shift the colour")
        .derived(&M::specular_share)
        .derived(&M::internal_reflectance)
        .table(&M::transmittance)
        .traits({.lobes = kReflection, .reciprocal = true})
        .limit({{"alpha", "0"}, {"int_ior", "1.5"}, {"ext_ior", "1"}}, "plastic",
               {{"int_ior", "1.5"}, {"ext_ior", "1"}}, 0.025)
        .limit({{"alpha", "0"},
                {"int_ior", "1.3"},
                {"ext_ior", "1.3"},
                {"diffuse_reflectance", "0.9,0.4,0.1"}},
               "diffuse", {{"reflectance", "0.9,0.4,0.1"}}, 1e-3)
        .exemplar("default", {})
        .exemplar("ggx", {{"distribution", "ggx"}, {"alpha", "0.3"}})
        .exemplar(
            "nonlinear",
            {{"diffuse_reflectance", "0.9,0.4,0.1"}, {"nonlinear", "true"}, {"alpha", "0.05"}})
        .exemplar("all normals", {{"sample_visible", "false"}, {"alpha", "0.2"}})
        .exemplar("polished", {{"alpha", "0.001"}})
        .exemplar("roughest white",
                  {{"alpha", "1"}, {"diffuse_reflectance", "1"}, {"int_ior", "1.9"}})
        .exemplar("black", {{"diffuse_reflectance", "0"}, {"alpha", "0.5"}});
  }

  void prepare_once(PrepareOnce& once) {
    T d = mean(diffuse_reflectance), s = mean(specular_reflectance);
    specular_share = d + s > T(0) ? s / (d + s) : T(0.5);
    RoughInterface coat = rough_interface(distribution, alpha, int_ior / ext_ior, kNodes);
    internal_reflectance = coat.internal_reflectance;
    transmittance = once.add_table(coat.transmittance);
  }
  FACETA_INLINE void prepare() {
    eta_ = int_ior / ext_ior;
    base_ = diffuse_reflectance.map([&](const T& rho) {
      return rho / (sqr(eta_) * (T(1) - internal_reflectance * (nonlinear ? rho : T(1))));
    });
  }

  FACETA_INLINE Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    MicrofacetReflection<T> coat = surface().reflection(wo, wi);
    T f = fresnel_dielectric(coat.cos_h(), eta_).reflectance;
    T to = transmittance.interpolate(wo.z, kNodes), ti = transmittance.interpolate(wi.z, kNodes);
    T cosine = select(above, wi.z * T(kInvPi), T(0));
    Choice lobe = choice(T(1) - to, to);
    return {specular_reflectance * (f * coat.value) + base_ * (to * ti * cosine),
            fma(lobe.specular, coat.pdf, lobe.diffuse * cosine)};
  }

  FACETA_INLINE Sample<T> sample(const Vec3<T>& wo, const Random<T>& random,
                                 const Context<T>& context) const {
    T to = transmittance.interpolate(wo.z, kNodes), p = choice(T(1) - to, to).specular;
    Sample<T> s;
    s.wi = select(random.uc < p, surface().sample_reflection(wo, random.u),
                  cosine_hemisphere(random.u));
    s.lobe = kReflection;
    s.valid = (wo.z > T(0)) & (s.wi.z > T(0));
    finish_sample(s, eval(wo, s.wi, context));
    return s;
  }

private:
  Color<T> base_; ///< diffuse albedo over eta^2, internal reflections included
  T eta_{};

  Microfacet<T> surface() const {
    return Microfacet<T>({.distribution = distribution, .sample_visible = sample_visible}, alpha,
                         alpha);
  }
  struct Choice {
    T specular, diffuse;
  };
  /// Probabilities of the lobes, each from its own share: 1 - p would lose the small one's digits.
  Choice choice(const T& reflected, const T& passed) const {
    T s = reflected * specular_share, d = passed * (T(1) - specular_share);
    auto none = !(s + d > T(0));
    T inverse = T(1) / select(none, T(1), s + d);
    return {select(none, T(1), s * inverse), select(none, T(0), d * inverse)};
  }
};

} // namespace faceta
