#include "render/kernels/wavefront.h"

#include <utility>

namespace faceta {

namespace {
constexpr int kPoolRows = kPoolSize + Wavefront::kPad;
constexpr int kCameraStride = kPoolRows;
constexpr int kShadowStride = kPoolRows;
} // namespace

Wavefront::Wavefront(const RenderJob& job, RenderCounters& counters)
    : job_(job), scene_(*job.scene), counters_(counters), shader_(*job.scene),
      scene_scale_(scene_.environment.scene_radius * 0.05f), row_memory_(2 * 16 * kPoolRows),
      rows_(row_memory_), next_rows_(row_memory_ + 16 * kPoolRows), place_memory_(4 * kPoolRows),
      places_(place_memory_), next_places_(place_memory_ + 2 * kPoolRows), hits_(kPoolRows),
      order_(kPoolRows), codes_(kPoolRows), keys_(kPoolRows), distances_(kPoolRows),
      camera_rays_(8 * kCameraStride), shadow_rays_(10 * kShadowStride), shadow_slots_(kPoolRows),
      shadow_far_(kPoolRows), pixel_x_(kPoolRows), pixel_y_(kPoolRows), samples_(kPoolRows),
      radiance_(size_t(kChunkRing) * kMaxChunkPaths * 4), begin_(scene_.root_count + 2),
      counters4_(4 * (scene_.root_count + 1)) {}

void Wavefront::run() {
  for (;;) {
    refill();
    if (count_ == 0)
      break;
    trace();
    sort();
    next_count_ = shadow_count_ = 0;
    for (int i = 0; i < kChunkRing; ++i)
      ring_[i].alive = 0;
    if (begin_[1] > begin_[0])
      shade_misses(order_ + begin_[0], begin_[1] - begin_[0]);
    for (int c = 0; c < scene_.class_count; ++c) {
      const ClassView& k = scene_.classes[c];
      int first = begin_[1 + k.first_root], last = begin_[1 + k.first_root + k.roots];
      if (last > first)
        shade_class(k, first, last - first);
    }
    shadows();
    std::swap(rows_, next_rows_);
    std::swap(places_, next_places_);
    count_ = next_count_;
    finish_chunks();
  }
}

// --- Chunks and camera rays ---

bool Wavefront::open_chunk() {
  if (exhausted_ || tail_ - head_ == kChunkRing)
    return false;
  ChunkState& c = ring_[tail_ % kChunkRing];
  if (!job_.next_chunk(job_.user, &c.chunk)) {
    exhausted_ = true;
    return false;
  }
  c.generated = c.alive = 0;
  c.open = true;
  ++tail_;
  return true;
}

void Wavefront::refill() {
  int survivors = count_;
  while (count_ < kPoolSize) {
    if (tail_ == head_ ||
        ring_[(tail_ - 1) % kChunkRing].generated == ring_[(tail_ - 1) % kChunkRing].chunk.paths())
      if (!open_chunk())
        break;
    ChunkState& c = ring_[(tail_ - 1) % kChunkRing];
    generate(min(kPoolSize - count_, c.chunk.paths() - c.generated));
  }
  survivors_ = survivors; // everything behind it was traced by generate()
}

void Wavefront::list_samples(const ChunkState& c, int count) {
  const CameraView& camera = scene_.camera;
  // Which pixel and sample each path is: counted, not divided.
  int pixel = c.generated / c.chunk.samples, sample = c.generated % c.chunk.samples;
  int px = pixel % c.chunk.width, py = pixel / c.chunk.width;
  for (int i = 0; i < count; ++i) {
    pixel_x_[i] = c.chunk.x + px + camera.crop_x;
    pixel_y_[i] = c.chunk.y + py + camera.crop_y;
    samples_[i] = c.chunk.first + sample;
    if (++sample == c.chunk.samples) {
      sample = 0;
      if (++px == c.chunk.width) {
        px = 0;
        ++py;
      }
    }
  }
}

FACETA_INLINE void Wavefront::start_paths(int row_index, const CameraRay<T>& r, const I& slot,
                                          const I& pixel_index, const I& s) {
  T row[16] = {r.o.x,
               r.o.y,
               r.o.z,
               r.d.x,
               r.d.y,
               r.d.z,
               T(kUnscattered),
               T(1),
               T(1),
               T(1),
               T(1),
               bits_float(slot),
               bits_float(pixel_index),
               bits_float(s),
               bits_float(I(0)),
               bits_float(I(0))};
  store_rows<T>(rows_ + 16 * row_index, M(true), row);
  if (scene_.environment.columns) {
    SampleStream<T> vertex(as_uint(pixel_index), as_uint(s), job_.settings.seed,
                           job_.settings.sampler == SamplerType::sobol);
    Vec2<T> place = environment_place(vertex, I(1), environment_choice(vertex, I(1)));
    store_pairs(places_ + 2 * row_index, place.x, place.y);
  }
}

void Wavefront::generate(int count) {
  int ring_index = static_cast<int>((tail_ - 1) % kChunkRing);
  ChunkState& c = ring_[ring_index];
  const CameraView& camera = scene_.camera;
  list_samples(c, count);
  float* rays = camera_rays_;
  int first_slot = ring_index * kMaxChunkPaths + c.generated;
  for (int i = 0; i < count; i += W) {
    I x = load_int<T>(pixel_x_ + i), y = load_int<T>(pixel_y_ + i), s = load_int<T>(samples_ + i);
    I pixel_index = y * I(camera.film_width) + x;
    I camera_sample = s;
    if (job_.settings.splits > 1) // sub-paths of one camera sample share its film position
      camera_sample = to_int(floor((to_float(s) + T(0.5f)) * T(1.0f / job_.settings.splits)));
    SampleStream<T> stream(as_uint(pixel_index), as_uint(camera_sample), job_.settings.seed,
                           job_.settings.sampler == SamplerType::sobol);
    Vec2<T> u = stream.pair(U(0));
    T cx = to_float(x) + T(0.5f), cy = to_float(y) + T(0.5f);
    T left = T(float(camera.crop_x)), right = T(float(camera.crop_x + camera.crop_width));
    T top = T(float(camera.crop_y)), bottom = T(float(camera.crop_y + camera.crop_height));
    cx = cx + sample_filter(scene_.filter, u.x, left - cx, right - cx);
    cy = cy + sample_filter(scene_.filter, u.y, top - cy, bottom - cy);
    CameraRay<T> r = camera_ray(camera, cx, cy);
    const T fields[8] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.near, r.far};
    for (int k = 0; k < 8; ++k)
      store(rays + k * kCameraStride + i, fields[k]);
    I slot = I(first_slot + i) + iota<T>();
    start_paths(count_ + i, r, slot, pixel_index, s);
  }
  RayArrays arrays{{rays, rays + kCameraStride, rays + 2 * kCameraStride},
                   {rays + 3 * kCameraStride, rays + 4 * kCameraStride, rays + 5 * kCameraStride},
                   rays + 6 * kCameraStride,
                   rays + 7 * kCameraStride};
  if (job_.record)
    job_.record(job_.user, RayKind::camera, &arrays, count);
  trace_camera(scene_, arrays, count, HitArrays{hits_, distances_}.from(count_));
  float* pixels = radiance_ + 4 * size_t(first_slot);
  for (int i = 0; i < count; ++i) {
    pixels[4 * i] = pixels[4 * i + 1] = pixels[4 * i + 2] = 0;
    pixels[4 * i + 3] = 1;
  }
  c.generated += count;
  count_ += count;
  counters_.paths += count;
  counters_.camera_rays += count;
}

