#pragma once

/// How sound measured reflectance is, in figures.

#include "bsdf/measured_data.h"

namespace faceta {

struct MeasuredAudit {
  /// What a viewer at an inclination gets, by 4096 of the renderer's own samples; of surfaces that
  /// are not isotropic, from four azimuths.
  struct Angle {
    double theta = 0;               ///< degrees
    std::array<double, 3> albedo{}; ///< mean over the azimuths
    double largest = 0;             ///< albedo of any channel and azimuth
    double variation = 0;           ///< standard deviation of the samples' luminance over its mean
  };
  /// f(a, b) against f(b, a), luminance, over 4096 pairs of directions spread evenly over solid
  /// angle up to 80 degrees.
  struct Reciprocity {
    double mean = 0;     ///< of |ln f(a, b) / f(b, a)|, which counts as 5 where one of them is 0
    double largest = 0;  ///< of that
    double relative = 0; ///< sum of |f(a, b) - f(b, a)| cos a cos b over that of the larger one
  };

  int64_t cells = 0;
  int64_t holes = 0;             ///< cells without a value, both of whose directions are above
  int64_t below = 0;             ///< cells without a value for directions below the surface
  int64_t negative = 0;          ///< values below zero
  double out_of_gamut = 0;       ///< share of the texels of an RGL table with a negative channel
  double largest_theta = 0;      ///< degrees; what lies beyond is not measured; 0: not known
  double smallest = 0, most = 0; ///< f_r > 0, luminance, over all directions looked at
  Reciprocity reciprocity;
  std::vector<Angle> angles;

  /// A verdict on one of these things.
  struct Finding {
    bool good = true;
    std::string text;
    std::string advice{}; ///< what to do about it
  };
  std::vector<Finding> findings;
  /// Whether every finding is good.
  bool clean() const;
};

/// Error if the renderer cannot read the table. `name` is for that.
MeasuredAudit audit_measured(const MeasuredFile& file, const std::string& name);

} // namespace faceta
