#include "verify/fit.h"

#include "base/maths.h"
#include "verify/fit_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <thread>

namespace faceta {

namespace {

/// Rows of the searches from many starts and of the last one.
constexpr size_t kCoarseRows = 1000, kFineRows = 3000;

double bic_of(double cost, size_t rows, int parameters) {
  double n = 3.0 * double(rows);
  return n * std::log(std::max(cost, 1e-30)) + parameters * std::log(n);
}

int step_for(const FitData& data, size_t rows) {
  // Odd, and prime to the grid's 45, so that all coordinates are met.
  int step = std::max(1, int(data.rows.size() / rows));
  while (step > 1 && (step % 2 == 0 || step % 3 == 0 || step % 5 == 0))
    --step;
  return step;
}

class Fitter {
public:
  Fitter(const FitData& data, const FitOptions& options)
      : data_(data), coarse_(thin_out(data, step_for(data, kCoarseRows))),
        fine_(thin_out(data, step_for(data, kFineRows))), alpha_(guess_alpha(data)) {
    threads_ = options.threads > 0 ? options.threads
                                   : std::max(1, int(std::thread::hardware_concurrency()));
    metric_ = options.metric;
  }

  struct Try {
    FitModel model;
    FitSolution best;
    double bic;
  };

  /// The best of several starts, on few rows: a few steps from all, more from the better two.
  Try coarse(const std::string& name, int lobes) {
    FitModel model(name, lobes);
    std::vector<FitSolution> list;
    for (const FitStart& start : starts(lobes))
      list.push_back(search(model, coarse_, start_fit(model, coarse_, start, metric_), 12, 1e-3));
    auto less = [](const FitSolution& a, const FitSolution& b) { return a.cost < b.cost; };
    std::sort(list.begin(), list.end(), less);
    for (size_t i = 0; i < std::min<size_t>(2, list.size()); ++i)
      list[i] = search(model, coarse_, list[i].x, 40, 1e-5);
    FitSolution best = *std::min_element(list.begin(), list.end(), less);
    double bic = bic_of(best.cost, data_.rows.size(), model.size());
    return {std::move(model), std::move(best), bic};
  }

  FitSolution fine(const Try& t) { return search(t.model, fine_, t.best.x, 150, 2e-6); }
  int iterations() const { return iterations_; }

private:
  const FitData& data_;
  FitData coarse_, fine_;
  double alpha_;
  FitMetric metric_;
  int threads_, iterations_ = 0;

