#include "verify/subject.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

Parameters from_settings(const Model& model, const Settings& settings) {
  Parameters p(model);
  for (const auto& [key, value] : settings)
    p.set(key, value);
  p.check();
  return p;
}

std::vector<const Parameters*> models_of(const Subject& subject) {
  return subject.tree ? subject.tree->models()
                      : std::vector<const Parameters*>{&*subject.parameters};
}

Vec3<double> from_angles(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

} // namespace

Subject::Subject(const Model& m, const Parameters& p, bool loses_nothing)
    : model(&m), parameters(p), record(p.record()), lossless(loses_nothing) {}

Subject::Subject(const Model& m, const Exemplar& exemplar)
    : Subject(m, from_settings(m, exemplar.settings), exemplar.lossless) {}

void Subject::run(EvalBatch& batch, TransportMode mode, Isa isa) const {
  if (tree)
    tree->eval(batch.arrays(), batch.n, isa, mode);
  else
    batch.run(kernel(isa), record.args(mode));
}

void Subject::run(SampleBatch& batch, TransportMode mode, Isa isa) const {
  if (tree)
    tree->sample(batch.arrays(), batch.n, isa, mode);
  else
    batch.run(kernel(isa), record.args(mode));
}

Sample<double> Subject::reference_sample(const Vec3<double>& wo, const Random<double>& random,
                                         TransportMode mode) const {
  return tree ? tree->reference_sample(wo, random, mode)
              : model->sample(record, wo, random, mode, {0.5, 0.5});
}

std::vector<double> Subject::numbers() const {
  return tree ? tree->numbers() : std::vector<double>(record.slots.begin(), record.slots.end());
}

std::vector<int> Subject::parameter_numbers() const {
  return tree ? tree->parameter_numbers() : model->descriptor.parameter_slots();
}

Eval<double> Subject::reference_at(const std::vector<double>& numbers,
                                   const ReferenceQuery& query) const {
  return tree ? tree->reference(query, numbers) : model->eval_at(record, numbers, query);
}

bool is_anisotropic(const Subject& subject) {
  RandomStream random(11);
  for (int i = 0; i < 24; ++i) {
    // Around the mirror direction, where even a narrow lobe has a value.
    double theta = 0.2 + random.next(), phi = 2 * kPi * random.next();
    double spread = std::pow(10.0, -4 * random.next());
    Vec3<double> wo = from_angles(theta, phi);
    Vec3<double> wi = from_angles(theta + spread * (random.next() - 0.5),
                                  phi + kPi + spread * (random.next() - 0.5));
    auto turned = [](const Vec3<double>& w) {
      double c = std::cos(1.1), s = std::sin(1.1);
      return Vec3<double>{c * w.x - s * w.y, s * w.x + c * w.y, w.z};
    };
    double a = subject.reference(wo, wi).pdf, b = subject.reference(turned(wo), turned(wi)).pdf;
    if (std::abs(a - b) > 1e-6 * (std::abs(a) + std::abs(b)))
      return true;
  }
  return false;
}

std::vector<Vec3<float>> viewers(const Subject& subject, Effort effort) {
  std::vector<double> angles = {0, 30, 60, 80, 89};
  std::vector<double> azimuths = {40};
  bool turn = is_anisotropic(subject);
  if (effort == Effort::full)
    angles = {0, 10, 30, 41, 45, 60, 70, 80, 85, 89};
  if (turn)
    azimuths = {0, 40, 90};
  if (turn && effort == Effort::full)
    azimuths = {0, 20, 40, 90, 160};
  std::vector<Vec3<float>> result;
  for (double side : {1.0, -1.0}) {
    if (side < 0 && !subject.traits().two_sided)
      break;
    for (double angle : angles)
      for (double azimuth : azimuths) {
        if (angle == 0 && azimuth != azimuths.front())
          continue;
        Vec3<double> w = from_angles(angle * kPi / 180, azimuth * kPi / 180);
        result.push_back(to_single({w.x, w.y, side * w.z}));
      }
  }
  return result;
}

int most_viewers(Effort effort) {
  return effort == Effort::quick ? 26 : 92;
}

std::vector<Vec3<double>> peak_hints(const Subject& subject, const Vec3<double>& wo) {
  std::vector<Vec3<double>> hints = {{0, 0, 1}, reflect(wo), wo};
  if (wo.z < 0)
    hints[0] = {0, 0, -1};
  if (!subject.transmissive())
    return hints;
  hints.push_back(-wo);
  for (const Parameters* model : models_of(subject)) {
    double eta = 1;
    for (const ParamInfo& p : model->descriptor().params)
      if (p.kind == ParamKind::ior) // the ratio of all indices named, whichever way round
        eta = model->slots()[p.slot] / eta;
    for (double ratio : {eta, 1 / eta}) {
      double square = 1 - ratio * ratio * (1 - wo.z * wo.z);
      if (square > 0)
        hints.push_back({-ratio * wo.x, -ratio * wo.y, -std::copysign(std::sqrt(square), wo.z)});
    }
  }
  return hints;
}

std::string to_text(const Vec3<float>& v) {
  return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x, v.y, v.z);
}

Sensitivity ulp_sensitivity(const Subject& subject, const Vec3<float>& wo, const Vec3<float>& wi,
                            TransportMode mode) {
  std::vector<double> numbers = subject.numbers();
  Sensitivity result;
  ReferenceQuery query{to_double(wo), to_double(wi), mode};
  result.center = subject.reference_at(numbers, query);
  auto compare = [&] {
    Eval<double> e = subject.reference_at(numbers, query);
    for (int k = 0; k < 4; ++k) {
      double a = k < 3 ? e.value[k] : e.pdf;
      double b = k < 3 ? result.center.value[k] : result.center.pdf;
      result.change[k] = std::max(result.change[k], std::abs(a - b));
    }
  };
  auto nudge = [&](double& x) {
    double kept = x;
    for (float way : {-INFINITY, INFINITY}) {
      x = std::nextafter(float(kept), way);
      compare();
    }
    x = kept;
  };
  auto turn = [&](Vec3<double>& w) {
    Vec3<double> kept = w;
    for (double way : {-0x1p-23, 0x1p-23}) {
      w.z = std::max(kept.z + way, 0x1p-149);
      compare();
    }
    w = kept;
  };
  if (subject.traits().of_angles) {
    turn(query.wo);
    turn(query.wi);
  }
  for (double* x : {&query.wo.x, &query.wo.y, &query.wo.z, &query.wi.x, &query.wi.y, &query.wi.z})
    nudge(*x);
  for (int k : subject.parameter_numbers())
    nudge(numbers[k]);
  return result;
}

} // namespace faceta
