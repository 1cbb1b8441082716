#pragma once

/// What Embree alone takes for the rays of a render: they are recorded, packed beforehand and
/// handed to Embree in the order of the render, in the packets that suit it best.

#include "render/render.h"

#include <array>
#include <cstdint>
#include <vector>

namespace faceta::bench {

inline constexpr int kRayKinds = 3; ///< RayKind: camera, closest, shadow

class Replay {
public:
  /// The records, one a thread, must outlive it.
  Replay(const SceneView& scene, const std::vector<RayRecord>& records);

  /// Prepares the rays in packets of 1, 8 or 16, by kind. Camera rays are traced as coherent.
  void pack(const std::array<int, kRayKinds>& widths);
  const std::array<int, kRayKinds>& widths() const { return widths_; }

  /// Traces all rays.
  void run() const;
  /// The same with a clock: processor seconds by kind.
  std::array<double, kRayKinds> run_by_kind() const;
  /// Rays that hit something, by kind: the same for every packing.
  std::array<uint64_t, kRayKinds> hits() const;
  std::array<uint64_t, kRayKinds> rays() const;

private:
  struct Batch {
    RayKind kind;
    size_t offset; ///< into packed_
    size_t count;
  };

  const SceneView& scene_;
  const std::vector<RayRecord>& records_;
  std::array<int, kRayKinds> widths_{};
  std::vector<float> packed_; ///< packets: origin, direction, near, far, each for all its rays
  std::vector<Batch> batches_;
};

} // namespace faceta::bench
