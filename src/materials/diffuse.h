#pragma once

#include "bsdf/describe.h"
#include "sampling/warp.h"

namespace faceta {

/// Lambert: f = rho / pi.
template <class T> struct Diffuse {
  Color<T> reflectance{T(0.5)};

  template <class D> static void describe(D& d) {
    d.model("diffuse", "Lambertian reflection")
        .equation("f = rho / pi")
        .reference("Lambert 1760, Photometria")
        .reflectance("reflectance", &Diffuse::reflectance, "albedo rho")
        .traits({.lobes = kReflection, .reciprocal = true})
        .exemplar("grey", {})
        .exemplar("coloured", {{"reflectance", "0.8,0.3,0.05"}})
        .exemplar("white", {{"reflectance", "1"}}, true);
  }

  Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    T pdf = select(above, wi.z * T(kInvPi), T(0));
    return {reflectance * pdf, pdf};
  }

  Sample<T> sample(const Vec3<T>& wo, const Random<T>& random, const Context<T>& context) const {
    Sample<T> s;
    s.wi = cosine_hemisphere(random.u);
    s.lobe = kReflection;
    s.valid = wo.z > T(0);
    finish_sample(s, eval(wo, s.wi, context));
    return s;
  }
};

} // namespace faceta
