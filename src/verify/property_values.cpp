#include "verify/properties.h"
#include "verify/statistics.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace faceta {

namespace {

constexpr TransportMode kModes[] = {TransportMode::radiance, TransportMode::importance};

Vec3<float> random_direction(RandomStream& random) {
  double z = 1 - 2 * random.next(), phi = 2 * kPi * random.next();
  double r = std::sqrt(std::max(0.0, 1 - z * z));
  return to_single({r * std::cos(phi), r * std::sin(phi), z});
}

// Poles, the horizon and its neighbourhood down to denormals, and ordinary directions.
std::vector<Vec3<float>> nasty_directions() {
  std::vector<Vec3<float>> result = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
  RandomStream random(21);
  for (float z : {1e-1f, 1e-3f, 1e-6f, 1e-12f, 1e-20f, 1e-38f, 1e-45f}) {
    double phi = 2 * kPi * random.next(), r = std::sqrt(1 - double(z) * z);
    for (float side : {1.0f, -1.0f})
      result.push_back({float(r * std::cos(phi)), float(r * std::sin(phi)), side * z});
  }
  for (float x : {1e-3f, 1e-6f, 1e-20f, 1e-45f}) // around the normal
    for (float side : {1.0f, -1.0f})
      result.push_back(to_single({x, -x, side * std::sqrt(1 - 2 * double(x) * x)}));
  for (int i = 0; i < 12; ++i)
    result.push_back(random_direction(random));
  return result;
}

bool fine(float v) {
  return is_finite(v) && v >= 0;
}

std::vector<std::pair<Vec3<float>, Vec3<float>>> nasty_pairs(const Subject& subject) {
  std::vector<std::pair<Vec3<float>, Vec3<float>>> pairs;
  std::vector<Vec3<float>> directions = nasty_directions();
  for (const Vec3<float>& wo : directions) {
    for (const Vec3<float>& wi : directions)
      pairs.emplace_back(wo, wi);
    pairs.emplace_back(wo, -wo);
    pairs.emplace_back(wo, reflect(wo));
    pairs.emplace_back(wo, Vec3<float>{wo.x, wo.y, -wo.z}); // h perpendicular to n
    pairs.emplace_back(wo, Vec3<float>{-wo.x, -wo.y, std::nextafter(-wo.z, 2.0f)});
  }
  RandomStream random(subject.stream(22));
  while (pairs.size() < 8192)
    pairs.emplace_back(random_direction(random), random_direction(random));
  return pairs;
}

void check_finite_evals(const Subject& subject, TransportMode mode, Outcome& outcome) {
  auto pairs = nasty_pairs(subject);
  EvalBatch batch(static_cast<int>(pairs.size()));
  for (int i = 0; i < batch.n; ++i)
    batch.set(i, pairs[i].first, pairs[i].second);
  subject.run(batch, mode);
  for (int i = 0; i < batch.n && outcome.passed; ++i) {
    float v[4] = {batch.value[0][i], batch.value[1][i], batch.value[2][i], batch.pdf[i]};
    if (!fine(v[0]) || !fine(v[1]) || !fine(v[2]) || !fine(v[3]))
      outcome.fail(fmt::format("eval at wo = {}, wi = {}: value ({}, {}, {}), pdf {}",
                               to_text(batch.viewer(i)), to_text(batch.light(i)), v[0], v[1], v[2],
                               v[3]));
    Eval<double> e = subject.reference(to_double(batch.viewer(i)), to_double(batch.light(i)), mode);
    for (double d : {e.value[0], e.value[1], e.value[2], e.pdf})
      if (!(std::isfinite(d) && d >= 0))
        outcome.fail(fmt::format("reference at wo = {}, wi = {}: value ({}, {}, {}), pdf {}",
                                 to_text(batch.viewer(i)), to_text(batch.light(i)), e.value[0],
                                 e.value[1], e.value[2], e.pdf));
  }
}

std::string sample_defect(const SampleBatch& b, int i) {
  float length =
      std::sqrt(b.wi[0][i] * b.wi[0][i] + b.wi[1][i] * b.wi[1][i] + b.wi[2][i] * b.wi[2][i]);
  for (int k = 0; k < 3; ++k)
    if (!fine(b.weight[k][i]) || !fine(b.value[k][i]))
      return fmt::format("weight {} and value {} of channel {}", b.weight[k][i], b.value[k][i], k);
  if (!b.valid(i)) {
    for (int k = 0; k < 3; ++k)
      if (b.weight[k][i] != 0)
        return "a failed sample has a weight";
    return {};
  }
  if (!(std::abs(length - 1) <= 1e-4f)) // also catches a NaN
    return fmt::format("direction {} has length {}", to_text(b.light(i)), length);
  if (!(is_finite(b.pdf[i]) && b.pdf[i] > 0))
    return fmt::format("density {}", b.pdf[i]);
  if (!(is_finite(b.eta[i]) && b.eta[i] > 0))
    return fmt::format("relative index {}", b.eta[i]);
  int lobe = b.lobe(i);
  if (lobe != kReflection && lobe != kTransmission && lobe != kNullLobe)
    return fmt::format("lobe {}", lobe);
  return {};
}

void check_finite_samples(const Subject& subject, TransportMode mode, Outcome& outcome) {
  const float corners[] = {0, 0x1p-24f, 0.25f, 0.5f, 0.75f, kOneMinusEpsilon};
  std::vector<Vec3<float>> directions = nasty_directions();
  SampleBatch batch(static_cast<int>(directions.size()) * 6 * 6 * 6 * 2);
  RandomStream random(subject.stream(23));
  batch.draw(random);
  for (int i = 0; i < batch.n; ++i) {
    batch.set_viewer(i, directions[i / 2 / 216 % directions.size()]);
    if (i % 2) // corners of the unit cube of random numbers, beside random ones
      continue;
    int c = i / 2 % 216;
    batch.u[0][i] = corners[c % 6];
    batch.u[1][i] = corners[c / 6 % 6];
    batch.uc[i] = corners[c / 36];
  }
  subject.run(batch, mode);
  for (int i = 0; i < batch.n && outcome.passed; ++i) {
    std::string defect = sample_defect(batch, i);
    if (!defect.empty())
      outcome.fail(fmt::format("sample at wo = {}, u = ({:.9g}, {:.9g}), uc = {:.9g}: {}",
                               to_text(batch.viewer(i)), batch.u[0][i], batch.u[1][i], batch.uc[i],
                               defect));
  }
}

// Samples from many viewers on every side on which the model scatters.
SampleBatch spread_samples(const Subject& subject, int n, TransportMode mode, uint64_t seed) {
  SampleBatch batch(n);
  RandomStream random(subject.stream(seed));
  for (int i = 0; i < n; ++i) {
    Vec3<float> wo = random_direction(random);
    if (!subject.traits().two_sided)
      wo.z = std::abs(wo.z);
    batch.set_viewer(i, wo);
  }
  batch.draw(random);
  subject.run(batch, mode);
  return batch;
}

std::string side_defect(const SampleBatch& b, int i) {
  float product = b.wo[2][i] * b.wi[2][i];
  switch (b.lobe(i)) {
  case kReflection:
    return product <= 0 ? "a reflected direction lies on the other side" : "";
  case kTransmission:
    return product >= 0 ? "a transmitted direction lies on the viewer's side" : "";
  default:
    return b.light(i).x != -b.wo[0][i] || b.light(i).y != -b.wo[1][i] || b.light(i).z != -b.wo[2][i]
               ? "a null sample does not go straight on"
               : "";
  }
}

} // namespace

