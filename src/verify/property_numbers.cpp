#include "verify/properties.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

// What is too dark for its digits to matter: 1e-9 of a white surface.
constexpr double kBlack = 3e-10;

Vec3<float> random_direction(RandomStream& random) {
  double z = 1 - 2 * random.next(), phi = 2 * kPi * random.next();
  if (random.next() < 0.1)
    z = std::copysign(std::pow(10.0, -12 * random.next()), z); // grazing
  double r = std::sqrt(std::max(0.0, 1 - z * z));
  return to_single({r * std::cos(phi), r * std::sin(phi), z});
}

// Pairs where the lobes are (sampled ones) and anywhere.
EvalBatch pairs_of(const Subject& subject, int n, uint64_t seed) {
  SampleBatch s(n);
  RandomStream random(subject.stream(seed));
  for (int i = 0; i < n; ++i)
    s.set_viewer(i, random_direction(random));
  s.draw(random);
  subject.run(s, TransportMode::radiance);
  EvalBatch e(n);
  for (int i = 0; i < n; ++i)
    e.set(i, s.viewer(i), i % 3 && s.valid(i) ? s.light(i) : random_direction(random));
  return e;
}

bool same_bits(float a, float b) {
  return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b) || (a != a && b != b);
}

// The inputs of one comparison between instruction sets.
struct LaneCase {
  const char* name;
  MaterialArgs args;
};

std::string compare_evals(const EvalBatch& a, const EvalBatch& b) {
  for (int i = 0; i < a.n; ++i)
    for (int k = 0; k < 4; ++k) {
      float x = k < 3 ? a.value[k][i] : a.pdf[i], y = k < 3 ? b.value[k][i] : b.pdf[i];
      if (!same_bits(x, y))
        return fmt::format("eval at wo = {}, wi = {}: {} is {:a} instead of {:a}",
                           to_text(a.viewer(i)), to_text(a.light(i)), k < 3 ? "value" : "density",
                           y, x);
    }
  return {};
}

std::string compare_samples(const SampleBatch& a, const SampleBatch& b) {
  for (int i = 0; i < a.n; ++i) {
    bool same =
        a.flags[i] == b.flags[i] && same_bits(a.pdf[i], b.pdf[i]) && same_bits(a.eta[i], b.eta[i]);
    for (int k = 0; k < 3; ++k)
      same = same && same_bits(a.wi[k][i], b.wi[k][i]) && same_bits(a.value[k][i], b.value[k][i]) &&
             same_bits(a.weight[k][i], b.weight[k][i]);
    if (!same)
      return fmt::format("sample at wo = {}, u = ({:a}, {:a}), uc = {:a}: wi {} instead of {}, "
                         "density {:a} instead of {:a}, flags {} instead of {}",
                         to_text(a.viewer(i)), a.u[0][i], a.u[1][i], a.uc[i], to_text(b.light(i)),
                         to_text(a.light(i)), b.pdf[i], a.pdf[i], b.flags[i], a.flags[i]);
  }
  return {};
}

void compare_kernels(const Subject& subject, const LaneCase& lane_case, EvalBatch& evals,
                     SampleBatch& samples, Outcome& outcome) {
  const MaterialKernel& scalar = subject.kernel(Isa::scalar);
  evals.run(scalar, lane_case.args);
  samples.run(scalar, lane_case.args);
  for (int isa = 0; isa < kIsaCount; ++isa) {
    const MaterialKernel* kernel = subject.model->kernels[isa];
    if (!kernel)
      continue;
    for (bool together : {false, true}) {
      EvalBatch e = evals;
      SampleBatch s = samples;
      if (together) {
        kernel->eval_sample(lane_case.args, e.arrays(), s.arrays(), e.n);
      } else {
        e.run(*kernel, lane_case.args);
        s.run(*kernel, lane_case.args);
      }
      for (const std::string& text : {compare_evals(evals, e), compare_samples(samples, s)})
        if (!text.empty())
          outcome.fail(fmt::format("{}, {}{}: {}", kIsaNames[isa], lane_case.name,
                                   together ? ", eval_sample" : "", text));
    }
  }
}

