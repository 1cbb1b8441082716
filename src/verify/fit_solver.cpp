#include "verify/fit_solver.h"

#include "base/maths.h"

#include <algorithm>
#include <ceres/ceres.h>
#include <cmath>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace faceta {

namespace {

// Cube roots are infinitely steep at 0; this rounds that corner, below what is ever measured.
constexpr double kCbrtCorner = 1e-7;

double transformed(FitMetric metric, double v) {
  return metric == FitMetric::log    ? std::log1p(v)
         : metric == FitMetric::cbrt ? std::cbrt(v + kCbrtCorner)
                                     : v;
}
double slope_of(FitMetric metric, double v) {
  return metric == FitMetric::log    ? 1 / (1 + v)
         : metric == FitMetric::cbrt ? 1 / (3 * sqr(std::cbrt(v + kCbrtCorner)))
                                     : 1;
}

/// Where numbers other than widths and colours start, of a plain and of a coated lobe.
struct StartShape {
  const char* name;
  double plain, coated;
};
constexpr StartShape kStartShapes[] = {{"gloss_across", 0, 1},
                                       {"gloss_masking", 0.15, 1.5},
                                       {"eta", 0.5, 1.5}, // a metal, or what lies under a coat
                                       {"k", 2.5, 0.3}};

/// Computes all residuals and derivatives of a step before Ceres asks for them: in parallel by
/// chunks of rows, each of which fits into the cache.
class Residuals : public ceres::EvaluationCallback {
public:
  Residuals(const FitModel& model, const FitData& data, const std::vector<double>& x,
            const FitSearch& search)
      : model_(model), residuals_(data, search.metric), x_(x), arena_(search.threads),
        values_(3 * data.rows.size()) {}

  void PrepareForEvaluation(bool with_derivatives, bool) override {
    constexpr size_t kRows = 64;
    size_t n = size_t(model_.size());
    derivatives_.resize(with_derivatives ? values_.size() * n : 0);
    FitModel::State state = model_.state(x_);
    std::span<const FitRow> rows = residuals_.data().rows;
    arena_.execute([&] {
      tbb::parallel_for(size_t(0), (rows.size() + kRows - 1) / kRows, [&](size_t chunk) {
        size_t first = chunk * kRows, count = std::min(kRows, rows.size() - first);
        double* values = &values_[3 * first];
        double* derivatives = with_derivatives ? &derivatives_[3 * first * n] : nullptr;
        model_.evaluate(state, rows.subspan(first, count), values, derivatives);
        residuals_.apply(first, count, values, derivatives, n);
      });
    });
  }
  const std::vector<double>& values() const { return values_; }
  const std::vector<double>& derivatives() const { return derivatives_; }

private:
  const FitModel& model_;
  FitResiduals residuals_;
  const std::vector<double>& x_;
  tbb::task_arena arena_;
  std::vector<double> values_, derivatives_;
};

/// Hands them over.
class ResidualCost : public ceres::CostFunction {
public:
  ResidualCost(const Residuals& residuals, int size) : residuals_(residuals) {
    set_num_residuals(int(residuals.values().size()));
    mutable_parameter_block_sizes()->push_back(size);
  }
  bool Evaluate(double const* const*, double* values, double** jacobians) const override {
    std::copy(residuals_.values().begin(), residuals_.values().end(), values);
    if (jacobians && jacobians[0])
      std::copy(residuals_.derivatives().begin(), residuals_.derivatives().end(), jacobians[0]);
    return std::all_of(residuals_.values().begin(), residuals_.values().end(),
                       [](double v) { return std::isfinite(v); });
  }

private:
  const Residuals& residuals_;
};

/// Minimises |A y - b|^2 for y in [low, high], from A'A and A'b, by coordinates.
std::vector<double> bounded_least_squares(const std::vector<double>& ata,
                                          const std::vector<double>& atb, double low, double high) {
  size_t n = atb.size();
  std::vector<double> y(n, low);
  for (int sweep = 0; sweep < 300; ++sweep)
    for (size_t i = 0; i < n; ++i) {
      double rest = atb[i];
      for (size_t j = 0; j < n; ++j)
        rest -= j == i ? 0 : ata[i * n + j] * y[j];
      y[i] = std::clamp(ata[i * n + i] > 0 ? rest / ata[i * n + i] : low, low, high);
    }
  return y;
}

/// Parameters that are colours which the value is proportional to: by their red channels.
std::vector<size_t> linear_colours(const FitModel& model) {
  std::vector<size_t> list;
  for (size_t j = 0; j < model.parameters().size(); ++j) {
    const FitParameter& p = model.parameters()[j];
    if (p.channel == 0 && !p.transform.logarithmic)
      list.push_back(j);
  }
  return list;
}

/// What each colour gives for 1: half of it is put in, so that nothing clips at 1.
std::vector<std::vector<double>> colour_columns(const FitModel& model, const FitData& data,
                                                std::vector<double> x,
                                                const std::vector<size_t>& colours) {
  auto set = [&](size_t j, double y) {
    for (size_t c = 0; c < 3; ++c)
      x[j + c] = model.parameters()[j + c].transform.inverse(y);
  };
  for (size_t j : colours)
    set(j, 0);
  std::vector<std::vector<double>> columns;
  for (size_t j : colours) {
    set(j, 0.5);
    std::vector<double> values(3 * data.rows.size());
    model.evaluate(model.state(x), data.rows, values.data(), nullptr);
    for (double& v : values)
      v *= 2;
    columns.push_back(std::move(values));
    set(j, 0);
  }
  return columns;
}

} // namespace

