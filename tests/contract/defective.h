#pragma once

/// Materials with one defect each: a property that passes them all proves nothing.

#include "bsdf/describe.h"
#include "sampling/warp.h"

namespace faceta::defective {

enum class Defect {
  none,
  none_mirror,    ///< nothing wrong with Lambert beside a mirror either
  wrong_density,  ///< the density is 2 % too small, and so are sample's
  wrong_sampling, ///< samples are uniform, the density says cosine
  wrong_weight,   ///< weight is 0.1 % above value / density
  wrong_sample,   ///< sample() gives another value than eval()
  wrong_side,     ///< one sample in a thousand goes below the surface as a reflection
  too_bright,     ///< reflects 1 % more than it receives
  lossy,          ///< claims to lose nothing and loses 1 %
  one_way,        ///< not reciprocal, claims to be
  not_a_number,   ///< 0 / 0 for wo = wi
  negative,       ///< negative at grazing angles
  lane_drift,     ///< wide lanes differ in the last bit
  lane_texture,   ///< wide lanes take the first lane's texel
  imprecise,      ///< cancellation in float
  wrong_slope,    ///< derivatives lose a term
  dead_parameter, ///< `gain` does nothing
  wrong_mode,     ///< importance has a factor that radiance has not
  wrong_delta,    ///< a delta lobe misreports its probability by 1 %
  hidden_peak,    ///< a narrow lobe in the density that sample() never draws from
  wrong_width     ///< assumes three channels
};

inline constexpr const char* kDefectNames[] = {
    "none",         "none_mirror",    "wrong_density", "wrong_sampling", "wrong_weight",
    "wrong_sample", "wrong_side",     "too_bright",    "lossy",          "one_way",
    "not_a_number", "negative",       "lane_drift",    "lane_texture",   "imprecise",
    "wrong_slope",  "dead_parameter", "wrong_mode",    "wrong_delta",    "hidden_peak",
    "wrong_width"};

/// A sum of Lambert and, for some defects, a mirror: right in everything but the defect.
template <class T, Defect kDefect> struct Defective {
  Color<T> reflectance{T(1)};
  T gain = T(1);

  static constexpr bool has(Defect d) { return kDefect == d; }
  static constexpr bool kMirror = has(Defect::none_mirror) || has(Defect::wrong_delta);

  template <class D> static void describe(D& d) {
    d.model(kDefectNames[int(kDefect)], "Lambert with one defect")
        .equation("f = rho / pi")
        .reference("none")
        .reflectance("reflectance", &Defective::reflectance, "albedo rho")
        .scalar("gain", &Defective::gain, {0, 1}, {0, 1}, "", "factor of everything")
        .traits({.lobes = kReflection, .has_delta = kMirror})
        .known_albedo({}, 1, 1, 1, 1e-3, "f = rho / pi")
        .exemplar("white", {}, !has(Defect::too_bright));
    if (kMirror)
      d.limit({{"gain", "0"}}, "diffuse", {{"reflectance", "0"}}, 1e-6);
    else
      d.limit({{"gain", "1"}}, "diffuse", {}, 1e-6);
  }

  Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>& context) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    T pdf = select(above, wi.z * T(kInvPi), T(0));
    Color<T> value = reflectance * (pdf * (has(Defect::dead_parameter) ? T(1) : gain));
    if (kMirror) {
      value = value * T(0.75);
      pdf = pdf * T(0.75);
    }
    if (has(Defect::wrong_density))
      pdf = pdf * T(0.98);
    if (has(Defect::too_bright))
      value = value * T(1.01);
    if (has(Defect::lossy))
      value = value * T(0.99);
    if (has(Defect::wrong_width))
      value = value * T(Color<T>::size() / 3.0);
    if (has(Defect::one_way))
      value = value * (T(1) - T(0.01) * wo.z);
    if (has(Defect::not_a_number)) {
      Vec3<T> d = wo - wi;
      value = value * (dot(d, d) / dot(d, d));
    }
    if (has(Defect::negative))
      value = value * select(wi.z < T(0.01), T(-1), T(1));
    if (has(Defect::lane_drift) && kWidthOf<T> > 1)
      value = value * T(1 + 0x1p-23f);
    if (has(Defect::imprecise)) {
      T one = T(1000) - (T(1000) - wi.z);
      value = value * (one / select(wi.z > T(0), wi.z, T(1)));
      value = select(above, value, Color<T>(T(0)));
    }
    if (has(Defect::wrong_mode) && context.mode == TransportMode::importance)
      value = value * T(1 - 1e-3);
    if (has(Defect::hidden_peak)) {
      Vec3<T> d = wi - normalize(Vec3<T>{T(0.3), T(-0.5), T(0.6)});
      pdf = pdf + select(above & (dot(d, d) < T(1e-2)), T(1), T(0));
    }
    forget_slope(value);
    return {value, pdf};
  }

  Sample<T> sample(const Vec3<T>& wo, const Random<T>& random, const Context<T>& context) const {
    Sample<T> s;
    s.wi = has(Defect::wrong_sampling) ? uniform_hemisphere(random.u) : cosine_hemisphere(random.u);
    s.lobe = kReflection;
    s.valid = wo.z > T(0);
    Eval<T> e = eval(wo, s.wi, context);
    if (has(Defect::hidden_peak))
      e.pdf = s.wi.z * T(kInvPi);
    if (has(Defect::wrong_sample))
      e.value = e.value * T(1.001);
    finish_sample(s, e);
    if (has(Defect::wrong_weight))
      s.weight = s.weight * T(1.001);
    if (has(Defect::wrong_side))
      s.wi.z = select(random.uc < T(0.001), -s.wi.z, s.wi.z);
    if (kMirror) {
      auto mirror = s.valid & (random.uc < T(has(Defect::wrong_delta) ? 0.26 : 0.25));
      s.wi = select(mirror, reflect(wo), s.wi);
      s.delta = mirror;
      s.pdf = select(mirror, T(0.25), s.pdf);
      s.value = select(mirror, Color<T>(T(0)), s.value);
      s.weight = select(mirror, reflectance * gain, s.weight);
    }
    return s;
  }

  void prepare() {
    if constexpr (kDefect == Defect::lane_texture && kWidthOf<T> > 1)
      gain = T(lane(gain, 0));
  }

