#pragma once

#include "bsdf/measured_data.h"

#include <string>

namespace faceta {

/// Writes tables as an RGL `.bsdf` file of colours that Mitsuba 3 (`measured`) and powitacq read.
/// Error if the tables do not fit together, or as of OutputFile.
void write_rgl(const std::string& path, const RglTables& tables, const std::string& description);

} // namespace faceta