void compare_trees(const Subject& subject, TransportMode mode, EvalBatch& evals,
                   SampleBatch& samples, Outcome& outcome) {
  subject.run(evals, mode, Isa::scalar);
  subject.run(samples, mode, Isa::scalar);
  for (Isa isa : {Isa::v3, Isa::v4}) {
    if (!isa_supported(isa))
      continue;
    EvalBatch e = evals;
    SampleBatch s = samples;
    subject.run(e, mode, isa);
    subject.run(s, mode, isa);
    for (const std::string& text : {compare_evals(evals, e), compare_samples(samples, s)})
      if (!text.empty())
        outcome.fail(fmt::format("{}: {}", kIsaNames[static_cast<int>(isa)], text));
  }
}

Outcome of_its_models() {
  Outcome outcome;
  outcome.applicable = false;
  outcome.message = "a tree has it from its models, which are proved themselves";
  return outcome;
}

double in_range(const Range& range, double u) {
  double low = std::isfinite(range.low) ? range.low : 0;
  double high = std::isfinite(range.high) ? range.high : low + 4;
  return low + u * (high - low);
}

// A record of its own for each of a few materials that differ in every parameter with a number.
constexpr int kRecords = 7;
std::vector<float> varied_records(const Subject& subject, bool textured_only,
                                  RandomStream& random) {
  std::vector<float> records;
  for (int r = 0; r < kRecords; ++r) {
    std::vector<float> slots = subject.record.slots;
    for (const ParamInfo& p : subject.model->descriptor.params)
      for (int k = 0; p.slot >= 0 && k < p.slots; ++k)
        if (r > 0 && (p.textured || !textured_only))
          slots[p.slot + k] = float(in_range(p.soft, random.next()));
    records.insert(records.end(), slots.begin(), slots.end());
  }
  return records;
}

} // namespace

Outcome check_lanes(const Subject& subject, Effort effort, double) {
  Outcome outcome;
  const int n = effort == Effort::quick ? 24571 : 99991; // a last group that is not full
  RandomStream random(subject.stream(71));
  EvalBatch evals = pairs_of(subject, n, 72);
  SampleBatch samples(n);
  samples.draw(random);
  for (int i = 0; i < n; ++i)
    samples.set_viewer(i, evals.viewer(i));
  const float corners[] = {0, 0x1p-24f, 0.5f, kOneMinusEpsilon};
  for (int i = 0; i < n; i += 9) {
    samples.u[0][i] = corners[i % 4];
    samples.u[1][i] = corners[i / 4 % 4];
    samples.uc[i] = corners[i / 16 % 4];
  }
  const TransportMode modes[] = {TransportMode::radiance, TransportMode::importance};
  if (subject.tree) {
    for (TransportMode mode : modes)
      compare_trees(subject, mode, evals, samples, outcome);
    return outcome;
  }
  for (TransportMode mode : modes)
    compare_kernels(subject, {"one material", subject.record.args(mode)}, evals, samples, outcome);

  std::vector<int32_t> rows(n + kLanePadding, 0);
  for (int i = 0; i < n; ++i) // stretches of one material, and mixed groups
    rows[i] = i / 512 % 2 ? int(random.bits() % kRecords) : i / 512 % kRecords;
  std::vector<float> records = varied_records(subject, false, random);
  MaterialArgs args = subject.record.args();
  args.records = records.data();
  args.rows = rows.data();
  compare_kernels(subject, {"a material in each lane", args}, evals, samples, outcome);

  // Textures that hold what the records of the lanes say must give the records' bits.
  records = varied_records(subject, true, random);
  args.records = records.data();
  const int stride = int(subject.record.slots.size());
  std::vector<std::vector<float>> texels(stride, std::vector<float>(n + kLanePadding));
  std::vector<const float*> lane_slots;
  for (int k = 0; k < stride; ++k) {
    for (int i = 0; i < n; ++i)
      texels[k][i] = records[rows[i] * stride + k];
    lane_slots.push_back(texels[k].data());
  }
  EvalBatch from_records = evals;
  from_records.run(subject.kernel(Isa::scalar), args);
  args = subject.record.args();
  args.lane_slots = lane_slots.data();
  for (const ParamInfo& p : subject.model->descriptor.params)
    for (int k = 0; p.textured && k < p.slots; ++k)
      args.textured |= uint64_t(1) << (p.slot + k);
  compare_kernels(subject, {"textures", args}, evals, samples, outcome);
  std::string text = compare_evals(from_records, evals);
  if (!text.empty())
    outcome.fail("textures against records: " + text);
  return outcome;
}

