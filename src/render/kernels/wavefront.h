#pragma once

/// The wavefront path tracer of one thread: a pool of paths that moves through stages (refill,
/// trace, sort by material class, shade in lanes, shadow rays) until its chunks are done.
///
/// A path is one 64-byte row: origin, direction, density of its last sample (negative: a delta or
/// the camera), eta, throughput, slot, pixel, sample, depth, packed normal of its last vertex.

#include "render/kernels/camera.h"
#include "render/kernels/lights.h"
#include "render/kernels/packets.h"
#include "render/kernels/shading.h"
#include "sampling/sequence.h"

#include <cstdlib>
#include <memory>
#include <vector>

namespace faceta {

/// In place of a path's density: so far it met nothing but null surfaces.
inline constexpr float kUnscattered = -2;
inline constexpr int kPoolSize = 1024;
inline constexpr int kChunkRing = 8;

/// Zeroed memory on 64-byte lines, allocated once.
template <class E> class AlignedArray {
public:
  explicit AlignedArray(size_t n)
      : data_(static_cast<E*>(std::aligned_alloc(64, (n * sizeof(E) + 63) / 64 * 64))) {
    std::memset(static_cast<void*>(data_), 0, n * sizeof(E));
  }
  ~AlignedArray() { std::free(data_); }
  AlignedArray(const AlignedArray&) = delete;
  AlignedArray& operator=(const AlignedArray&) = delete;
  operator E*() const { return data_; }
  E* get() const { return data_; }

private:
  E* data_;
};

/// A unit normal in 32 bits (octahedral), for the light BVH only.
template <class T> FACETA_INLINE IntOf<T> pack_normal(const Vec3<T>& n) {
  T scale = T(1) / (abs(n.x) + abs(n.y) + abs(n.z));
  T x = n.x * scale, y = n.y * scale;
  auto lower = n.z < T(0);
  T fx = copysign(T(1) - abs(y), x), fy = copysign(T(1) - abs(x), y);
  x = select(lower, fx, x);
  y = select(lower, fy, y);
  IntOf<T> ix = to_int(fma(x, T(32000), T(32768))), iy = to_int(fma(y, T(32000), T(32768)));
  return ix | (iy << 16);
}
template <class T> FACETA_INLINE Vec3<T> unpack_normal(const IntOf<T>& bits) {
  using I = IntOf<T>;
  T x = (to_float(bits & I(0xffff)) - T(32768)) * T(1.0f / 32000);
  T y = (to_float((bits >> 16) & I(0xffff)) - T(32768)) * T(1.0f / 32000);
  T z = T(1) - abs(x) - abs(y);
  T fold = max(-z, T(0));
  x = x - copysign(fold, x);
  y = y - copysign(fold, y);
  return normalize(Vec3<T>{x, y, z});
}

/// Weight of the power heuristic (Veach 1997); q may be huge ("no other strategy" is q = 0).
template <class T> FACETA_INLINE T power_heuristic(const T& p, const T& q) {
  T ratio = q / p;
  return T(1) / fma(ratio, ratio, T(1));
}

class Wavefront {
public:
  using T = Lanes;
  using I = IntOf<T>;
  using U = UintOf<T>;
  using M = MaskOf<T>;
  static constexpr int W = kWidthOf<T>;
  static constexpr int kPad = 2 * kLanePadding;

  Wavefront(const RenderJob& job, RenderCounters& counters);
  void run();

private:
  // One path in each lane, unpacked from rows.
  struct PathLanes {
    Vec3<T> o, d;
    T pdf, eta;
    Color<T> throughput;
    I slot, pixel, sample, depth, normal;
  };
  // A light (or the environment) chosen and sampled.
  struct LightSample {
    Vec3<T> direction;
    T distance, pdf;
    Color<T> radiance; ///< over the density and the probability of the choice
    M delta, valid;
  };
  // Lanes of paths on their way through a class: begun (the surface is known, what comes next is
  // being fetched) while the group before is shaded.
  struct Group {
    PathLanes path;
    SurfaceLanes<T> surface;
    Vec2<T> place, next_choice; // on the environment: to sample here, and at the next vertex
    M active;
  };
  // Lanes of paths that left the scene.
  struct Misses {
    PathLanes path;
    EnvironmentSpot<T> spot;
    M active;
  };
  // Chunks in flight; finished in order.
  struct ChunkState {
    Chunk chunk;
    int generated = 0, alive = 0;
    bool open = false;
  };

