#pragma once

/// Measured reflectance with its faults mended.

#include "bsdf/rgl_tables.h"

namespace faceta {

struct RepairOptions {
  bool symmetrise = true; ///< take the mean of f(a, b) and f(b, a)
  /// Degrees; 0: none. Pairs with a direction that lies lower get the value of the widest pair that
  /// does not, with the same half vector and turned the same way about it.
  double max_theta = 0;
};

struct Repaired {
  Reflectance value;
  std::vector<std::string> notes; ///< what was done
};

/// The reflectance of a file, mended in this order: cells above the surface without a value become
/// the mean of their neighbours in the grid (all holes together: a harmonic function); negative
/// values 0; what lies beyond max_theta is drawn from below it; both directions of light get their
/// mean; and where a viewer gets more light than there is, values are multiplied by s(theta_i)
/// s(theta_o), 1 elsewhere, such that the albedo is 0.99 there. Error if the renderer cannot read
/// the table (`name` is for that), or if max_theta is not between 10 and 90.
Repaired repaired(MeasuredFile file, const std::string& name, const RepairOptions& options);

/// Fills the cells of a grid without a value of directions above the surface; how many.
int64_t fill_holes(MeasuredGrid& grid);

} // namespace faceta
