#pragma once

/// Hypothesis tests that the verifier's verdicts rest on.

#include <string>
#include <vector>

namespace faceta {

/// Regularised upper incomplete gamma function Q(a, x) for a > 0, x >= 0; absolute error below
/// 1e-13.
double gamma_q(double a, double x);

/// Probability that a chi-square variable with `degrees` degrees of freedom exceeds `statistic`.
double chi_square_survival(double statistic, double degrees);

/// Probability that a standard normal variable exceeds |z|, on both sides together.
double two_sided_normal(double z);

/// The |z| that a standard normal variable exceeds with probability `level`, in (0, 1].
double two_sided_quantile(double level);

/// Level of one of `count` independent tests so that all together err with probability `family`
/// (Sidak 1967, "Rectangular confidence regions for the means of multivariate normal
/// distributions").
double sidak(double family, double count);

/// One cell of a histogram: how many samples were expected, how many came.
struct HistogramCell {
  double expected = 0, observed = 0;
};

struct ChiSquareResult {
  double statistic = 0;
  int degrees = 0;
  double p_value = 1; ///< 0 if a sample fell where none can
  int pooled = 0;     ///< cells that were merged because they expected too few
};

/// Pearson's test of counts that were drawn from all cells together (degrees = cells - 1). Cells
/// that expect fewer than `least` are pooled, smallest first, into cells that expect at least that;
/// a pooled rest that still expects less joins the smallest cell left. Counts where less than
/// `nothing` is expected in the whole pool give p = 0.
ChiSquareResult chi_square_test(std::vector<HistogramCell> cells, double least = 5,
                                double nothing = 1e-9);

/// Mean of a sample and the standard error of that mean, summed in a numerically stable way
/// (Welford 1962).
class RunningMean {
public:
  void add(double value) {
    ++count_;
    double delta = value - mean_;
    mean_ += delta / double(count_);
    squares_ += delta * (value - mean_);
  }
  double mean() const { return mean_; }
  double standard_error() const;
  long count() const { return count_; }

private:
  long count_ = 0;
  double mean_ = 0, squares_ = 0;
};

} // namespace faceta
