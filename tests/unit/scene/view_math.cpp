#include "view_math.h"

#include <cmath>
#include <limits>
#include <numbers>

using namespace faceta;
using namespace faceta::double3;

namespace test {

namespace {

constexpr double kPi = std::numbers::pi;

Double3 apply(const float (&m)[12], const Double3& p, double w) {
  Double3 r;
  for (int k = 0; k < 3; ++k)
    r[k] = m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + w * m[4 * k + 3];
  return r;
}

void complete(SurfacePoint& s, const Double3& tangent) {
  Double3 dp_du = s.dp_du;
  s.dp_du = tangent;
  complete_frame(s);
  s.dp_du = dp_du;
}

SurfacePoint triangle(const TriangleRecord& r, const Double3& o, const Double3& d) {
  Double3 v0 = load(r.v0), e1 = load(r.e1), e2 = load(r.e2), h = cross(d, e2);
  double inverse = 1 / dot(e1, h);
  double u = dot(sub(o, v0), h) * inverse, v = dot(d, cross(sub(o, v0), e1)) * inverse;
  double b[3] = {1 - u - v, u, v};
  SurfacePoint s;
  s.p = add(v0, add(scale(e1, u), scale(e2, v)));
  s.n = normalize(cross(e1, e2));
  const Double3 n[3] = {load(r.n0), load(r.n1), load(r.n2)};
  const float* uv[3] = {r.uv0, r.uv1, r.uv2};
  for (int k = 0; k < 3; ++k) {
    s.sh_n = add(s.sh_n, scale(n[k], b[k]));
    s.u += b[k] * uv[k][0];
    s.v += b[k] * uv[k][1];
  }
  s.sh_n = normalize(s.sh_n);
  s.dp_du = load(r.dpdu);
  complete(s, s.dp_du);
  return s;
}

SurfacePoint quadric(const QuadricRecord& q, const Double3& p) {
  auto type = static_cast<QuadricType>(q.type);
  bool sphere = type == QuadricType::sphere, disk = type == QuadricType::disk;
  Double3 l = apply(q.to_local, p, 1);
  double rho = std::hypot(l[0], l[1]), norm = sphere ? length(l) : rho;
  l = disk ? Double3{l[0], l[1], 0}
           : Double3{l[0] / norm, l[1] / norm, sphere ? l[2] / norm : l[2]};
  double phi = std::atan2(l[1], l[0]);
  phi = phi < 0 ? phi + 2 * kPi : phi;
  Double3 n = disk ? Double3{0, 0, 1} : Double3{l[0], l[1], sphere ? l[2] : 0};
  SurfacePoint s;
  s.p = apply(q.to_world, l, 1);
  for (int k = 0; k < 3; ++k)
    s.n[k] = q.to_local[k] * n[0] + q.to_local[4 + k] * n[1] + q.to_local[8 + k] * n[2];
  s.n = s.sh_n = scale(normalize(s.n), q.flip);
  double around = phi / (2 * kPi);
  s.u = disk ? rho : around;
  s.v = sphere ? std::acos(std::clamp(l[2], -1.0, 1.0)) / kPi : disk ? around : l[2];
  // Along u: around the axis, outwards on a disk. Too near the axis there is no such direction.
  Double3 along = disk ? Double3{l[0], l[1], 0} : Double3{-l[1], l[0], 0};
  complete(s, std::hypot(l[0], l[1]) > 1e-6 ? apply(q.to_world, along, 0) : Double3{});
  return s;
}

} // namespace

Hit trace(const SceneView& view, const Double3& o, const Double3& d, int packet) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit8 r{};
  for (int i = 0; i < 8; ++i) {
    r.ray.org_x[i] = o[0], r.ray.org_y[i] = o[1], r.ray.org_z[i] = o[2];
    r.ray.dir_x[i] = d[0], r.ray.dir_y[i] = d[1], r.ray.dir_z[i] = d[2];
    r.ray.tfar[i] = std::numeric_limits<float>::infinity();
    r.ray.mask[i] = ~0u;
    r.hit.geomID[i] = r.hit.primID[i] = r.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  if (packet == 8) {
    alignas(32) int valid[8] = {0, 0, 0, -1, 0, -1, 0, 0};
    rtcIntersect8(valid, view.embree, &context, &r);
    return {int(r.hit.geomID[3]), int(r.hit.primID[3]), r.ray.tfar[3]};
  }
  RTCRayHit one{};
  one.ray = {r.ray.org_x[0],
             r.ray.org_y[0],
             r.ray.org_z[0],
             0,
             r.ray.dir_x[0],
             r.ray.dir_y[0],
             r.ray.dir_z[0],
             0,
             r.ray.tfar[0],
             ~0u,
             0,
             0};
  one.hit.geomID = one.hit.primID = one.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(view.embree, &context, &one);
  return {int(one.hit.geomID), int(one.hit.primID), one.ray.tfar};
}

bool occluded(const SceneView& view, const Double3& o, const Double3& d, double far) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray{float(o[0]), float(o[1]), float(o[2]), 0,   float(d[0]), float(d[1]),
             float(d[2]), 0,           float(far),  ~0u, 0,           0};
  rtcOccluded1(view.embree, &context, &ray);
  return ray.tfar < 0;
}

SurfacePoint surface(const SceneView& view, const Hit& hit, const Double3& o, const Double3& d) {
  return hit.geometry == 0 ? triangle(view.triangles[hit.primitive], o, d)
                           : quadric(view.quadrics[hit.primitive], add(o, scale(d, hit.t)));
}

} // namespace test
