#include "replay.h"

#include "base/error.h"
#include "results.h"

#include <cstring>
#include <ctime>
#include <embree3/rtcore.h>
#include <limits>

namespace faceta::bench {

namespace {

template <int W> struct Packets;
template <> struct Packets<1> {
  using RayHit = RTCRayHit;
  using Ray = RTCRay;
  static void intersect(const int*, RTCScene s, RTCIntersectContext* c, RayHit* r) {
    rtcIntersect1(s, c, r);
  }
  static void occluded(const int*, RTCScene s, RTCIntersectContext* c, Ray* r) {
    rtcOccluded1(s, c, r);
  }
};
template <> struct Packets<8> {
  using RayHit = RTCRayHit8;
  using Ray = RTCRay8;
  static void intersect(const int* v, RTCScene s, RTCIntersectContext* c, RayHit* r) {
    rtcIntersect8(v, s, c, r);
  }
  static void occluded(const int* v, RTCScene s, RTCIntersectContext* c, Ray* r) {
    rtcOccluded8(v, s, c, r);
  }
};
template <> struct Packets<16> {
  using RayHit = RTCRayHit16;
  using Ray = RTCRay16;
  static void intersect(const int* v, RTCScene s, RTCIntersectContext* c, RayHit* r) {
    rtcIntersect16(v, s, c, r);
  }
  static void occluded(const int* v, RTCScene s, RTCIntersectContext* c, Ray* r) {
    rtcOccluded16(v, s, c, r);
  }
};

/// The eight fields of W rays, one after the other.
template <int W, class Ray> void load_rays(Ray& ray, const float* packet) {
  constexpr size_t kBytes = W * sizeof(float);
  std::memcpy(&ray.org_x, packet, kBytes);
  std::memcpy(&ray.org_y, packet + W, kBytes);
  std::memcpy(&ray.org_z, packet + 2 * W, kBytes);
  std::memcpy(&ray.dir_x, packet + 3 * W, kBytes);
  std::memcpy(&ray.dir_y, packet + 4 * W, kBytes);
  std::memcpy(&ray.dir_z, packet + 5 * W, kBytes);
  std::memcpy(&ray.tnear, packet + 6 * W, kBytes);
  std::memcpy(&ray.tfar, packet + 7 * W, kBytes);
}

template <int W, class Ray> void init_rays(Ray& ray) {
  constexpr size_t kBytes = W * sizeof(float);
  std::memset(&ray.time, 0, kBytes);
  std::memset(&ray.mask, 0xff, kBytes);
  std::memset(&ray.id, 0, kBytes);
  std::memset(&ray.flags, 0, kBytes);
}

template <int W> uint64_t count_equal(const void* words, uint32_t value, size_t lanes) {
  uint32_t w[W];
  std::memcpy(w, words, sizeof w);
  uint64_t equal = 0;
  for (size_t i = 0; i < lanes; ++i)
    equal += w[i] == value;
  return equal;
}

/// Calls trace(valid, packet, lanes) for each packet of a batch; all but the last are full.
template <int W, class Trace>
void for_each_packet(const float* packets, size_t count, const Trace& trace) {
  alignas(64) int32_t valid[W];
  std::memset(valid, 0xff, sizeof valid);
  for (size_t i = 0; i < count; i += W, packets += 8 * W) {
    size_t lanes = std::min<size_t>(W, count - i);
    for (size_t k = lanes; k < W; ++k)
      valid[k] = 0;
    trace(valid, packets, lanes);
  }
}

template <int W, bool kCount>
uint64_t trace_batch(RTCScene scene, RayKind kind, const float* packets, size_t count) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (kind == RayKind::camera)
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  uint64_t hits = 0;
  if (kind == RayKind::shadow) {
    typename Packets<W>::Ray ray;
    init_rays<W>(ray);
    for_each_packet<W>(packets, count, [&](const int* valid, const float* packet, size_t lanes) {
      load_rays<W>(ray, packet);
      Packets<W>::occluded(valid, scene, &context, &ray);
      if (kCount) // an occluded ray has tfar = -infinity
        hits += count_equal<W>(&ray.tfar, 0xff800000u, lanes);
    });
  } else {
    typename Packets<W>::RayHit hit;
    init_rays<W>(hit.ray);
    std::memset(&hit.hit.instID, 0xff, sizeof hit.hit.instID);
    for_each_packet<W>(packets, count, [&](const int* valid, const float* packet, size_t lanes) {
      load_rays<W>(hit.ray, packet);
      std::memset(&hit.hit.geomID, 0xff, sizeof hit.hit.geomID);
      Packets<W>::intersect(valid, scene, &context, &hit);
      if (kCount)
        hits += lanes - count_equal<W>(&hit.hit.geomID, RTC_INVALID_GEOMETRY_ID, lanes);
    });
  }
  return hits;
}

template <bool kCount>
uint64_t trace_batch(RTCScene scene, int width, RayKind kind, const float* packets, size_t count) {
  switch (width) {
  case 1:
    return trace_batch<1, kCount>(scene, kind, packets, count);
  case 8:
    return trace_batch<8, kCount>(scene, kind, packets, count);
  default:
    return trace_batch<16, kCount>(scene, kind, packets, count);
  }
}

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

} // namespace

