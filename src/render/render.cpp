#include "render/render.h"

#include "spectrum/cie.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace faceta {

namespace {

using Clock = std::chrono::steady_clock;

/// Flushes denormals to zero while it lives: they cost a hundred times and carry no light.
class FlushDenormals {
public:
#if defined(__SSE__)
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040); }
  ~FlushDenormals() { _mm_setcsr(saved_); }

private:
  unsigned saved_;
#endif
};

struct Tile {
  int x, y, width, height;
};

std::vector<Tile> make_tiles(int width, int height, int side) {
  std::vector<Tile> tiles;
  for (int y = 0; y < height; y += side)
    for (int x = 0; x < width; x += side)
      tiles.push_back({x, y, std::min(side, width - x), std::min(side, height - y)});
  return tiles;
}

/// What the threads share during one pass.
struct Pass {
  const std::vector<Tile>& tiles;
  int first, last; ///< samples, sub-samples included
  std::atomic<size_t> next_tile{0};
  std::atomic<uint64_t>& done_paths;
};

/// One thread: hands chunks of its tiles to the kernels and sums what comes back.
struct Worker {
  Pass& pass;
  Film& film;
  int splits;
  RayRecord* record;
  std::optional<Tile> tile{};
  int sample = 0;
  uint64_t non_finite = 0;

  bool next(Chunk& chunk) {
    if (!tile || sample == pass.last) {
      size_t i = pass.next_tile++;
      if (i >= pass.tiles.size())
        return false;
      tile = pass.tiles[i];
      sample = pass.first;
    }
    int per_chunk =
        std::max(splits, kMaxChunkPaths / (tile->width * tile->height) / splits * splits);
    int samples = std::min(per_chunk, pass.last - sample);
    chunk = {tile->x, tile->y, tile->width, tile->height, sample, samples};
    sample += samples;
    return true;
  }

  void finish(const Chunk& chunk, const float* rgba) {
    for (int p = 0; p < chunk.width * chunk.height; ++p) {
      int x = chunk.x + p % chunk.width, y = chunk.y + p / chunk.width;
      size_t pixel = size_t(y) * film.width + x;
      double* sum = &film.sums[4 * pixel];
      double* square = &film.squares[3 * pixel];
      double* xyz_square = film.xyz_squares.empty() ? nullptr : &film.xyz_squares[3 * pixel];
      // Kept apart from the film while samples are added: writing to it waits for each.
      PixelSums sums;
      std::copy_n(sum, 4, sums.sum);
      std::copy_n(square, 3, sums.square);
      for (int s = 0; s < chunk.samples; s += splits)
        add_sample(rgba + 4 * (size_t(p) * chunk.samples + s), sums, xyz_square);
      std::copy_n(sums.sum, 4, sum);
      std::copy_n(sums.square, 3, square);
    }
    pass.done_paths += chunk.paths();
  }

  struct PixelSums {
    double sum[4], square[3];
  };

  void add_sample(const float* rgba, PixelSums& sums, double* xyz_square) {
    double c[4] = {rgba[0], rgba[1], rgba[2], rgba[3]};
    if (splits > 1) {
      for (int j = 1; j < splits; ++j)
        for (int k = 0; k < 4; ++k)
          c[k] += rgba[4 * j + k];
      double share = 1.0 / splits;
      for (double& v : c)
        v *= share;
    }
    if (!std::isfinite(c[0] + c[1] + c[2])) {
      ++non_finite;
      c[0] = c[1] = c[2] = 0;
    }
    for (int k = 0; k < 4; ++k)
      sums.sum[k] += c[k];
    for (int k = 0; k < 3; ++k)
      sums.square[k] += c[k] * c[k];
    if (xyz_square) {
      std::array<double, 3> xyz = srgb_to_xyz({c[0], c[1], c[2]});
      for (int k = 0; k < 3; ++k)
        xyz_square[k] += xyz[k] * xyz[k];
    }
  }
};

void append_rays(RayRecord& record, RayKind kind, const RayArrays& rays, int count) {
  record.batches.push_back({kind, record.rays.size() / 8, size_t(count)});
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k)
      record.rays.push_back(rays.origin[k][i]);
    for (int k = 0; k < 3; ++k)
      record.rays.push_back(rays.direction[k][i]);
    record.rays.push_back(rays.near[i]);
    record.rays.push_back(rays.far[i]);
  }
}

