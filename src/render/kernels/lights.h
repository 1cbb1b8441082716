#pragma once

/// Choosing a light, sampling a direction to it, and the densities of both, in lanes.

#include "render/kernels/environment.h"
#include "render/kernels/rows.h"
#include "sampling/warp.h"

#include <cstddef>

namespace faceta {

/// The fields of LightRecord a lane needs.
template <class T> struct LightLanes {
  IntOf<T> type, texture, primitive, trail, depth;
  T area, radius, length1, length2, inverse1, inverse2;
  Vec3<T> p, e1, e2, n;
  Color<T> radiance;
  Vec2<T> uv0, duv1, duv2;
};

/// The fields of a LightRecord from its 32 words.
template <class T> FACETA_INLINE LightLanes<T> light_lanes(const T (&a)[16], const T (&b)[16]) {
  LightLanes<T> l;
  l.type = as_integer(a[0]);
  l.texture = as_integer(a[1]);
  l.primitive = as_integer(a[2]);
  l.area = a[3];
  l.p = {a[4], a[5], a[6]};
  l.e1 = {a[7], a[8], a[9]};
  l.e2 = {a[10], a[11], a[12]};
  l.n = {a[13], a[14], a[15]};
  l.radiance = Color<T>(b[0], b[1], b[2]);
  l.radius = b[3];
  l.uv0 = {b[4], b[5]};
  l.duv1 = {b[6], b[7]};
  l.duv2 = {b[8], b[9]};
  l.trail = as_integer(b[10]);
  l.depth = as_integer(b[11]);
  l.length1 = b[12];
  l.length2 = b[13];
  l.inverse1 = b[14];
  l.inverse2 = b[15];
  return l;
}

/// Calls use(lights) with the records at `index`. Where all lanes have the same light, the usual
/// case, its fields stay in memory until they are used.
template <class T, class Use>
FACETA_INLINE void with_lights(const SceneView& scene, const IntOf<T>& index, const Use& use) {
  alignas(64) int32_t rows[kWidthOf<T>];
  store(rows, index);
  T a[16], b[16];
  const float* base = reinterpret_cast<const float*>(scene.lights);
  if (all(index == IntOf<T>(rows[0]))) {
    spread_row(base + int64_t(rows[0]) * 32, a);
    spread_row(base + int64_t(rows[0]) * 32 + 16, b);
    use(light_lanes(a, b));
    return;
  }
  load_rows<T>(base, 32, rows, a);
  load_rows<T>(base + 16, 32, rows, b);
  use(light_lanes(a, b));
}

// --- The light BVH (Conty Estevez and Kulla 2018; the importance as in Pharr et al. 2023, 12.6.3)
// ---

/// Conservative importance of a node for a point with normal n: 0 only where nothing arrives.
template <class T>
FACETA_INLINE T node_importance(const T (&w)[16], const Vec3<T>& p, const Vec3<T>& n) {
  Vec3<T> center{w[0], w[1], w[2]}, axis{w[4], w[5], w[6]};
  T radius2 = w[3], cos_spread = w[7], sin_spread = w[8], cos_emission = w[9], power = w[10];
  Vec3<T> to_point = p - center;
  T d2 = dot(to_point, to_point);
  // Inside the sphere or near it distance says nothing: use its size.
  T distance2 = max(d2, radius2);
  T inverse = T(1) / sqrt(max(d2, T(1e-30)));
  Vec3<T> wi = to_point * inverse;
  // The cone that the sphere fills, seen from p.
  auto inside = d2 <= radius2;
  T sin_bounds2 = min(radius2 * inverse * inverse, T(1));
  T cos_bounds = select(inside, T(-1), safe_sqrt(T(1) - sin_bounds2));
  T sin_bounds = select(inside, T(0), sqrt(sin_bounds2));

  auto cos_sub = [](const T& sin_a, const T& cos_a, const T& sin_b, const T& cos_b) {
    return select(cos_a > cos_b, T(1), fma(cos_a, cos_b, sin_a * sin_b)); // cos(max(0, a - b))
  };
  auto sin_sub = [](const T& sin_a, const T& cos_a, const T& sin_b, const T& cos_b) {
    return select(cos_a > cos_b, T(0), fma(sin_a, cos_b, -(cos_a * sin_b)));
  };
  T cos_w = dot(wi, axis), sin_w = safe_sqrt(fma(-cos_w, cos_w, T(1)));
  T cos_x = cos_sub(sin_w, cos_w, sin_spread, cos_spread);
  T sin_x = sin_sub(sin_w, cos_w, sin_spread, cos_spread);
  T cos_p = select(inside, T(1), cos_sub(sin_x, cos_x, sin_bounds, cos_bounds));
  // Emission falls to zero at cos_emission; the margin keeps rounding from losing light.
  auto dark = cos_p < cos_emission - T(1e-3f);
  T cos_i = abs(dot(wi, n)), sin_i = safe_sqrt(fma(-cos_i, cos_i, T(1)));
  T facing = select(inside, T(1), cos_sub(sin_i, cos_i, sin_bounds, cos_bounds));
  T importance = power * max(cos_p, T(0.01f)) * max(facing, T(0.01f)) / max(distance2, T(1e-30f));
  return select(dark, T(0), importance);
}

constexpr int kChildWord = offsetof(LightNode, child) / 4;
constexpr int kLightWord = offsetof(LightNode, light) / 4;

/// A light chosen by its importance and the probability of the choice (0: no light matters).
template <class T> struct LightChoice {
  IntOf<T> light;
  T probability;
};

/// The importances of the two children that start at node `child`.
template <class T> struct ChildImportances {
  T first, second;
};
template <class T>
FACETA_INLINE ChildImportances<T> child_importances(const SceneView& scene, const IntOf<T>& child,
                                                    const Vec3<T>& p, const Vec3<T>& n, T (&a)[16],
                                                    T (&b)[16]) {
  alignas(64) int32_t rows[kWidthOf<T>];
  store(rows, child);
  const float* base = reinterpret_cast<const float*>(scene.light_nodes);
  if (all(child == IntOf<T>(rows[0]))) { // as at the root, always
    spread_row(base + int64_t(rows[0]) * 16, a);
    spread_row(base + int64_t(rows[0]) * 16 + 16, b);
  } else {
    load_rows<T>(base, 16, rows, a);
    load_rows<T>(base + 16, 16, rows, b);
  }
  return {node_importance(a, p, n), node_importance(b, p, n)};
}

template <class T> FACETA_INLINE LightChoice<T>
choose_light(const SceneView& scene, const Vec3<T>& p, const Vec3<T>& n, T u) {
  using I = IntOf<T>;
  const LightNode& root = scene.light_nodes[0];
  LightChoice<T> choice{I(root.light), T(1)};
  I child = I(root.child);
  auto descending = child >= I(0);
  while (any(descending)) {
    T a[16], b[16];
    ChildImportances<T> importance =
        child_importances(scene, select(descending, child, I(0)), p, n, a, b);
    T sum = importance.first + importance.second;
    auto lost = !(sum > T(0));
    T p_first = select(lost, T(0.5f), importance.first / select(lost, T(1), sum));
    auto take_first = u < p_first;
    T taken = select(take_first, p_first, T(1) - p_first);
    T rescaled = select(take_first, u, u - p_first) / select(taken > T(0), taken, T(1));
    u = select(descending, min(max(rescaled, T(0)), T(kOneMinusEpsilon)), u);
    choice.probability =
        select(descending, select(lost, T(0), choice.probability * taken), choice.probability);
    I next = select(take_first, as_integer(a[kChildWord]), as_integer(b[kChildWord]));
    I light = select(take_first, as_integer(a[kLightWord]), as_integer(b[kLightWord]));
    choice.light = select(descending, light, choice.light);
    child = select(descending, next, child);
    descending = descending & (child >= I(0)) & !lost;
  }
  auto nothing = choice.light < I(0);
  choice.probability = select(nothing, T(0), choice.probability);
  choice.light = select(nothing, I(0), choice.light);
  return choice;
}

/// The probability with which choose_light() takes a light, following its trail.
template <class T> FACETA_INLINE T light_probability(const SceneView& scene, const LightLanes<T>& l,
                                                     const Vec3<T>& p, const Vec3<T>& n,
                                                     MaskOf<T> active) {
  using I = IntOf<T>;
  T probability = T(1);
  I child = I(scene.light_nodes[0].child);
  I trail = l.trail, level = I(0);
  auto descending = active & (level < l.depth);
  while (any(descending)) {
    T a[16], b[16];
    ChildImportances<T> importance =
        child_importances(scene, select(descending, child, I(0)), p, n, a, b);
    T sum = importance.first + importance.second;
    auto lost = !(sum > T(0));
    T p_first = select(lost, T(0), importance.first / select(lost, T(1), sum));
    auto second = (trail & I(1)) != I(0);
    T taken = select(second, select(lost, T(0), T(1) - p_first), p_first);
    probability = select(descending, probability * taken, probability);
    child = select(descending, select(second, as_integer(b[kChildWord]), as_integer(a[kChildWord])),
                   child);
    trail = trail >> 1;
    level = level + I(1);
    descending = descending & (level < l.depth);
  }
  return probability;
}

// --- Directions to a light ---

/// The sphere's cone seen from p: 1 - cos of its half angle; 0 if p is inside or too near.
template <class T> FACETA_INLINE T sphere_cone(const LightLanes<T>& l, const Vec3<T>& to_center) {
  T d2 = dot(to_center, to_center);
  T sin2 = l.radius * l.radius / max(d2, T(1e-30f));
  T cosine = safe_sqrt(T(1) - sin2);
  return select(sin2 < T(0.9999f), sin2 / (T(1) + cosine), T(0));
}

/// Rectangles that fill much of the view are sampled by solid angle, others by area: from afar both
/// are alike, and the area costs a quarter. So are those that p lies on, or behind: no light comes.
template <class T>
FACETA_INLINE MaskOf<T> near_rectangle(const LightLanes<T>& l, const Vec3<T>& p) {
  T half = T(0.5f);
  Vec3<T> from_center = p - fma(l.e1, half, fma(l.e2, half, l.p));
  T diagonal2 = fma(l.length1, l.length1, l.length2 * l.length2);
  auto rectangle = l.type == IntOf<T>(static_cast<int32_t>(LightType::rectangle));
  auto lit = dot(from_center, l.n) > T(2e-7f) * (l.length1 + l.length2);
  return rectangle & lit & (diagonal2 > T(2) * dot(from_center, from_center));
}

/// The solid angle of a rectangle and what sampling it needs (Urena, Fajardo and King 2013).
template <class T> struct RectangleView {
  Vec3<T> x, y, z; ///< unit axes; z points away from p
  T x0, x1, y0, y1, z0;
  T b0, b1, k, solid_angle; ///< solid_angle 0: too small for this arithmetic, sample the area
};

template <class T>
FACETA_INLINE RectangleView<T> view_rectangle(const LightLanes<T>& l, const Vec3<T>& p) {
  RectangleView<T> r;
  r.x = l.e1 * l.inverse1;
  r.y = l.e2 * l.inverse2;
  r.z = l.n;
  Vec3<T> d = l.p - p;
  r.x0 = dot(d, r.x);
  r.y0 = dot(d, r.y);
  r.z0 = dot(d, r.z);
  r.z = select(r.z0 > T(0), -r.z, r.z);
  r.z0 = -abs(r.z0);
  r.x1 = r.x0 + l.length1;
  r.y1 = r.y0 + l.length2;
  // The normals of the four side planes lie in the planes x = const or y = const.
  T z2 = r.z0 * r.z0;
  T ny0 = T(1) / sqrt(fma(r.y0, r.y0, z2)), nx1 = T(1) / sqrt(fma(r.x1, r.x1, z2));
  T ny1 = T(1) / sqrt(fma(r.y1, r.y1, z2)), nx0 = T(1) / sqrt(fma(r.x0, r.x0, z2));
  T n0z = -r.y0 * ny0, n1z = r.x1 * nx1, n2z = r.y1 * ny1, n3z = -r.x0 * nx0;
  // dot(n0, n1) = n0z n1z, as their other components lie along y and x. The angles g_i = acos(-n_i
  // n_j) add up as arguments of unit complex numbers do: two arc tangents instead of four cosines.
  auto unit = [](const T& c) { return Vec2<T>{-c, safe_sqrt(fma(-c, c, T(1)))}; };
  auto times = [](const Vec2<T>& p, const Vec2<T>& q) {
    return Vec2<T>{fma(p.x, q.x, -(p.y * q.y)), fma(p.x, q.y, p.y * q.x)};
  };
  Vec2<T> g01 = times(unit(n0z * n1z), unit(n1z * n2z));
  Vec2<T> g23 = times(unit(n2z * n3z), unit(n3z * n0z));
  r.b0 = n0z;
  r.b1 = n2z;
  // g2 + g3 lies in [0, 2 pi]; the solid angle is the sum of all four less 2 pi.
  T k = atan2(g23.y, g23.x);
  r.k = select(k < T(0), -k, T(2 * kPi) - k);
  Vec2<T> all_four = times(g01, g23);
  T s = atan2(all_four.y, all_four.x);
  // Only above the rectangle more than pi is seen of it; elsewhere a sum below 0 is rounding.
  // Nearer to it than to its edges 2.09 at least is seen: a small sum is then 2 pi that was
  // rounded.
  T inside = min(min(-r.x0, r.x1), min(-r.y0, r.y1));
  auto more = ((inside > T(0)) & (s < T(0))) | ((inside > -r.z0) & (s < T(1)));
  s = select(more, s + T(2 * kPi), s);
  // Below this the sum of four angles has lost its digits; the area is then uniform enough.
  r.solid_angle = select((s > T(0.02f)) & (r.z0 < T(0)), s, T(0));
  return r;
}

template <class T>
FACETA_INLINE Vec3<T> sample_rectangle(const RectangleView<T>& r, const Vec2<T>& u) {
  T au = fma(u.x, r.solid_angle, r.k);
  SinCos<T> sc = sincos(au);
  T fu = fma(sc.cos, r.b0, -r.b1) / sc.sin;
  T cu = copysign(T(1) / sqrt(fma(fu, fu, r.b0 * r.b0)), fu);
  cu = clamp(cu, T(-kOneMinusEpsilon), T(kOneMinusEpsilon));
  T xu = -(cu * r.z0) / sqrt(fma(-cu, cu, T(1)));
  xu = clamp(xu, r.x0, r.x1);
  T d2 = fma(xu, xu, r.z0 * r.z0);
  T h0 = r.y0 / sqrt(fma(r.y0, r.y0, d2));
  T h1 = r.y1 / sqrt(fma(r.y1, r.y1, d2));
  T hv = lerp(h0, h1, u.y);
  T yv = hv * sqrt(d2) / sqrt(max(fma(-hv, hv, T(1)), T(1e-7f)));
  yv = clamp(yv, r.y0, r.y1);
  return r.x * xu + r.y * yv + r.z * r.z0;
}

/// A point on a light seen from p.
template <class T> struct LightPoint {
  Vec3<T> offset, direction; ///< from p to the point; the same of length 1
  T distance;
  T pdf; ///< solid angle; 1 for a point light
  Vec2<T> uv;
  MaskOf<T> delta;
  MaskOf<T> valid; ///< p lies on the emitting side
};

/// A point on rectangles that fill much of the view, where solid_angle is above 0.
template <class T> struct NearRectanglePoint {
  Vec3<T> offset; ///< from p
  T b1, b2, solid_angle;
};
/// Rare: out of the way of the others. Takes a copy, so that theirs stays in registers.
template <class T> FACETA_NOINLINE NearRectanglePoint<T>
sample_near_rectangle(const LightLanes<T> l, const Vec3<T> p, const Vec2<T> u) {
  RectangleView<T> r = view_rectangle(l, p);
  Vec3<T> q = sample_rectangle(r, u);
  return {q, (dot(q, r.x) - r.x0) * l.inverse1, (dot(q, r.y) - r.y0) * l.inverse2, r.solid_angle};
}

/// A point of the spheres: in the cone that they fill, or anywhere on those that p is inside of.
/// Returns the lanes that p is outside of.
template <class T>
FACETA_INLINE MaskOf<T> sample_sphere_light(const LightLanes<T>& l, const MaskOf<T>& sphere,
                                            const Vec3<T>& p, const Vec2<T>& u, Vec3<T>& offset,
                                            Vec3<T>& normal, T& solid_pdf) {
  Vec3<T> to_center = l.p - p;
  T cone = sphere_cone(l, to_center);
  auto outside = cone > T(0);
  T d2 = dot(to_center, to_center), distance = sqrt(d2);
  Frame<T> frame = frame_from_normal(to_center * (T(1) / distance));
  T one_minus_cos = u.x * cone, cosine = T(1) - one_minus_cos;
  T sin2 = one_minus_cos * (T(1) + cosine);
  SinCos<T> phi = sincos(T(2 * kPi) * u.y);
  T sine = sqrt(max(sin2, T(0)));
  Vec3<T> w = frame.to_world({sine * phi.cos, sine * phi.sin, cosine});
  T inward = safe_sqrt(l.radius * l.radius - d2 * sin2);
  T along = fma(distance, cosine, -inward);
  Vec3<T> anywhere = uniform_sphere(u);
  Vec3<T> near_point = fma(anywhere, l.radius, to_center);
  offset = select(sphere, select(outside, w * along, near_point), offset);
  normal = select(sphere, anywhere * l.n.x, normal); // n.x: orientation of the sphere
  // From the centre to the point; taken as the difference of both, little of it would be left of
  // small spheres far away.
  T across = sine * along;
  Vec3<T> outward =
      frame.to_world({across * phi.cos, across * phi.sin, -fma(distance, sin2, inward * cosine)});
  normal = select(sphere & outside, normalize(outward) * l.n.x, normal);
  solid_pdf = select(sphere & outside, T(1 / (2 * kPi)) / select(outside, cone, T(1)), solid_pdf);
  return outside;
}

template <class T> FACETA_INLINE LightPoint<T>
sample_light(const SceneView& scene, const LightLanes<T>& l, const Vec3<T>& p, const Vec2<T>& u) {
  using I = IntOf<T>;
  auto is = [&](LightType type) { return l.type == I(static_cast<int32_t>(type)); };
  auto triangle = is(LightType::triangle), rectangle = is(LightType::rectangle);
  auto sphere = is(LightType::sphere), point = is(LightType::point);
  auto quadric = is(LightType::disk) | is(LightType::cylinder);

  // Uniform over the area: parallelogram directly, triangle by the square root map.
  T b1 = u.x, b2 = u.y;
  if (any(triangle)) {
    T root = sqrt(u.x);
    b1 = select(triangle, T(1) - root, b1);
    b2 = select(triangle, u.y * root, b2);
  }
  LightPoint<T> s;
  s.offset = fma(l.e1, b1, fma(l.e2, b2, l.p)) - p;
  s.delta = point;
  Vec3<T> normal = l.n;
  auto by_area = triangle | rectangle | quadric;
  T solid_pdf = T(0);
  auto near = near_rectangle(l, p);
  if (any(near)) {
    NearRectanglePoint<T> q = sample_near_rectangle(l, p, u);
    auto wide = near & (q.solid_angle > T(0));
    s.offset = select(wide, q.offset, s.offset);
    b1 = select(wide, q.b1, b1);
    b2 = select(wide, q.b2, b2);
    solid_pdf = select(wide, T(1) / q.solid_angle, solid_pdf);
    by_area = by_area & !wide;
  }
  if (any(sphere)) {
    by_area =
        by_area | (sphere & !sample_sphere_light(l, sphere, p, u, s.offset, normal, solid_pdf));
    auto textured = sphere & (l.texture >= I(0));
    if (any(textured))
      sphere_light_uv(scene, l, textured, p + s.offset, b1, b2);
  }
  if (any(quadric))
    sample_quadric_light(scene, l, quadric, p, u, s.offset, normal, b1, b2);
  T d2 = dot(s.offset, s.offset);
  T inverse = T(1) / sqrt(max(d2, T(1e-30f)));
  s.distance = d2 * inverse;
  s.direction = s.offset * inverse;
  T cosine = -dot(s.direction, normal);
  s.valid = (d2 > T(0)) & (point | (cosine > T(1e-7f)));
  s.pdf = select(point, T(1), solid_pdf);
  if (any(by_area))
    s.pdf = select(by_area, d2 / max(cosine * l.area, T(1e-30f)), s.pdf);
  s.valid = s.valid & (s.pdf > T(0));
  if (any(l.texture >= I(0)))
    s.uv = {fma(l.duv1.x, b1, fma(l.duv2.x, b2, l.uv0.x)),
            fma(l.duv1.y, b1, fma(l.duv2.y, b2, l.uv0.y))};
  return s;
}

/// The solid-angle density with which sample_light() from p finds a point it can see: `offset` from
/// p to the point, `normal` there.
template <class T> FACETA_INLINE T light_direction_pdf(const LightLanes<T>& l, const Vec3<T>& p,
                                                       const Vec3<T>& offset,
                                                       const Vec3<T>& normal) {
  using I = IntOf<T>;
  T d2 = dot(offset, offset);
  T cosine = abs(dot(offset, normal)) / sqrt(max(d2, T(1e-30f)));
  T pdf = d2 / max(cosine * l.area, T(1e-30f));
  auto near = near_rectangle(l, p);
  if (any(near)) {
    T solid_angle = view_rectangle(l, p).solid_angle;
    auto wide = near & (solid_angle > T(0));
    pdf = select(wide, T(1) / select(wide, solid_angle, T(1)), pdf);
  }
  auto sphere = l.type == I(static_cast<int32_t>(LightType::sphere));
  if (any(sphere)) {
    T cone = sphere_cone(l, l.p - p);
    auto outside = sphere & (cone > T(0));
    pdf = select(outside, T(1 / (2 * kPi)) / select(outside, cone, T(1)), pdf);
  }
  return pdf;
}

} // namespace faceta
