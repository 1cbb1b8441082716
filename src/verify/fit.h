#pragma once

/// Fits materials to measured reflectance: Levenberg and Marquardt's method (Ceres) on the models'
/// own templates with exact derivatives, from several starts.

#include "scene/scene.h"
#include "verify/fit_model.h"

namespace faceta {

struct FitOptions {
  std::string model = "auto"; ///< "auto": the best of ggx, hazygloss and roughconductor by BIC
  int lobes = 0;              ///< 0: by BIC, of one and two
  FitMetric metric = FitMetric::log;
  int threads = 0; ///< 0: all
};

/// One material of a fitted sum.
struct FitPart {
  double share = 1; ///< of the sum, in (0, 1]; the shares of all parts add up to 1
  Parameters parameters;
};

/// What was tried on the way, fitted to fewer rows than the result.
struct FitCandidate {
  std::string model;
  int lobes = 1, parameters = 0;
  double error = 0, bic = 0; ///< in the metric of the fit
};

struct FitResult {
  std::string model;
  int lobes = 1, parameters = 0; ///< how many numbers are free
  std::vector<FitPart> parts;
  FitErrorReport errors; ///< of all rows, of the parameters as written in `parts`
  /// n ln(mean squared residual) + k ln n of all rows, n = 3 rows, in the metric of the fit.
  double bic = 0;
  int iterations = 0; ///< of all starts
  double seconds = 0;
  std::vector<double> fitted; ///< f_r cos theta_i, three per row of the data
  std::vector<FitCandidate> candidates;
};

/// Fits a material. The result is the same for any number of threads up to rounding.
/// @throws Error for an unknown model or an impossible number of lobes.
FitResult fit_material(const FitData& data, const FitOptions& options = {});

/// The sum as a tree of materials: one model, or blends of two, nested.
std::shared_ptr<MaterialNode> fit_node(const FitResult& result);

/// The result as indented JSON: model, parts, errors in all metrics by channel and by theta_i,
/// BIC, candidates.
std::string fit_json(const FitResult& result);
/// A table for people.
std::string fit_text(const FitResult& result);

} // namespace faceta
