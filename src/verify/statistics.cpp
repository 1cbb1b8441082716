#include "verify/statistics.h"

#include <algorithm>
#include <cmath>

namespace faceta {

namespace {

// P(a, x) by its power series: for x < a + 1.
double gamma_series(double a, double x) {
  double term = 1 / a, sum = term;
  for (int n = 1; n < 100000 && term > sum * 1e-17; ++n)
    sum += term *= x / (a + n);
  return sum * std::exp(a * std::log(x) - x - std::lgamma(a));
}

// Q(a, x) by Legendre's continued fraction, evaluated from the front (Lentz 1976): for x >= a + 1.
double gamma_fraction(double a, double x) {
  const double tiny = 1e-300;
  double b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
  for (int n = 1; n < 100000; ++n) {
    double an = -n * (n - a);
    b += 2;
    d = an * d + b;
    c = b + an / c;
    d = 1 / (std::abs(d) < tiny ? tiny : d);
    c = std::abs(c) < tiny ? tiny : c;
    double factor = d * c;
    h *= factor;
    if (std::abs(factor - 1) < 1e-16)
      break;
  }
  return h * std::exp(a * std::log(x) - x - std::lgamma(a));
}

} // namespace

double gamma_q(double a, double x) {
  if (!(x > 0))
    return 1;
  if (std::isinf(x))
    return 0;
  return x < a + 1 ? 1 - gamma_series(a, x) : gamma_fraction(a, x);
}

double chi_square_survival(double statistic, double degrees) {
  return degrees <= 0 ? 1 : gamma_q(degrees / 2, statistic / 2);
}

double two_sided_normal(double z) {
  return std::erfc(std::abs(z) / std::sqrt(2.0));
}

double two_sided_quantile(double level) {
  double low = 0, high = 40; // beyond 38.5 a double's probability is 0
  for (int i = 0; i < 60; ++i) {
    double middle = 0.5 * (low + high);
    (two_sided_normal(middle) > level ? low : high) = middle;
  }
  return high;
}

double sidak(double family, double count) {
  return count <= 1 ? family : -std::expm1(std::log1p(-family) / count);
}

ChiSquareResult chi_square_test(std::vector<HistogramCell> cells, double least, double nothing) {
  std::sort(cells.begin(), cells.end(),
            [](const HistogramCell& a, const HistogramCell& b) { return a.expected < b.expected; });
  ChiSquareResult result;
  std::vector<HistogramCell> kept;
  HistogramCell pool;
  for (const HistogramCell& cell : cells) {
    bool large = cell.expected >= least;
    if (large && pool.expected < nothing && pool.observed > 0) {
      result.p_value = 0;
      return result;
    }
    if (large && pool.expected < nothing) {
      kept.push_back(cell);
      continue;
    }
    pool.expected += cell.expected;
    pool.observed += cell.observed;
    ++result.pooled;
    if (pool.expected >= least) {
      kept.push_back(pool);
      pool = {};
    }
  }
  if (pool.expected > 0 || pool.observed > 0) {
    if (pool.expected < nothing && pool.observed > 0) {
      result.p_value = 0;
      return result;
    }
    if (kept.empty())
      return result;
    kept.back().expected += pool.expected;
    kept.back().observed += pool.observed;
  }
  for (const HistogramCell& cell : kept)
    result.statistic +=
        (cell.observed - cell.expected) * (cell.observed - cell.expected) / cell.expected;
  result.degrees = static_cast<int>(kept.size()) - 1;
  result.p_value = chi_square_survival(result.statistic, result.degrees);
  return result;
}

double RunningMean::standard_error() const {
  return count_ < 2 ? 0 : std::sqrt(squares_ / double(count_ - 1) / double(count_));
}

} // namespace faceta
