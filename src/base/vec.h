#pragma once

/// Vectors, frames and affine maps over any number type.

#include "base/maths.h"

namespace faceta {

template <class T> struct Vec2 {
  T x{}, y{};
};

template <class T> struct Vec3 {
  T x{}, y{}, z{};

  friend FACETA_INLINE Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend FACETA_INLINE Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend FACETA_INLINE Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend FACETA_INLINE Vec3 operator*(const Vec3& a, const T& s) {
    return {a.x * s, a.y * s, a.z * s};
  }
  friend FACETA_INLINE Vec3 operator*(const T& s, const Vec3& a) { return a * s; }
};

template <class T> FACETA_INLINE T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
template <class T> FACETA_INLINE Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}
template <class T> FACETA_INLINE T length(const Vec3<T>& a) {
  return sqrt(dot(a, a));
}
template <class T> FACETA_INLINE Vec3<T> normalize(const Vec3<T>& a) {
  return a * (T(1) / length(a));
}
/// a + s b.
template <class T> FACETA_INLINE Vec3<T> fma(const Vec3<T>& b, const T& s, const Vec3<T>& a) {
  return {fma(b.x, s, a.x), fma(b.y, s, a.y), fma(b.z, s, a.z)};
}
template <class M, class T>
FACETA_INLINE Vec3<T> select(const M& m, const Vec3<T>& a, const Vec3<T>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// An orthonormal basis; n is the third axis.
template <class T> struct Frame {
  Vec3<T> s, t, n;

  FACETA_INLINE Vec3<T> to_local(const Vec3<T>& v) const {
    return {dot(v, s), dot(v, t), dot(v, n)};
  }
  FACETA_INLINE Vec3<T> to_world(const Vec3<T>& v) const {
    return fma(s, v.x, fma(t, v.y, n * v.z));
  }
};

/// Completes a unit vector to a basis without branches (Duff et al. 2017, "Building an Orthonormal
/// Basis, Revisited", JCGT 6(1)).
template <class T> FACETA_INLINE Frame<T> frame_from_normal(const Vec3<T>& n) {
  T sign = copysign(T(1), n.z);
  T a = T(-1) / (sign + n.z);
  T b = n.x * n.y * a;
  return {{fma(sign * n.x * n.x, a, T(1)), sign * b, -sign * n.x},
          {b, fma(n.y * n.y, a, sign), -n.y},
          n};
}

} // namespace faceta
