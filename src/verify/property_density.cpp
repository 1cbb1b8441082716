#include "verify/density_study.h"
#include "verify/properties.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

std::vector<TransportMode> modes_of(const Subject& subject, Effort effort) {
  if (effort == Effort::full && subject.transmissive())
    return {TransportMode::radiance, TransportMode::importance};
  return {TransportMode::radiance};
}

const char* name_of(TransportMode mode) {
  return mode == TransportMode::radiance ? "radiance" : "importance";
}

// The density of a table with steps takes minutes a viewer to integrate: few viewers must do.
Effort affordable(const Subject& subject, Effort effort) {
  bool steps = subject.traits().tabulated && subject.transmissive();
  return steps ? Effort::quick : effort;
}

} // namespace

Outcome check_chi_square(const Subject& subject, Effort wanted, double level) {
  Effort effort = affordable(subject, wanted);
  Outcome outcome;
  outcome.figure = 1;
  uint64_t seed = subject.stream(1000);
  for (TransportMode mode : modes_of(subject, effort))
    for (const Vec3<float>& wo : viewers(subject, effort)) {
      DensityStudy study = study_density(subject, wo, mode, 1 << 20, ++seed, 0.02);
      if (!study.defect.empty())
        outcome.fail(fmt::format("wo = {}: {}", to_text(wo), study.defect));
      ChiSquareResult result = study.chi_square();
      outcome.figure = std::min(outcome.figure, result.p_value);
      if (result.p_value < level)
        outcome.fail(fmt::format(
            "wo = {}, {}: chi-square {:.1f} with {} degrees of freedom, p = {:.2g} < {:.2g}; {}; "
            "density {:.6f} + delta {:.6f}, failed {:.6f}",
            to_text(wo), name_of(mode), result.statistic, result.degrees, result.p_value, level,
            study.worst_cell(), study.total_mass(), study.delta_probability(),
            study.failures / study.samples));
    }
  return outcome;
}

Outcome check_density(const Subject& subject, Effort wanted, double level) {
  Effort effort = affordable(subject, wanted);
  Outcome outcome;
  const double z = two_sided_quantile(level);
  uint64_t seed = subject.stream(2000);
  for (TransportMode mode : modes_of(subject, effort))
    for (const Vec3<float>& wo : viewers(subject, effort)) {
      DensityStudy study = study_density(subject, wo, mode, 1 << 18, ++seed, 0.002);
      double failed = study.failures / study.samples;
      double difference = study.total_mass() + study.delta_probability() - (1 - failed);
      double noise = std::sqrt(failed * (1 - failed) / study.samples);
      outcome.figure = std::max(outcome.figure, std::abs(difference));
      if (!(std::abs(difference) <= 1e-4 + z * noise))
        outcome.fail(fmt::format("wo = {}, {}: density {:.6f} (quadrature error below {:.1g}) + "
                                 "delta {:.6f} against 1 - {:.6f} failed +- {:.1g}",
                                 to_text(wo), name_of(mode), study.total_mass(), study.mass_error,
                                 study.delta_probability(), failed, noise));
    }
  return outcome;
}

} // namespace faceta
