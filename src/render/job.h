#pragma once

/// The interface between the render driver and the wavefront kernels of an instruction set.

#include "scene/view.h"

namespace faceta {

enum class SamplerType : int32_t { independent, sobol };

struct RenderSettings {
  SamplerType sampler = SamplerType::sobol;
  uint32_t seed = 0;
  int32_t max_depth = -1; ///< 1: emitters only, 2: direct light ...; -1: unlimited
  int32_t rr_depth = 5;
  int32_t hide_emitters = 0;
  /// Where alpha is 1: wherever a camera ray meets a surface (direct); or where paths meet more
  /// than null surfaces, or the environment is seen (path).
  int32_t alpha_of_hits = 0;
  /// The strategies of the direct integrator, relative to one another; both 1 for path.
  float light_fraction = 1, bsdf_fraction = 1;
  /// direct: shading samples a camera sample; of these, so many choose a light and a direction.
  int32_t splits = 1, light_splits = 1, bsdf_splits = 1;
  /// splits / light_splits and splits / bsdf_splits: a strategy that runs in few of the averaged
  /// sub-paths counts more in each.
  float light_scale = 1, bsdf_scale = 1;
};

/// Pixels [x, x + width) x [y, y + height) of the crop window, samples [first, first + samples).
/// Path k of a chunk is sample k % samples of pixel k / samples, row by row.
struct Chunk {
  int32_t x, y, width, height;
  int32_t first, samples;
  int32_t paths() const { return width * height * samples; }
};

inline constexpr int kChunkShift = 12, kMaxChunkPaths = 1 << kChunkShift;

enum class RayKind : int32_t { camera, closest, shadow };

/// Rays as structure of arrays, for recording.
struct RayArrays {
  const float *origin[3], *direction[3], *near, *far;
};

struct RenderJob {
  const SceneView* scene;
  RenderSettings settings;
  void* user;
  /// The next chunk for this thread; false: no more.
  bool (*next_chunk)(void* user, Chunk* chunk);
  /// Called in the order of next_chunk: R, G, B, alpha of each path.
  void (*finish_chunk)(void* user, const Chunk* chunk, const float* rgba);
  /// Null, or called with every batch of rays before it is traced.
  void (*record)(void* user, RayKind kind, const RayArrays* rays, int count);
};

struct RenderCounters {
  uint64_t paths = 0, camera_rays = 0, closest_rays = 0, shadow_rays = 0, vertices = 0;
  uint64_t groups = 0; ///< shaded groups of lanes: vertices / (groups * width) is the lane use
};

/// What an instruction set offers.
struct RenderKernels {
  int32_t lane_width;
  /// Renders until next_chunk says no; allocates its pools once at the start.
  void (*run)(const RenderJob& job, RenderCounters& counters);
  /// One root material, its tree and textures, over arrays; `eval` or `sample` may be null.
  void (*scatter)(const SceneView& scene, int32_t root, int32_t importance, const EvalArrays* eval,
                  const SampleArrays* sample, int n);
};

} // namespace faceta
