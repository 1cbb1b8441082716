#include "formats/measured_audit.h"

#include "formats/measured_common.h"
#include "formats/reflector.h"
#include "materials/measured_demo.h"
#include "spectrum/cie.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace faceta {

namespace {

using Audit = MeasuredAudit;

constexpr int kSamples = 4096, kPairs = 4096;
constexpr double kRange = 80 * kDegree; ///< of the pairs
constexpr double kZero = 5;             ///< |ln f(a, b) / f(b, a)| where one of them is 0

double luminance_of(const Color<double>& c) {
  return luminance({c[0], c[1], c[2]});
}

/// Calls function(cell, angles) for all cells of a grid.
template <class F> void for_cells(const MeasuredGrid& grid, const F& function) {
  double angles[4] = {};
  size_t index[4] = {}, axes = grid.axes.size();
  for (size_t cell = 0; cell < grid.rgb.size() / 3; ++cell) {
    for (size_t k = 0; k < axes; ++k)
      angles[k] = grid.axes[k].nodes[index[k]];
    function(cell, angles);
    for (size_t k = axes; k-- > 0 && ++index[k] == grid.axes[k].nodes.size();)
      index[k] = 0;
  }
}

/// The last inclination of an axis whose values are not those of the one before; the axis' last if
/// nothing is repeated (or everything: then it means nothing).
double last_distinct(const MeasuredGrid& grid, size_t axis) {
  const std::vector<double>& nodes = grid.axes[axis].nodes;
  size_t inner = 3, outer = 1;
  for (size_t k = 0; k < grid.axes.size(); ++k)
    (k < axis ? outer : inner) *= k == axis ? 1 : grid.axes[k].nodes.size();
  auto same = [&](size_t a, size_t b) {
    for (size_t o = 0; o < outer; ++o) {
      const float* slab = &grid.rgb[o * nodes.size() * inner];
      if (std::memcmp(slab + a * inner, slab + b * inner, inner * sizeof(float)) != 0)
        return false;
    }
    return true;
  };
  size_t last = nodes.size() - 1;
  while (last > 0 && same(last, last - 1))
    --last;
  return last > 0 ? nodes[last] : nodes.back();
}

void audit_cells(Audit& audit, const MeasuredGrid& grid) {
  using C = MeasuredCoordinates;
  for_cells(grid, [&](size_t cell, const double* angles) {
    if (!std::isnan(grid.rgb[3 * cell]))
      return;
    Vec3<double> wo, wi;
    ++(directions_of(grid.coordinates, angles, wo, wi) ? audit.holes : audit.below);
  });
  if (grid.coordinates == C::half_difference)
    return;
  bool around = grid.coordinates == C::specular || grid.coordinates == C::specular_rotated;
  double last = last_distinct(grid, 0);
  if (!around)
    last = std::min(last, last_distinct(grid, axis_count(grid.coordinates) == 3 ? 1 : 2));
  double known = audit.largest_theta > 0 ? audit.largest_theta * kDegree : 0.5 * kPi;
  audit.largest_theta = std::min(last, known) / kDegree;
}

void audit_cells(Audit& audit, const RglTables& tables) {
  size_t texels = tables.rgb.size() / 3, out = 0;
  for (size_t k = 0; k < texels; ++k)
    out += tables.rgb[3 * k] < 0 || tables.rgb[3 * k + 1] < 0 || tables.rgb[3 * k + 2] < 0;
  audit.out_of_gamut = texels > 0 ? double(out) / double(texels) : 0;
}

template <class T> void audit_cells(Audit&, const T&) {}

void note_value(Audit& audit, double f) {
  if (f <= 0)
    return;
  audit.most = std::max(audit.most, f);
  audit.smallest = audit.smallest > 0 ? std::min(audit.smallest, f) : f;
}

void audit_reciprocity(Audit& audit, const Reflector& reflector) {
  // Evenly over solid angle: the cosines are uniform.
  auto inclination = [](double u) { return std::acos(1 - u * (1 - std::cos(kRange))); };
  std::vector<Vec2<double>> both(kPairs), cosines(kPairs);
  tbb::parallel_for(0, kPairs, [&](int k) {
    Vec3<double> e = even_point(k);
    double turn = 2 * kPi * (e.z + 0.381966 * k);
    Vec3<double> a = direction_of(inclination(e.x), 2 * kPi * e.z);
    Vec3<double> b = direction_of(inclination(e.y), turn);
    both[size_t(k)] = {luminance_of(reflector.value(a, b)) / b.z,
                       luminance_of(reflector.value(b, a)) / a.z};
    cosines[size_t(k)] = {a.z, b.z};
  });
  Audit::Reciprocity& r = audit.reciprocity;
  double difference = 0, sum = 0;
  int pairs = 0;
  for (size_t k = 0; k < both.size(); ++k) {
    auto [ab, ba] = both[k];
    note_value(audit, ab), note_value(audit, ba);
    double weight = cosines[k].x * cosines[k].y;
    difference += std::abs(ab - ba) * weight;
    sum += std::max(ab, ba) * weight;
    if (ab <= 0 && ba <= 0)
      continue;
    double ratio = ab > 0 && ba > 0 ? std::min(kZero, std::abs(std::log(ab / ba))) : kZero;
    r.mean += ratio;
    r.largest = std::max(r.largest, ratio);
    ++pairs;
  }
  r.mean = pairs > 0 ? r.mean / pairs : 0;
  r.relative = sum > 0 ? difference / sum : 0;
}

Audit::Angle angle_of(const Reflector& reflector, double theta, bool isotropic, Audit& values) {
  Audit::Angle angle;
  angle.theta = theta;
  const int azimuths = isotropic ? 1 : 4;
  double sum = 0, squares = 0;
  for (int turn = 0; turn < azimuths; ++turn) {
    Vec3<double> wo = direction_of(theta * kDegree, turn * 0.25 * kPi);
    std::array<double, 3> mean{};
    for_samples(reflector, wo, kSamples, [&](const Vec3<double>& wi, double pdf) {
      Color<double> value = reflector.value(wo, wi);
      note_value(values, luminance_of(value) / wi.z);
      double weight = luminance_of(value) / pdf;
      sum += weight, squares += sqr(weight);
      for (int c = 0; c < 3; ++c)
        mean[size_t(c)] += value[c] / pdf / kSamples;
    });
    for (size_t c = 0; c < 3; ++c) {
      angle.albedo[c] += mean[c] / azimuths;
      angle.largest = std::max(angle.largest, mean[c]);
    }
  }
  double n = double(kSamples) * azimuths;
  angle.variation = sum > 0 ? std::sqrt(std::max(0.0, squares * n / sqr(sum) - 1)) : 0;
  return angle;
}

// --- Verdicts ---

std::string percent(double share) {
  return fmt::format("{:.3g} %", 100 * share);
}

void judge_cells(Audit& a) {
  auto say = [&](bool good, std::string text, std::string advice = {}) {
    a.findings.push_back({good, std::move(text), good ? "" : std::move(advice)});
  };
  if (a.holes > 0)
    say(false,
        fmt::format("{} cells above the surface hold no value ({})", a.holes,
                    percent(double(a.holes) / double(std::max<int64_t>(a.cells, 1)))),
        "--repair fills them from their neighbours");
  else
    say(true, "no holes above the surface");
  if (a.negative > 0 && a.out_of_gamut == 0)
    say(false, fmt::format("{} negative values, read as 0", a.negative), "--repair leaves none");
  if (a.out_of_gamut > 0)
    say(false,
        percent(a.out_of_gamut) + " of the texels have a negative channel: outside of sRGB, read "
                                  "as 0",
        "--repair leaves none; the colours stay what is rendered now");
  if (a.negative == 0 && a.out_of_gamut == 0)
    say(true, "no negative values");
  if (a.largest_theta > 0 && a.largest_theta < 79.5)
    say(true, fmt::format("nothing was measured beyond {:.1f} degrees", a.largest_theta), "");
}

void judge_light(Audit& a) {
  const Audit::Reciprocity& r = a.reciprocity;
  bool fair = r.mean <= 0.1 && r.relative <= 0.1;
  a.findings.push_back(
      {fair,
       fmt::format("{}reciprocal: |ln f(a,b)/f(b,a)| is {:.3g} in the mean, {:.3g} at most; {} of "
                   "the light",
                   fair ? "" : "not ", r.mean, r.largest, percent(r.relative)),
       fair ? "" : "--repair takes the mean of both directions of light"});
  const Audit::Angle* worst = &a.angles.front();
  for (const Audit::Angle& angle : a.angles)
    worst = angle.largest > worst->largest ? &angle : worst;
  bool conserves = worst->largest <= 1.005;
  a.findings.push_back(
      {conserves,
       conserves ? fmt::format("albedo at most {:.3f} ({:g} degrees)", worst->largest, worst->theta)
                 : fmt::format("albedo {:.3f} at {:g} degrees: more light than there is",
                               worst->largest, worst->theta),
       conserves ? "" : "--repair darkens such angles, both ways"});
  double variation = 0;
  for (const Audit::Angle& angle : a.angles)
    variation = std::max(variation, angle.variation);
  a.findings.push_back(
      {true, fmt::format("samples' weights vary by {:.3g} of their mean at most", variation)});
}

} // namespace

bool MeasuredAudit::clean() const {
  return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return f.good; });
}

MeasuredAudit audit_measured(const MeasuredFile& file, const std::string& name) {
  const Reflector reflector(file, name);
  MeasuredAudit audit;
  audit.cells = file.info.cells;
  audit.negative = file.info.negative;
  audit.largest_theta = file.info.largest_theta / kDegree;
  std::visit([&](const auto& data) { audit_cells(audit, data); }, file.data);
  audit_reciprocity(audit, reflector);
  const bool isotropic = is_isotropic(
      [&](const Vec3<double>& wo, const Vec3<double>& wi) { return reflector.value(wo, wi); });
  const double thetas[] = {0, 30, 60, 75, 85};
  std::vector<MeasuredAudit> values(std::size(thetas));
  audit.angles.resize(std::size(thetas));
  tbb::parallel_for(size_t(0), std::size(thetas), [&](size_t k) {
    audit.angles[k] = angle_of(reflector, thetas[k], isotropic, values[k]);
  });
  for (const MeasuredAudit& v : values)
    note_value(audit, v.most), note_value(audit, v.smallest);
  judge_cells(audit);
  judge_light(audit);
  return audit;
}

} // namespace faceta