RenderJob make_job(const Scene& scene, const RenderSettings& settings, Worker& worker) {
  RenderJob job{};
  job.scene = &scene.view();
  job.settings = settings;
  job.user = &worker;
  job.next_chunk = [](void* user, Chunk* chunk) {
    return static_cast<Worker*>(user)->next(*chunk);
  };
  job.finish_chunk = [](void* user, const Chunk* chunk, const float* rgba) {
    static_cast<Worker*>(user)->finish(*chunk, rgba);
  };
  if (worker.record)
    job.record = [](void* user, RayKind kind, const RayArrays* rays, int count) {
      append_rays(*static_cast<Worker*>(user)->record, kind, *rays, count);
    };
  return job;
}

void add_counters(RenderCounters& a, const RenderCounters& b) {
  a.paths += b.paths;
  a.camera_rays += b.camera_rays;
  a.closest_rays += b.closest_rays;
  a.shadow_rays += b.shadow_rays;
  a.vertices += b.vertices;
  a.groups += b.groups;
}

uint64_t rays_of(const RenderCounters& c) {
  return c.camera_rays + c.closest_rays + c.shadow_rays;
}

/// Calls work(0) ... work(threads - 1), each on a thread of its own, and waits for them.
void run_on_threads(int threads, const std::function<void(int)>& work) {
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i)
    pool.emplace_back(work, i);
  work(0);
  for (std::thread& t : pool)
    t.join();
}

/// Calls back about four times a second until destroyed.
class ProgressThread {
public:
  ProgressThread(const RenderOptions& options, std::function<Progress()> now) {
    if (options.progress)
      thread_ = std::thread([this, &options, now = std::move(now)] {
        std::unique_lock lock(mutex_);
        while (!wake_.wait_for(lock, std::chrono::milliseconds(250), [this] { return done_; }))
          options.progress(now());
      });
  }
  ~ProgressThread() {
    {
      std::lock_guard lock(mutex_);
      done_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable())
      thread_.join();
  }

private:
  std::mutex mutex_;
  std::condition_variable wake_;
  bool done_ = false;
  std::thread thread_;
};

const RenderKernels& kernels_of(Isa isa) {
  const RenderKernels* kernels = Registry::global().render_kernels(isa);
  if (!kernels)
    throw Error(std::string("this processor cannot run the instruction set '") +
                    kIsaNames[static_cast<int>(isa)] + "'",
                {}, "use --isa scalar or the default");
  return *kernels;
}

Film make_film(const CameraView& camera, bool moments) {
  Film film;
  film.width = camera.crop_width;
  film.height = camera.crop_height;
  size_t pixels = size_t(film.width) * film.height;
  film.sums.assign(4 * pixels, 0.0);
  film.squares.assign(3 * pixels, 0.0);
  if (moments)
    film.xyz_squares.assign(3 * pixels, 0.0);
  return film;
}

/// Pixels along the edge of a tile, of which one sample fits into a chunk.
int tile_side(const RenderOptions& options, size_t pixels, int threads) {
  int splits = options.settings.splits;
  if (splits > kMaxChunkPaths)
    throw Error("more than " + std::to_string(kMaxChunkPaths) + " shading samples");
  int side =
      options.tile > 0 ? std::min(options.tile, 32) : (pixels >= size_t(threads) * 16384 ? 16 : 8);
  while (side > 1 && side * side * splits > kMaxChunkPaths)
    side /= 2;
  return side;
}

Image film_image(const Film& film, std::vector<std::string> channels,
                 const std::function<void(size_t, float*)>& pixel) {
  Image image;
  image.width = film.width;
  image.height = film.height;
  image.channels = std::move(channels);
  size_t n = image.channels.size();
  image.data.resize(size_t(film.width) * film.height * n);
  for (size_t i = 0; i < size_t(film.width) * film.height; ++i)
    pixel(i, &image.data[n * i]);
  return image;
}

} // namespace

Image Film::image() const {
  double scale = samples ? 1.0 / double(samples) : 0;
  return film_image(*this, {"R", "G", "B", "A"}, [&](size_t i, float* out) {
    for (int k = 0; k < 4; ++k)
      out[k] = static_cast<float>(sums[4 * i + k] * scale);
  });
}

