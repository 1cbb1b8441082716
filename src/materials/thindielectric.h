#pragma once

#include "bsdf/describe.h"
#include "bsdf/fresnel.h"

namespace faceta {

/// A thin parallel slab of glass: what passes goes straight on.
template <class T> struct ThinDielectric {
  T int_ior = T(1.5046), ext_ior = T(1.000277);
  Color<T> specular_reflectance{T(1)}, specular_transmittance{T(1)};

  template <class D> static FACETA_INLINE void describe(D& d) {
    d.model("thindielectric", "Thin pane of glass")
        .equation("f = R' delta(wi - r(wo)) / |cos theta| + (1 - R') delta(wi + wo) / |cos theta|,"
                  "  R' = 2 R / (1 + R),  R = F of one interface")
        .reference("Stokes 1862, On the Intensity of the Light reflected from or transmitted "
                   "through a Pile of Plates")
        .note("Deltas: eval is always 0; sample reflects with probability R', else passes "
              "straight on. Both sides of the pane see the same outside.")
        .ior("int_ior", &ThinDielectric::int_ior, "bk7", "index of refraction of the pane")
        .ior("ext_ior", &ThinDielectric::ext_ior, "air", "index of refraction around it")
        .reflectance("specular_reflectance", &ThinDielectric::specular_reflectance,
                     "factor on the reflection, 1 for real glass")
        .reflectance("specular_transmittance", &ThinDielectric::specular_transmittance,
                     "factor on the transmission, 1 for real glass")
        .traits(
            {.lobes = kReflection | kNullLobe, .delta = true, .has_delta = true, .two_sided = true})
        .exemplar("window", {}, true)
        .exemplar("diamond film", {{"int_ior", "diamond"}}, true)
        .exemplar("air film in water", {{"int_ior", "air"}, {"ext_ior", "water"}}, true)
        .exemplar("tinted", {{"specular_reflectance", "0.5,0.7,1"},
                             {"specular_transmittance", "0.4,0.8,0.5"}});
  }

  FACETA_INLINE Eval<T> eval(const Vec3<T>&, const Vec3<T>&, const Context<T>&) const { return {}; }

  FACETA_INLINE Sample<T> sample(const Vec3<T>& wo, const Random<T>& random,
                                 const Context<T>&) const {
    DielectricFresnel<T> one = fresnel_dielectric(abs(wo.z), int_ior / ext_ior);
    // All orders of reflection between the two interfaces.
    T inverse = T(1) / (T(1) + one.reflectance);
    T r = T(2) * one.reflectance * inverse;
    auto reflected = random.uc < r;
    Sample<T> s;
    s.wi = select(reflected, reflect(wo), -wo);
    s.valid = wo.z != T(0);
    s.delta = true;
    s.lobe = select(reflected, IntOf<T>(kReflection), IntOf<T>(kNullLobe));
    s.pdf = select(s.valid, select(reflected, r, one.transmittance * inverse), T(0));
    s.weight = select(reflected, specular_reflectance, specular_transmittance);
    s.weight = select(s.valid, s.weight, Color<T>(T(0)));
    return s;
  }
};

} // namespace faceta
