#pragma once

/// The light BVH: a binary tree over lights with a place, in which the renderer chooses a light by
/// the importance of bounds (Conty Estevez and Kulla, "Importance Sampling of Many Lights with
/// Adaptive Tree Splitting", 2018).

#include "scene/double3.h"
#include "scene/view.h"

#include <vector>

namespace faceta {

/// What a light or a group of them looks like from afar.
struct LightBounds {
  Double3 low{}, high{};
  Double3 axis{0, 0, 1};   ///< unit axis of the cone of surface normals
  double cos_spread = -1;  ///< half angle of that cone; -1: all directions
  double cos_emission = 0; ///< half angle of emission about a normal
  double power = 0;
};

/// The smallest cone found around both, and everything else added up.
LightBounds unite(const LightBounds& a, const LightBounds& b);

struct LightTree {
  /// The way to a light: bit i tells which child is taken at level i (1: the second).
  struct Trail {
    uint32_t bits = 0;
    int32_t depth = 0;
  };
  std::vector<LightNode> nodes; ///< [0] is the root; without lights it has neither child nor light
  std::vector<Trail> trails;    ///< per light; at most 32 levels
};

/// The tree over lights of positive power, by the surface area orientation heuristic.
LightTree build_light_tree(const std::vector<LightBounds>& lights);

} // namespace faceta
