#pragma once

#include <array>
#include <cmath>

namespace faceta {

/// A point or vector in double precision, for work done once at load time.
using Double3 = std::array<double, 3>;

/// An affine object-to-world matrix, row-major; the last row must be (0, 0, 0, 1).
using ToWorld = std::array<double, 16>;

inline constexpr ToWorld kIdentityToWorld = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

namespace double3 {

inline Double3 add(const Double3& a, const Double3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Double3 sub(const Double3& a, const Double3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Double3 scale(const Double3& a, double s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
inline double dot(const Double3& a, const Double3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Double3 cross(const Double3& a, const Double3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Double3& a) {
  return std::hypot(a[0], a[1], a[2]);
}
/// a / |a|; the zero vector stays zero.
inline Double3 normalize(const Double3& a) {
  double l = length(a);
  return l > 0 ? Double3{a[0] / l, a[1] / l, a[2] / l} : Double3{0, 0, 0};
}
inline bool finite(const Double3& a) {
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

/// Column j of the 3x4 part of m (j = 3: the translation).
inline Double3 column(const ToWorld& m, int j) {
  return {m[j], m[4 + j], m[8 + j]};
}
inline Double3 map_vector(const ToWorld& m, const Double3& v) {
  return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[4] * v[0] + m[5] * v[1] + m[6] * v[2],
          m[8] * v[0] + m[9] * v[1] + m[10] * v[2]};
}
inline Double3 map_point(const ToWorld& m, const Double3& p) {
  return add(map_vector(m, p), column(m, 3));
}

} // namespace double3
} // namespace faceta
