#pragma once

#include "bsdf/describe.h"
#include "bsdf/fresnel.h"

namespace faceta {

/// A smooth interface between two dielectrics: reflection and refraction.
template <class T> struct Dielectric {
  T int_ior = T(1.5046), ext_ior = T(1.000277);
  Color<T> specular_reflectance{T(1)}, specular_transmittance{T(1)};

  template <class D> static FACETA_INLINE void describe(D& d) {
    d.model("dielectric", "Smooth glass")
        .equation("f_r = F delta(wi - r(wo)) / |cos theta_r|,  "
                  "f_t = (eta_t / eta_i)^2 (1 - F) delta(wi - t(wo)) / |cos theta_t|")
        .reference("Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces")
        .note("Deltas: eval is always 0; sample reflects with probability F, else refracts.")
        .note("The transmitted direction is (-q x, -q y, -sign(z) cos theta_t) with q = eta_o / "
              "eta_t, o the side of wo. The course prints the ratio upside down and leaves the "
              "sign out; that vector is not of unit length (a test shows it).")
        .note("Radiance is scaled by (eta_o / eta_t)^2 when it is refracted; importance is not.")
        .ior("int_ior", &Dielectric::int_ior, "bk7", "index of refraction below the surface")
        .ior("ext_ior", &Dielectric::ext_ior, "air", "index of refraction above the surface")
        .reflectance("specular_reflectance", &Dielectric::specular_reflectance,
                     "factor on the reflection, 1 for real glass")
        .reflectance("specular_transmittance", &Dielectric::specular_transmittance,
                     "factor on the transmission, 1 for real glass")
        .traits({.lobes = kReflection | kTransmission,
                 .delta = true,
                 .has_delta = true,
                 .two_sided = true})
        .exemplar("glass", {}, true)
        .exemplar("water", {{"int_ior", "water"}}, true)
        .exemplar("diamond", {{"int_ior", "diamond"}}, true)
        .exemplar("air bubble in water", {{"int_ior", "air"}, {"ext_ior", "water"}}, true)
        .exemplar("no interface", {{"int_ior", "1.5"}, {"ext_ior", "1.5"}}, true)
        .exemplar("coloured", {{"specular_reflectance", "1,0.5,0.25"},
                               {"specular_transmittance", "0.2,0.6,0.9"}});
  }

  FACETA_INLINE Eval<T> eval(const Vec3<T>&, const Vec3<T>&, const Context<T>&) const { return {}; }

  FACETA_INLINE Sample<T> sample(const Vec3<T>& wo, const Random<T>& random,
                                 const Context<T>& context) const {
    DielectricFresnel<T> f = fresnel_dielectric(wo.z, int_ior / ext_ior);
    auto reflected = random.uc < f.reflectance;
    T scale = context.mode == TransportMode::radiance ? f.eta_ti * f.eta_ti : T(1);
    Sample<T> s;
    s.wi = select(reflected, reflect(wo), refract(wo, f));
    s.valid = wo.z != T(0);
    s.delta = true;
    s.lobe = select(reflected, IntOf<T>(kReflection), IntOf<T>(kTransmission));
    s.eta = select(reflected, T(1), f.eta_it);
    s.pdf = select(s.valid, select(reflected, f.reflectance, f.transmittance), T(0));
    s.weight = select(reflected, specular_reflectance, specular_transmittance * scale);
    s.weight = select(s.valid, s.weight, Color<T>(T(0)));
    return s;
  }
};

} // namespace faceta
