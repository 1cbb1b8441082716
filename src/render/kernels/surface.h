#pragma once

/// From a hit to a surface point in lanes: position, normals, shading frame, uv, material, light.

#include "render/kernels/rows.h"
#include "sampling/warp.h"
#include "scene/view.h"

namespace faceta {

/// Hit codes: triangle index, or kQuadricHit + quadric index, or kNoHit.
inline constexpr int32_t kNoHit = -1, kQuadricHit = 0x40000000;

template <class T> struct SurfaceLanes {
  Vec3<T> p;         ///< on the surface
  Vec3<T> geometric; ///< unit normal of the surface
  Frame<T> frame;    ///< shading frame
  Vec2<T> uv;
  IntOf<T> material, light;
};

/// Shading frame from a normal and the direction of u (Gram-Schmidt); any tangent if there is none.
template <class T> FACETA_INLINE Frame<T> shading_frame(const Vec3<T>& n, const Vec3<T>& dpdu) {
  Vec3<T> s = fma(n, -dot(n, dpdu), dpdu);
  T length2 = dot(s, s);
  auto degenerate = !(length2 > T(1e-24f));
  s = s * (T(1) / sqrt(select(degenerate, T(1), length2)));
  if (any(degenerate))
    s = select(degenerate, frame_from_normal(n).s, s);
  return {s, cross(n, s), n};
}

template <class T> FACETA_INLINE Vec3<T> transform_point(const T* m, const Vec3<T>& p) {
  return {fma(m[0], p.x, fma(m[1], p.y, fma(m[2], p.z, m[3]))),
          fma(m[4], p.x, fma(m[5], p.y, fma(m[6], p.z, m[7]))),
          fma(m[8], p.x, fma(m[9], p.y, fma(m[10], p.z, m[11])))};
}
template <class T> FACETA_INLINE Vec3<T> transform_vector(const T* m, const Vec3<T>& v) {
  return {fma(m[0], v.x, fma(m[1], v.y, m[2] * v.z)), fma(m[4], v.x, fma(m[5], v.y, m[6] * v.z)),
          fma(m[8], v.x, fma(m[9], v.y, m[10] * v.z))};
}
/// A normal by the inverse map m of its surface's.
template <class T> FACETA_INLINE Vec3<T> transform_normal(const T* m, const Vec3<T>& n) {
  return {fma(m[0], n.x, fma(m[4], n.y, m[8] * n.z)), fma(m[1], n.x, fma(m[5], n.y, m[9] * n.z)),
          fma(m[2], n.x, fma(m[6], n.y, m[10] * n.z))};
}

/// The second row of a triangle: normals and uv, for barycentric coordinates (u, v).
template <class T> FACETA_INLINE void interpolate_triangle(const float* base, const int32_t* rows,
                                                           const T& u, const T& v,
                                                           const MaskOf<T>& flat, Vec3<T>& normal,
                                                           Vec2<T>& uv) {
  T b[16];
  load_rows<T>(base + 16, 32, rows, b);
  T w = T(1) - u - v;
  Vec3<T> n = Vec3<T>{b[0], b[1], b[2]} * w;
  n = fma(Vec3<T>{b[3], b[4], b[5]}, u, n);
  n = fma(Vec3<T>{b[6], b[7], b[8]}, v, n);
  T n2 = dot(n, n);
  auto usable = (n2 > T(1e-20f)) & !flat;
  normal = select(usable, n * (T(1) / sqrt(select(usable, n2, T(1)))), normal);
  uv = {fma(w, b[9], fma(u, b[11], v * b[13])), fma(w, b[10], fma(u, b[12], v * b[14]))};
}

/// A triangle hit. Without need_uv, groups of flat triangles spare the second row.
template <class T>
FACETA_INLINE SurfaceLanes<T> triangle_point(const SceneView& scene, const IntOf<T>& index,
                                             const Vec3<T>& o, const Vec3<T>& d, bool need_uv) {
  alignas(64) int32_t rows[kWidthOf<T>];
  store(rows, index);
  const float* base = reinterpret_cast<const float*>(scene.triangles);
  T a[16];
  load_rows<T>(base, 32, rows, a);
  Vec3<T> v0{a[0], a[1], a[2]}, e1{a[3], a[4], a[5]}, e2{a[6], a[7], a[8]};
  // Moeller and Trumbore 1997, by true division: the same bits whatever Embree was built for.
  Vec3<T> h = cross(d, e2);
  T inverse = T(1) / dot(e1, h);
  Vec3<T> s = o - v0;
  T u = clamp01(dot(s, h) * inverse);
  T v = clamp(dot(d, cross(s, e1)) * inverse, T(0), T(1) - u);
  SurfaceLanes<T> point;
  point.p = fma(e1, u, fma(e2, v, v0));
  point.geometric = cross(e1, e2) * a[15];
  point.material = as_integer(a[12]);
  point.light = as_integer(a[13]);
  auto flat = (as_integer(a[14]) & IntOf<T>(kSmoothTriangle)) == IntOf<T>(0);
  Vec3<T> n = point.geometric;
  point.uv = {T(0), T(0)};
  if (need_uv || !all(flat) || any(point.light >= IntOf<T>(0)))
    interpolate_triangle(base, rows, u, v, flat, n, point.uv);
  point.frame = shading_frame(n, Vec3<T>{a[9], a[10], a[11]});
  return point;
}

template <class T> struct QuadricLanes {
  T to_world[12], to_local[12], flip;
  IntOf<T> type, material, light;
};

template <class T>
FACETA_INLINE QuadricLanes<T> load_quadrics(const SceneView& scene, const IntOf<T>& index) {
  alignas(64) int32_t rows[kWidthOf<T>];
  store(rows, index);
  const float* base = reinterpret_cast<const float*>(scene.quadrics);
  T a[16], b[16];
  load_rows<T>(base, 32, rows, a);
  load_rows<T>(base + 16, 32, rows, b);
  QuadricLanes<T> q;
  for (int i = 0; i < 12; ++i) {
    q.to_world[i] = a[i];
    q.to_local[i] = b[i];
  }
  q.material = as_integer(a[12]);
  q.light = as_integer(a[13]);
  q.type = as_integer(a[15]);
  q.flip = b[12];
  return q;
}

/// uv of a point on the unit sphere.
template <class T> FACETA_INLINE Vec2<T> sphere_uv(const Vec3<T>& l) {
  T phi = atan2(l.y, l.x);
  phi = select(phi < T(0), phi + T(2 * kPi), phi);
  return {phi * T(kInvTwoPi), acos(clamp(l.z, T(-1), T(1))) * T(kInvPi)};
}

/// A quadric at the distance that Embree's callback found.
template <class T>
FACETA_INLINE SurfaceLanes<T> quadric_point(const SceneView& scene, const IntOf<T>& index,
                                            const Vec3<T>& o, const Vec3<T>& d, const T& t) {
  using I = IntOf<T>;
  QuadricLanes<T> q = load_quadrics<T>(scene, index);
  auto sphere = q.type == I(static_cast<int32_t>(QuadricType::sphere));
  auto disk = q.type == I(static_cast<int32_t>(QuadricType::disk));
  Vec3<T> l = transform_point(q.to_local, fma(d, t, o));
  T rho2 = fma(l.x, l.x, l.y * l.y);
  // Pull the point onto the surface: the rounding of t must not become an offset.
  T norm = sqrt(fma(l.z, l.z, rho2)), rho = sqrt(rho2);
  T scale = T(1) / max(select(sphere, norm, rho), T(1e-20f));
  l = select(disk, Vec3<T>{l.x, l.y, T(0)},
             Vec3<T>{l.x * scale, l.y * scale, select(sphere, l.z * scale, l.z)});
  Vec2<T> around = sphere_uv(l);
  SurfaceLanes<T> point;
  point.p = transform_point(q.to_world, l);
  Vec3<T> n = select(disk, Vec3<T>{T(0), T(0), T(1)}, Vec3<T>{l.x, l.y, select(sphere, l.z, T(0))});
  n = normalize(transform_normal(q.to_local, n)) * q.flip;
  point.geometric = n;
  point.uv = {select(disk, rho, around.x), select(sphere, around.y, select(disk, around.x, l.z))};
  // Along u: around the axis, outwards on a disk.
  T inverse_rho = T(1) / max(rho, T(1e-20f));
  auto center = disk & (rho < T(1e-20f));
  Vec3<T> along =
      select(disk, Vec3<T>{select(center, T(1), l.x * inverse_rho), l.y * inverse_rho, T(0)},
             Vec3<T>{-l.y, l.x, T(0)});
  point.frame = shading_frame(n, transform_vector(q.to_world, along));
  point.material = q.material;
  point.light = q.light;
  return point;
}

/// A uniform point on a disk or cylinder light: fills offset, normal and uv for the lanes of
/// `mask`.
template <class T, class L>
FACETA_INLINE void sample_quadric_light(const SceneView& scene, const L& light, MaskOf<T> mask,
                                        const Vec3<T>& p, const Vec2<T>& u, Vec3<T>& offset,
                                        Vec3<T>& normal, T& b1, T& b2) {
  using I = IntOf<T>;
  QuadricLanes<T> q = load_quadrics<T>(scene, select(mask, light.primitive, I(0)));
  auto disk = q.type == I(static_cast<int32_t>(QuadricType::disk));
  Vec2<T> d = concentric_disk(u);
  SinCos<T> phi = sincos(T(2 * kPi) * u.x);
  Vec3<T> l = select(disk, Vec3<T>{d.x, d.y, T(0)}, Vec3<T>{phi.cos, phi.sin, u.y});
  Vec3<T> n = select(disk, Vec3<T>{T(0), T(0), T(1)}, Vec3<T>{phi.cos, phi.sin, T(0)});
  offset = select(mask, transform_point(q.to_world, l) - p, offset);
  normal = select(mask, normalize(transform_normal(q.to_local, n)) * q.flip, normal);
  T angle = atan2(d.y, d.x) * T(kInvTwoPi);
  angle = select(angle < T(0), angle + T(1), angle);
  b1 = select(mask, select(disk, sqrt(fma(d.x, d.x, d.y * d.y)), u.x), b1);
  b2 = select(mask, select(disk, angle, u.y), b2);
}

/// uv of sampled points p on sphere lights, for the lanes of `mask`.
template <class T, class L> FACETA_INLINE void sphere_light_uv(const SceneView& scene,
                                                               const L& light, MaskOf<T> mask,
                                                               const Vec3<T>& p, T& b1, T& b2) {
  QuadricLanes<T> q = load_quadrics<T>(scene, select(mask, light.primitive, IntOf<T>(0)));
  Vec2<T> uv = sphere_uv(normalize(transform_point(q.to_local, p)));
  b1 = select(mask, uv.x, b1);
  b2 = select(mask, uv.y, b2);
}

/// Where a ray leaves the surface on the side of `direction`. The offset covers the rounding of the
/// point and of Embree's own (not robust) intersection, both proportional to the coordinates.
template <class T> FACETA_INLINE Vec3<T>
offset_origin(const SurfaceLanes<T>& s, const Vec3<T>& direction, const T& scene_scale) {
  T size = max(max(abs(s.p.x), abs(s.p.y)), max(abs(s.p.z), scene_scale));
  T epsilon = size * T(4e-6f);
  return fma(s.geometric, copysign(epsilon, dot(direction, s.geometric)), s.p);
}

} // namespace faceta
