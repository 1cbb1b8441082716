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
  using I = IntOf<T>;
  T w[8]; // density, scale, twelve halves
  load_octets<T>(reinterpret_cast<const float*>(e.cells), cell, w);
  // Half i as a float 2^112 times too small: the sign stays, exponent and mantissa move.
  auto half = [&](int i) {
    I word = as_integer(w[2 + i / 2]);
    return bits_float(((i & 1 ? word : word << 16) >> 3) & I(static_cast<int32_t>(0x8fffe000)));
  };
  EnvironmentLight<T> light;
  for (int c = 0; c < 3; ++c) {
    T top = lerp(half(c), half(3 + c), fx), bottom = lerp(half(6 + c), half(9 + c), fx);
    light.radiance[c] = T(e.radiance[c]) * (lerp(top, bottom, fy) * T(0x1p112f) * w[1]);
  }
  light.pdf = w[0] / max(sin_theta * T(2 * kPi * kPi), T(1e-12f));
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

/// The leaf that `choice` meets first, before its alias is looked at.
template <class T>
FACETA_INLINE IntOf<T> environment_leaf(const EnvironmentView& e, const Vec2<T>& choice) {
  using I = IntOf<T>;
  return min(to_int(choice.x * T(float(e.leaf_count))), I(e.leaf_count - 1));
}

/// Where on the image `choice` (rectangle, alias) and `place` (inside it) lead, in cells.
template <class T> FACETA_INLINE Vec2<T>
choose_environment_place(const EnvironmentView& e, const Vec2<T>& choice, const Vec2<T>& place) {
  using I = IntOf<T>;
  T w[8];
  load_octets<T>(reinterpret_cast<const float*>(e.leaves), environment_leaf(e, choice), w);
  auto keep = choice.y < w[0];
  I origin = as_integer(select(keep, w[1], w[2])), size = as_integer(select(keep, w[3], w[4]));
  auto low = [](const I& word) { return to_float(word & I(0xffff)); };
  auto high = [](const I& word) { return to_float((word >> 16) & I(0xffff)); };
  return {fma(low(size), place.x, low(origin)), fma(high(size), place.y, high(origin))};
}

/// The cell of a place, kept on the image.
template <class T>
FACETA_INLINE IntOf<T> environment_cell_at(const EnvironmentView& e, const T& x, const T& y) {
  using I = IntOf<T>;
  I column = min(to_int(x), I(e.columns - 1)), row = min(to_int(y), I(e.rows - 1));
  return row * I(e.columns) + column;
}

/// The light through a place.
template <class T> FACETA_INLINE EnvironmentLight<T>
sample_environment_place(const EnvironmentView& e, const Vec2<T>& place) {
  SinCos<T> phi = sincos(place.x * T(float(2 * kPi / e.columns)));
  SinCos<T> theta = sincos(place.y * T(float(kPi / e.rows)));
  T cx = min(floor(place.x), T(float(e.columns - 1)));
  T cy = min(floor(place.y), T(float(e.rows - 1)));
  EnvironmentLight<T> light = detail::environment_cell<T>(
      e, environment_cell_at(e, place.x, place.y), place.x - cx, place.y - cy, theta.sin);
  light.direction =
      rotate(e.to_world, Vec3<T>{theta.sin * phi.sin, theta.cos, -(theta.sin * phi.cos)});
  return light;
}

/// A direction towards a constant environment.
template <class T> FACETA_INLINE EnvironmentLight<T>
sample_constant_environment(const EnvironmentView& e, const Vec2<T>& u) {
  EnvironmentLight<T> light;
  light.direction = uniform_sphere(u);
  light.radiance = Color<T>(T(e.radiance[0]), T(e.radiance[1]), T(e.radiance[2]));
  light.pdf = T(1 / (4 * kPi));
  return light;
}

} // namespace faceta
