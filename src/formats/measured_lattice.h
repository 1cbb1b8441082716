#pragma once

/// Measurements that lie on a full grid of angles.

#include "bsdf/measured_data.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace faceta {

/// A grid with the very angles that were measured.
struct MeasuredLattice {
  MeasuredGrid grid;
  int64_t holes = 0;    ///< combinations of its angles that nobody measured
  int64_t repeated = 0; ///< rows beyond the first of the same angles; the mean was taken
};

/// A row: the angles in the order of the axes, unused ones 0.
struct LatticeRow {
  std::array<double, 4> angles;
  std::array<double, 3> rgb;
};

/// The grid that the rows lie on, if there is one: at least three quarters of all combinations of
/// the angles occur (angles closer than 1e-5 are one), there are no more than 4096 of an axis, and
/// at least two polar angles and three azimuths of each kind. Azimuths may have any range; those of
/// `relative` grids within one half turn become a grid folded into [0, pi]. Where wi or wo is the
/// normal, one azimuth stands for all. `declared`: the file says that it holds a grid, any number
/// of angles makes one.
std::optional<MeasuredLattice> lattice_from_rows(MeasuredCoordinates coordinates,
                                                 std::vector<LatticeRow> rows,
                                                 bool declared = false);

/// The same for directions: `relative` if isotropic, else relative_rotated or absolute.
std::optional<MeasuredLattice> lattice_from_samples(std::span<const MeasuredSample> samples,
                                                    bool isotropic);

/// "9 x 10 x 37 (theta_i, theta_o, dphi)".
std::string describe_lattice(const MeasuredGrid& grid);

} // namespace faceta
