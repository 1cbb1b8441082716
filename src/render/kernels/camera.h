#pragma once

/// Camera rays in lanes, with the pixel filter importance-sampled.

#include "render/kernels/surface.h"

namespace faceta {

/// The cumulated filter at an offset, by linear interpolation of its table.
FACETA_INLINE float filter_cdf(const FilterView& f, float offset) {
  if (f.cells == 0)
    return clamp01(offset + 0.5f);
  float x = clamp((offset + f.radius) / (2 * f.radius), 0.0f, 1.0f) * float(f.cells);
  int i = min(static_cast<int>(x), f.cells - 1);
  return lerp(f.cdf[i], f.cdf[i + 1], x - float(i));
}

/// An offset from the pixel centre with density proportional to the filter, kept inside
/// [low, high] (pixels at the border of the film only see what is on it, as a splatting film
/// would).
template <class T>
FACETA_INLINE T sample_filter(const FilterView& f, const T& u, const T& low, const T& high) {
  using I = IntOf<T>;
  if (f.cells == 0)
    return u - T(0.5f);
  // cdf at the bounds.
  auto cdf = [&](const T& offset) {
    T x = clamp((offset + T(f.radius)) * T(0.5f * float(f.cells) / f.radius), T(0),
                T(float(f.cells)));
    I i = min(to_int(x), I(f.cells - 1));
    return lerp(gather<T>(f.cdf, i), gather<T>(f.cdf, i + I(1)), x - to_float(i));
  };
  T target = u;
  // Away from the border of the film cdf(low) is 0 and cdf(high) 1.
  if (!all((low <= T(-f.radius)) & (high >= T(f.radius))))
    target = lerp(cdf(low), cdf(high), u);
  I first(0); // the last entry <= target
  for (int step = f.cells / 2; step > 0; step /= 2) {
    I probe = min(first + I(step), I(f.cells - 1));
    first = select(gather<T>(f.cdf, probe) <= target, probe, first);
  }
  T a = gather<T>(f.cdf, first), b = gather<T>(f.cdf, first + I(1));
  T inside = clamp01((target - a) / max(b - a, T(1e-20f)));
  return (to_float(first) + inside) * T(2 * f.radius / float(f.cells)) - T(f.radius);
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
