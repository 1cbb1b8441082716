#pragma once

#include "bsdf/describe.h"
#include "bsdf/fresnel.h"

namespace faceta {

/// A smooth metal: a perfect mirror tinted by its Fresnel reflectance.
template <class T> struct Conductor {
  Color<T> eta{T(0)}, k{T(1)}, specular_reflectance{T(1)};

  template <class D> static FACETA_INLINE void describe(D& d) {
    d.model("conductor", "Smooth metal")
        .equation("f = F(cos theta) delta(wi - r(wo)) / cos theta,  r(wo) = (-x, -y, z)")
        .reference("Born and Wolf 1999, Principles of Optics, 14.2: reflection at a metal")
        .note("A delta: eval is always 0, sample returns the mirror direction with probability 1.")
        .note("eta and k are relative to the outside. The default, 'none', is a perfect mirror "
              "(eta = 0, k = 1, F = 1).")
        .spectrum("eta", &Conductor::eta, {0, 5}, "real part of the index of refraction")
        .spectrum("k", &Conductor::k, {0, 10}, "imaginary part of the index of refraction")
        .metal("material", "none", "a metal by name, instead of eta and k")
        .reflectance("specular_reflectance", &Conductor::specular_reflectance,
                     "factor on the reflection, 1 for a real metal")
        .traits({.lobes = kReflection, .delta = true, .has_delta = true})
        .limit({{"eta", "1.5"}, {"k", "0"}}, "dielectric", {{"int_ior", "1.5"}, {"ext_ior", "1"}},
               1e-6)
        .exemplar("mirror", {}, true)
        .exemplar("gold of the course", {{"material", "gold"}})
        .exemplar("aluminium", {{"material", "Al"}})
        .exemplar("tinted", {{"material", "Cu"}, {"specular_reflectance", "0.9,0.5,0.2"}})
        .exemplar("weak absorber", {{"eta", "1.5"}, {"k", "0"}});
  }

  FACETA_INLINE Eval<T> eval(const Vec3<T>&, const Vec3<T>&, const Context<T>&) const { return {}; }

  FACETA_INLINE Sample<T> sample(const Vec3<T>& wo, const Random<T>&, const Context<T>&) const {
    Sample<T> s;
    s.wi = reflect(wo);
    s.valid = wo.z > T(0);
    s.delta = true;
    s.lobe = kReflection;
    s.pdf = select(s.valid, T(1), T(0));
    s.weight = specular_reflectance * fresnel_conductor(min(abs(wo.z), T(1)), eta, k);
    s.weight = select(s.valid, s.weight, Color<T>(T(0)));
    return s;
  }
};

} // namespace faceta