FitResiduals::FitResiduals(const FitData& data, FitMetric metric) : data_(&data), metric_(metric) {
  double sum_o = 0, square = 0;
  for (const FitRow& row : data.rows) {
    sum_o += row.weight * row.wo.z;
    for (double v : row.value)
      square += row.weight * row.wo.z * sqr(v * row.wi.z);
  }
  for (const FitRow& row : data.rows) {
    double share = metric == FitMetric::log    ? row.weight / 3
                   : metric == FitMetric::cbrt ? row.weight * row.wo.z / (3 * sum_o)
                                               : row.weight * row.wo.z / square;
    scale_.push_back(std::sqrt(share));
    for (double v : row.value)
      wanted_.push_back(transformed(metric, v * row.wi.z));
  }
}

void FitResiduals::apply(size_t first, size_t count, double* values, double* derivatives,
                         size_t n) const {
  for (size_t i = 0; i < 3 * count; ++i) {
    double scale = scale_[first + i / 3], slope = scale * slope_of(metric_, values[i]);
    values[i] = scale * (transformed(metric_, values[i]) - wanted_[3 * first + i]);
    for (size_t k = 0; derivatives && k < n; ++k)
      derivatives[i * n + k] *= slope;
  }
}

FitSolution solve_fit(const FitModel& model, const FitData& data, const std::vector<double>& x,
                      const FitSearch& search) {
  FitSolution solution{x};
  Residuals residuals(model, data, solution.x, search);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &residuals;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(new ResidualCost(residuals, model.size()), nullptr, solution.x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = search.iterations;
  options.function_tolerance = search.tolerance;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  solution.cost = 2 * summary.final_cost;
  solution.iterations = int(summary.iterations.size());
  return solution;
}

std::vector<double> start_fit(const FitModel& model, const FitData& data, const FitStart& start,
                              FitMetric metric) {
  std::vector<double> x = model.start();
  size_t lobe = 0;
  for (size_t j = 0; j < model.parameters().size(); ++j) {
    const FitParameter& p = model.parameters()[j];
    bool is_alpha = p.name.size() >= 5 && p.name.compare(p.name.size() - 5, 5, "alpha") == 0;
    for (const auto& [name, plain, coated] : kStartShapes)
      if (p.name == name)
        x[j] = p.transform.inverse(start.coated ? coated : plain);
    if (!is_alpha && p.name != "exponent")
      continue;
    double alpha = start.alphas[std::min(lobe++, start.alphas.size() - 1)];
    x[j] = p.transform.inverse(is_alpha ? alpha : 2 / sqr(alpha));
  }
  std::vector<size_t> colours = linear_colours(model);
  auto columns = colour_columns(model, data, x, colours);
  size_t n = colours.size();
  for (size_t c = 0; c < 3; ++c) {
    std::vector<double> ata(n * n), atb(n);
    for (size_t i = 0; i < data.rows.size(); ++i) {
      const FitRow& row = data.rows[i];
      double f = row.value[c] * row.wi.z, w = row.weight * sqr(slope_of(metric, f + 1e-4));
      for (size_t a = 0; a < n; ++a) {
        atb[a] += w * columns[a][3 * i + c] * f;
        for (size_t b = 0; b < n; ++b)
          ata[a * n + b] += w * columns[a][3 * i + c] * columns[b][3 * i + c];
      }
    }
    // A colour that starts at 0 has no slope to leave it.
    std::vector<double> y = bounded_least_squares(ata, atb, 0.003, 0.95);
    for (size_t a = 0; a < n; ++a)
      x[colours[a] + c] = model.parameters()[colours[a] + c].transform.inverse(y[a]);
  }
  return x;
}

double guess_alpha(const FitData& data) {
  // Median slope of the half vector, weighted by the light that it reflects: near the normal, value
  // times solid angle is D cos theta_h, of whose GGX slopes half lie below alpha.
  std::vector<std::pair<double, double>> slopes;
  double sum = 0;
  for (const FitRow& row : data.rows) {
    Vec3<double> h = row.wo + row.wi;
    double c = 0.5 * length(h);
    if (c < 0.8)
      continue;
    double slope = std::sqrt(sqr(h.x) + sqr(h.y)) / h.z;
    double floor = 0.05; // of the diffuse base
    double value = row.weight * std::max(row.value[0] + row.value[1] + row.value[2] - floor, 0.0);
    slopes.emplace_back(slope, value);
    sum += value;
  }
  std::sort(slopes.begin(), slopes.end());
  double below = 0;
  for (auto [slope, value] : slopes)
    if ((below += value) >= 0.5 * sum)
      return std::clamp(slope, 0.003, 0.7);
  return 0.2;
}

} // namespace faceta
