#pragma once

/// THE CONTRACT between a surface-scattering model and everything that uses it.
///
/// Directions are unit vectors in the local frame (z = shading normal) and both leave the surface:
/// wo is known (towards the viewer), wi is sampled (towards the light). Values INCLUDE
/// |cos theta_i|.
///
/// A model is a struct template over its number type T with
///   template <class D> static void describe(D& d);      what everyone else asks: describe.h
///   Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const;
///   Sample<T> sample(const Vec3<T>& wo, const Random<T>&, const Context<T>&) const;
/// and optionally
///   void prepare();                          per lane, after textures were applied; cheap
///   void prepare_once(PrepareOnce&);         T = double only: tables and means, once per material
///   static constexpr std::array<int, choices> kUsualChoices[];  kernel_impl.h: faster samples
///   static const char* validate(const Model<double>&);  null, or what is wrong with the parameters
///
/// Nothing throws, allocates or locks inside eval, sample and prepare. Branch on parameters
/// (choices, flags), never on a lane: select(mask, a, b).

#include "base/vec.h"
#include "spectrum/color.h"

namespace faceta {

/// What travels along the path: radiance from the camera, or importance from a light. Radiance is
/// scaled by 1/eta^2 when it crosses an interface.
enum class TransportMode { radiance, importance };

/// The circumstances of a query.
template <class T> struct Context {
  TransportMode mode = TransportMode::radiance;
  Vec2<T> uv{T(0.5), T(0.5)};
};

/// Value (including |cos theta_i|) and solid-angle density of the non-delta lobes.
template <class T> struct Eval {
  Color<T> value;
  T pdf = T(0);
};

/// The kinds of lobe a sample can belong to.
enum Lobe : int32_t { kNoLobe = 0, kReflection = 1, kTransmission = 2, kNullLobe = 4 };

/// Uniform numbers in [0, 1): a pair for the direction, one for choices, and a counter-based key
/// for models that need more.
template <class T> struct Random {
  Vec2<T> u;
  T uc;
  UintOf<T> key{0};
};

/// A sampled direction. weight = value / pdf; for a delta lobe value is 0, pdf is its discrete
/// probability and weight the discrete weight. Invalid samples have weight 0.
template <class T> struct Sample {
  Vec3<T> wi{T(0), T(0), T(1)};
  Color<T> value;
  T pdf = T(0);
  Color<T> weight;
  /// Relative index of refraction across the event: eta_i / eta_o, 1 for reflection.
  T eta = T(1);
  IntOf<T> lobe{kNoLobe};
  MaskOf<T> delta{false};
  MaskOf<T> valid{false};
};

// --- The local frame ---

template <class T> FACETA_INLINE T cos_theta(const Vec3<T>& w) {
  return w.z;
}
template <class T> FACETA_INLINE T abs_cos_theta(const Vec3<T>& w) {
  return abs(w.z);
}
template <class T> FACETA_INLINE T sin_theta_squared(const Vec3<T>& w) {
  return fma(w.x, w.x, w.y * w.y);
}
template <class T> FACETA_INLINE MaskOf<T> same_hemisphere(const Vec3<T>& a, const Vec3<T>& b) {
  return a.z * b.z > T(0);
}
/// Mirror direction about the normal: (-x, -y, z).
template <class T> FACETA_INLINE Vec3<T> reflect(const Vec3<T>& w) {
  return {-w.x, -w.y, w.z};
}
/// Mirror direction about h: -w + 2 (w.h) h.
template <class T> FACETA_INLINE Vec3<T> reflect(const Vec3<T>& w, const Vec3<T>& h) {
  return fma(h, T(2) * dot(w, h), -w);
}

/// Samples of less density fail: below the normal floats 1 / pdf would overflow.
inline constexpr double kSmallestDensity = 1.2e-38;

/// value / pdf where the density is positive, and both cleared where it is not: the common end of
/// every non-delta sample().
template <class T> FACETA_INLINE void finish_sample(Sample<T>& s, const Eval<T>& e) {
  auto ok = s.valid & (e.pdf > T(kSmallestDensity));
  s.valid = ok;
  s.pdf = select(ok, e.pdf, T(0));
  s.value = select(ok, e.value, Color<T>(T(0)));
  s.weight = s.value * (T(1) / select(ok, e.pdf, T(1)));
}

} // namespace faceta