Outcome check_finite(const Subject& subject, Effort, double) {
  Outcome outcome;
  for (TransportMode mode : kModes) {
    check_finite_evals(subject, mode, outcome);
    check_finite_samples(subject, mode, outcome);
  }
  return outcome;
}

Outcome check_consistency(const Subject& subject, Effort effort, double) {
  Outcome outcome;
  for (TransportMode mode : kModes) {
    SampleBatch s = spread_samples(subject, effort == Effort::quick ? 16384 : 65536, mode, 31);
    EvalBatch e(s.n);
    for (int i = 0; i < s.n; ++i)
      e.set(i, s.viewer(i), s.light(i));
    subject.run(e, mode);
    for (int i = 0; i < s.n; ++i) {
      if (!s.valid(i))
        continue;
      std::string where = fmt::format(
          "wo = {}, u = ({:.9g}, {:.9g}), uc = {:.9g} -> wi = {}: ", to_text(s.viewer(i)),
          s.u[0][i], s.u[1][i], s.uc[i], to_text(s.light(i)));
      std::string side = side_defect(s, i);
      if (!side.empty())
        outcome.fail(where + side);
      if (!(s.lobe(i) & subject.traits().lobes))
        outcome.fail(where + "the lobe is not among the model's traits");
      if (s.lobe(i) == kReflection && s.eta[i] != 1)
        outcome.fail(where + fmt::format("reflection has relative index {}", s.eta[i]));
      if (s.delta(i))
        continue;
      for (int k = 0; k < 3; ++k) {
        double error = std::abs(double(s.weight[k][i]) * s.pdf[i] - s.value[k][i]);
        if (!(error <= 1e-5 * s.value[k][i] + 1e-30))
          outcome.fail(where + fmt::format("weight {} is not value {} / density {}", s.weight[k][i],
                                           s.value[k][i], s.pdf[i]));
      }
      double largest = 0;
      for (int k = 0; k < 4; ++k) {
        double sampled = k < 3 ? s.value[k][i] : s.pdf[i];
        double evaluated = k < 3 ? e.value[k][i] : e.pdf[i];
        double error = std::abs(sampled - evaluated);
        largest = std::max(largest, error / std::max(std::abs(evaluated), 1e-20));
        if (error <= 2e-5 * std::abs(evaluated) + 1e-30)
          continue;
        // Two roundings of the same number may each be an ulp of the inputs away from it.
        double change = ulp_sensitivity(subject, s.viewer(i), s.light(i), mode).change[k];
        if (!(error <= 2e-5 * std::abs(evaluated) + 4 * change))
          outcome.fail(where +
                       fmt::format("{} of the sample is {}, of eval {} (an ulp explains {})",
                                   k < 3 ? "value" : "density", sampled, evaluated, change));
      }
      outcome.figure = std::max(outcome.figure, largest);
    }
  }
  return outcome;
}

