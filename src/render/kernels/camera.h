#pragma once

/// Camera rays in lanes, with the pixel filter importance-sampled.

#include "render/kernels/surface.h"

namespace faceta {

/// An offset from the pixel centre with density proportional to the filter, kept inside
/// [low, high] (pixels at the border of the film only see what is on it, as a splatting film
/// would).
template <class T>
FACETA_INLINE T sample_filter(const FilterView& f, const T& u, const T& low, const T& high) {
  using I = IntOf<T>;
  static_assert(kFilterCells == 32);
  if (f.cells == 0)
    return u - T(0.5f);
  // From -1 at -radius over 0 to 1 at radius.
  auto cumulated = [&](const T& offset) {
    T x = min(abs(offset) * (T(float(kFilterCells)) / T(f.radius)), T(float(kFilterCells)));
    I i = min(to_int(x), I(kFilterCells - 1));
    T a = entry32<T>(f.share, i), b = entry32<T>(f.share + 1, i);
    return copysign(lerp(a, b, x - to_float(i)), offset);
  };
  T target = fma(T(2), u, T(-1));
  // Away from the border of the film the bounds cut nothing off.
  if (!all((low <= T(-f.radius)) & (high >= T(f.radius))))
    target = lerp(cumulated(low), cumulated(high), u);
  T distance = abs(target);
  I cell(0); // the last that starts at or below it
  for (int step = kFilterCells / 2; step > 0; step /= 2) {
    I probe = cell + I(step);
    cell = select(entry32<T>(f.share, probe) <= distance, probe, cell);
  }
  T a = entry32<T>(f.share, cell), b = entry32<T>(f.share + 1, cell);
  T inside = clamp01((distance - a) / max(b - a, T(1e-20f)));
  return copysign((to_float(cell) + inside) * T(f.radius / float(kFilterCells)), target);
}

template <class T> struct CameraRay {
  Vec3<T> o, d;
  T near, far;
};

/// The ray through a film position in pixels of the whole film.
template <class T>
FACETA_INLINE CameraRay<T> camera_ray(const CameraView& c, const T& x, const T& y) {
  const float* m = c.sample_to_camera;
  T fx = x / T(float(c.film_width)), fy = y / T(float(c.film_height));
  auto row = [&](int r) { return fma(T(m[4 * r]), fx, fma(T(m[4 * r + 1]), fy, T(m[4 * r + 3]))); };
  T w = T(1) / row(3);
  Vec3<T> near_point{row(0) * w, row(1) * w, row(2) * w};
  Vec3<T> d = normalize(near_point);
  T inverse_z = T(1) / d.z;
  T m_world[12];
  for (int i = 0; i < 12; ++i)
    m_world[i] = T(c.to_world[i]);
  CameraRay<T> ray;
  ray.o = {m_world[3], m_world[7], m_world[11]};
  ray.d = normalize(transform_vector(m_world, d));
  ray.near = T(c.near_clip) * inverse_z;
  ray.far = T(c.far_clip) * inverse_z;
  return ray;
}

} // namespace faceta
