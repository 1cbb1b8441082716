#pragma once

// What the render kernels do with a scene's records, written once more in double precision.

#include "scene/scene.h"

#include <embree3/rtcore.h>

namespace test {

using faceta::Double3;

inline Double3 load(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

struct Hit {
  int geometry = -1, primitive = -1;
  double t = 0;
};
/// The nearest hit by Embree; packet: 1 or 8 equal rays.
Hit trace(const faceta::SceneView& view, const Double3& o, const Double3& d, int packet = 1);
bool occluded(const faceta::SceneView& view, const Double3& o, const Double3& d, double far);

/// The surface point of a hit (dp_du and dp_dv are not known of quadrics).
faceta::SurfacePoint surface(const faceta::SceneView& view, const Hit& hit, const Double3& o,
                             const Double3& d);

} // namespace test
