#pragma once

/// Light from infinity in lanes: radiance along a direction, and sampling by two alias tables.

#include "render/kernels/rows.h"
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

/// A direction towards the light from infinity: `choice` picks the cell, `u` the place in it.
template <class T> FACETA_INLINE EnvironmentLight<T>
sample_environment(const EnvironmentView& e, const Vec2<T>& choice, const Vec2<T>& u) {
  using I = IntOf<T>;
  if (e.columns == 0) {
    EnvironmentLight<T> light;
    T z = fma(T(-2), choice.x, T(1)), r = sqrt(max(fma(-z, z, T(1)), T(0)));
    SinCos<T> phi = sincos(T(2 * kPi) * choice.y);
    light.direction = {r * phi.cos, r * phi.sin, z};
    light.radiance = Color<T>(T(e.radiance[0]), T(e.radiance[1]), T(e.radiance[2]));
    light.pdf = T(1 / (4 * kPi));
    return light;
  }
  T y = choice.y * T(float(e.rows)), cy = floor(y);
  I row = to_int(cy);
  auto keep_row = y - cy < gather<T>(e.row_threshold, row);
  row = select(keep_row, row, gather_int<T>(e.row_alias, row));
  T x = choice.x * T(float(e.columns)), cx = floor(x);
  I cell = row * I(e.columns) + to_int(cx);
  const float* cells = reinterpret_cast<const float*>(e.cells);
  auto keep_column = x - cx < gather<T>(cells, cell << 4);
  I alias = float_bits(gather<T>(cells + 1, cell << 4));
  cell = select(keep_column, cell, row * I(e.columns) + alias);
  T column = to_float(select(keep_column, to_int(cx), alias));
  T s = (column + u.x) / T(float(e.columns)), t = (to_float(row) + u.y) / T(float(e.rows));
  SinCos<T> phi = sincos(T(2 * kPi) * s), theta = sincos(T(kPi) * t);
  EnvironmentLight<T> light = detail::environment_cell<T>(e, cell, u.x, u.y, theta.sin);
  light.direction =
      rotate(e.to_world, Vec3<T>{theta.sin * phi.sin, theta.cos, -(theta.sin * phi.cos)});
  return light;
}

} // namespace faceta
