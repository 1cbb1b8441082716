#include "verify/fit_model.h"

#include "base/maths.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

using Names = std::vector<std::string>;

/// How a model is put together for a number of lobes.
struct Recipe {
  const char* name;
  const char* model;
  int most_lobes;
  Settings fixed;
  Names held; ///< parameters that keep their defaults or fixed values
};

const Names kGgxHeld{"gloss_fresnel", "gloss_tail", "gloss_along", "gloss_across", "gloss_masking",
                     "haze_fresnel",  "haze_tail",  "haze_along",  "haze_across",  "haze_masking"};

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> list{
      {"hazygloss", "hazygloss", 3, {}, {}},
      {"ggx", "hazygloss", 3, {{"gloss_tail", "2"}, {"haze_tail", "2"}}, kGgxHeld},
      {"roughconductor", "roughconductor", 3, {{"distribution", "ggx"}}, {"specular_reflectance"}},
      {"roughplastic", "roughplastic", 1, {{"distribution", "ggx"}}, {"ext_ior"}},
      {"phong", "phong", 3, {}, {}},
      {"blinnphong", "blinnphong", 3, {}, {}},
      {"ward", "ward", 3, {}, {}},
      {"orennayar", "orennayar", 1, {}, {}},
      {"diffuse", "diffuse", 1, {}, {}}};
  return list;
}

const Recipe& recipe_of(const std::string& name) {
  for (const Recipe& r : recipes())
    if (name == r.name)
      return r;
  throw Error("'" + name + "' is no model that can be fitted", {},
              suggestion(name, fit_model_names()));
}

/// Where a parameter may go in a fit: its soft range, logarithmic where that spans decades.
FitTransform transform_of(const ParamInfo& p) {
  double low = p.soft.low, high = p.soft.high;
  if (p.kind == ParamKind::reflectance)
    return {0, 1};
  if (p.kind == ParamKind::spectrum)
    return {0.01, high, true};
  if (p.name == "exponent")
    return {0.1, 1e5, true};
  return {low, high, low > 0 && high > 20 * low};
}

/// One colour is three numbers, alpha of both directions is one.
bool is_free(const ParamInfo& p, const Names& held) {
  if (p.slot < 0 || p.kind == ParamKind::metal || p.kind == ParamKind::choice ||
      p.kind == ParamKind::flag || p.name == "alpha_u" || p.name == "alpha_v")
    return false;
  return std::find(held.begin(), held.end(), p.name) == held.end();
}

} // namespace

double FitTransform::value(double x) const {
  double s = 1 / (1 + std::exp(-x));
  return logarithmic ? low * std::pow(high / low, s) : low + (high - low) * s;
}

double FitTransform::slope(double x) const {
  double s = 1 / (1 + std::exp(-x)), ds = s * (1 - s);
  return logarithmic ? value(x) * std::log(high / low) * ds : (high - low) * ds;
}

double FitTransform::inverse(double y) const {
  double s = logarithmic ? std::log(y / low) / std::log(high / low) : (y - low) / (high - low);
  if (!(s > 1e-6))
    s = 1e-6;
  s = std::min(s, 1 - 1e-6);
  return std::log(s / (1 - s));
}

std::vector<DirectionPair> pairs_of(std::span<const FitRow> rows) {
  std::vector<DirectionPair> pairs;
  for (const FitRow& row : rows)
    pairs.push_back({row.wo, row.wi});
  return pairs;
}

std::vector<std::string> fit_model_names() {
  std::vector<std::string> names;
  for (const Recipe& r : recipes())
    names.push_back(r.name);
  return names;
}

int most_fit_lobes(const std::string& model) {
  return recipe_of(model).most_lobes;
}

FitModel::FitModel(const std::string& model, int lobes) : name_(model), lobes_(lobes) {
  const Recipe& recipe = recipe_of(model);
  if (lobes < 1 || lobes > recipe.most_lobes)
    throw Error(fmt::format("{} is fitted with {} lobe{}, not {}", model,
                            recipe.most_lobes > 1 ? "1 to 3" : "1",
                            recipe.most_lobes > 1 ? "s" : "", lobes));
  bool pairs = recipe.model == std::string("hazygloss"); // two lobes a node
  int terms = pairs ? (lobes + 1) / 2 : lobes;
  for (int k = 0; k < terms; ++k) {
    FitTerm term{recipe.model, recipe.fixed};
    Names held = recipe.held;
    if (pairs && 2 * k + 1 == lobes) { // without a second lobe
      for (const char* name : {"haze_normal", "haze_grazing"})
        term.fixed.emplace_back(name, "0");
      for (const char* name : {"haze_normal", "haze_grazing", "haze_fresnel", "haze_alpha",
                               "haze_tail", "haze_along", "haze_across", "haze_masking"})
        held.push_back(name);
    }
    if (k > 0 && Registry::global().get(recipe.model).descriptor.find("diffuse_reflectance")) {
      term.fixed.emplace_back("diffuse_reflectance", "0");
      held.push_back("diffuse_reflectance");
    }
    add(std::move(term), held);
  }
  if (recipe.model == std::string("roughconductor"))
    add({"diffuse", {}}, {});
}

