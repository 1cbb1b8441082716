#pragma once

#include "bsdf/describe.h"
#include "bsdf/lobes.h"
#include "sampling/warp.h"

namespace faceta {

/// Blinn's lobe about the half vector, normalised to the albedo rho_s at normal incidence.
template <class T> struct BlinnPhong {
  T exponent{T(30)};
  Color<T> diffuse_reflectance{T(0.5)};
  Color<T> specular_reflectance{T(0.2)};

  template <class D> static void describe(D& d) {
    using M = BlinnPhong;
    d.model("blinnphong", "Blinn-Phong reflection")
        .equation("f = rho_d/pi + rho_s k(n) (n.h)^n, h = (wi+wo)/|wi+wo|,\n"
                  "k(n) = (n+2)(n+4) / (8 pi (2^(-n/2) + n))")
        .reference("Blinn 1977, Models of Light Reflection for Computer Synthesized Pictures")
        .reference("Giesen 2009, Phong and Blinn-Phong Normalization Factors (note)")
        .note("k(n) makes the albedo of the highlight exactly rho_s at normal incidence, by "
              "integration: "
              "1/k = 2 pi int cos^n(t/2) cos t sin t dt over [0, pi/2]. For every n the albedo is "
              "largest there (a unit test walks a dense grid of n and angles), so it stays below "
              "rho_d + rho_s everywhere")
        .note("where rho_d + rho_s exceeds 1 in a channel, both are scaled down to add up to 1")
        .scalar("exponent", &M::exponent, {0, kInfinity}, {0, 1000}, "",
                "sharpness n of the highlight")
        .reflectance("diffuse_reflectance", &M::diffuse_reflectance, "diffuse albedo rho_d")
        .reflectance("specular_reflectance", &M::specular_reflectance,
                     "largest albedo rho_s of the highlight")
        .traits({.lobes = kReflection, .reciprocal = true})
        .limit({{"exponent", "0"},
                {"diffuse_reflectance", "0.5,0.2,0.1"},
                {"specular_reflectance", "0.4,0.2,0.6"}},
               "diffuse", {{"reflectance", "0.9,0.4,0.7"}}, 1e-6)
        .exemplar("default", {})
        .exemplar("flat", {{"exponent", "0"}})
        .exemplar("sharp", {{"exponent", "10000"}, {"diffuse_reflectance", "0.1,0.2,0.4"}})
        .exemplar("over-full white", {{"diffuse_reflectance", "1"}, {"specular_reflectance", "1"}})
        .exemplar("glossy only", {{"exponent", "5"},
                                  {"diffuse_reflectance", "0"},
                                  {"specular_reflectance", "0.99,0.8,0.3"}})
        .exemplar("black", {{"diffuse_reflectance", "0"}, {"specular_reflectance", "0"}});
  }

  void prepare() {
    lobes_.set(diffuse_reflectance, specular_reflectance);
    T residue = exp(T(-0.34657359027997264) * exponent); // 2^(-n/2)
    scale_ = (exponent + T(2)) * T(0.125 * kInvPi) * ((exponent + T(4)) / (residue + exponent));
  }

  Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    Vec3<T> h = wo + wi;
    // cos^2 and 1 - cos^2 each from their own components; wo.h = |h|/2.
    T length2 = max(dot(h, h), T(1e-18)), inverse = T(1) / length2;
    T lobe = cosine_power(sqr(h.z) * inverse, sin_theta_squared(h) * inverse, T(0.5) * exponent);
    T density = (exponent + T(1)) * T(0.25 * kInvPi) * lobe / sqrt(length2);
    return lobes_.mix(above, wi.z * T(kInvPi), scale_ * lobe * wi.z, density);
  }

  Sample<T> sample(const Vec3<T>& wo, const Random<T>& random, const Context<T>& context) const {
    Sample<T> s;
    Vec3<T> glossy = reflect(wo, sample_cosine_power(random.u, exponent));
    s.wi = select(random.uc < lobes_.diffuse_probability, cosine_hemisphere(random.u), glossy);
    s.lobe = kReflection;
    s.valid = (wo.z > T(0)) & (s.wi.z > T(0));
    finish_sample(s, eval(wo, s.wi, context));
    return s;
  }

private:
  TwoLobes<T> lobes_;
  T scale_{};
};

} // namespace faceta
