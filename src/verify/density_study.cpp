#include "verify/density_study.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta {

namespace {

constexpr int kBatch = 4096;
constexpr int kPilot = 16384;
constexpr int kLeaf = 32;
constexpr long kEvaluationsPerCell = 40000;
constexpr int kParts = 8; ///< of cells of the sphere, where the density has steps

SpherePartition make_partition(const Subject& subject, const Vec3<float>& wo, TransportMode mode,
                               RandomStream& random) {
  std::vector<Vec3<double>> pilot;
  SampleBatch batch(kBatch);
  batch.set_all_viewers(wo);
  for (int done = 0; done < kPilot; done += kBatch) {
    batch.draw(random);
    subject.run(batch, mode);
    for (int i = 0; i < kBatch; ++i)
      if (batch.valid(i) && !batch.delta(i))
        pilot.push_back(to_double(batch.light(i)));
  }
  Vec3<double> viewer = to_double(wo);
  return SpherePartition(pilot, peak_hints(subject, viewer), reflect(viewer), kLeaf);
}

void count_delta(DensityStudy& study, const SampleBatch& batch, int i) {
  Vec3<float> wi = batch.light(i);
  for (DeltaGroup& group : study.deltas)
    if (group.lobe == batch.lobe(i) && group.wi.x == wi.x && group.wi.y == wi.y &&
        group.wi.z == wi.z && group.probability == batch.pdf[i]) {
      ++group.count;
      return;
    }
  if (study.deltas.size() >= 8)
    study.defect = "delta lobes have more than 8 directions or probabilities for one viewer";
  else
    study.deltas.push_back({batch.lobe(i), wi, batch.pdf[i], 1});
}

void draw_samples(DensityStudy& study, const Subject& subject, const Vec3<float>& wo,
                  TransportMode mode, long samples, RandomStream& random) {
  SampleBatch batch(kBatch);
  batch.set_all_viewers(wo);
  for (long done = 0; done < samples; done += kBatch) {
    batch.draw(random);
    subject.run(batch, mode);
    for (int i = 0; i < kBatch; ++i) {
      ++study.samples;
      if (!batch.valid(i))
        ++study.failures;
      else if (batch.delta(i))
        count_delta(study, batch, i);
      else
        ++study.observed[study.partition.locate(to_double(batch.light(i)))];
    }
  }
}

} // namespace

DensityStudy study_density(const Subject& subject, const Vec3<float>& wo, TransportMode mode,
                           long samples, uint64_t seed, double tolerance) {
  RandomStream random(seed);
  DensityStudy study{make_partition(subject, wo, mode, random), {}, {}, 0, {}, 0, 0, {}};
  size_t cells = study.partition.cells().size();
  study.observed.assign(cells, 0);
  study.mass.assign(cells, 0);
  draw_samples(study, subject, wo, mode, samples, random);
  Vec3<double> viewer = to_double(wo);
  PlaneFunction density = [&](double t, double phi) {
    return subject.reference(viewer, study.partition.direction(t, phi), mode).pdf;
  };
  for (size_t i = 0; i < cells; ++i) {
    double deviation = std::sqrt(std::max(study.observed[i], 5.0)) / study.samples;
    Integral mass = integrate(density, study.partition.cells()[i], tolerance * deviation, 0,
                              kEvaluationsPerCell,
                              subject.traits().tabulated && subject.transmissive() ? kParts : 1);
    study.mass[i] = mass.value;
    study.mass_error += mass.error;
  }
  return study;
}

double DensityStudy::total_mass() const {
  double sum = 0;
  for (double m : mass)
    sum += m;
  return sum;
}

double DensityStudy::delta_probability() const {
  double sum = 0;
  for (const DeltaGroup& group : deltas)
    sum += group.probability;
  return sum;
}

ChiSquareResult DensityStudy::chi_square() const {
  std::vector<HistogramCell> cells;
  for (size_t i = 0; i < mass.size(); ++i)
    cells.push_back({mass[i] * samples, observed[i]});
  for (const DeltaGroup& group : deltas)
    cells.push_back({group.probability * samples, group.count});
  // Failure takes the rest; what quadrature leaves of a full density is no failure.
  double rest = 1 - total_mass() - delta_probability();
  cells.push_back({rest > 1e-5 ? rest * samples : 0, failures});
  return chi_square_test(std::move(cells));
}

std::string DensityStudy::worst_cell() const {
  double worst = 0;
  std::string text = "all cells agree";
  for (size_t i = 0; i < mass.size(); ++i) {
    double expected = mass[i] * samples;
    double z = (observed[i] - expected) / std::sqrt(std::max(expected, 5.0));
    if (std::abs(z) <= worst)
      continue;
    worst = std::abs(z);
    const Rectangle& c = partition.cells()[i];
    Vec3<double> w = partition.direction(0.5 * (c.x0 + c.x1), 0.5 * (c.y0 + c.y1));
    text = fmt::format("around wi = ({:.6g}, {:.6g}, {:.6g}) {:.0f} samples came where {:.1f} were "
                       "expected ({:+.1f} standard deviations)",
                       w.x, w.y, w.z, observed[i], expected, z);
  }
  for (const DeltaGroup& group : deltas) {
    double expected = group.probability * samples;
    double z = (group.count - expected) / std::sqrt(std::max(expected, 5.0));
    if (std::abs(z) <= worst)
      continue;
    worst = std::abs(z);
    text = fmt::format("delta lobe towards {}: {:.0f} samples, {:.1f} expected", to_text(group.wi),
                       group.count, expected);
  }
  return text;
}

} // namespace faceta