Replay::Replay(const SceneView& scene, const std::vector<RayRecord>& records)
    : scene_(scene), records_(records) {}

void Replay::pack(const std::array<int, kRayKinds>& widths) {
  for (int width : widths)
    if (width != 1 && width != 8 && width != 16)
      throw Error("Embree has no packets of " + std::to_string(width) + " rays");
  widths_ = widths;
  batches_.clear();
  size_t size = 0;
  for (const RayRecord& record : records_)
    for (const RayRecord::Batch& b : record.batches) {
      size_t width = widths_[static_cast<int>(b.kind)];
      batches_.push_back({b.kind, size, b.count});
      size += 8 * width * ((b.count + width - 1) / width);
    }
  packed_.assign(size, 0.0f);
  size_t index = 0;
  for (const RayRecord& record : records_)
    for (const RayRecord::Batch& b : record.batches) {
      size_t width = widths_[static_cast<int>(b.kind)];
      float* packets = &packed_[batches_[index++].offset];
      for (size_t i = 0; i < b.count; ++i)
        for (size_t k = 0; k < 8; ++k)
          packets[8 * width * (i / width) + k * width + i % width] =
              record.rays[8 * (b.first + i) + k];
    }
}

void Replay::run() const {
  FlushDenormals flush;
  for (const Batch& b : batches_)
    trace_batch<false>(scene_.embree, widths_[static_cast<int>(b.kind)], b.kind, &packed_[b.offset],
                       b.count);
}

std::array<double, kRayKinds> Replay::run_by_kind() const {
  FlushDenormals flush;
  std::array<double, kRayKinds> seconds{};
  for (const Batch& b : batches_) {
    double start = thread_seconds();
    trace_batch<false>(scene_.embree, widths_[static_cast<int>(b.kind)], b.kind, &packed_[b.offset],
                       b.count);
    seconds[static_cast<int>(b.kind)] += thread_seconds() - start;
  }
  return seconds;
}

std::array<uint64_t, kRayKinds> Replay::hits() const {
  FlushDenormals flush;
  std::array<uint64_t, kRayKinds> hits{};
  for (const Batch& b : batches_)
    hits[static_cast<int>(b.kind)] += trace_batch<true>(
        scene_.embree, widths_[static_cast<int>(b.kind)], b.kind, &packed_[b.offset], b.count);
  return hits;
}

std::array<uint64_t, kRayKinds> Replay::rays() const {
  std::array<uint64_t, kRayKinds> rays{};
  for (const Batch& b : batches_)
    rays[static_cast<int>(b.kind)] += b.count;
  return rays;
}

} // namespace faceta::bench
