#pragma once

/// Maps from the unit square to directions, and the densities they have.

#include "base/vec.h"

namespace faceta {

/// Concentric map of the square to the unit disk (Shirley and Chiu 1997), without branches.
template <class T> FACETA_INLINE Vec2<T> concentric_disk(const Vec2<T>& u) {
  T a = fma(T(2), u.x, T(-1)), b = fma(T(2), u.y, T(-1));
  auto wide = abs(a) > abs(b);
  T r = select(wide, a, b);
  T ratio = select(wide, b, a) / select(r == T(0), T(1), r);
  T phi = select(wide, T(0.25 * kPi) * ratio, T(0.5 * kPi) - T(0.25 * kPi) * ratio);
  SinCos<T> sc = sincos(phi);
  return {r * sc.cos, r * sc.sin};
}

/// Cosine-weighted direction about z; density cos(theta) / pi.
template <class T> FACETA_INLINE Vec3<T> cosine_hemisphere(const Vec2<T>& u) {
  Vec2<T> d = concentric_disk(u);
  return {d.x, d.y, sqrt(max(T(1) - fma(d.x, d.x, d.y * d.y), T(1e-12)))};
}

/// Uniform direction on the sphere; density 1 / (4 pi).
template <class T> FACETA_INLINE Vec3<T> uniform_sphere(const Vec2<T>& u) {
  T z = fma(T(-2), u.x, T(1));
  T r = safe_sqrt(fma(-z, z, T(1)));
  SinCos<T> sc = sincos(T(2 * kPi) * u.y);
  return {r * sc.cos, r * sc.sin, z};
}

/// Uniform direction on the hemisphere z > 0; density 1 / (2 pi).
template <class T> FACETA_INLINE Vec3<T> uniform_hemisphere(const Vec2<T>& u) {
  T z = T(1) - u.x;
  T r = safe_sqrt(fma(-z, z, T(1)));
  SinCos<T> sc = sincos(T(2 * kPi) * u.y);
  return {r * sc.cos, r * sc.sin, z};
}

} // namespace faceta