Outcome check_energy(const Subject& subject, Effort effort, double level) {
  Outcome outcome;
  const double z_limit = two_sided_quantile(level);
  const bool excused = find_excuse(subject.descriptor(), "energy");
  const long rounds = effort == Effort::quick ? 64 : 256;
  std::vector<double> cosines = {1, 0.9, 0.7, 0.5, 0.3, 0.1, 0.03, 0.01, 0.001};
  RandomStream random(subject.stream(41));
  SampleBatch batch(4096);
  for (double side : {1.0, -1.0}) {
    if (side < 0 && !subject.traits().two_sided)
      break;
    for (double z : cosines) {
      double phi = 2 * kPi * random.next(), r = std::sqrt(1 - z * z);
      Vec3<float> wo = to_single({r * std::cos(phi), r * std::sin(phi), side * z});
      batch.set_all_viewers(wo);
      RunningMean albedo[3];
      for (long round = 0; round < rounds; ++round) {
        batch.draw(random);
        subject.run(batch, TransportMode::importance);
        for (int i = 0; i < batch.n; ++i)
          for (int k = 0; k < 3; ++k)
            albedo[k].add(batch.weight[k][i]);
      }
      for (const RunningMean& a : albedo) {
        outcome.figure = std::max(outcome.figure, a.mean());
        double noise = z_limit * a.standard_error();
        std::string text = fmt::format("albedo {:.6f} +- {:.1g} at wo = {}", a.mean(),
                                       a.standard_error(), to_text(wo));
        double bound = subject.traits().albedo_bound;
        if (!(a.mean() <= bound + 1e-5 + noise))
          outcome.fail_beyond_excuse(fmt::format("{}, above the bound {}", text, bound));
        if (subject.lossless && !(std::abs(a.mean() - 1) <= 1e-3 + noise))
          outcome.fail_beyond_excuse(text + ", but nothing may be lost");
        if (excused && a.mean() > 1 + (subject.lossless ? 1e-3 : 1e-5) + noise)
          outcome.fail(text + ", more than arrives");
      }
    }
  }
  return outcome;
}

