#pragma once

/// Makes the block of numbers that the renderer reads (measured_table.h) of what a file holds.

#include "base/huge_vector.h"
#include "bsdf/measured_data.h"

#include <functional>

namespace faceta {

/// The block of a table. Error if sizes or values contradict what the structs promise.
HugeVector<float> measured_block(const MeasuredGrid& grid);
HugeVector<float> measured_block(const RglTables& tables);

/// The same for what transmits or is constant over cells (measured_cells.h). Error if it would not
/// fit: more than 1 GiB, or trees of more than 16 levels, 2^24 branches or 2^24 values.
HugeVector<float> measured_block(const MeasuredPatches& patches);
HugeVector<float> measured_block(const MeasuredTree& tree);

/// The block of whatever a file holds.
HugeVector<float> measured_block(const MeasuredFile& file);

/// Normals of a surface from what it reflects back to the light: the dominant eigenvector of
/// f(o, o) cos o max(0, o.h) (Dupuy et al. 2015), at the inclinations ((k + 0.5) / n)^2 pi / 2,
/// where retro[k] is f(o, o) cos o. Scaled so that its projected area is one.
std::vector<double> normals_of_retroreflection(const std::vector<double>& retro);

} // namespace faceta
