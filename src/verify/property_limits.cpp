#include "verify/parameter_values.h"
#include "verify/properties.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

// i mirrored at the point: 0.d0 d1 d2... from ...d2 d1 d0 in this base.
double radical_inverse(int i, int base) {
  double value = 0, place = 1.0 / base;
  for (; i > 0; i /= base, place /= base)
    value += i % base * place;
  return value;
}

// Hammersley's points, which fill the unit cube evenly; turned, so that none lies in a corner.
void fill_evenly(SampleBatch& batch) {
  auto single = [](double x) { return float(std::floor((x - std::floor(x)) * 0x1p24) * 0x1p-24); };
  for (int i = 0; i < batch.n; ++i) {
    batch.u[0][i] = single((i + 0.5) / batch.n);
    batch.u[1][i] = single(radical_inverse(i, 2) + 0.21);
    batch.uc[i] = single(radical_inverse(i, 3) + 0.37);
  }
}

// What one kind of lobe scatters: energy of each channel, and the mean direction times energy.
struct LobeSum {
  std::array<double, 3> energy{};
  Vec3<double> direction{0, 0, 0};
};

// [0] reflected, [1] passed on (transmitted or straight through).
std::array<LobeSum, 2> scattered(const Subject& subject, SampleBatch& batch, const Vec3<float>& wo,
                                 TransportMode mode) {
  batch.set_all_viewers(wo);
  subject.run(batch, mode);
  std::array<LobeSum, 2> sums;
  for (int i = 0; i < batch.n; ++i) {
    if (!batch.valid(i))
      continue;
    LobeSum& sum = sums[batch.lobe(i) == kReflection ? 0 : 1];
    for (int k = 0; k < 3; ++k)
      sum.energy[k] += batch.weight[k][i] / double(batch.n);
    sum.direction =
        sum.direction + to_double(batch.light(i)) * (double(batch.weight[1][i]) / batch.n);
  }
  return sums;
}

Vec3<float> viewer(double cosine, double azimuth) {
  double sine = std::sqrt(1 - cosine * cosine);
  return to_single({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine});
}

Parameters with_settings(const Model& model, const Settings& settings) {
  Parameters p(model);
  for (const auto& [key, value] : settings)
    p.set(key, value);
  return p;
}

bool free_to_draw(const ParamInfo& p, const Parameters& given) {
  if (given.was_set(p.name) || p.kind == ParamKind::metal)
    return false;
  for (const ParamInfo& other : given.descriptor().params)
    if (given.was_set(other.name) &&
        (lists(p.excludes, other.name) || lists(other.excludes, p.name)))
      return false;
  return true;
}

// Random words for every choice, random numbers for what both models have.
void draw_rest(Parameters& a, Parameters& b, RandomStream& random) {
  for (const ParamInfo& p : a.descriptor().params) {
    if (!free_to_draw(p, a))
      continue;
    const ParamInfo* q = b.descriptor().find(p.name);
    bool shared = q && q->kind == p.kind && free_to_draw(*q, b);
    if (!p.choices.empty()) {
      const std::string& word = p.choices[random.bits() % p.choices.size()];
      a.set(p.name, word);
      if (shared)
        b.set(p.name, word);
    } else if (shared && p.slots == 3) {
      std::array<double, 3> rgb;
      for (double& c : rgb)
        c = soft_value(p, random.next());
      a.set_color(p.name, rgb);
      b.set_color(p.name, rgb);
    } else if (shared) {
      double value = soft_value(p, random.next());
      a.set_number(p.name, value);
      b.set_number(p.name, value);
    }
  }
}

std::string described(const Parameters& p) {
  std::string text = p.model().name();
  for (const auto& [name, value] : p.given())
    text += fmt::format(" {}={}", name, value);
  return text;
}

void compare_energies(const Subject& a, const Subject& b, double tolerance, SampleBatch& batch,
                      Outcome& outcome) {
  const uint32_t passes = kTransmission | kNullLobe;
  bool both_pass = (a.traits().lobes & passes) && (b.traits().lobes & passes);
  bool both_sides = a.traits().two_sided && b.traits().two_sided;
  for (double cosine : {0.97, 0.7, 0.35, 0.1})
    for (double side : {1.0, -1.0})
      for (TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
        if ((side < 0 && !both_sides) || (mode == TransportMode::importance && !both_pass))
          continue;
        Vec3<float> wo = viewer(side * cosine, 0.7);
        std::array<LobeSum, 2> here = scattered(a, batch, wo, mode);
        std::array<LobeSum, 2> there = scattered(b, batch, wo, mode);
        for (int lobe = 0; lobe < (both_pass ? 2 : 1); ++lobe) {
          const LobeSum &x = here[lobe], &y = there[lobe];
          double error = length(x.direction - y.direction), size = 1;
          for (int k = 0; k < 3; ++k) {
            error = std::max(error, std::abs(x.energy[k] - y.energy[k]));
            size = std::max(size, y.energy[k]);
          }
          // The points' own error beside the limit's.
          double allowed = (tolerance + 1e-3) * size;
          outcome.figure = std::max(outcome.figure, error / allowed);
          if (!(error <= allowed))
            outcome.fail(fmt::format(
                "wo = {}, {}: {} gives ({:.5f}, {:.5f}, {:.5f}) towards {}, {} gives ({:.5f}, "
                "{:.5f}, {:.5f}) towards {}",
                to_text(wo), lobe ? "passing" : "reflected", described(*a.parameters), x.energy[0],
                x.energy[1], x.energy[2], to_text(to_single(x.direction)), described(*b.parameters),
                y.energy[0], y.energy[1], y.energy[2], to_text(to_single(y.direction))));
        }
      }
}

