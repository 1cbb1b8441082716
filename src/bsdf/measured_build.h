#pragma once

/// Makes the block of numbers that the renderer reads (measured_table.h) of what a file holds.

#include "base/huge_vector.h"
#include "bsdf/measured_data.h"

#include <functional>

namespace faceta {

/// How finely the warps of a table are resolved; the defaults are what files get.
struct MeasuredResolution {
  int normals = 128;  ///< nodes a side of the visible normals' square, isotropic
  int luminance = 32; ///< of luminance
  int azimuths = 16;  ///< viewers around, of anisotropic tables, whose squares have half the nodes
  int subsamples = 3; ///< points a cell of luminance and side
  double cosine = 0.05; ///< share of cosine-weighted directions
};

/// The block of a table. Error if sizes or values contradict what the structs promise.
HugeVector<float> measured_block(const MeasuredGrid& grid, const MeasuredResolution& = {});
HugeVector<float> measured_block(const RglTables& tables);

/// Normals of a surface from what it reflects back to the light: the dominant eigenvector of
/// f(o, o) cos o max(0, o.h) (Dupuy et al. 2015), at the inclinations ((k + 0.5) / n)^2 pi / 2,
/// where retro[k] is f(o, o) cos o. Scaled so that its projected area is one.
std::vector<double> normals_of_retroreflection(const std::vector<double>& retro);

} // namespace faceta
