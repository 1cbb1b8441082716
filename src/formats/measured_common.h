#pragma once

/// What several readers of measured reflectance need.

#include "bsdf/measured_data.h"
#include "formats/input_text.h"

#include <numbers>
#include <span>

namespace faceta {

inline constexpr double kDegree = std::numbers::pi / 180;

/// The centres of n equal cells between two angles.
std::vector<double> cell_centres(size_t n, double first, double last);

/// How much of each measured wavelength goes into red, green and blue.
using WavelengthWeights = std::vector<std::array<double, 3>>;

/// The weights that turn values at these wavelengths (nm, increasing strictly, at least one),
/// linear in between and constant beyond the ends, into linear sRGB under D65, so that the
/// spectrum 1 becomes (1, 1, 1) exactly; colours outside the gamut get negative components. Or
/// those of one wavelength alone, as grey, if `only` is not negative: Error at `where` if it lies
/// outside.
WavelengthWeights wavelength_weights(const std::vector<double>& wavelengths, double only,
                                     const SourcePosition& where);

/// Error if the options ask for a wavelength, or for one of several materials, of a file that
/// holds the colours of one.
void expect_one_coloured_material(const InputText& input, const MeasuredOptions& options);
/// Error if the options ask for one of several materials of a file that holds one.
void expect_one_material(const InputText& input, const MeasuredOptions& options);

/// Text of a file made fit to be shown: without control characters, at most 1000 bytes, cut at the
/// first NUL.
std::string shown_text(std::string_view text);

/// f_r of a cell, or the mark of a hole, for MeasuredGrid::rgb.
struct CellTally {
  int64_t holes = 0, negative = 0;
  /// Stores a cell: a hole if a value is not finite (as a float); values below zero become 0 and
  /// are counted.
  void store(float* rgb, const std::array<double, 3>& value);
};

/// The angle to the normal of wi or wo, whichever lies lower, that a cell of a half-difference
/// grid has; above pi/2: below the horizon.
struct HalfDifferenceReach {
  double largest_theta = 0; ///< of the cells that are no holes, at most pi/2
  int64_t holes_above = 0;  ///< holes with both directions above the horizon
};
HalfDifferenceReach reach_of(const MeasuredGrid& grid);

} // namespace faceta
