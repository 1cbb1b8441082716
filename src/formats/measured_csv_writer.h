#pragma once

#include "bsdf/measured_data.h"

namespace faceta {

/// Writes a grid of relative or absolute coordinates as a table of text, a line for each pair of
/// directions that has a value: theta_i,phi_i,theta_o,phi_o,r,g,b in degrees and 1/sr; light of
/// relative coordinates comes from azimuth 0. Error for other coordinates, or as of OutputFile.
void write_measured_csv(const std::string& path, const MeasuredGrid& grid);

} // namespace faceta
