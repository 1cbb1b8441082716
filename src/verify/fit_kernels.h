#pragma once

/// The models' own templates, evaluated for many rows at once with derivatives with respect to
/// their parameters.

#include "bsdf/registry.h"
#include "verify/fit_data.h"

namespace faceta {

/// Evaluates a model for rows: values[3 i + c] = f_r cos theta_i of channel c; and, unless
/// `derivatives` is null, derivatives[(3 i + c) n + k] with respect to slot active[k] of n. `slots`
/// override the record's in double precision; tables stay as the record has them.
using FitKernel = void (*)(const Record& record, const std::vector<double>& slots,
                           const std::vector<int>& active, std::span<const FitRow> rows,
                           double* values, double* derivatives);

/// Null if the model is not one of those that can be fitted.
FitKernel find_fit_kernel(const std::string& model);

} // namespace faceta
