#pragma once

#include "bsdf/describe.h"
#include "sampling/warp.h"

/// A material of the test program's own, in a namespace inside faceta (so that pow(x, y) is our own
/// for every number type). This header and one line of CMake are all that a newcomer writes.
namespace faceta::newcomers {

/// Minnaert's law, f = rho (k + 1) / (2 pi) (cos_i cos_o)^(k - 1) for k >= 1; albedo rho
/// cos_o^(k-1).
template <class T> struct Newcomer {
  Color<T> reflectance{T(0.5)};
  T darkening = T(1.5);

  template <class D> static void describe(D& d) {
    d.model("minnaert", "Minnaert's limb darkening")
        .equation("f = rho (k + 1) / (2 pi) (cos_i cos_o)^(k - 1)")
        .reference("Minnaert 1941, The reciprocity principle in lunar photometry")
        .reflectance("reflectance", &Newcomer::reflectance, "albedo rho at the normal")
        .scalar("darkening", &Newcomer::darkening, {1, 100}, {1, 10}, "", "exponent k")
        .traits({.lobes = kReflection, .reciprocal = true})
        .exemplar("moon", {})
        .exemplar("white", {{"reflectance", "1"}, {"darkening", "1"}}, true)
        .exemplar("velvet", {{"reflectance", "0.9,0.1,0.2"}, {"darkening", "7.5"}});
  }

  Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    // Cosines kept away from 0, so that logarithms stay finite.
    T ci = max(wi.z, T(1e-30)), co = max(wo.z, T(1e-30));
    T pdf = select(above, (darkening + T(1)) * T(kInvTwoPi) * pow(ci, darkening), T(0));
    return {reflectance * (pdf * pow(co, darkening - T(1))), pdf};
  }

  Sample<T> sample(const Vec3<T>& wo, const Random<T>& random, const Context<T>& context) const {
    Sample<T> s;
    T z = pow(T(1) - random.u.x, T(1) / (darkening + T(1)));
    T r = safe_sqrt(fma(-z, z, T(1)));
    SinCos<T> azimuth = sincos(T(2 * kPi) * random.u.y);
    s.wi = {r * azimuth.cos, r * azimuth.sin, z};
    s.lobe = kReflection;
    s.valid = wo.z > T(0);
    finish_sample(s, eval(wo, s.wi, context));
    return s;
  }
};

} // namespace faceta::newcomers