Outcome check_precision(const Subject& subject, Effort effort, double) {
  Outcome outcome;
  int n = effort == Effort::quick ? 4096 : 32768;
  for (TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
    EvalBatch e = pairs_of(subject, n, 81);
    subject.run(e, mode, Isa::scalar);
    for (int i = 0; i < n; ++i) {
      Eval<double> r = subject.reference(to_double(e.viewer(i)), to_double(e.light(i)), mode);
      Sensitivity s;
      bool known = false;
      for (int k = 0; k < 4; ++k) {
        double truth = k < 3 ? r.value[k] : r.pdf;
        double error = std::abs((k < 3 ? e.value[k][i] : e.pdf[i]) - truth);
        double allowed = 1e-5 * std::abs(truth) + kBlack;
        if (error > allowed) {
          if (!known)
            s = ulp_sensitivity(subject, e.viewer(i), e.light(i), mode);
          known = true;
          allowed += s.change[k];
        }
        outcome.figure = std::max(outcome.figure, error / allowed);
        if (!(error <= allowed))
          outcome.fail(fmt::format("wo = {}, wi = {}: {} is {:.9g} in float, {:.9g} in double; an "
                                   "ulp explains {:.2g}",
                                   to_text(e.viewer(i)), to_text(e.light(i)),
                                   k < 3 ? "value" : "density", k < 3 ? e.value[k][i] : e.pdf[i],
                                   truth, s.change[k]));
      }
    }
  }
  return outcome;
}

namespace {

void compare_channels(const ReferenceWide& wide, const Color<double>& color, double pdf,
                      double tolerance, const std::string& where, Outcome& outcome) {
  for (int k = 0; k < 7; ++k) {
    double a = k < 6 ? wide.color[k] : wide.pdf, b = k < 6 ? color[k % 3] : pdf;
    double error = std::abs(a - b) / std::max(std::abs(b), 1e-8);
    outcome.figure = std::max(outcome.figure, error / tolerance);
    if (!(error <= tolerance))
      outcome.fail(fmt::format("{}: {} {} is {:.12g} with three channels, {:.12g} with six", where,
                               k < 6 ? "channel" : "density", k < 6 ? std::to_string(k) : "", b,
                               a));
  }
}

} // namespace

Outcome check_channels(const Subject& subject, Effort effort, double) {
  if (subject.tree)
    return of_its_models();
  Outcome outcome;
  const Model& model = *subject.model;
  int n = effort == Effort::quick ? 2048 : 16384;
  EvalBatch pairs = pairs_of(subject, n, 95);
  RandomStream random(96);
  for (int i = 0; i < n; ++i) {
    ReferenceQuery q{to_double(pairs.viewer(i)), to_double(pairs.light(i))};
    Eval<double> three = model.eval(subject.record, q);
    std::string viewer = "wo = " + to_text(pairs.viewer(i));
    compare_channels(model.eval_wide(subject.record, q), three.value, three.pdf, 1e-9,
                     viewer + ", wi = " + to_text(pairs.light(i)), outcome);
    Random<double> numbers{{random.next(), random.next()}, random.next()};
    Sample<double> s =
        model.sample(subject.record, q.wo, numbers, TransportMode::radiance, {0.5, 0.5});
    ReferenceWide wide = model.sample_wide(subject.record, q.wo, numbers);
    // Both round differently on the way to a direction, to which narrow lobes are sensitive.
    if (s.valid)
      compare_channels(wide, s.weight, s.pdf, 1e-6, viewer + ", sampled", outcome);
    else if (wide.pdf != 0)
      outcome.fail(viewer + ": sampling fails with three channels, not with six");
  }
  return outcome;
}