void FitModel::add(FitTerm term, const std::vector<std::string>& held) {
  const Model& model = Registry::global().get(term.model);
  Parameters given = make_parameters(term.model, term.fixed);
  std::vector<int> slots, owners;
  for (const ParamInfo& p : model.descriptor.params) {
    if (!is_free(p, held))
      continue;
    bool color = p.kind == ParamKind::reflectance || p.kind == ParamKind::spectrum;
    for (int c = 0; c < (color ? 3 : 1); ++c) {
      FitParameter free{int(terms_.size()), p.name, color ? c : -1, {}, transform_of(p), 0};
      for (int s = color ? c : 0; s < (color ? c + 1 : p.slots); ++s) {
        free.slots.push_back(p.slot + s);
        slots.push_back(p.slot + s);
        owners.push_back(int(parameters_.size()));
      }
      free.start = given.slots()[size_t(free.slots[0])];
      parameters_.push_back(std::move(free));
    }
  }
  terms_.push_back(std::move(term));
  active_.push_back(std::move(slots));
  owner_.push_back(std::move(owners));
  models_.push_back(&model);
}

std::vector<double> FitModel::start() const {
  std::vector<double> x;
  for (const FitParameter& p : parameters_)
    x.push_back(std::clamp(p.transform.inverse(p.start), -3.0, 3.0));
  x.resize(size_t(size()), 0.0);
  return x;
}

FitModel::State FitModel::state(const std::vector<double>& x) const {
  State s;
  s.x = x;
  double sum = 1;
  s.weights.assign(1, 1.0);
  for (size_t k = parameters_.size(); k < x.size(); ++k) {
    s.weights.push_back(std::exp(x[k]));
    sum += s.weights.back();
  }
  for (double& w : s.weights)
    w /= sum;
  for (const FitTerm& term : terms_)
    s.slots.push_back(make_parameters(term.model, term.fixed).slots());
  for (size_t j = 0; j < parameters_.size(); ++j)
    for (int slot : parameters_[j].slots)
      s.slots[size_t(parameters_[j].term)][size_t(slot)] = parameters_[j].transform.value(x[j]);
  for (size_t k = 0; k < terms_.size(); ++k) {
    Parameters fixed = make_parameters(terms_[k].model, terms_[k].fixed);
    s.records.push_back(fixed.model().make_record(s.slots[k], fixed.choices(), {}));
    // Derived slots and tables are the record's own.
    std::vector<int> given = fixed.descriptor().parameter_slots();
    for (size_t i = 0; i < s.records[k].slots.size(); ++i)
      if (i >= s.slots[k].size())
        s.slots[k].push_back(s.records[k].slots[i]);
      else if (std::find(given.begin(), given.end(), int(i)) == given.end())
        s.slots[k][i] = s.records[k].slots[i];
  }
  return s;
}

void FitModel::evaluate(const State& state, std::span<const FitRow> rows, double* values,
                        double* derivatives) const {
  size_t count = 3 * rows.size(), n = size_t(size());
  std::fill(values, values + count, 0.0);
  if (derivatives)
    std::fill(derivatives, derivatives + count * n, 0.0);
  std::vector<double> term(count), slopes;
  std::vector<DirectionPair> pairs = pairs_of(rows);
  for (size_t k = 0; k < terms_.size(); ++k) {
    size_t width = active_[k].size();
    if (derivatives)
      slopes.resize(count * width);
    models_[k]->eval_rows(state.records[k], state.slots[k], active_[k], pairs, term.data(),
                          derivatives ? slopes.data() : nullptr);
    double w = state.weights[k];
    for (size_t i = 0; i < count; ++i)
      values[i] += w * term[i];
    if (!derivatives)
      continue;
    for (size_t a = 0; a < width; ++a) {
      size_t j = size_t(owner_[k][a]);
      double scale = w * parameters_[j].transform.slope(state.x[j]);
      for (size_t i = 0; i < count; ++i)
        derivatives[i * n + j] += scale * slopes[i * width + a];
    }
    // The k-th share grows at the cost of all: dw_l/dx_k = w_l (delta_kl - w_k).
    for (size_t l = 1; l < terms_.size(); ++l) {
      size_t j = parameters_.size() + l - 1;
      double scale = w * ((l == k ? 1.0 : 0.0) - state.weights[l]);
      for (size_t i = 0; i < count; ++i)
        derivatives[i * n + j] += scale * term[i];
    }
  }
}

Settings FitModel::settings(const State& state, size_t term) const {
  Settings settings = terms_[term].fixed;
  for (size_t j = 0; j < parameters_.size(); ++j) {
    const FitParameter& p = parameters_[j];
    if (size_t(p.term) != term)
      continue;
    std::string text = fmt::format("{:.6g}", state.slots[term][size_t(p.slots[0])]);
    if (p.channel > 0)
      settings.back().second += "," + text;
    else
      settings.emplace_back(p.name, text);
  }
  return settings;
}

} // namespace faceta
