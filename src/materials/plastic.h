#pragma once

#include "bsdf/describe.h"
#include "bsdf/fresnel.h"
#include "sampling/warp.h"

namespace faceta {

/// A diffuse base under a smooth dielectric coat.
template <class T> struct Plastic {
  Color<T> diffuse_reflectance{T(0.5)};
  Color<T> specular_reflectance{T(1)};
  T int_ior{T(1.49)}, ext_ior{T(1.000277)};
  int nonlinear = 0;
  T specular_share{T(2.0 / 3)}; ///< of the two mean colours

  template <class D> static void describe(D& d) {
    using M = Plastic;
    d.model("plastic", "Smooth plastic")
        .equation("f = s F(cos_o) delta(wi - mirror)/cos_i "
                  "+ (1-F(cos_o)) (1-F(cos_i)) / (pi eta^2) {rho/(1 - R) | rho/(1 - rho R)}\n"
                  "F: dielectric Fresnel at eta = int_ior/ext_ior, R: its diffuse reflectance from "
                  "inside; the right-hand alternative if nonlinear")
        .reference("Jakob et al. 2022, Mitsuba 3: plastic")
        .reference("Egan and Hilgeman 1973; d'Eon and Irving 2011 (fits of R)")
        .note(
            "light that scatters inside keeps its colour, or with nonlinear takes on more of it at "
            "each internal reflection")
        .note("R is the scene contract's fit: a white base returns 0.12 % more or less than it "
              "receives "
              "for eta up to 2, 4.3 % too much at 2.5. Beyond eta = 3.8 the fit is useless and is "
              "held "
              "at 0.99")
        .reflectance("diffuse_reflectance", &M::diffuse_reflectance, "albedo rho of the base")
        .reflectance("specular_reflectance", &M::specular_reflectance,
                     "factor s on the coat's reflection; 1 is physical")
        .ior("int_ior", &M::int_ior, "polypropylene", "index of refraction of the coat")
        .ior("ext_ior", &M::ext_ior, "air", "index of refraction outside")
        .flag("nonlinear", &M::nonlinear, "let internal scattering shift the colour")
        .derived(&M::specular_share)
        .traits({.lobes = kReflection, .has_delta = true, .reciprocal = true, .albedo_bound = 1.05})
        .excuse(
            "energy",
            "the fitted internal reflectance R is up to 4.3 % off at eta = 2.5 (0.12 % up to 2)",
            "Egan and Hilgeman 1973; d'Eon and Irving 2011 (fits of R)")
        .limit({{"int_ior", "1.3"}, {"ext_ior", "1.3"}, {"diffuse_reflectance", "0.9,0.4,0.1"}},
               "diffuse", {{"reflectance", "0.9,0.4,0.1"}}, 1e-3)
        .exemplar("default", {})
        .exemplar("nonlinear", {{"diffuse_reflectance", "0.9,0.4,0.1"}, {"nonlinear", "true"}})
        .exemplar("ceramic", {{"diffuse_reflectance", "0.05,0.1,0.4"}, {"int_ior", "1.9"}})
        .exemplar("black", {{"diffuse_reflectance", "0"}})
        .exemplar("tinted coat", {{"specular_reflectance", "0.8,0.4,0"}})
        .exemplar("no coat", {{"int_ior", "air"}, {"diffuse_reflectance", "0.9"}});
  }

  void prepare_once(PrepareOnce&) {
    T d = mean(diffuse_reflectance), s = mean(specular_reflectance);
    specular_share = d + s > T(0) ? s / (d + s) : T(0.5);
  }
  void prepare() {
    eta_ = int_ior / ext_ior;
    T inside = min(fresnel_diffuse_reflectance(ext_ior / int_ior), T(0.99));
    base_ = diffuse_reflectance.map([&](const T& rho) {
      return rho / (sqr(eta_) * (T(1) - inside * (nonlinear ? rho : T(1))));
    });
  }

  Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    DielectricFresnel<T> fo = fresnel_dielectric(wo.z, eta_);
    T to = fo.transmittance, ti = fresnel_dielectric(wi.z, eta_).transmittance;
    T cosine = select(above, wi.z * T(kInvPi), T(0));
    return {base_ * (to * ti * cosine), cosine * choice(fo.reflectance, to).diffuse};
  }

  Sample<T> sample(const Vec3<T>& wo, const Random<T>& random, const Context<T>& context) const {
    DielectricFresnel<T> fresnel = fresnel_dielectric(wo.z, eta_);
    T f = fresnel.reflectance, p = choice(f, fresnel.transmittance).specular;
    auto mirror = random.uc < p;
    Sample<T> s;
    s.wi = select(mirror, reflect(wo), cosine_hemisphere(random.u));
    s.lobe = kReflection;
    s.valid = (wo.z > T(0)) & (s.wi.z > T(0));
    auto delta = mirror & s.valid;
    finish_sample(s, eval(wo, s.wi, context));
    s.delta = delta;
    s.valid = s.valid | delta;
    s.value = select(delta, Color<T>(T(0)), s.value);
    s.pdf = select(delta, p, s.pdf);
    s.weight = select(delta, specular_reflectance * (f / select(delta, p, T(1))), s.weight);
    return s;
  }

private:
  Color<T> base_; ///< diffuse albedo over eta^2, internal reflections included
  T eta_{};

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