void compare_values(const Subject& a, const Subject& b, double tolerance, RandomStream& random,
                    Outcome& outcome) {
  if (a.traits().has_delta || b.traits().has_delta)
    return;
  for (int i = 0; i < 256; ++i) {
    // Not where tables of equidistant cosines are coarse.
    Vec3<float> wo = viewer(0.02 + 0.98 * random.next(), 2 * kPi * random.next());
    Vec3<float> wi = viewer(0.02 + 0.98 * random.next(), 2 * kPi * random.next());
    Eval<double> x = a.reference(to_double(wo), to_double(wi));
    Eval<double> y = b.reference(to_double(wo), to_double(wi));
    for (int k = 0; k < 3; ++k) {
      double error = std::abs(x.value[k] - y.value[k]);
      double allowed = tolerance * std::abs(y.value[k]) + 1e-9;
      outcome.figure = std::max(outcome.figure, error / allowed);
      if (!(error <= allowed))
        outcome.fail(fmt::format("wo = {}, wi = {}: {} gives {:.9g}, {} gives {:.9g}", to_text(wo),
                                 to_text(wi), described(*a.parameters), x.value[k],
                                 described(*b.parameters), y.value[k]));
    }
  }
}

// Equal indices on both sides: light goes straight on, or the model refuses them.
void check_no_interface(const Model& model, SampleBatch& batch, Outcome& outcome) {
  for (const char* index : {"1", "1.5", "2.25"}) {
    Parameters p = with_settings(model, {{"int_ior", index}, {"ext_ior", index}});
    std::optional<Subject> subject;
    try {
      subject.emplace(model, p);
    } catch (const Error& error) {
      if (error.message().find("int_ior") == std::string::npos)
        outcome.fail(
            fmt::format("equal indices are refused without naming them: {}", error.message()));
      return;
    }
    for (double cosine : {1.0, 0.5, 0.01, -0.3}) {
      Vec3<float> wo = viewer(cosine, 0.7);
      std::array<LobeSum, 2> sums = scattered(*subject, batch, wo, TransportMode::radiance);
      double error = std::max(length(sums[1].direction + to_double(wo)), sums[0].energy[1]);
      if (!(error <= 1e-5))
        outcome.fail(fmt::format(
            "between equal indices {}, light from {} passes towards {}, {:.6f} "
            "of it is reflected",
            index, to_text(wo), to_text(to_single(sums[1].direction)), sums[0].energy[1]));
    }
  }
}

} // namespace

Outcome check_limits(const Model& model) {
  Outcome outcome;
  const Descriptor& d = model.descriptor;
  SampleBatch batch(1 << 15);
  fill_evenly(batch);
  bool interface =
      d.find("int_ior") && d.find("ext_ior") && (d.traits.lobes & (kTransmission | kNullLobe));
  if (d.limits.empty() && !interface) {
    outcome.applicable = false;
    outcome.message = "the model names no limit";
  }
  if (interface)
    check_no_interface(model, batch, outcome);
  RandomStream random(131);
  for (const Limit& limit : d.limits)
    for (int round = 0; round < 8; ++round) {
      Parameters here = with_settings(model, limit.settings);
      Parameters there = with_settings(Registry::global().get(limit.model), limit.other);
      draw_rest(here, there, random);
      here.check();
      there.check();
      Subject a(model, here), b(there.model(), there);
      compare_energies(a, b, limit.tolerance, batch, outcome);
      compare_values(a, b, limit.tolerance, random, outcome);
    }
  return outcome;
}

Outcome check_albedos(const Model& model) {
  Outcome outcome;
  const double cosines[] = {1, 0.5, 0.1};
  if (model.descriptor.albedos.empty()) {
    outcome.applicable = false;
    outcome.message = "no albedos are known";
    return outcome;
  }
  SampleBatch batch(1 << 18);
  fill_evenly(batch);
  for (const KnownAlbedo& known : model.descriptor.albedos) {
    Subject subject(model, with_settings(model, known.settings));
    for (int i = 0; i < 3; ++i) {
      std::array<LobeSum, 2> sums =
          scattered(subject, batch, viewer(cosines[i], 0.4), TransportMode::importance);
      double albedo = sums[0].energy[1] + sums[1].energy[1];
      double error = std::abs(albedo - known.albedo[i]);
      outcome.figure = std::max(outcome.figure, error);
      if (!(error <= known.tolerance))
        outcome.fail(fmt::format("{} at cos theta = {}: {:.5f} instead of {} ({})",
                                 described(*subject.parameters), cosines[i], albedo,
                                 known.albedo[i], known.source));
    }
  }
  return outcome;
}

} // namespace faceta
