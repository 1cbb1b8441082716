#include "verify/parameter_values.h"
#include "verify/properties.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

constexpr int kQueries = 1021; // a last group that is not full
constexpr double kTableError = 0.05;

// The two values that alternate, as text: channels differ, so that none is taken for another.
std::array<std::string, 2> two_values(const ParamInfo& p) {
  auto text = [&](double u) { return fmt::format("{}", float(soft_value(p, u))); };
  if (p.kind == ParamKind::reflectance || p.kind == ParamKind::spectrum)
    return {text(0.125) + "," + text(0.5) + "," + text(0.75),
            text(0.875) + "," + text(0.25) + "," + text(0.375)};
  return {text(0.125), text(0.875)};
}

struct Queries {
  EvalBatch evals{kQueries};
  SampleBatch samples{kQueries};
};

// Pairs around the mirror direction and everywhere; samples of the same viewers.
Queries make_queries(const Subject& subject) {
  Queries q;
  RandomStream random(121);
  for (int i = 0; i < kQueries; ++i) {
    double z = 1 - random.next() * (subject.traits().two_sided ? 2 : 1);
    double phi = 2 * kPi * random.next(), r = std::sqrt(1 - z * z);
    q.samples.set_viewer(i, to_single({r * std::cos(phi), r * std::sin(phi), z}));
  }
  q.samples.draw(random);
  subject.run(q.samples, TransportMode::radiance);
  for (int i = 0; i < kQueries; ++i) {
    Vec3<float> wo = q.samples.viewer(i);
    q.evals.set(i, wo, q.samples.valid(i) ? q.samples.light(i) : Vec3<float>{-wo.x, -wo.y, wo.z});
  }
  return q;
}

void run(Queries& q, const MaterialKernel& kernel, const MaterialArgs& args) {
  q.evals.run(kernel, args);
  q.samples.run(kernel, args);
}

// How far a lane may be from the material with its value: 0 means the same bits.
double tolerance_of(const Subject& subject) {
  int declared = 0;
  for (const ParamInfo& p : subject.model->descriptor.params)
    if (p.slot >= 0)
      declared = std::max(declared, p.slot + p.slots);
  const Descriptor& d = subject.model->descriptor;
  if (declared + int(d.table_slots.size()) == d.slots && subject.record.tables.empty())
    return 0;
  return declared + int(d.table_slots.size()) == d.slots ? kTableError : 1e-5;
}

bool same(float a, float b, double tolerance) {
  if (tolerance == 0)
    return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b);
  double least = tolerance == kTableError ? 3e-3 : 1e-12; // errors of albedos, over their mean
  return std::abs(double(a) - b) <= tolerance * std::max(std::abs(a), std::abs(b)) + least;
}

// Compares lane i. With derived numbers the choice between lobes is that of the mean, so that only
// values are compared, and the energy that a delta lobe carries.
bool same_lane(const Queries& a, const Queries& b, int i, double tolerance) {
  bool equal = tolerance > 0 || (same(a.evals.pdf[i], b.evals.pdf[i], 0) &&
                                 a.samples.flags[i] == b.samples.flags[i] &&
                                 same(a.samples.pdf[i], b.samples.pdf[i], 0));
  for (int k = 0; k < 3; ++k) {
    equal = equal && same(a.evals.value[k][i], b.evals.value[k][i], tolerance);
    float x = a.samples.weight[k][i], y = b.samples.weight[k][i];
    if (tolerance == 0)
      equal = equal && same(x, y, 0) && same(a.samples.wi[k][i], b.samples.wi[k][i], 0);
    else if (a.samples.delta(i) && b.samples.delta(i))
      equal = equal && same(x * a.samples.pdf[i], y * b.samples.pdf[i], tolerance);
  }
  return equal;
}

// One exemplar, one parameter. Whether the two values make a difference.
bool check_texture(const Model& model, const Exemplar& exemplar, const ParamInfo& p,
                   Outcome& outcome) {
  std::array<std::string, 2> texts = two_values(p);
  Subject ends[2] = {{model, changed(model, exemplar, p, texts[0])},
                     {model, changed(model, exemplar, p, texts[1])}};
  Parameters between = *ends[0].parameters;
  std::array<double, 3> middle{};
  for (int k = 0; k < 3; ++k) {
    int slot = p.slot + std::min(k, p.slots - 1);
    middle[k] = 0.5 * (ends[0].parameters->slots()[slot] + ends[1].parameters->slots()[slot]);
  }
  between.set_texture(p.name, middle);
  Subject textured(model, between);

  Queries expected[2] = {make_queries(textured), make_queries(textured)};
  Queries queries = expected[0];
  for (int side = 0; side < 2; ++side)
    run(expected[side], *model.kernels[int(Isa::scalar)], ends[side].record.args());
  std::vector<std::vector<float>> texels(p.slots, std::vector<float>(kQueries + kLanePadding));
  std::vector<const float*> lane_slots(textured.record.slots.size(), nullptr);
  MaterialArgs args = textured.record.args();
  for (int k = 0; k < p.slots; ++k) {
    for (size_t i = 0; i < texels[k].size(); ++i)
      texels[k][i] = ends[i % 2].record.slots[p.slot + k];
    lane_slots[p.slot + k] = texels[k].data();
    args.textured |= uint64_t(1) << (p.slot + k);
  }
  args.lane_slots = lane_slots.data();
  const double tolerance = tolerance_of(textured);
  bool matters = false;
  for (int isa = 0; isa < kIsaCount; ++isa) {
    if (!model.kernels[isa])
      continue;
    run(queries, *model.kernels[isa], args);
    for (int i = 0; i < kQueries; ++i) {
      matters = matters || !same_lane(expected[0], expected[1], i, tolerance);
      if (!same_lane(queries, expected[i % 2], i, tolerance))
        outcome.fail(fmt::format(
            "{}: a texture on '{}' of the exemplar '{}' gives ({:.9g}, {:.9g}, {:.9g}) at wo = {}, "
            "wi = {}; the value {} gives ({:.9g}, {:.9g}, {:.9g})",
            kIsaNames[isa], p.name, exemplar.name, queries.evals.value[0][i],
            queries.evals.value[1][i], queries.evals.value[2][i], to_text(queries.evals.viewer(i)),
            to_text(queries.evals.light(i)), texts[i % 2], expected[i % 2].evals.value[0][i],
            expected[i % 2].evals.value[1][i], expected[i % 2].evals.value[2][i]));
    }
  }
  return matters;
}

} // namespace

Outcome check_textures(const Model& model) {
  Outcome outcome;
  outcome.applicable = false;
  outcome.message = "no parameter takes a texture";
  for (const ParamInfo& p : model.descriptor.params) {
    if (!p.textured)
      continue;
    if (!outcome.applicable)
      outcome.message.clear();
    outcome.applicable = true;
    bool matters = false;
    for (const Exemplar& exemplar : model.descriptor.exemplars)
      matters = check_texture(model, exemplar, p, outcome) || matters;
    if (!matters)
      outcome.fail(fmt::format("a texture on '{}' changes nothing", p.name));
  }
  return outcome;
}

} // namespace faceta