private:
  static void forget_slope(Color<T>& value) {
    if constexpr (kDefect == Defect::wrong_slope && requires { value[0].v; } &&
                  !std::is_same_v<typename NumberTraits<T>::Scalar, float>)
      value[0].v *= 1 + 1e-4;
  }
};

template <class T> using Sound = Defective<T, Defect::none>;
template <class T> using SoundMirror = Defective<T, Defect::none_mirror>;
template <class T> using WrongDensity = Defective<T, Defect::wrong_density>;
template <class T> using WrongSampling = Defective<T, Defect::wrong_sampling>;
template <class T> using WrongWeight = Defective<T, Defect::wrong_weight>;
template <class T> using WrongSample = Defective<T, Defect::wrong_sample>;
template <class T> using WrongSide = Defective<T, Defect::wrong_side>;
template <class T> using TooBright = Defective<T, Defect::too_bright>;
template <class T> using Lossy = Defective<T, Defect::lossy>;
template <class T> using OneWay = Defective<T, Defect::one_way>;
template <class T> using NotANumber = Defective<T, Defect::not_a_number>;
template <class T> using Negative = Defective<T, Defect::negative>;
template <class T> using LaneDrift = Defective<T, Defect::lane_drift>;
template <class T> using LaneTexture = Defective<T, Defect::lane_texture>;
template <class T> using Imprecise = Defective<T, Defect::imprecise>;
template <class T> using WrongSlope = Defective<T, Defect::wrong_slope>;
template <class T> using DeadParameter = Defective<T, Defect::dead_parameter>;
template <class T> using WrongMode = Defective<T, Defect::wrong_mode>;
template <class T> using WrongDelta = Defective<T, Defect::wrong_delta>;
template <class T> using HiddenPeak = Defective<T, Defect::hidden_peak>;
template <class T> using WrongWidth = Defective<T, Defect::wrong_width>;

} // namespace faceta::defective
