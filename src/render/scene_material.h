#pragma once

/// One material of a scene over arrays, as the renderer's kernels run it: its tree, its textures.

#include "render/job.h"
#include "scene/scene.h"

namespace faceta {

class SceneMaterial {
public:
  /// Builds the scene for an instruction set; nobody may have built it before.
  /// \param material from Scene::add_material
  /// Error: this processor cannot run the instruction set.
  SceneMaterial(std::unique_ptr<Scene> scene, int material, Isa isa);

  /// Both may be called from several threads at once. Arrays hold n + kLanePadding values.
  void eval(const EvalArrays& arrays, int n, TransportMode mode) const;
  void sample(const SampleArrays& arrays, int n, TransportMode mode) const;

private:
  std::unique_ptr<Scene> scene_;
  const RenderKernels* kernels_;
  int root_ = 0;
};

} // namespace faceta
