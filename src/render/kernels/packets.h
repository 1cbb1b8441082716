#pragma once

/// Handing rays to Embree in the packets it likes best, and taking hits back.

#include "render/job.h"
#include "render/kernels/rows.h"
#include "render/kernels/surface.h"

#include <embree3/rtcore.h>

namespace faceta {

/// What a packet's hits are written to.
struct HitArrays {
  int32_t* codes;
  float* distances;

  FACETA_INLINE HitArrays from(int i) const { return {codes + i, distances + i}; }
};

/// Fetches ahead what shading hit k will read, the record of a triangle or quadric: Embree has just
/// emptied the caches, and while it traces the next packet there is time. A miss, -1, fetches what
/// lies before the triangles, which costs less than to tell.
FACETA_INLINE void prefetch_hit(const SceneView& scene, const HitArrays& hits, int k) {
  static_assert(sizeof(QuadricRecord) == sizeof(TriangleRecord));
  int32_t code = hits.codes[k];
  const char* base = reinterpret_cast<const char*>(scene.triangles);
  if (scene.quadric_count > 0 && code >= kQuadricHit) {
    base = reinterpret_cast<const char*>(scene.quadrics);
    code -= kQuadricHit;
  }
  const char* record = base + code * int64_t(sizeof(TriangleRecord));
  __builtin_prefetch(record);
  __builtin_prefetch(record + 64);
}

FACETA_INLINE int32_t hit_code(uint32_t geometry, uint32_t primitive) {
  if (geometry == RTC_INVALID_GEOMETRY_ID)
    return kNoHit;
  return static_cast<int32_t>(primitive) + (geometry == 1 ? kQuadricHit : 0);
}

#if FACETA_LANE_WIDTH == 1

FACETA_INLINE RTCRayHit make_ray(const float* o, const float* d, float near, float far) {
  RTCRayHit r;
  r.ray.org_x = o[0], r.ray.org_y = o[1], r.ray.org_z = o[2];
  r.ray.dir_x = d[0], r.ray.dir_y = d[1], r.ray.dir_z = d[2];
  r.ray.tnear = near, r.ray.tfar = far, r.ray.time = 0;
  r.ray.mask = ~0u, r.ray.id = 0, r.ray.flags = 0;
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return r;
}

/// Closest hits of the rays in path rows (origin, direction in words 0 to 5).
inline void trace_rows(const SceneView& scene, const float* rows, int n, const HitArrays& hits) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (int i = 0; i < n; ++i) {
    const float* row = rows + 16 * i;
    RTCRayHit r = make_ray(row, row + 3, 0.0f, __builtin_inff());
    rtcIntersect1(scene.embree, &context, &r);
    hits.codes[i] = hit_code(r.hit.geomID, r.hit.primID);
    hits.distances[i] = r.ray.tfar;
    prefetch_hit(scene, hits, i);
  }
}

inline void trace_camera(const SceneView& scene, const RayArrays& rays, int n,
                         const HitArrays& hits) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (int i = 0; i < n; ++i) {
    float o[3], d[3];
    for (int k = 0; k < 3; ++k) {
      o[k] = rays.origin[k][i];
      d[k] = rays.direction[k][i];
    }
    RTCRayHit r = make_ray(o, d, rays.near[i], rays.far[i]);
    rtcIntersect1(scene.embree, &context, &r);
    hits.codes[i] = hit_code(r.hit.geomID, r.hit.primID);
    hits.distances[i] = r.ray.tfar;
    prefetch_hit(scene, hits, i);
  }
}

/// Leaves in `far` what is below 0 for blocked rays.
inline void trace_shadow(const SceneView& scene, const RayArrays& rays, int n, float* far) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (int i = 0; i < n; ++i) {
    float o[3], d[3];
    for (int k = 0; k < 3; ++k) {
      o[k] = rays.origin[k][i];
      d[k] = rays.direction[k][i];
    }
    RTCRay r = make_ray(o, d, 0.0f, rays.far[i]).ray;
    rtcOccluded1(scene.embree, &context, &r);
    far[i] = r.tfar;
  }
}

#else

FACETA_INLINE __m256i packet_mask(int remaining) {
  __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  return _mm256_cmpgt_epi32(_mm256_set1_epi32(remaining), lanes);
}

/// Codes and distances of eight hits; prefetches what they point at.
FACETA_INLINE void take_hits(const SceneView& scene, const uint32_t* geometry,
                             const uint32_t* primitive, const float* far, __m256i valid,
                             const HitArrays& hits) {
  __m256i g = _mm256_load_si256(reinterpret_cast<const __m256i*>(geometry));
  __m256i p = _mm256_load_si256(reinterpret_cast<const __m256i*>(primitive));
  __m256i none = _mm256_set1_epi32(-1);
  __m256i quadric = _mm256_cmpeq_epi32(g, _mm256_set1_epi32(1));
  p = _mm256_add_epi32(p, _mm256_and_si256(quadric, _mm256_set1_epi32(kQuadricHit)));
  __m256i miss = _mm256_or_si256(_mm256_cmpeq_epi32(g, none), _mm256_xor_si256(valid, none));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(hits.codes), _mm256_or_si256(p, miss));
  _mm256_storeu_ps(hits.distances, _mm256_load_ps(far));
  for (int k = 0; k < 8; ++k)
    prefetch_hit(scene, hits, k);
}

