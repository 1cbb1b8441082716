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

/// A place on the image: a cell and the fractions inside it.
template <class T> struct EnvironmentSpot {
  IntOf<T> cell;
  T fx, fy, sin_theta;
};

/// The spot at (x, y) in cells, kept on the image.
template <class T> FACETA_INLINE EnvironmentSpot<T>
environment_spot(const EnvironmentView& e, const T& x, const T& y, const T& sin_theta) {
  T cx = min(floor(x), T(float(e.columns - 1))), cy = min(floor(y), T(float(e.rows - 1)));
  return {to_int(cy) * IntOf<T>(e.columns) + to_int(cx), x - cx, y - cy, sin_theta};
}

/// Where a world direction meets the image.
template <class T>
FACETA_INLINE EnvironmentSpot<T> environment_spot(const EnvironmentView& e, const Vec3<T>& d) {
  Vec3<T> v = rotate(e.to_local, d);
  // u = atan2(x, -z) / 2pi, v = acos(y) / pi, +Y up.
  T u = atan2(v.x, -v.z) * T(kInvTwoPi);
  u = u - floor(u);
  T t = acos(clamp(v.y, T(-1), T(1))) * T(kInvPi);
  return environment_spot(e, u * T(float(e.columns)), t * T(float(e.rows)),
                          sqrt(fma(v.x, v.x, v.z * v.z)));
}

/// Radiance and density at a spot; the direction is left to others.
template <class T> FACETA_INLINE EnvironmentLight<T>
environment_light(const EnvironmentView& e, const EnvironmentSpot<T>& spot) {
  using I = IntOf<T>;
  T w[8]; // density, scale, twelve halves
  load_octets<T>(reinterpret_cast<const float*>(e.cells), spot.cell, w);
  // Half i as a float 2^112 times too small: the sign stays, exponent and mantissa move.
  auto half = [&](int i) {
    I word = as_integer(w[2 + i / 2]);
    return bits_float(((i & 1 ? word : word << 16) >> 3) & I(static_cast<int32_t>(0x8fffe000)));
  };
  EnvironmentLight<T> light;
  for (int c = 0; c < 3; ++c) {
    T top = lerp(half(c), half(3 + c), spot.fx), bottom = lerp(half(6 + c), half(9 + c), spot.fx);
    light.radiance[c] = T(e.radiance[c]) * (lerp(top, bottom, spot.fy) * T(0x1p112f) * w[1]);
  }
  light.pdf = w[0] / max(spot.sin_theta * T(2 * kPi * kPi), T(1e-12f));
  return light;
}

/// What a constant environment sends from everywhere, and the density of sampling it.
template <class T>
FACETA_INLINE EnvironmentLight<T> constant_environment(const EnvironmentView& e) {
  EnvironmentLight<T> light;
  light.radiance = Color<T>(T(e.radiance[0]), T(e.radiance[1]), T(e.radiance[2]));
  light.pdf = T(1 / (4 * kPi));
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

/// The light through a place.
template <class T> FACETA_INLINE EnvironmentLight<T>
sample_environment_place(const EnvironmentView& e, const Vec2<T>& place) {
  SinCos<T> phi = sincos(place.x * T(float(2 * kPi / e.columns)));
  SinCos<T> theta = sincos(place.y * T(float(kPi / e.rows)));
  EnvironmentLight<T> light =
      environment_light(e, environment_spot(e, place.x, place.y, theta.sin));
  light.direction =
      rotate(e.to_world, Vec3<T>{theta.sin * phi.sin, theta.cos, -(theta.sin * phi.cos)});
  return light;
}

/// A direction towards a constant environment.
template <class T> FACETA_INLINE EnvironmentLight<T>
sample_constant_environment(const EnvironmentView& e, const Vec2<T>& u) {
  EnvironmentLight<T> light = constant_environment<T>(e);
  light.direction = uniform_sphere(u);
  return light;
}

} // namespace faceta
