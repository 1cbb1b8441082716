#pragma once

#include "bsdf/describe.h"
#include "sampling/warp.h"

/// A material of somebody else's project.
namespace faceta::consumer {

/// Lommel and Seeliger: dust that scatters light once, f = rho / (4 pi (cos_i + cos_o)).
template <class T> struct Dust {
  Color<T> reflectance{T(0.5)};

  template <class D> static void describe(D& d) {
    d.model("dust", "Dust that scatters once")
        .equation("f = rho / (4 pi (cos_i + cos_o))")
        .reference("Seeliger 1887, Zur Theorie der Beleuchtung der grossen Planeten")
        .reflectance("reflectance", &Dust::reflectance, "albedo of one grain, rho")
        .traits({.lobes = kReflection, .reciprocal = true})
        .exemplar("moon", {});
  }

  Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    T share = T(0.25) / max(wi.z + wo.z, T(1e-30));
    T pdf = select(above, wi.z * T(kInvPi), T(0));
    return {reflectance * (pdf * share), pdf};
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

} // namespace faceta::consumer