template <class Packet> FACETA_INLINE void init_ray_hits(Packet& p, int width) {
  std::memset(p.ray.time, 0, 4 * width);
  std::memset(p.ray.mask, 0xff, 4 * width);
  std::memset(p.ray.id, 0, 4 * width);
  std::memset(p.ray.flags, 0, 4 * width);
  std::memset(p.hit.instID[0], 0xff, 4 * width);
}

inline void trace_rows(const SceneView& scene, const float* rows, int n, const HitArrays& hits) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit8 p;
  init_ray_hits(p, 8);
  for (int i = 0; i < n; i += 8) {
    alignas(32) int32_t valid[8];
    _mm256_store_si256(reinterpret_cast<__m256i*>(valid), packet_mask(n - i));
    __m256 r[8];
    for (int k = 0; k < 8; ++k)
      r[k] = _mm256_load_ps(rows + 16 * (i + k));
    transpose8(r);
    _mm256_store_ps(p.ray.org_x, r[0]);
    _mm256_store_ps(p.ray.org_y, r[1]);
    _mm256_store_ps(p.ray.org_z, r[2]);
    _mm256_store_ps(p.ray.dir_x, r[3]);
    _mm256_store_ps(p.ray.dir_y, r[4]);
    _mm256_store_ps(p.ray.dir_z, r[5]);
    _mm256_store_ps(p.ray.tnear, _mm256_setzero_ps());
    _mm256_store_ps(p.ray.tfar, _mm256_set1_ps(__builtin_inff()));
    std::memset(p.hit.geomID, 0xff, sizeof p.hit.geomID);
    rtcIntersect8(valid, scene.embree, &context, &p);
    take_hits(scene, p.hit.geomID, p.hit.primID, p.ray.tfar, packet_mask(n - i), hits.from(i));
  }
}

inline void trace_camera(const SceneView& scene, const RayArrays& rays, int n,
                         const HitArrays& hits) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  constexpr int kWidth = 16;
  RTCRayHit16 p;
  init_ray_hits(p, kWidth);
  for (int i = 0; i < n; i += kWidth) {
    alignas(64) int32_t valid[kWidth];
    for (int k = 0; k < kWidth; ++k)
      valid[k] = i + k < n ? -1 : 0;
    constexpr size_t kBytes = kWidth * sizeof(float);
    std::memcpy(p.ray.org_x, rays.origin[0] + i, kBytes);
    std::memcpy(p.ray.org_y, rays.origin[1] + i, kBytes);
    std::memcpy(p.ray.org_z, rays.origin[2] + i, kBytes);
    std::memcpy(p.ray.dir_x, rays.direction[0] + i, kBytes);
    std::memcpy(p.ray.dir_y, rays.direction[1] + i, kBytes);
    std::memcpy(p.ray.dir_z, rays.direction[2] + i, kBytes);
    std::memcpy(p.ray.tnear, rays.near + i, kBytes);
    std::memcpy(p.ray.tfar, rays.far + i, kBytes);
    std::memset(p.hit.geomID, 0xff, sizeof p.hit.geomID);
    rtcIntersect16(valid, scene.embree, &context, &p);
    for (int k = 0; k < kWidth; k += 8)
      take_hits(scene, p.hit.geomID + k, p.hit.primID + k, p.ray.tfar + k, packet_mask(n - i - k),
                hits.from(i + k));
  }
}

inline void trace_shadow(const SceneView& scene, const RayArrays& rays, int n, float* far) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay8 p;
  std::memset(p.time, 0, sizeof p.time);
  std::memset(p.mask, 0xff, sizeof p.mask);
  std::memset(p.id, 0, sizeof p.id);
  std::memset(p.flags, 0, sizeof p.flags);
  for (int i = 0; i < n; i += 8) {
    alignas(32) int32_t valid[8];
    _mm256_store_si256(reinterpret_cast<__m256i*>(valid), packet_mask(n - i));
    std::memcpy(p.org_x, rays.origin[0] + i, 32);
    std::memcpy(p.org_y, rays.origin[1] + i, 32);
    std::memcpy(p.org_z, rays.origin[2] + i, 32);
    std::memcpy(p.dir_x, rays.direction[0] + i, 32);
    std::memcpy(p.dir_y, rays.direction[1] + i, 32);
    std::memcpy(p.dir_z, rays.direction[2] + i, 32);
    std::memset(p.tnear, 0, 32);
    std::memcpy(p.tfar, rays.far + i, 32);
    rtcOccluded8(valid, scene.embree, &context, &p);
    std::memcpy(far + i, p.tfar, 32);
  }
}

#endif

} // namespace faceta
