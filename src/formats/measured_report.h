#pragma once

/// What is told of measured reflectance, for people and for programs (one JSON object each).

#include "formats/measured_audit.h"
#include "formats/measured_convert.h"

namespace faceta {

/// What is in a file, and its audit.
std::string measured_text(const std::string& name, const MeasuredInfo& info,
                          const MeasuredAudit& audit);
std::string measured_json(const std::string& name, const MeasuredInfo& info,
                          const MeasuredAudit& audit);

/// What was written to a file.
std::string conversion_text(const std::string& path, const Conversion& made);
std::string conversion_json(const std::string& path, const Conversion& made);

} // namespace faceta
