#pragma once

#include "bsdf/describe.h"
#include "bsdf/lobes.h"
#include "sampling/warp.h"

namespace faceta {

/// Phong's lobe about the mirror direction, in the normalised form of Lafortune and Willems.
template <class T> struct Phong {
  T exponent{T(30)};
  Color<T> diffuse_reflectance{T(0.5)};
  Color<T> specular_reflectance{T(0.2)};

  template <class D> static void describe(D& d) {
    using M = Phong;
    d.model("phong", "Modified Phong reflection")
        .equation("f = rho_d/pi + rho_s (n+2)/(2 pi) max(0, cos a)^n, a = angle from the mirror "
                  "direction of wo to wi")
        .reference("Phong 1975, Illumination for Computer Generated Pictures")
        .reference("Lafortune and Willems 1994, Using the Modified Phong Reflectance Model for "
                   "Physically Based Rendering")
        .note("the lobe ends 90 degrees from the mirror direction, for n = 0 as well")
        .note(
            "where rho_d + rho_s exceeds 1 in a channel, both are scaled down to add up to 1. The "
            "specular albedo is rho_s at normal incidence and falls from there: the overlap of two "
            "decreasing lobes, cos^n a and cos theta, is largest when their axes agree")
        .scalar("exponent", &M::exponent, {0, kInfinity}, {0, 1000}, "",
                "sharpness n of the highlight")
        .reflectance("diffuse_reflectance", &M::diffuse_reflectance, "diffuse albedo rho_d")
        .reflectance("specular_reflectance", &M::specular_reflectance,
                     "largest albedo rho_s of the highlight")
        .traits({.lobes = kReflection, .reciprocal = true})
        .exemplar("default", {})
        .exemplar("flat", {{"exponent", "0"}})
        .exemplar("sharp", {{"exponent", "10000"}, {"diffuse_reflectance", "0.1,0.2,0.4"}})
        .exemplar("over-full white", {{"diffuse_reflectance", "1"}, {"specular_reflectance", "1"}})
        .exemplar("glossy only", {{"exponent", "5"},
                                  {"diffuse_reflectance", "0"},
                                  {"specular_reflectance", "0.99,0.8,0.3"}})
        .exemplar("black", {{"diffuse_reflectance", "0"}, {"specular_reflectance", "0"}});
  }

  void prepare() { lobes_.set(diffuse_reflectance, specular_reflectance); }

  Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    // 1 - cos a from the chord: exact where the highlight is.
    Vec3<T> chord = wi - reflect(wo);
    T t = T(0.5) * dot(chord, chord);
    T lobe = cosine_power(T(1) - t, t, exponent) * T(kInvTwoPi);
    return lobes_.mix(above, wi.z * T(kInvPi), (exponent + T(2)) * lobe * wi.z,
                      (exponent + T(1)) * lobe);
  }

  Sample<T> sample(const Vec3<T>& wo, const Random<T>& random, const Context<T>& context) const {
    Sample<T> s;
    Vec3<T> glossy =
        frame_from_normal(reflect(wo)).to_world(sample_cosine_power(random.u, exponent));
    s.wi = select(random.uc < lobes_.diffuse_probability, cosine_hemisphere(random.u), glossy);
    s.lobe = kReflection;
    s.valid = (wo.z > T(0)) & (s.wi.z > T(0));
    finish_sample(s, eval(wo, s.wi, context));
    return s;
  }

private:
  TwoLobes<T> lobes_;
};

} // namespace faceta