namespace {

// A central difference with what is known of its error.
struct Difference {
  double value, error;
  bool kink;
};

// f at x - h, x - h/2, x, x + h/2, x + h.
Difference difference_of(const double (&f)[5], double h) {
  double wide = (f[4] - f[0]) / (2 * h), narrow = (f[3] - f[1]) / h;
  double value = narrow + (narrow - wide) / 3; // Richardson's extrapolation
  // The two one-sided slopes of a smooth function approach each other like h; with a kink in reach
  // they do not.
  double bend = ((f[4] - f[2]) - (f[2] - f[0])) / h;
  double bend_narrow = ((f[3] - f[2]) - (f[2] - f[1])) / (0.5 * h);
  double noise = 2e-14 * std::abs(f[2]) / h;
  bool kink =
      std::abs(bend_narrow - 0.5 * bend) > 1e-3 * std::abs(bend) + 1e-7 * std::abs(value) + noise;
  // A kink too slight to be told from curvature changes the slope by no more than this.
  double slight = std::abs(2 * bend_narrow - bend);
  return {value, std::abs(value - narrow) + slight + noise, kink};
}

struct DerivativeTally {
  long checked = 0, unresolved = 0;
};

void check_derivatives_at(const Subject& subject, const ReferenceQuery& query,
                          const std::vector<int>& active, Outcome& outcome,
                          DerivativeTally& tally) {
  const Model& model = *subject.model;
  std::vector<double> slots(subject.record.slots.begin(), subject.record.slots.end());
  ReferenceJet jet = model.eval_jet(subject.record, slots, active, query);
  for (size_t a = 0; a < active.size(); ++a) {
    double x = slots[active[a]], h = 1e-4 * std::max(std::abs(x), 1e-2);
    double f[4][5];
    for (int step = 0; step < 5; ++step) {
      slots[active[a]] = x + (step - 2) * 0.5 * h;
      Eval<double> e = model.eval_at(subject.record, slots, query);
      for (int k = 0; k < 4; ++k)
        f[k][step] = k < 3 ? e.value[k] : e.pdf;
    }
    slots[active[a]] = x;
    for (int k = 0; k < 4; ++k) {
      Difference d = difference_of(f[k], h);
      double derivative = jet.derivative[k][a];
      double size = std::max(std::abs(derivative), std::abs(d.value));
      if (d.kink)
        continue;
      // What the differences cannot tell from zero is compared with zero.
      if (d.error > 1e-3 * size + 1e-12 + 1e-9 * std::abs(f[k][2])) {
        ++tally.unresolved;
        continue;
      }
      ++tally.checked;
      double error = std::abs(derivative - d.value);
      outcome.figure = std::max(outcome.figure, (error - d.error) / std::max(size, 1e-12));
      if (!(error <= 1e-6 * size + d.error + 1e-14) || !std::isfinite(derivative))
        outcome.fail(
            fmt::format("wo = {}, wi = {}, slot {} = {:.9g}, output {}: Jet gives {:.12g}, "
                        "differences {:.12g} +- {:.1g}",
                        to_text(to_single(query.wo)), to_text(to_single(query.wi)), active[a], x, k,
                        derivative, d.value, d.error));
    }
  }
}

} // namespace

Outcome check_derivatives(const Subject& subject, Effort effort, double) {
  if (subject.tree)
    return of_its_models();
  Outcome outcome;
  std::vector<int> declared = subject.parameter_numbers();
  DerivativeTally tally;
  int n = effort == Effort::quick ? 300 : 3000;
  EvalBatch pairs = pairs_of(subject, n, 91);
  for (int i = 0; i < n; ++i)
    for (size_t first = 0; first < declared.size(); first += 8) {
      std::vector<int> active(declared.begin() + first,
                              declared.begin() + std::min(first + 8, declared.size()));
      check_derivatives_at(subject, {to_double(pairs.viewer(i)), to_double(pairs.light(i))}, active,
                           outcome, tally);
    }
  if (tally.unresolved > tally.checked)
    outcome.fail(fmt::format("differences resolved only {} of {} derivatives", tally.checked,
                             tally.checked + tally.unresolved));
  return outcome;
}

} // namespace faceta
