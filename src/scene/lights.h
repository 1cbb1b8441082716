#pragma once

/// The lights with a place, and the tree that chooses among them.

#include "scene/geometry.h"
#include "scene/light_bvh.h"
#include "scene/scene.h"

namespace faceta {

class LightStore {
public:
  /// Radiance as the kernels and the choice of lights see it.
  struct Emission {
    std::array<double, 3> radiance{}; ///< or intensity; a factor on the texture
    int texture = -1;
    double brightness = 0; ///< mean luminance, the texture counted in
    double sampling_weight = 1;
  };

  /// Each of these appends a light and returns its number; final_light() turns that into its place
  /// in records(). Lights without power and uneven tubes are never
  /// chosen, but shine when met by chance.
  int add_triangle(const TriangleRecord& triangle, int primitive, const Emission& emission);
  /// The parallelogram with corner v0 and edges e1, e2 of the triangle, which must be orthogonal.
  int add_rectangle(const TriangleRecord& triangle, int primitive, const Emission& emission);
  int add_sphere(const Sphere& sphere, int primitive, const Emission& emission);
  int add_disk(const Disk& disk, const Box& box, int primitive, const Emission& emission);
  int add_cylinder(const Cylinder& cylinder, const Box& box, int primitive,
                   const Emission& emission);
  int add_point(const Double3& position, const Emission& intensity);

  /// Sorts the lights that can be chosen to the front and builds the tree.
  void build();
  int final_light(int light) const { return order_[light]; }
  int count() const { return static_cast<int>(records_.size()); }
  /// How many lights can be chosen, and the mean of their sampling weights, weighted by power.
  int chosen() const { return chosen_; }
  double mean_weight() const;

  const std::vector<LightRecord>& records() const { return records_; }
  const std::vector<LightNode>& nodes() const { return tree_.nodes; }
  size_t bytes() const;

private:
  int add(LightRecord record, LightBounds bounds, const Emission& emission, double flux_factor);
  int add_flat(LightType type, const TriangleRecord& triangle, int primitive,
               const Emission& emission);

  std::vector<LightRecord> records_;
  std::vector<LightBounds> bounds_; ///< power times sampling weight; 0: never chosen
  std::vector<int> order_;
  LightTree tree_;
  int chosen_ = 0;
  double power_ = 0, weighted_power_ = 0;
};

} // namespace faceta