Image Film::variance() const {
  double n = double(samples);
  return film_image(*this, {"R", "G", "B"}, [&](size_t i, float* out) {
    for (int k = 0; k < 3; ++k) {
      double mean = n > 0 ? sums[4 * i + k] / n : 0;
      double second = n > 0 ? squares[3 * i + k] / n : 0;
      out[k] = n > 1 ? static_cast<float>(std::max(0.0, second - mean * mean) / (n - 1)) : 0.0f;
    }
  });
}

RenderSettings render_settings(const IntegratorDesc& integrator, const SamplerDesc& sampler) {
  RenderSettings s;
  s.sampler = sampler.type == "independent" ? SamplerType::independent : SamplerType::sobol;
  s.seed = sampler.seed;
  s.max_depth = integrator.max_depth;
  s.rr_depth = integrator.rr_depth;
  s.hide_emitters = integrator.hide_emitters;
  if (integrator.type == "direct") {
    s.alpha_of_hits = 1;
    s.max_depth = 2;
    s.rr_depth = 1 << 30;
    s.light_splits = integrator.emitter_samples;
    s.bsdf_splits = integrator.bsdf_samples;
    s.splits = std::max({1, s.light_splits, s.bsdf_splits});
    // Multi-sample MIS (Veach 1997): densities are weighed by the number of samples of a strategy.
    s.light_fraction = float(s.light_splits);
    s.bsdf_fraction = float(s.bsdf_splits);
    s.light_scale = s.light_splits ? float(s.splits) / float(s.light_splits) : 0.0f;
    s.bsdf_scale = s.bsdf_splits ? float(s.splits) / float(s.bsdf_splits) : 0.0f;
  }
  return s;
}

RenderResult render(const Scene& scene, const RenderOptions& options) {
  const SceneView& view = scene.view();
  const RenderKernels& kernels = kernels_of(options.isa);
  RenderResult result;
  Film& film = result.film;
  film = make_film(view.camera, options.moments);
  size_t pixels = size_t(film.width) * film.height;
  int threads =
      options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  int splits = options.settings.splits;
  std::vector<Tile> tiles =
      make_tiles(film.width, film.height, tile_side(options, pixels, threads));
  // Passes of about four million paths: what Ctrl-C waits for.
  int64_t pass_samples =
      std::clamp<int64_t>((int64_t(1) << 22) / int64_t(pixels * splits), 1, options.spp);
  if (options.record)
    options.record->assign(threads, {});

  Clock::time_point start = Clock::now();
  auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  std::atomic<uint64_t> done_paths{0};
  std::mutex merge;
  double total_paths = double(pixels) * splits * options.spp;
  {
    ProgressThread progress(options, [&] {
      Progress p;
      p.seconds = elapsed();
      p.total_samples = options.spp;
      p.fraction = double(done_paths) / total_paths;
      p.samples = static_cast<int64_t>(p.fraction * options.spp);
      std::lock_guard lock(merge);
      p.rays = rays_of(result.counters);
      return p;
    });
    while (film.samples < options.spp) {
      int last = static_cast<int>(std::min<int64_t>(film.samples + pass_samples, options.spp));
      Pass pass{tiles, static_cast<int>(film.samples) * splits, last * splits, {}, done_paths};
      auto work = [&](int index) {
        FlushDenormals flush;
        Worker worker{pass, film, splits, options.record ? &(*options.record)[index] : nullptr};
        RenderCounters counters;
        kernels.run(make_job(scene, options.settings, worker), counters);
        std::lock_guard lock(merge);
        add_counters(result.counters, counters);
        film.non_finite += worker.non_finite;
      };
      run_on_threads(threads, work);
      film.samples = last;
      bool late = options.timeout >= 0 && elapsed() > options.timeout;
      if ((late || (options.stop && *options.stop)) && film.samples < options.spp) {
        result.stopped = true;
        break;
      }
    }
  }
  result.seconds = elapsed();
  if (options.progress)
    options.progress({result.seconds, film.samples, options.spp, 1.0, rays_of(result.counters)});
  return result;
}

} // namespace faceta
