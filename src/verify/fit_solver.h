#pragma once

#include "verify/fit_model.h"

namespace faceta {

/// The best numbers that one search has found.
struct FitSolution {
  std::vector<double> x;
  double cost = 0; ///< the metric's square on the rows of the search
  int iterations = 0;
};

struct FitSearch {
  FitMetric metric = FitMetric::log;
  int iterations = 50;
  double tolerance = 1e-6; ///< relative fall of the cost at which to stop
  int threads = 1;
};

/// Levenberg and Marquardt's method from x on.
FitSolution solve_fit(const FitModel& model, const FitData& data, const std::vector<double>& x,
                      const FitSearch& search);

/// Residuals of the metric: root of the weight times the difference of transformed values, three a
/// row; their squares add up to the metric's square. `derivatives` (size() per residual) holds
/// those of the values and becomes those of the residuals, unless null.
class FitResiduals {
public:
  FitResiduals(const FitData& data, FitMetric metric);
  /// Of rows [first, first + count), in place.
  void apply(size_t first, size_t count, double* values, double* derivatives, size_t n) const;
  const FitData& data() const { return *data_; }

private:
  const FitData* data_;
  FitMetric metric_;
  std::vector<double> scale_, wanted_; ///< per row; per value
};

/// Where a search begins.
struct FitStart {
  std::vector<double> alphas; ///< widths of the lobes, as many as there are
  /// The first lobe lies under a clear coat: rounder highlights, less light at grazing angles.
  bool coated = false;
};

/// Starting numbers: the lobes' widths, and the colours that fit best to those, channel by channel
/// (variable projection).
std::vector<double> start_fit(const FitModel& model, const FitData& data, const FitStart& start,
                              FitMetric metric);

/// The roughness that the peak's width at small theta_d suggests: alpha of a GGX lobe.
double guess_alpha(const FitData& data);

} // namespace faceta
