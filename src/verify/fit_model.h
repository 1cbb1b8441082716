#pragma once

/// What is fitted: a sum of materials with free parameters, each behind a transform that keeps it
/// in its range.

#include "bsdf/registry.h"
#include "verify/fit_data.h"

namespace faceta {

/// y in (low, high) of an unbounded x: low + (high - low) s(x), s the logistic function; of the
/// logarithms if `logarithmic`.
struct FitTransform {
  double low = 0, high = 1;
  bool logarithmic = false;

  double value(double x) const;
  double slope(double x) const;   ///< dy/dx
  double inverse(double y) const; ///< of y moved a millionth of the range inside
};

/// One material of the sum.
struct FitTerm {
  std::string model;
  Settings fixed; ///< parameters that are not free
};

/// A free number: the slots of its term that take it (both directions' alpha, for one).
struct FitParameter {
  int term = 0;
  std::string name; ///< of the model's parameter
  int channel = -1; ///< of a colour
  std::vector<int> slots;
  FitTransform transform;
  double start = 0; ///< y
};

/// The sum f = sum w_k f_k with shares w_k > 0 that add up to 1 (as blendbsdf mixes), and its free
/// numbers x: transformed parameters, then log(w_k / w_0) for k > 0.
class FitModel {
public:
  /// `model` as fit_model_names() lists them; `lobes` 1 to 3.
  /// @throws Error for another model, or a number of lobes that it cannot have.
  FitModel(const std::string& model, int lobes);

  const std::string& name() const { return name_; }
  int lobes() const { return lobes_; }
  int size() const { return int(parameters_.size() + terms_.size()) - 1; }
  const std::vector<FitTerm>& terms() const { return terms_; }
  const std::vector<FitParameter>& parameters() const { return parameters_; }

  /// The sum with values of its free numbers: shares, slots, records.
  struct State {
    std::vector<double> x, weights;
    std::vector<std::vector<double>> slots; ///< of each term
    std::vector<Record> records;
  };
  State state(const std::vector<double>& x) const;
  /// f_r cos theta_i, three per row; and d/dx, size() per value, unless null.
  void evaluate(const State& state, std::span<const FitRow> rows, double* values,
                double* derivatives) const;
  /// The first values of the free numbers: the parameters' defaults, but off the ends of their
  /// ranges, where nothing has a slope; equal shares.
  std::vector<double> start() const;
  /// The k-th term's parameters as settings, the fixed ones included.
  Settings settings(const State& state, size_t term) const;

private:
  void add(FitTerm term, const std::vector<std::string>& held);

  std::string name_;
  int lobes_;
  std::vector<FitTerm> terms_;
  std::vector<FitParameter> parameters_;
  std::vector<std::vector<int>> active_, owner_; ///< per term: slots and the parameters they take
  std::vector<const Model*> models_;             ///< of the terms
};

/// Directions of rows.
std::vector<DirectionPair> pairs_of(std::span<const FitRow> rows);

/// Names that FitModel takes: registered models and "ggx", which is two (or one) GGX lobes with
/// free reflectances at both ends of Schlick's curve over a diffuse base, as a hazygloss.
std::vector<std::string> fit_model_names();
/// The most lobes that a model can be fitted with.
int most_fit_lobes(const std::string& model);

} // namespace faceta