void Wavefront::finish_chunks() {
  while (head_ < tail_) {
    int index = static_cast<int>(head_ % kChunkRing);
    ChunkState& c = ring_[index];
    if (c.generated < c.chunk.paths() || c.alive > 0)
      break;
    job_.finish_chunk(job_.user, &c.chunk, radiance_ + 4 * size_t(index) * kMaxChunkPaths);
    c.open = false;
    ++head_;
  }
}

// --- Tracing and sorting ---

void Wavefront::trace() {
  if (survivors_ == 0)
    return;
  if (job_.record) {
    std::vector<float> arrays(6 * size_t(survivors_)), near(survivors_, 0.0f),
        far(survivors_, __builtin_inff());
    for (int i = 0; i < survivors_; ++i)
      for (int k = 0; k < 6; ++k)
        arrays[k * size_t(survivors_) + i] = rows_[16 * i + k];
    const float* a = arrays.data();
    size_t n = survivors_;
    RayArrays rays{
        {a, a + n, a + 2 * n}, {a + 3 * n, a + 4 * n, a + 5 * n}, near.data(), far.data()};
    job_.record(job_.user, RayKind::closest, &rays, survivors_);
  }
  // A packet may write past the survivors, where the first camera hits lie.
  int tail = min(kLanePadding, count_ - survivors_);
  int32_t codes[kLanePadding];
  float distances[kLanePadding];
  std::memcpy(codes, hits_ + survivors_, 4 * tail);
  std::memcpy(distances, distances_ + survivors_, 4 * tail);
  trace_rows(scene_, rows_, survivors_, {hits_, distances_});
  std::memcpy(hits_ + survivors_, codes, 4 * tail);
  std::memcpy(distances_ + survivors_, distances, 4 * tail);
  counters_.closest_rays += survivors_;
}

