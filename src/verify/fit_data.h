#pragma once

/// What a fit is fitted to and how it is judged: directions in half-difference coordinates, their
/// weights, and three metrics of error. Angles in degrees; theta_h = angle(n, h),
/// theta_d = angle(h, wi), h = normalize(wi + wo) (Rusinkiewicz 1998, A New Change of Variables for
/// Efficient BRDF Representation).

#include "base/vec.h"

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace faceta {

/// A BRDF to fit: f_r of wo (viewer) and wi (light), WITHOUT cosine, in linear RGB; both unit, z up
/// and above the surface. Called from several threads at once.
struct FitTarget {
  std::function<std::array<double, 3>(const Vec3<double>& wo, const Vec3<double>& wi)> value;
};

/// One pair of directions with the measured f_r and its share W of the solid angles of all pairs.
struct FitRow {
  Vec3<double> wo, wi;
  std::array<double, 3> value;
  double weight;
};

/// A cell of the grid: i in theta_h = (i/90)^2 90 degrees, theta_d and phi_d in degrees.
struct FitCell {
  double h, theta_d, phi_d;
};

/// Rows of a grid; weights add up to 1.
struct FitData {
  std::vector<FitRow> rows;
  std::vector<FitCell> cells; ///< of the rows; empty for rows from elsewhere
  int holes = 0;              ///< directions left out because the target had no finite value there
};

/// Samples a target at i = 0.5, 2.5 .. 88.5, theta_d = 1, 3 .. 89, phi_d = 1, 5 .. 177, where both
/// directions are at most max_theta from the normal: 57,307 pairs for 80 degrees. Negative values
/// count as 0; values that are not finite as holes.
/// @throws Error if max_theta is not in (0, 90], if no row is left, or if all values are 0.
FitData sample_fit_target(const FitTarget& target, double max_theta = 80);

/// The same checks for rows from elsewhere, whose weights are scaled to add up to 1; rows that are
/// not finite, below the surface or without weight are holes.
FitData check_fit_rows(std::vector<FitRow> rows);

/// Every step-th row, or all if step is 1; weights scaled.
FitData thin_out(const FitData& data, int step);

/// What a fit minimises. With c = cos theta_i, sums over rows (weight W) and channels:
///   log:  sqrt(sum W (ln(1 + f c) - ln(1 + g c))^2 / 3)
///   cbrt: sqrt(sum W cos_o (cbrt(f c) - cbrt(g c))^2 / (3 sum W cos_o))
///   rel:  sqrt(sum W cos_o ((f - g) c)^2 / sum W cos_o (f c)^2)
enum class FitMetric { log, cbrt, rel };
inline constexpr const char* kFitMetricNames[] = {"log", "cbrt", "rel"};
/// @throws Error for another name.
FitMetric parse_fit_metric(const std::string& name);

/// An error in the three metrics, in the order of FitMetric.
using FitErrors = std::array<double, 3>;

/// A channel's or a bin's error is measured with its own rows' weights and, of rel, its own f.
struct FitErrorReport {
  FitErrors all{};
  std::array<FitErrors, 3> channels{};
  /// Of rows by theta_i in bins of 10 degrees from 0; 0 where a bin is empty.
  std::array<FitErrors, 9> by_theta_i{};
  std::array<double, 9> weight_by_theta_i{}; ///< share of W, to tell empty bins
};

/// Errors of `fitted` (f_r c, three per row) against the data.
FitErrorReport fit_errors(const FitData& data, std::span<const double> fitted);

/// The residual ln(1 + g c) - ln(1 + f c), mean over phi_d and channels, and the root of its mean
/// square, over theta_h (rows of the map, 45 nodes of the grid) and theta_d (columns, 45).
struct FitMap {
  static constexpr int kSize = 45;
  std::vector<double> mean, rms; ///< kSize * kSize; NaN where no direction is
};
/// @throws Error if the data have no cells.
FitMap fit_map(const FitData& data, std::span<const double> fitted);

} // namespace faceta