Outcome check_reciprocity(const Subject& subject, Effort effort, double) {
  Outcome outcome;
  if (!subject.traits().reciprocal) {
    outcome.applicable = false;
    outcome.message = "the model does not claim to be reciprocal";
    return outcome;
  }
  outcome.applicable = !subject.traits().delta;
  if (subject.traits().delta)
    outcome.message = "every lobe is a delta, whose value is 0";
  SampleBatch s =
      spread_samples(subject, effort == Effort::quick ? 2048 : 16384, TransportMode::radiance, 51);
  RandomStream random(subject.stream(52));
  for (int i = 0; i < s.n; ++i) {
    // Half of the pairs where the lobe is, half anywhere.
    bool sampled = i % 2 == 0 && s.valid(i) && !s.delta(i);
    Vec3<double> a = normalize(to_double(s.viewer(i)));
    Vec3<double> b = normalize(to_double(sampled ? s.light(i) : random_direction(random)));
    if (std::abs(b.z) < 1e-6 || std::abs(a.z) < 1e-6)
      continue;
    if (!subject.traits().two_sided)
      b.z = std::abs(b.z);
    Eval<double> there = subject.reference(a, b, TransportMode::radiance);
    Eval<double> back = subject.reference(b, a, TransportMode::importance);
    for (int k = 0; k < 3; ++k) {
      double f = there.value[k] / std::abs(b.z), g = back.value[k] / std::abs(a.z);
      double error = std::abs(f - g), size = std::max(std::abs(f), std::abs(g));
      outcome.figure = std::max(outcome.figure, error / std::max(size, 1e-9));
      if (!(error <= 1e-6 * size + 1e-12))
        outcome.fail(fmt::format("f({}, {}) = {:.9g}, the other way round {:.9g}",
                                 to_text(to_single(a)), to_text(to_single(b)), f, g));
    }
  }
  return outcome;
}

Outcome check_modes(const Subject& subject, Effort effort, double) {
  Outcome outcome;
  int n = effort == Effort::quick ? 8192 : 32768;
  SampleBatch radiance = spread_samples(subject, n, TransportMode::radiance, 61);
  SampleBatch importance = spread_samples(subject, n, TransportMode::importance, 61);
  for (int i = 0; i < n; ++i) {
    std::string where =
        fmt::format("wo = {}, u = ({:.9g}, {:.9g}), uc = {:.9g}: ", to_text(radiance.viewer(i)),
                    radiance.u[0][i], radiance.u[1][i], radiance.uc[i]);
    if (radiance.flags[i] != importance.flags[i] || radiance.wi[0][i] != importance.wi[0][i] ||
        radiance.wi[1][i] != importance.wi[1][i] || radiance.wi[2][i] != importance.wi[2][i] ||
        radiance.pdf[i] != importance.pdf[i]) {
      outcome.fail(where + "the transport mode changes direction, lobe or density");
      continue;
    }
    if (!radiance.valid(i))
      continue;
    double square = double(radiance.eta[i]) * radiance.eta[i];
    for (int k = 0; k < 3; ++k) {
      double a = radiance.weight[k][i] * square, b = importance.weight[k][i];
      double error = std::abs(a - b) / std::max(b, 1e-20);
      outcome.figure = std::max(outcome.figure, error);
      if (!(error <= 1e-5))
        outcome.fail(where + fmt::format("weight {} in radiance, {} in importance, eta {}",
                                         radiance.weight[k][i], b, radiance.eta[i]));
    }
  }
  return outcome;
}

} // namespace faceta