/// 0 for a miss, else 1 + the material.
Wavefront::I Wavefront::hit_keys(const I& code) const {
  M quadric = code >= I(kQuadricHit), miss = code == I(kNoHit);
  constexpr int kTriangleWords = sizeof(TriangleRecord) / 4;
  I word = select(quadric | miss, I(0), code * I(kTriangleWords));
  I key = gather_int<T>(&scene_.triangles[0].material, word) + I(1);
  if (any(quadric)) {
    constexpr int kQuadricWords = sizeof(QuadricRecord) / 4;
    word = select(quadric, (code - I(kQuadricHit)) * I(kQuadricWords), I(0));
    key = select(quadric, gather_int<T>(&scene_.quadrics[0].material, word) + I(1), key);
  }
  return select(miss, I(0), key);
}

void Wavefront::sort() {
  // Four sets of counters, one for every fourth path: increments of one counter would wait for each
  // other where neighbours share a material.
  const int keys = scene_.root_count + 1, count = count_;
  std::fill(counters4_.begin(), counters4_.end(), 0);
  int32_t *key4 = keys_, *counters = counters4_.data();
  for (int i = 0; i < count; i += W)
    store(key4 + i, hit_keys(load_int<T>(hits_ + i)) << 2);
  int whole = count & ~3;
  for (int i = 0; i < whole; i += 4)
    for (int k = 0; k < 4; ++k)
      ++counters[key4[i + k] + k];
  for (int i = whole; i < count; ++i)
    ++counters[key4[i] + (i & 3)];
  int32_t position = 0;
  for (int key = 0; key < keys; ++key) {
    begin_[key] = position;
    for (int k = 0; k < 4; ++k) {
      int32_t n = counters[4 * key + k];
      counters[4 * key + k] = position;
      position += n;
    }
  }
  begin_[keys] = position;
  int32_t *order = order_, *codes = codes_;
  const int32_t* hits = hits_;
  auto place = [&](int i, int k) {
    int32_t at = counters[key4[i] + k]++;
    order[at] = i;
    codes[at] = hits[i];
  };
  for (int i = 0; i < whole; i += 4)
    for (int k = 0; k < 4; ++k)
      place(i + k, k);
  for (int i = whole; i < count; ++i)
    place(i, i & 3);
  // What a last group reads beyond the end.
  for (int i = 0; i < kPad; ++i) {
    order[count + i] = order[max(count - 1, 0)];
    codes[count + i] = kNoHit;
  }
}

