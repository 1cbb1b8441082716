#pragma once

/// Real materials with one fault each, of the kind that people make: what faults_test.cpp plants.

#include "materials/diffuse.h"
#include "materials/phong.h"
#include "materials/roughconductor.h"
#include "materials/roughdielectric.h"

namespace faceta::faulty {

/// The real material under another name, whose eval() goes through Fault::spoil(). Samples carry
/// the spoiled value and density: whoever makes such a mistake makes it in one place.
template <class T, template <class> class Real, class Fault> struct Faulty : Real<T> {
  static constexpr int kUsualChoices = 0; ///< no way round sample()
  template <class D> static void describe(D& d) {
    Real<T>::describe(d);
    d.model(Fault::kName, "a real material with a fault");
  }
  Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>& context) const {
    Eval<T> e = Real<T>::eval(wo, wi, context);
    static_cast<const Fault*>(this)->spoil(e, wo, wi, context);
    return e;
  }
  Sample<T> sample(const Vec3<T>& wo, const Random<T>& random, const Context<T>& context) const {
    Sample<T> s = Real<T>::sample(wo, random, context);
    finish_sample(s, eval(wo, s.wi, context));
    return s;
  }
  void spoil(Eval<T>&, const Vec3<T>&, const Vec3<T>&, const Context<T>&) const {}
};

/// The cosine of the wrong direction in a density.
template <class T> struct WrongCosine : Faulty<T, Diffuse, WrongCosine<T>> {
  static constexpr const char* kName = "wrong_cosine";
  void spoil(Eval<T>& e, const Vec3<T>& wo, const Vec3<T>&, const Context<T>&) const {
    e.pdf = select(e.pdf > T(0), wo.z * T(kInvPi), T(0));
  }
};

/// The density of h instead of that of wi: 4 |wo.h| dropped.
template <class T> struct NoJacobian : Faulty<T, RoughConductor, NoJacobian<T>> {
  static constexpr const char* kName = "no_jacobian";
  void spoil(Eval<T>& e, const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    e.pdf = e.pdf * (T(2) * length(wo + wi)); // wo.h = |wo + wi| / 2
  }
};

/// eval() takes the index of the near side for that of the far side.
template <class T> struct EtaUpsideDown : Faulty<T, RoughDielectric, EtaUpsideDown<T>> {
  static constexpr const char* kName = "eta_upside_down";
  void spoil(Eval<T>& e, const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>& context) const {
    RoughDielectric<T> turned = *this;
    turned.int_ior = this->ext_ior;
    turned.ext_ior = this->int_ior;
    e = turned.eval(wo, wi, context);
  }
};

/// Radiance crosses the interface as if it were importance.
template <class T> struct NoEtaSquared : Faulty<T, RoughDielectric, NoEtaSquared<T>> {
  static constexpr const char* kName = "no_eta_squared";
  void spoil(Eval<T>& e, const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>& context) const {
    Context<T> importance = context;
    importance.mode = TransportMode::importance;
    e = RoughDielectric<T>::eval(wo, wi, importance);
  }
};

/// G without the shadowing of wi.
template <class T> struct OneMaskingMissing : Faulty<T, RoughConductor, OneMaskingMissing<T>> {
  static constexpr const char* kName = "one_masking_missing";
  void spoil(Eval<T>& e, const Vec3<T>&, const Vec3<T>& wi, const Context<T>&) const {
    Microfacet<T> surface({.distribution = this->distribution}, this->alpha_u, this->alpha_v);
    e.value = e.value * select(wi.z > T(0), T(1) / surface.masking(wi), T(1));
  }
};

/// D without its 1 / pi, in value and density.
template <class T> struct Unnormalised : Faulty<T, RoughConductor, Unnormalised<T>> {
  static constexpr const char* kName = "unnormalised";
  void spoil(Eval<T>& e, const Vec3<T>&, const Vec3<T>&, const Context<T>&) const {
    e.value = e.value * T(kPi);
    e.pdf = e.pdf * T(kPi);
  }
};

/// alpha squared wherever alpha is meant: consistent in itself.
template <class T> struct AlphaSquared : Faulty<T, RoughConductor, AlphaSquared<T>> {
  static constexpr const char* kName = "alpha_squared";
  void prepare() {
    this->alpha_u = sqr(this->alpha_u);
    this->alpha_v = sqr(this->alpha_v);
    RoughConductor<T>::prepare();
  }
};

/// The half vector of transmission is not turned to the side of wo: it points into the denser
/// medium, so that from the thinner side the microfacet is seen from behind.
template <class T> struct HalfVectorSign : Faulty<T, RoughDielectric, HalfVectorSign<T>> {
  static constexpr const char* kName = "half_vector_sign";
  void spoil(Eval<T>& e, const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    T down = this->int_ior / this->ext_ior, up = this->ext_ior / this->int_ior;
    Vec3<T> h = wo + wi * select(wo.z > T(0), down, up);
    auto seen = (wo.z * wi.z > T(0)) | (dot(wo, h) > T(0));
    e.value = select(seen, e.value, Color<T>(T(0)));
    e.pdf = select(seen, e.pdf, T(0));
  }
};

/// A tint that depends on the viewer alone.
template <class T> struct OneWayTint : Faulty<T, Phong, OneWayTint<T>> {
  static constexpr const char* kName = "one_way_tint";
  void spoil(Eval<T>& e, const Vec3<T>& wo, const Vec3<T>&, const Context<T>&) const {
    e.value = e.value * fma(T(-0.01), wo.z, T(1));
  }
};

/// Samples normals of a surface that is 1 % rougher than the density says.
template <class T> struct RougherSampling : Faulty<T, RoughConductor, RougherSampling<T>> {
  static constexpr const char* kName = "rougher_sampling";
  Sample<T> sample(const Vec3<T>& wo, const Random<T>& random, const Context<T>& context) const {
    RoughConductor<T> rougher = *this;
    rougher.alpha_u = this->alpha_u * T(1.01);
    rougher.alpha_v = this->alpha_v * T(1.01);
    rougher.prepare();
    Sample<T> s = rougher.sample(wo, random, context);
    finish_sample(s, this->eval(wo, s.wi, context));
    return s;
  }
};

/// Eight lanes round once more than one or sixteen.
template <class T> struct LaneRounding : Faulty<T, RoughConductor, LaneRounding<T>> {
  static constexpr const char* kName = "lane_rounding";
  void spoil(Eval<T>& e, const Vec3<T>&, const Vec3<T>&, const Context<T>&) const {
    if constexpr (kWidthOf<T> == 8)
      e.value = e.value * T(3) * T(1.0 / 3);
  }
};

/// A parameter that is read, and then forgotten.
template <class T> struct IgnoredParameter : Faulty<T, RoughConductor, IgnoredParameter<T>> {
  static constexpr const char* kName = "ignored_parameter";
  void prepare() {
    this->specular_reflectance = Color<T>(T(1));
    RoughConductor<T>::prepare();
  }
};

} // namespace faceta::faulty
