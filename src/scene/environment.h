#pragma once

/// Light from infinity: cells and alias tables for the kernels.

#include "base/huge_vector.h"
#include "scene/scene.h"

namespace faceta {

/// The alias method (Walker 1977; Vose 1991): keep entry i with probability threshold[i], else take
/// alias[i]. Weights must be 0 or more; if all are 0, every entry is equally likely.
struct AliasTable {
  std::vector<float> threshold;
  std::vector<int32_t> alias;
};
AliasTable make_alias_table(const std::vector<double>& weights);

/// An environment image is looked up as in Mitsuba 3.9.1: texels bilinear, columns centred at
/// (i + 1/2) / width and wrapped around, rows from pole to pole, the first at v = 0 and the last at
/// v = 1. The half texel is put into the rotations, so that cells start at u = 0.
class EnvironmentTables {
public:
  /// Throws Error for images smaller than 2 x 3, values that are not finite, a to_world that is not
  /// a rotation, mirroring or uniform scale (which is without effect).
  explicit EnvironmentTables(const EnvironmentDesc& desc);

  /// Without the fields that concern the rest of the scene: probability, center, scene_radius.
  EnvironmentView view() const;
  bool black() const { return black_; }
  size_t bytes() const;

private:
  void set_rotations(const ToWorld& to_world, int width);
  void add_image(const Image& image);
  void add_leaves(const std::vector<double>& weights, double total);

  EnvironmentView view_{};
  bool black_ = true;
  HugeVector<EnvironmentCell> cells_;
  HugeVector<EnvironmentLeaf> leaves_;
};

} // namespace faceta
