#include "verify/fit_data.h"

#include "base/error.h"
#include "base/maths.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>

namespace faceta {

namespace {

constexpr double kDegree = kPi / 180;

/// The pair of directions of a cell: wi at (theta_d, phi_d) about h, turned by theta_h.
FitRow row_of(const FitCell& cell) {
  double th = sqr(cell.h / 90) * 0.5 * kPi, td = cell.theta_d * kDegree, pd = cell.phi_d * kDegree;
  Vec3<double> d{std::sin(td) * std::cos(pd), std::sin(td) * std::sin(pd), std::cos(td)};
  auto turned = [&](double x, double y, double z) {
    return Vec3<double>{x * std::cos(th) + z * std::sin(th), y,
                        z * std::cos(th) - x * std::sin(th)};
  };
  FitRow row;
  row.wi = turned(d.x, d.y, d.z);
  row.wo = turned(-d.x, -d.y, d.z);
  row.weight = 4 * std::cos(td) * std::sin(td) * std::sin(th) * (2 * cell.h / 8100);
  return row;
}

FitData grid_of(double max_theta) {
  FitData data;
  double least = std::cos(max_theta * kDegree);
  for (int i = 0; i < FitMap::kSize; ++i)
    for (int j = 0; j < FitMap::kSize; ++j)
      for (int k = 0; k < 45; ++k) {
        FitCell cell{2 * i + 0.5, 2 * j + 1.0, 4 * k + 1.0};
        FitRow row = row_of(cell);
        if (row.wi.z < least || row.wo.z < least)
          continue;
        data.rows.push_back(row);
        data.cells.push_back(cell);
      }
  return data;
}

bool usable(const FitRow& row) {
  auto finite = [](const Vec3<double>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  return finite(row.wo) && finite(row.wi) && row.wo.z > 0 && row.wi.z > 0 &&
         std::isfinite(row.weight) && row.weight > 0 &&
         std::all_of(row.value.begin(), row.value.end(), [](double v) { return std::isfinite(v); });
}

/// Drops holes, clamps negatives, scales the weights.
void clean(FitData& data) {
  size_t kept = 0;
  double sum = 0, largest = 0;
  for (size_t i = 0; i < data.rows.size(); ++i) {
    FitRow row = data.rows[i];
    if (!usable(row)) {
      ++data.holes;
      continue;
    }
    for (double& v : row.value)
      largest = std::max(largest, v = std::max(v, 0.0));
    sum += row.weight;
    data.rows[kept] = row;
    if (!data.cells.empty())
      data.cells[kept] = data.cells[i];
    ++kept;
  }
  data.rows.resize(kept);
  if (!data.cells.empty())
    data.cells.resize(kept);
  if (kept == 0)
    throw Error("there is nothing to fit: no direction has a finite value", {},
                "directions need wo and wi above the surface and finite values");
  if (!(largest > 0))
    throw Error("there is nothing to fit: all values are 0");
  for (FitRow& row : data.rows)
    row.weight /= sum;
}

/// Sums of one set of rows and channels.
struct ErrorSums {
  double log = 0, cbrt = 0, difference = 0, square = 0, weight = 0, weight_o = 0;

  void add(double w, double cos_o, double f, double g) {
    log += w * sqr(std::log1p(f) - std::log1p(g));
    cbrt += w * cos_o * sqr(std::cbrt(f) - std::cbrt(g));
    difference += w * cos_o * sqr(f - g);
    square += w * cos_o * sqr(f);
    weight += w;
    weight_o += w * cos_o;
  }
  FitErrors errors() const {
    auto root = [](double a, double b) { return b > 0 ? std::sqrt(a / b) : 0.0; };
    return {root(log, weight), root(cbrt, weight_o), root(difference, square)};
  }
};

} // namespace

FitMetric parse_fit_metric(const std::string& name) {
  for (int i = 0; i < 3; ++i)
    if (name == kFitMetricNames[i])
      return static_cast<FitMetric>(i);
  throw Error("unknown metric '" + name + "'", {}, "known: log, cbrt, rel");
}

FitData sample_fit_target(const FitTarget& target, double max_theta) {
  if (!(max_theta > 0) || max_theta > 90)
    throw Error("the largest angle of a fit must lie in (0, 90] degrees");
  FitData data = grid_of(max_theta);
  tbb::parallel_for(size_t(0), data.rows.size(), [&](size_t i) {
    data.rows[i].value = target.value(data.rows[i].wo, data.rows[i].wi);
  });
  clean(data);
  return data;
}

FitData check_fit_rows(std::vector<FitRow> rows) {
  FitData data;
  data.rows = std::move(rows);
  clean(data);
  return data;
}

FitData thin_out(const FitData& data, int step) {
  FitData thin;
  double sum = 0;
  for (size_t i = 0; i < data.rows.size(); i += size_t(std::max(step, 1))) {
    thin.rows.push_back(data.rows[i]);
    sum += data.rows[i].weight;
  }
  for (FitRow& row : thin.rows)
    row.weight /= sum;
  return thin;
}

FitErrorReport fit_errors(const FitData& data, std::span<const double> fitted) {
  ErrorSums all, channels[3], bins[9];
  for (size_t i = 0; i < data.rows.size(); ++i) {
    const FitRow& row = data.rows[i];
    int bin = std::clamp(int(std::acos(std::min(row.wi.z, 1.0)) / kDegree / 10), 0, 8);
    for (int c = 0; c < 3; ++c) {
      double f = row.value[size_t(c)] * row.wi.z, g = fitted[3 * i + size_t(c)];
      for (ErrorSums* sums : {&all, &channels[c], &bins[bin]})
        sums->add(row.weight, row.wo.z, f, g);
    }
  }
  FitErrorReport report;
  report.all = all.errors();
  for (size_t c = 0; c < 3; ++c)
    report.channels[c] = channels[c].errors();
  for (size_t b = 0; b < 9; ++b) {
    report.by_theta_i[b] = bins[b].errors();
    report.weight_by_theta_i[b] = bins[b].weight / 3;
  }
  return report;
}

FitMap fit_map(const FitData& data, std::span<const double> fitted) {
  if (data.cells.size() != data.rows.size())
    throw Error("a residual map needs directions on the grid");
  size_t cells = size_t(FitMap::kSize) * FitMap::kSize;
  std::vector<double> sum(cells), square(cells), weight(cells);
  for (size_t i = 0; i < data.rows.size(); ++i) {
    const FitRow& row = data.rows[i];
    size_t at = size_t(data.cells[i].h / 2) * FitMap::kSize + size_t(data.cells[i].theta_d / 2);
    for (size_t c = 0; c < 3; ++c) {
      double r = std::log1p(fitted[3 * i + c]) - std::log1p(row.value[c] * row.wi.z);
      sum[at] += row.weight * r;
      square[at] += row.weight * r * r;
      weight[at] += row.weight;
    }
  }
  FitMap map;
  double none = std::numeric_limits<double>::quiet_NaN();
  for (size_t k = 0; k < cells; ++k) {
    map.mean.push_back(weight[k] > 0 ? sum[k] / weight[k] : none);
    map.rms.push_back(weight[k] > 0 ? std::sqrt(square[k] / weight[k]) : none);
  }
  return map;
}

} // namespace faceta