  void refill();
  bool open_chunk();
  void generate(int count);
  void list_samples(const ChunkState& c, int count);
  void start_paths(int row_index, const CameraRay<T>& r, const I& slot, const I& pixel_index,
                   const I& s);
  void finish_chunks();
  void trace();
  I hit_keys(const I& code) const;
  void sort();
  void shade_misses(const int32_t* order, int n);
  void begin_misses(const int32_t* order, int n, Misses& m) const;
  void finish_misses(const Misses& m);
  void prefetch_cells(const I& cells) const;
  void shade_class(const ClassView& c, int first, int n);
  void begin_group(const ClassView& c, int first, int n, Group& g) const;
  void shade_group(const ClassView& c, Group& g);
  M meet(const Group& g);
  void shadows();

  void load_paths(const int32_t* order, PathLanes& path) const;
  void surface_points(const I& index, const I& code, bool need_uv, Group& g) const;
  Color<T> emission(const PathLanes& path, const SurfaceLanes<T>& s, M active);
  LightSample sample_lights(const SurfaceLanes<T>& s, const SampleStream<T>& stream,
                            const I& dimension, const T& choice, const Vec2<T>& place);
  SampleStream<T> stream_of(const PathLanes& path) const;
  Vec2<T> environment_choice(const SampleStream<T>& stream, const I& dimension) const;
  Vec2<T> environment_place(const SampleStream<T>& stream, const I& dimension,
                            const Vec2<T>& choice) const;
  void queue_shadow(const SurfaceLanes<T>& s, const LightSample& l, const Color<T>& contribution,
                    const I& slot, M mask);
  void see_through(const PathLanes& path, const SurfaceLanes<T>& s, M mask);
  void store_paths(const PathLanes& path, const Vec3<T>& o, const Vec3<T>& d, const T& pdf,
                   const T& eta, const Color<T>& throughput, const I& depth, const I& normal,
                   M mask);
  void store_places(const Vec2<T>& place, int first, M mask);
  void continue_paths(const PathLanes& path, const SurfaceLanes<T>& s, const Sample<T>& sample,
                      const SampleStream<T>& stream, const I& dimension, const Vec2<T>& next_choice,
                      M active);
  void add(const Color<T>& c, const I& slot, M mask);
  void clear_alpha(const I& slot, M mask);
  bool environment_is_seen() const {
    return scene_.environment.present && !job_.settings.hide_emitters;
  }

  const RenderJob& job_;
  const SceneView& scene_;
  RenderCounters& counters_;
  Shader<T> shader_;
  float scene_scale_;

  int count_ = 0, next_count_ = 0, shadow_count_ = 0;
  int survivors_ =
      0; ///< paths of earlier rounds, first in the pool; those behind are new and traced
  AlignedArray<float> row_memory_;
  float *rows_, *next_rows_; ///< the pool, and the one that survivors move to
  /// The place on the environment that each path's next vertex samples: chosen when the ray is
  /// made, so that its cell is on its way from memory while others are shaded. x and y of each
  /// path.
  AlignedArray<float> place_memory_;
  float *places_, *next_places_;
  AlignedArray<int32_t> hits_;          ///< hit codes of the pool
  AlignedArray<int32_t> order_, codes_; ///< the pool sorted by material: row and hit code
  AlignedArray<int32_t> keys_;          ///< of sort(): 4 times the key of each path
  AlignedArray<float> distances_;
  AlignedArray<float> camera_rays_; ///< origin, direction, near, far as arrays
  AlignedArray<float> shadow_rays_; ///< origin, direction, far, contribution as arrays
  AlignedArray<int32_t> shadow_slots_;
  AlignedArray<float> shadow_far_; ///< below 0: blocked
  AlignedArray<int32_t> pixel_x_, pixel_y_, samples_;
  AlignedArray<float> radiance_;   ///< RGBA a slot, kMaxChunkPaths a ring entry
  std::vector<int32_t> begin_;     ///< first position of each key in the order
  std::vector<int32_t> counters4_; ///< of sort()
  ChunkState ring_[kChunkRing];
  uint64_t head_ = 0, tail_ = 0; ///< ring positions: oldest open chunk, next to open
  bool exhausted_ = false;
};

} // namespace faceta
