#pragma once

/// Rendering a scene: threads, tiles, passes, the film, progress and recording.

#include "render/job.h"
#include "scene/scene.h"

#include <atomic>
#include <functional>
#include <optional>

namespace faceta {

/// Sums per pixel of the crop window, row by row. Each pixel sums its own samples in double and in
/// order, so that the bits depend on scene, seed and samples alone.
struct Film {
  int width = 0, height = 0;
  int64_t samples = 0;             ///< per pixel
  std::vector<double> sums;        ///< R, G, B, alpha a pixel
  std::vector<double> squares;     ///< of R, G, B a pixel
  std::vector<double> xyz_squares; ///< of X, Y, Z a pixel; empty unless asked for
  uint64_t non_finite = 0;         ///< samples that were infinite or no number, added as 0

  /// The mean as R, G, B, A.
  Image image() const;
  /// The variance of the mean as R, G, B (needs two samples).
  Image variance() const;
};

struct Progress {
  double seconds = 0;
  int64_t samples = 0, total_samples = 0; ///< per pixel
  double fraction = 0;                    ///< of the whole render
  uint64_t rays = 0;
};

/// The rays of a render in the order they were traced, for measuring what tracing alone costs.
struct RayRecord {
  struct Batch {
    RayKind kind;
    size_t first, count;
  };
  std::vector<float> rays; ///< origin, direction, near, far: 8 a ray
  std::vector<Batch> batches;
};

struct RenderOptions {
  int spp = 16;
  RenderSettings settings;
  int threads = 0; ///< 0: all processors
  Isa isa = best_isa();
  double timeout = -1;  ///< seconds after which the pass is finished and no other begun; < 0: none
  bool moments = false; ///< fill Film::xyz_squares
  int tile = 0;         ///< pixels a side; 0: chosen. Any value gives the same picture.
  std::function<void(const Progress&)> progress; ///< about four times a second
  const std::atomic<bool>* stop = nullptr;       ///< finish the pass, then return
  std::vector<RayRecord>* record = nullptr;      ///< filled with one record a thread
};

struct RenderResult {
  Film film;
  RenderCounters counters;
  double seconds = 0;
  bool stopped = false; ///< before all samples were done
};

/// Renders the sensor that the scene's view() shows. The scene must have been built for `isa`.
RenderResult render(const Scene& scene, const RenderOptions& options);

/// Kernel settings from what the scene file says.
RenderSettings render_settings(const IntegratorDesc& integrator, const SamplerDesc& sampler);

} // namespace faceta
