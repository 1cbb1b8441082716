#pragma once

#include "bsdf/columns.h"

namespace faceta {

/// Adds value_r, value_g, value_b (including |cos theta_i|) and pdf to every line of a CSV table
/// with the columns wo_x, wo_y, wo_z, wi_x, wi_y, wi_z and optionally u, v (0.5). Directions are
/// unit vectors in the local frame, taken as they are; a length further from 1 than 1e-3 is an
/// Error. Files and their errors: transform_csv(); other columns stay as they are.
void eval_table(const ColumnMaterial& material, const std::string& source,
                const std::string& target);

/// Adds wi_x, wi_y, wi_z, weight_r, weight_g, weight_b, pdf, lobe (reflection | transmission |
/// null) and delta (0 | 1) to every line of a CSV table with the columns wo_x, wo_y, wo_z, u1, u2,
/// uc and optionally u, v (0.5). The pdf of a delta is its discrete probability. A failed sample
/// has the lobe none and zeros everywhere else. u1, u2 and uc lie in [0, 1]; what rounds to 1 is
/// taken as the largest float below.
void sample_table(const ColumnMaterial& material, const std::string& source,
                  const std::string& target);

} // namespace faceta
