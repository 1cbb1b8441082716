#pragma once

#include "bsdf/measured_data.h"
#include "formats/input_text.h"

namespace faceta {

/// MERL (Matusik et al. 2003), `.binary`: int32 sizes of theta_h, theta_d and phi_d, then float64
/// planes red, green, blue, in units of 1/1500, 1.15/1500 and 1.66/1500. Sizes other than 90, 90,
/// 180 are read if the file is as long as they say. A cell with a value below zero or not finite in
/// any channel is a hole. MeasuredOptions::merl_nodes says where in a cell its value sits.
bool is_merl(std::string_view bytes);
MeasuredFile read_merl(const InputText& input, const MeasuredOptions& options);

/// Writes a grid of 90 x 90 x 180 half-difference cells, holes as -1. Error if it is another grid,
/// or as of OutputFile. Where its nodes lie is not written: see MeasuredOptions::merl_nodes.
void write_merl(const std::string& path, const MeasuredGrid& grid);

} // namespace faceta
