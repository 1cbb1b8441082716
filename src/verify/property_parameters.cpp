#include "verify/parameter_values.h"
#include "verify/properties.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <set>

namespace faceta {

namespace {

std::vector<std::string> values_to_try(const ParamInfo& p) {
  if (p.kind == ParamKind::metal)
    return {"Au", "Ag", "Al", "none"};
  if (p.kind == ParamKind::file)
    return {"demo:plastic", "demo:metal", "demo:shade", "demo:tree4"}; // two for either model
  if (!p.choices.empty())
    return p.choices;
  std::vector<std::string> values;
  for (double u : {0.0, 0.13, 0.5, 0.87, 1.0})
    values.push_back(fmt::format("{}", soft_value(p, u)));
  return values;
}

// Everything a set of parameters does to fixed inputs.
std::vector<float> fingerprint(const Subject& subject) {
  const int n = 512;
  RandomStream random(101);
  SampleBatch s(n);
  EvalBatch e(n);
  for (int i = 0; i < n; ++i) {
    double z = 1 - random.next() * (subject.traits().two_sided ? 2 : 1),
           phi = 2 * kPi * random.next();
    double r = std::sqrt(1 - z * z);
    Vec3<float> wo = to_single({r * std::cos(phi), r * std::sin(phi), z});
    double spread = std::pow(10.0, -4 * random.next()), turn = spread * random.next();
    double c = std::cos(turn), d = std::sin(turn);
    s.set_viewer(i, wo);
    // Near the mirror direction, so that narrow lobes are seen.
    e.set(i, wo, {float(-c * wo.x + d * wo.y), float(-d * wo.x - c * wo.y), wo.z});
  }
  s.draw(random);
  s.run(subject.kernel(Isa::scalar), subject.record.args());
  e.run(subject.kernel(Isa::scalar), subject.record.args());
  std::vector<float> result;
  for (const std::vector<float>* a :
       {&s.wi[0], &s.wi[1], &s.wi[2], &s.pdf, &s.weight[0], &s.weight[1], &s.weight[2], &s.eta,
        &e.value[0], &e.value[1], &e.value[2], &e.pdf})
    result.insert(result.end(), a->begin(), a->begin() + n);
  for (int i = 0; i < n; ++i)
    result.push_back(float(s.flags[i]));
  return result;
}

bool same_prints(const std::vector<float>& a, const std::vector<float>& b) {
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

bool matters(const Model& model, const ParamInfo& p) {
  for (const Exemplar& exemplar : model.descriptor.exemplars) {
    std::vector<float> first;
    bool refused = false;
    for (const std::string& value : values_to_try(p)) {
      try {
        std::vector<float> print = fingerprint(Subject(model, changed(model, exemplar, p, value)));
        if (first.empty())
          first = print;
        else if (!same_prints(first, print))
          return true;
      } catch (const Error&) {
        // Not every value goes with every exemplar (equal indices, a name that excludes others).
        refused = true;
      }
    }
    if (p.reads_file && refused)
      return true;
  }
  return false;
}

void check_refusal(const Model& model, const ParamInfo& p, const std::string& text,
                   Outcome& outcome) {
  try {
    Parameters parameters(model);
    parameters.set(p.name, text);
    if (p.kind == ParamKind::file)
      parameters.load_file();
  } catch (const Error& e) {
    if (std::string(e.what()).find(p.name) == std::string::npos && p.kind != ParamKind::metal &&
        p.kind != ParamKind::ior && p.kind != ParamKind::file)
      outcome.fail(
          fmt::format("'{}' = {} is refused without naming it: {}", p.name, text, e.what()));
    return;
  }
  outcome.fail(fmt::format("'{}' = {} is accepted", p.name, text));
}

void check_range(const Model& model, const ParamInfo& p, Outcome& outcome) {
  check_refusal(model, p, "no such thing", outcome);
  if (p.slot < 0)
    return;
  for (const char* text : {"nan", "inf", "-inf", ""})
    check_refusal(model, p, text, outcome);
  if (std::isfinite(p.hard.low))
    check_refusal(model, p, fmt::format("{}", std::nextafter(p.hard.low, -kInfinity)), outcome);
  if (std::isfinite(p.hard.high))
    check_refusal(model, p, fmt::format("{}", std::nextafter(p.hard.high, kInfinity)), outcome);
  if (!(p.soft.low >= p.hard.low && p.soft.high <= p.hard.high && p.soft.low < p.soft.high))
    outcome.fail(fmt::format("the soft range of '{}' is not inside the hard one", p.name));
  for (double value : p.defaults)
    if (!(value >= p.hard.low && value <= p.hard.high))
      outcome.fail(fmt::format("the default {} of '{}' is out of range", value, p.name));
}

std::string difference_of(const Parameters& a, const Parameters& b) {
  for (const ParamInfo& p : a.descriptor().params) {
    if (p.choice >= 0 && a.choices()[p.choice] != b.choices()[p.choice])
      return p.name;
    for (int k = 0; p.slot >= 0 && k < p.slots; ++k)
      if (std::bit_cast<uint64_t>(a.slots()[p.slot + k]) !=
          std::bit_cast<uint64_t>(b.slots()[p.slot + k]))
        return p.name;
    if (a.was_set(p.name) && a.given_name(p.name) != b.given_name(p.name))
      return p.name + " (its name)";
  }
  return {};
}

Parameters through_text(const Parameters& p) {
  Parameters result(p.model());
  for (const ParamInfo& info : p.descriptor().params)
    if (p.was_set(info.name))
      result.set(info.name, p.text(info.name));
  return result;
}

// Numbers without short decimals in every parameter that goes with what the exemplar gives.
Parameters with_random_numbers(const Parameters& given, RandomStream& random) {
  Parameters p = given;
  for (const ParamInfo& info : p.descriptor().params) {
    bool clash = info.slot < 0 || info.reads_file || lists(info.excludes, "eta") ||
                 !p.given_name(info.name).empty();
    for (const ParamInfo& other : p.descriptor().params)
      clash = clash || (p.was_set(other.name) &&
                        (lists(info.excludes, other.name) || lists(other.excludes, info.name)));
    std::string partner = partner_of(info.name);
    if (clash || (!partner.empty() && !p.was_set(info.name)))
      continue;
    auto draw = [&] { return soft_value(info, random.next()); };
    if (info.slots == 3)
      p.set_color(info.name, {draw(), draw(), draw()});
    else
      p.set_number(info.name, draw());
  }
  return p;
}

} // namespace

std::vector<std::pair<std::string, RoundTrip>>& round_trips() {
  static std::vector<std::pair<std::string, RoundTrip>> trips = {{"text", through_text}};
  return trips;
}

std::vector<std::pair<std::string, TreeRoundTrip>>& tree_round_trips() {
  static std::vector<std::pair<std::string, TreeRoundTrip>> formats;
  return formats;
}

Outcome check_round_trip(const Subject& subject, Effort, double) {
  Outcome outcome;
  if (subject.tree) {
    for (const auto& [format, trip] : tree_round_trips()) {
      std::string back = MaterialTree(*trip(subject.tree->definition())).text();
      if (back != subject.tree->text())
        outcome.fail(fmt::format("{} makes {} of {}", format, back, subject.tree->text()));
    }
    return outcome;
  }
  RandomStream random(111);
  for (const auto& [format, trip] : round_trips())
    for (int round = 0; round < 20; ++round) {
      Parameters given =
          round == 0 ? *subject.parameters : with_random_numbers(*subject.parameters, random);
      std::string difference = difference_of(given, trip(given));
      if (!difference.empty())
        outcome.fail(fmt::format("{} changes {}", format, difference));
    }
  return outcome;
}

Outcome check_parameters(const Model& model) {
  Outcome outcome;
  for (const ParamInfo& p : model.descriptor.params) {
    check_range(model, p, outcome);
    if (!matters(model, p))
      outcome.fail(fmt::format("'{}' changes nothing", p.name));
  }
  return outcome;
}

Outcome check_description(const Model& model) {
  Outcome outcome;
  const Descriptor& d = model.descriptor;
  if (d.name.empty() || d.title.empty() || d.equation.empty())
    outcome.fail("name, title or equation is missing");
  if (d.references.empty())
    outcome.fail("no reference");
  if (d.exemplars.empty())
    outcome.fail("no exemplar: nothing would be tested");
  for (const ParamInfo& p : d.params)
    if (p.doc.empty())
      outcome.fail(fmt::format("parameter '{}' is not documented", p.name));
  std::set<std::string> names;
  for (const Exemplar& e : d.exemplars)
    if (!names.insert(e.name).second || e.name.empty())
      outcome.fail(fmt::format("two exemplars are named '{}'", e.name));
  for (const Excuse& e : d.excuses) {
    bool known = false;
    for (const Property& p : subject_properties())
      known = known || e.property == p.name;
    if (!known || e.reason.empty() || e.reference.empty())
      outcome.fail(
          fmt::format("excuse for '{}': no such property, no reason or no reference", e.property));
  }
  return outcome;
}

const std::vector<Property>& subject_properties() {
  static const std::vector<Property> properties = {
      {"finite", "values, densities and weights are finite and not negative", check_finite},
      {"chi2", "samples follow the density", check_chi_square, "smallest p-value"},
      {"density", "the density integrates to one minus the failures", check_density,
       "largest difference"},
      {"consistency", "eval() agrees with sample()", check_consistency, "largest relative error"},
      {"energy", "no more light leaves than the model may give back", check_energy,
       "largest albedo"},
      {"reciprocity", "both directions of light see the same value", check_reciprocity,
       "largest relative difference"},
      {"modes", "transport modes differ by eta squared only", check_modes,
       "largest relative error"},
      {"lanes", "every instruction set gives the same bits", check_lanes},
      {"precision", "float is as good as its inputs allow", check_precision,
       "largest error over what is allowed"},
      {"derivatives", "automatic derivatives agree with differences", check_derivatives,
       "largest relative error"},
      {"channels", "colours of any width work alike", check_channels,
       "largest error over what is allowed"},
      {"round_trip", "parameters survive writing and reading", check_round_trip}};
  return properties;
}

const std::vector<ModelProperty>& model_properties() {
  static const std::vector<ModelProperty> properties = {
      {"description", "the model is described completely", check_description},
      {"parameters", "every parameter has its range and its effect", check_parameters},
      {"textures", "every textured parameter is taken lane by lane", check_textures},
      {"limits", "at the ends of its ranges the model becomes those it should", check_limits},
      {"albedos", "albedos are those that others have computed", check_albedos}};
  return properties;
}

const Excuse* find_excuse(const Descriptor& descriptor, const std::string& property) {
  for (const Excuse& e : descriptor.excuses)
    if (e.property == property)
      return &e;
  return nullptr;
}

} // namespace faceta
