#pragma once

/// How evenly a model's samples weigh: the noise that its sampling rule adds to a picture, beside
/// the least that its own value leaves to any rule.

#include "verify/suite.h"

namespace faceta {

/// Weights w = value / density of samples for one viewer, failed ones counted as 0.
///
/// The coefficient of variation of a colour is the root of the mean over its channels of (standard
/// deviation / mean)^2; channels that are black are left out. With s the root of the mean over the
/// channels of (w / mean w)^2 it is sqrt(E[s^2] - 1). By Cauchy and Schwarz's inequality no density
/// leaves less than sqrt(E[s]^2 - 1), and one proportional to s times the density leaves just that:
/// 0 for a value without colour, more where channels disagree on where the light goes. A rule whose
/// samples fail with probability q cannot do better than sqrt(E[s]^2 / (1 - q) - 1).
struct EfficiencyPoint {
  Vec3<float> wo{0, 0, 1};
  double theta = 0;     ///< degrees between the normal and wo; above 90: from inside
  double variation = 0; ///< coefficient of variation; NaN (as the two below) if all weights are 0
  double best = 0;      ///< the least that any rule leaves
  double of_rule = 0;   ///< the least that a rule leaves whose samples fail as often as these
  double failed = 0;    ///< share of the samples that failed
  Color<double> mean;   ///< of the weights: the albedo
};

/// One viewer, `samples` of the widest kernel. Importance transport: without the factor 1/eta^2 of
/// radiance, by which a lobe would differ from another without being sampled worse.
EfficiencyPoint study_efficiency(const Subject& subject, const Vec3<float>& wo, int samples);

struct EfficiencyReport {
  int samples = 0;   ///< for each viewer
  uint64_t seed = 0; ///< what their random numbers came from
  struct Row {
    SuiteSubject subject;
    std::vector<EfficiencyPoint> points; ///< for the viewers of the suite: viewers()
  };
  std::vector<Row> rows;
};

/// Studies every subject, in parallel; the same figures whatever the number of threads.
EfficiencyReport study_efficiencies(const std::vector<SuiteSubject>& subjects, int samples,
                                    uint64_t seed);

/// For a terminal, within 100 columns: a row a subject (two if it scatters inside), variation and
/// best for each angle, the worst azimuth. One subject alone: a row a viewer, all figures.
std::string efficiency_text(const EfficiencyReport& report);

/// One JSON object:
///   version, samples, seed, isa
///   subjects  [name, model, parameters: {name: text}, points]
///   points    [wo: [x, y, z], theta (degrees, above 90 from inside), variation, best, of_rule,
///             failed, mean: [r, g, b]]; null where all weights are 0
/// Fields may be added, never renamed.
std::string efficiency_json(const EfficiencyReport& report, const std::string& version);

} // namespace faceta