  FitSolution search(const FitModel& model, const FitData& data, const std::vector<double>& x,
                     int iterations, double tolerance) {
    FitSolution s = solve_fit(model, data, x, {metric_, iterations, tolerance, threads_});
    iterations_ += s.iterations;
    return s;
  }
  std::vector<FitStart> starts(int lobes) const {
    double a = alpha_, wide = std::min(3 * a, 0.9);
    if (lobes == 1)
      return {{{a}}, {{0.3 * a}}, {{std::min(2 * a, 0.9)}}, {{a}, true}};
    if (lobes == 2)
      return {{{0.7 * a, wide}}, {{0.3 * a, a}},       {{a, a}},
              {{0.01, 0.15}},    {{0.7 * a, a}, true}, {{a, 0.3 * a}, true}};
    return {{{0.4 * a, a, wide}}, {{0.01, 0.05, 0.3}}, {{0.7 * a, a, wide}, true}};
  }
};

/// What options leave open.
std::vector<std::pair<std::string, int>> candidates_of(const FitOptions& options) {
  std::vector<std::pair<std::string, int>> list;
  std::vector<std::string> models{options.model};
  if (options.model == "auto")
    models = {"roughconductor", "ggx", "hazygloss"};
  for (const std::string& model : models) {
    int most = most_fit_lobes(model);
    if (options.lobes > 0)
      list.emplace_back(model, options.lobes);
    else
      for (int lobes = 1; lobes <= std::min(most, 2); ++lobes)
        list.emplace_back(model, lobes);
  }
  return list;
}

/// Parameters as they are written out, rounded, so that the errors are those of the file.
std::vector<FitPart> parts_of(const FitModel& model, const FitModel::State& state) {
  std::vector<FitPart> parts;
  for (size_t k = 0; k < model.terms().size(); ++k)
    parts.push_back(
        {state.weights[k], make_parameters(model.terms()[k].model, model.settings(state, k))});
  return parts;
}

std::vector<double> values_of(const std::vector<FitPart>& parts, const FitData& data) {
  std::vector<double> sum(3 * data.rows.size()), values(sum.size());
  std::vector<DirectionPair> pairs = pairs_of(data.rows);
  for (const FitPart& part : parts) {
    Record record = part.parameters.record();
    std::vector<double> slots(record.slots.begin(), record.slots.end());
    part.parameters.model().eval_rows(record, slots, {}, pairs, values.data(), nullptr);
    for (size_t i = 0; i < sum.size(); ++i)
      sum[i] += part.share * values[i];
  }
  return sum;
}

/// The parts from `first` on, scaled to shares that add up to 1.
std::shared_ptr<MaterialNode> sum_node(const std::vector<FitPart>& parts, size_t first) {
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(parts[first].parameters);
  if (first + 1 == parts.size())
    return node;
  double rest = 0;
  for (size_t k = first + 1; k < parts.size(); ++k)
    rest += parts[k].share;
  auto blend = std::make_shared<MaterialNode>();
  blend->kind = MaterialNode::Kind::blend;
  blend->weight.value.fill(rest / (rest + parts[first].share));
  blend->children = {node, sum_node(parts, first + 1)};
  return blend;
}

/// Numbers as numbers, colours as three, names as text: as a material's JSON has them.
nlohmann::ordered_json value_json(const Parameters& parameters, const std::string& name) {
  const ParamInfo& p = *parameters.descriptor().find(name);
  if (p.slot < 0 || !parameters.given_name(name).empty())
    return parameters.text(name);
  const double* slots = &parameters.slots()[size_t(p.slot)];
  if (p.kind == ParamKind::reflectance || p.kind == ParamKind::spectrum)
    return {slots[0], slots[1], slots[2]};
  return slots[0];
}

nlohmann::ordered_json errors_json(const FitErrors& e) {
  return {{"log", e[0]}, {"cbrt", e[1]}, {"rel", e[2]}};
}

} // namespace

FitResult fit_material(const FitData& data, const FitOptions& options) {
  auto begin = std::chrono::steady_clock::now();
  Fitter fitter(data, options);
  FitResult result;
  std::vector<Fitter::Try> tries;
  for (const auto& [name, lobes] : candidates_of(options)) {
    tries.push_back(fitter.coarse(name, lobes));
    const Fitter::Try& t = tries.back();
    result.candidates.push_back({name, lobes, t.model.size(), std::sqrt(t.best.cost), t.bic});
  }
  auto best = std::min_element(tries.begin(), tries.end(),
                               [](const auto& a, const auto& b) { return a.bic < b.bic; });
  FitSolution solution = fitter.fine(*best);
  result.model = best->model.name();
  result.lobes = best->model.lobes();
  result.parameters = best->model.size();
  result.parts = parts_of(best->model, best->model.state(solution.x));
  result.fitted = values_of(result.parts, data);
  result.errors = fit_errors(data, result.fitted);
  double error = result.errors.all[size_t(options.metric)];
  result.bic = bic_of(sqr(error), data.rows.size(), result.parameters);
  result.iterations = fitter.iterations();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

std::shared_ptr<MaterialNode> fit_node(const FitResult& result) {
  return sum_node(result.parts, 0);
}

std::string fit_json(const FitResult& result) {
  nlohmann::ordered_json json{{"model", result.model},
                              {"lobes", result.lobes},
                              {"free_parameters", result.parameters},
                              {"bic", result.bic},
                              {"iterations", result.iterations},
                              {"seconds", result.seconds},
                              {"errors", errors_json(result.errors.all)}};
  for (size_t c = 0; c < 3; ++c)
    json["errors_by_channel"].push_back(errors_json(result.errors.channels[c]));
  for (size_t b = 0; b < 9; ++b)
    if (result.errors.weight_by_theta_i[b] > 0) {
      nlohmann::ordered_json bin{{"theta_i", {10 * b, 10 * b + 10}},
                                 {"weight", result.errors.weight_by_theta_i[b]}};
      bin.update(errors_json(result.errors.by_theta_i[b]));
      json["errors_by_theta_i"].push_back(bin);
    }
  for (const FitPart& part : result.parts) {
    nlohmann::ordered_json parameters;
    for (const auto& [name, text] : part.parameters.given())
      parameters[name] = value_json(part.parameters, name);
    nlohmann::ordered_json material{{"model", part.parameters.model().name()},
                                    {"parameters", parameters}};
    json["parts"].push_back({{"share", part.share}, {"material", material}});
  }
  for (const FitCandidate& c : result.candidates)
    json["candidates"].push_back({{"model", c.model},
                                  {"lobes", c.lobes},
                                  {"free_parameters", c.parameters},
                                  {"error", c.error},
                                  {"bic", c.bic}});
  return json.dump(2) + "\n";
}

std::string fit_text(const FitResult& result) {
  const FitErrorReport& e = result.errors;
  std::string text = fmt::format("{}, {} lobe{}, {} free numbers: {} iterations, {:.2f} s\n"
                                 "            E_log   E_cbrt    E_rel\n",
                                 result.model, result.lobes, result.lobes == 1 ? "" : "s",
                                 result.parameters, result.iterations, result.seconds);
  auto line = [&](const std::string& name, const FitErrors& v) {
    text += fmt::format("{:8} {:8.4f} {:8.4f} {:8.4f}\n", name, v[0], v[1], v[2]);
  };
  line("all", e.all);
  for (size_t c = 0; c < 3; ++c)
    line(std::array{"red", "green", "blue"}[c], e.channels[c]);
  for (size_t b = 0; b < 9; ++b)
    if (e.weight_by_theta_i[b] > 0)
      line(fmt::format("{}-{} deg", 10 * b, 10 * b + 10), e.by_theta_i[b]);
  for (const FitPart& part : result.parts) {
    text += fmt::format("{:.4g} x {}\n", part.share, part.parameters.model().name());
    for (const auto& [name, value] : part.parameters.given())
      text += fmt::format("  {} = {}\n", name, part.parameters.text(name));
  }
  if (result.candidates.size() > 1)
    for (const FitCandidate& c : result.candidates)
      text += fmt::format("tried {:15} {} lobe{}: error {:.4f}, BIC {:.0f}\n", c.model, c.lobes,
                          c.lobes == 1 ? " " : "s", c.error, c.bic);
  return text;
}

} // namespace faceta
