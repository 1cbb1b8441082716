#pragma once

/// Writes reflectance, of whatever kind, in the formats that programs for measured materials read.

#include "bsdf/rgl_tables.h"

#include <optional>
#include <string>

namespace faceta {

enum class MeasuredTarget { rgl, merl, csv };

/// By the ending: .bsdf, .binary or .csv; nothing for others.
std::optional<MeasuredTarget> measured_target(const std::string& path);

struct ConvertOptions {
  MeasuredTarget target = MeasuredTarget::rgl;
  /// rgl: texels a side of the values (nothing: as many as they need). csv: degrees between angles
  /// (nothing: 5, or 10 where the surface is not isotropic). merl: must be nothing.
  std::optional<double> resolution{};
  std::string description{}; ///< of rgl
};

/// How good a written file is.
struct Conversion {
  /// Albedos of a viewer at an inclination; of surfaces that are not isotropic at azimuth 0.3.
  struct Row {
    double theta = 0; ///< degrees
    std::array<double, 3> source{}, result{};
    double error = 0; ///< relative, of the worst channel
  };
  std::string resolution;
  std::vector<Row> rows;
  double error = 0; ///< the largest up to 80 degrees
  std::vector<std::string> notes;
};

/// Writes a file and compares it with its source. Error if the format cannot hold it (MERL: a
/// surface that is not isotropic), if the resolution makes no sense, or as of OutputFile.
///
/// Of MERL each cell has the value at its centre, the mean of both directions of light; of CSV
/// each row has f_r of its angles.
Conversion write_reflectance(const std::string& path, const Reflectance& f,
                             const ConvertOptions& options);

/// The mean of f_r(wo, wi) and f_r(wi, wo).
Reflectance symmetrised(Reflectance f);

} // namespace faceta
