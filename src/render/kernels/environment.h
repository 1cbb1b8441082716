#pragma once

/// Light from infinity in lanes: radiance along a direction, and sampling by two alias tables.

#include "render/kernels/rows.h"
#include "sampling/warp.h"
#include "scene/view.h"
#include "spectrum/color.h"

namespace faceta {

template <class T> FACETA_INLINE Vec3<T> rotate(const float (&m)[9], const Vec3<T>& v) {
  return {fma(T(m[0]), v.x, fma(T(m[1]), v.y, T(m[2]) * v.z)),
          fma(T(m[3]), v.x, fma(T(m[4]), v.y, T(m[5]) * v.z)),
          fma(T(m[6]), v.x, fma(T(m[7]), v.y, T(m[8]) * v.z))};
}

template <class T> struct EnvironmentLight {
  Color<T> radiance;
  T pdf; ///< solid angle
  Vec3<T> direction;
};

namespace detail {

/// Radiance and density inside cells at fractions (fx, fy).
template <class T>
FACETA_INLINE EnvironmentLight<T> environment_cell(const EnvironmentView& e, const IntOf<T>& cell,
                                                   const T& fx, const T& fy, const T& sin_theta) {
  alignas(64) int32_t rows[kWidthOf<T>];
  store(rows, cell);
  T w[16];
  load_rows<T>(reinterpret_cast<const float*>(e.cells), 16, rows, w);
  EnvironmentLight<T> light;
  for (int c = 0; c < 3; ++c) {
    T top = lerp(w[4 + c], w[7 + c], fx), bottom = lerp(w[10 + c], w[13 + c], fx);
    light.radiance[c] = T(e.radiance[c]) * lerp(top, bottom, fy);
  }
  light.pdf = w[2] / max(sin_theta * T(2 * kPi * kPi), T(1e-12f));
  return light;
}

} // namespace detail

/// What arrives from a world direction, and the density of sampling it.
template <class T>
FACETA_INLINE EnvironmentLight<T> environment_light(const EnvironmentView& e, const Vec3<T>& d) {
  using I = IntOf<T>;
  EnvironmentLight<T> light;
  if (e.columns == 0) {
    light.radiance = Color<T>(T(e.radiance[0]), T(e.radiance[1]), T(e.radiance[2]));
    light.pdf = T(1 / (4 * kPi));
  } else {
    Vec3<T> v = rotate(e.to_local, d);
    // u = atan2(x, -z) / 2pi, v = acos(y) / pi, +Y up.
    T u = atan2(v.x, -v.z) * T(kInvTwoPi);
    u = u - floor(u);
    T t = acos(clamp(v.y, T(-1), T(1))) * T(kInvPi);
    T x = u * T(float(e.columns)), y = t * T(float(e.rows));
    T cx = min(floor(x), T(float(e.columns - 1))), cy = min(floor(y), T(float(e.rows - 1)));
    T sin_theta = sqrt(fma(v.x, v.x, v.z * v.z));
    I cell = to_int(cy) * I(e.columns) + to_int(cx);
    light = detail::environment_cell<T>(e, cell, x - cx, y - cy, sin_theta);
  }
  light.direction = d;
  return light;
}

/// The cell that `choice` picks: a row by one alias table, a column by the row's own.
template <class T>
FACETA_INLINE IntOf<T> choose_environment_cell(const EnvironmentView& e, const Vec2<T>& choice) {
  using I = IntOf<T>;
  T y = choice.y * T(float(e.rows)), cy = floor(y);
  I row = to_int(cy);
  auto keep_row = y - cy < gather<T>(e.row_threshold, row);
  row = select(keep_row, row, gather_int<T>(e.row_alias, row));
  T x = choice.x * T(float(e.columns)), cx = floor(x);
  I first = row * I(e.columns), column = to_int(cx);
  I entry = gather_int<T>(reinterpret_cast<const int32_t*>(e.column_aliases), first + column);
  auto keep_column = (x - cx) * T(65536) < to_float(entry & I(0xffff));
  I alias = (entry >> 16) & I(0xffff);
  return first + select(keep_column, column, alias);
}

/// A direction towards the light from infinity through the place `u` in a chosen cell.
template <class T>
FACETA_INLINE EnvironmentLight<T> sample_environment_cell(const EnvironmentView& e,
                                                          const IntOf<T>& cell,
                                                          const Vec2<T>& u) {
  using I = IntOf<T>;
  // The quotient by way of float is off by one at most; the integer rest mends it.
  I n(e.columns);
  I row = to_int(to_float(cell) * T(1.0f / float(e.columns)));
  I column = cell - row * n;
  auto before = column < I(0), behind = column >= n;
  row = row + select(behind, I(1), I(0)) - select(before, I(1), I(0));
  column = column + select(before, n, I(0)) - select(behind, n, I(0));
  T s = (to_float(column) + u.x) / T(float(e.columns));
  T t = (to_float(row) + u.y) / T(float(e.rows));
  SinCos<T> phi = sincos(T(2 * kPi) * s), theta = sincos(T(kPi) * t);
  EnvironmentLight<T> light = detail::environment_cell<T>(e, cell, u.x, u.y, theta.sin);
  light.direction =
      rotate(e.to_world, Vec3<T>{theta.sin * phi.sin, theta.cos, -(theta.sin * phi.cos)});
  return light;
}

/// A direction towards a constant environment.
template <class T>
FACETA_INLINE EnvironmentLight<T> sample_constant_environment(const EnvironmentView& e,
                                                              const Vec2<T>& u) {
  EnvironmentLight<T> light;
  light.direction = uniform_sphere(u);
  light.radiance = Color<T>(T(e.radiance[0]), T(e.radiance[1]), T(e.radiance[2]));
  light.pdf = T(1 / (4 * kPi));
  return light;
}

} // namespace faceta
