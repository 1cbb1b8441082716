#pragma once

/// Samples of a model beside the integral of its density, for one direction to the viewer.

#include "verify/sphere_partition.h"
#include "verify/statistics.h"
#include "verify/subject.h"

namespace faceta {

/// Samples of one delta lobe.
struct DeltaGroup {
  int lobe;
  Vec3<float> wi;
  double probability; ///< as sample() reports it
  double count;
};

struct DensityStudy {
  SpherePartition partition;
  std::vector<double> observed; ///< samples in each cell
  std::vector<double> mass;     ///< density integrated over each cell
  double mass_error = 0;        ///< estimated error of all masses together
  std::vector<DeltaGroup> deltas;
  double samples = 0, failures = 0;
  std::string defect; ///< a delta lobe without a fixed direction, say; empty if there is none

  double total_mass() const;        ///< of the non-delta lobes
  double delta_probability() const; ///< of all delta lobes
  /// The cells, the delta lobes and failure, as counts.
  ChiSquareResult chi_square() const;
  /// Where counts and density differ most, in words.
  std::string worst_cell() const;
};

/// Draws `samples` directions with the widest kernel and integrates the reference's density over
/// cells that follow it. The error of each cell is held below `tolerance` of the cell's own
/// standard deviation.
DensityStudy study_density(const Subject& subject, const Vec3<float>& wo, TransportMode mode,
                           long samples, uint64_t seed, double tolerance);

} // namespace faceta