// --- Lanes of paths ---

void Wavefront::load_paths(const int32_t* order, PathLanes& p) const {
  T w[16];
  load_rows<T>(rows_, 16, order, w);
  p.o = {w[0], w[1], w[2]};
  p.d = {w[3], w[4], w[5]};
  p.pdf = w[6];
  p.eta = w[7];
  p.throughput = Color<T>(w[8], w[9], w[10]);
  p.slot = as_integer(w[11]);
  p.pixel = as_integer(w[12]);
  p.sample = as_integer(w[13]);
  p.depth = as_integer(w[14]);
  p.normal = as_integer(w[15]);
}

void Wavefront::add(const Color<T>& c, const I& slot, M mask) {
  alignas(64) float r[W], g[W], b[W];
  alignas(64) int32_t slots[W];
  store(r, c[0]);
  store(g, c[1]);
  store(b, c[2]);
  store(slots, slot);
  for (uint32_t bits = mask_bits(mask); bits; bits &= bits - 1) {
    int i = __builtin_ctz(bits);
    float* pixel = radiance_ + 4 * size_t(slots[i]);
    pixel[0] += r[i];
    pixel[1] += g[i];
    pixel[2] += b[i];
  }
}

void Wavefront::clear_alpha(const I& slot, M mask) {
  alignas(64) int32_t slots[W];
  store(slots, slot);
  for (uint32_t bits = mask_bits(mask); bits; bits &= bits - 1)
    radiance_[4 * size_t(slots[__builtin_ctz(bits)]) + 3] = 0;
}

void Wavefront::begin_misses(const int32_t* order, int n, Misses& m) const {
  m.active = first_lanes<T>(n);
  load_paths(order, m.path);
  const EnvironmentView& e = scene_.environment;
  if (e.columns == 0)
    return;
  m.spot = environment_spot(e, m.path.d);
  prefetch_cells(m.spot.cell);
}

void Wavefront::shade_misses(const int32_t* order, int n) {
  Misses groups[2]; // while one is shaded, the memory that the next needs is on its way
  begin_misses(order, n, groups[0]);
  for (int i = 0; i < n; i += W) {
    int k = (i / W) & 1;
    if (i + W < n)
      begin_misses(order + i + W, n - i - W, groups[k ^ 1]);
    finish_misses(groups[k]);
  }
}

void Wavefront::finish_misses(const Misses& m) {
  const EnvironmentView& e = scene_.environment;
  const PathLanes& path = m.path;
  M active = m.active;
  M direct =
      active & (job_.settings.alpha_of_hits ? path.depth == I(0) : path.pdf == T(kUnscattered));
  if (job_.settings.alpha_of_hits || !environment_is_seen())
    clear_alpha(path.slot, direct);
  if (!e.present)
    return;
  EnvironmentLight<T> light = e.columns ? environment_light(e, m.spot) : constant_environment<T>(e);
  auto mis = path.pdf > T(0);
  T other = light.pdf * T(e.probability * job_.settings.light_fraction);
  T weight = select(
      mis, power_heuristic(max(path.pdf, T(1e-30f)) * T(job_.settings.bsdf_fraction), other), T(1));
  if (job_.settings.hide_emitters)
    active = active & !direct;
  add(path.throughput * light.radiance * weight, path.slot, active);
}

void Wavefront::prefetch_cells(const I& cells) const {
  alignas(64) int32_t at[W];
  store(at, cells);
  for (int k = 0; k < W; ++k)
    prefetch_once(scene_.environment.cells + at[k]);
}

} // namespace faceta
