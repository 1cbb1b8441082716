#pragma once

/// Embree's tree over a scene: geometry 0 holds all triangles, geometry 1 all quadrics.

#include "scene/geometry.h"

#include <atomic>

struct RTCDeviceTy;

namespace faceta {

class Accelerator {
public:
  Accelerator() = default;
  ~Accelerator();
  Accelerator(const Accelerator&) = delete;
  Accelerator& operator=(const Accelerator&) = delete;

  /// Builds the tree. It refers to the arrays of `geometry` from then on, which must stay as they
  /// are; only the positions and indices grow by some padding. Throws Error if Embree cannot.
  void build(SceneGeometry& geometry);
  RTCSceneTy* scene() const { return scene_; }
  /// What Embree has allocated.
  size_t bytes() const { return static_cast<size_t>(bytes_.load()); }

private:
  void check(const char* what) const;
  void attach_triangles(SceneGeometry& geometry);
  void attach_quadrics(SceneGeometry& geometry);

  RTCDeviceTy* device_ = nullptr;
  RTCSceneTy* scene_ = nullptr;
  std::atomic<int64_t> bytes_{0};
};

} // namespace faceta
