#include "verify/plot_data.h"

#include "verify/quadrature.h"
#include "verify/sphere_partition.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace faceta {

namespace {

constexpr double kDegree = kPi / 180;
constexpr auto kMode = TransportMode::importance;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

} // namespace

double channel_of(const Color<double>& c, PlotChannel channel) {
  switch (channel) {
  case PlotChannel::red:
    return c[0];
  case PlotChannel::green:
    return c[1];
  case PlotChannel::blue:
    return c[2];
  default:
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
  }
}

Vec3<double> plane_direction(double angle, double phi) {
  double s = std::sin(angle);
  return {s * std::cos(phi * kDegree), s * std::sin(phi * kDegree), std::cos(angle)};
}

Vec3<double> plot_viewer(double theta, double phi) {
  return plane_direction(-theta * kDegree, phi);
}

std::vector<DeltaLobe> delta_lobes(const Subject& subject, const Vec3<double>& wo,
                                   PlotChannel channel) {
  std::vector<DeltaLobe> lobes;
  if (!subject.traits().has_delta && !subject.traits().delta)
    return lobes;
  constexpr int kSteps = 256;
  for (int i = 0; i < kSteps; ++i) {
    Random<double> random{{0.5, 0.5}, (i + 0.5) / kSteps, {}};
    Sample<double> s = subject.reference_sample(wo, random, kMode);
    if (!s.valid || !s.delta)
      continue;
    bool known = false;
    for (const DeltaLobe& l : lobes)
      known |= l.lobe == s.lobe && dot(l.wi, s.wi) > 1 - 1e-9;
    if (!known)
      lobes.push_back({s.wi, s.lobe, s.pdf, s.pdf * channel_of(s.weight, channel)});
  }
  return lobes;
}

// --- In the plane of incidence ---

namespace {

/// Angles to begin with: every degree, and ever closer around where a lobe may be narrow.
std::vector<double> first_angles(const Subject& subject, const Vec3<double>& wo, double phi) {
  std::vector<double> angles;
  for (int i = -180; i <= 180; ++i)
    angles.push_back(i * kDegree);
  for (const Vec3<double>& hint : peak_hints(subject, wo)) {
    double x = hint.x * std::cos(phi * kDegree) + hint.y * std::sin(phi * kDegree);
    double center = std::atan2(x, hint.z);
    angles.push_back(center);
    for (double offset = 1e-4; offset < 0.02; offset *= 2)
      for (double side : {-1.0, 1.0})
        if (std::abs(center + side * offset) < kPi)
          angles.push_back(center + side * offset);
  }
  std::sort(angles.begin(), angles.end());
  angles.erase(std::unique(angles.begin(), angles.end()), angles.end());
  return angles;
}

class PolarRefiner {
public:
  PolarRefiner(std::function<double(double)> value, const std::function<double(double)>& radius,
               double tolerance)
      : value_(std::move(value)), radius_(radius), tolerance_(tolerance) {}

  std::vector<Vec2<double>> run(const std::vector<double>& angles) {
    Vec2<double> last = at(angles.front());
    points_ = {last};
    for (size_t i = 1; i < angles.size(); ++i) {
      Vec2<double> next = at(angles[i]);
      refine(last, next, 0);
      points_.push_back(next);
      last = next;
    }
    return std::move(points_);
  }

private:
  Vec2<double> at(double angle) const { return {angle, value_(angle)}; }
  Vec2<double> place(const Vec2<double>& p) const {
    double r = radius_(p.y);
    return {r * std::sin(p.x), r * std::cos(p.x)};
  }

  void refine(const Vec2<double>& a, const Vec2<double>& b, int depth) {
    if (depth > 6)
      return;
    Vec2<double> middle = at(0.5 * (a.x + b.x));
    Vec2<double> p = place(a), q = place(b), m = place(middle);
    if (std::hypot(m.x - 0.5 * (p.x + q.x), m.y - 0.5 * (p.y + q.y)) <= tolerance_)
      return;
    refine(a, middle, depth + 1);
    points_.push_back(middle);
    refine(middle, b, depth + 1);
  }

  std::function<double(double)> value_;
  const std::function<double(double)>& radius_;
  double tolerance_;
  std::vector<Vec2<double>> points_;
};

} // namespace

std::vector<Vec2<double>> polar_curve(const Subject& subject, double theta, double phi,
                                      PlotChannel channel,
                                      const std::function<double(double)>& radius,
                                      double tolerance) {
  Vec3<double> wo = plot_viewer(theta, phi);
  auto value = [&](double angle) {
    return channel_of(subject.reference(wo, plane_direction(angle, phi), kMode).value, channel);
  };
  return PolarRefiner(value, radius, tolerance).run(first_angles(subject, wo, phi));
}

std::vector<double> image_slice(const Subject& subject, int n, double phi, PlotChannel channel) {
  std::vector<double> values;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) {
      double h = (column + 0.5) * 90 / n * kDegree, d = (n - row - 0.5) * 90 / n * kDegree;
      // Half vector cos(d) times, and to either side of it along the horizon.
      double c = std::cos(phi * kDegree), s = std::sin(phi * kDegree);
      double along = std::cos(d) * std::sin(h), across = std::sin(d);
      Vec3<double> wi{along * c - across * s, along * s + across * c, std::cos(d) * std::cos(h)};
      Vec3<double> wo{along * c + across * s, along * s - across * c, wi.z};
      values.push_back(channel_of(subject.reference(wo, wi, kMode).value, channel) / wi.z);
    }
  return values;
}

// --- Over all directions ---

namespace {

std::vector<Vec3<double>> pilot_samples(const Subject& subject, const Vec3<double>& wo, int count) {
  std::vector<Vec3<double>> directions;
  SampleBatch batch(count);
  RandomStream random(71);
  batch.set_all_viewers(to_single(wo));
  batch.draw(random);
  subject.run(batch, kMode);
  for (int i = 0; i < count; ++i)
    if (batch.valid(i) && !batch.delta(i))
      directions.push_back(to_double(batch.light(i)));
  return directions;
}

} // namespace

Albedo directional_albedo(const Subject& subject, const Vec3<double>& wo, PlotChannel channel) {
  Albedo albedo;
  bool above = wo.z > 0;
  for (const DeltaLobe& lobe : delta_lobes(subject, wo, channel))
    ((lobe.wi.z > 0) == above ? albedo.reflection : albedo.transmission) += lobe.weight;
  if (subject.traits().delta)
    return albedo;
  // Cells that are small where samples are dense, so that no lobe is too narrow to be found; they
  // end at the horizon, where values break off.
  SpherePartition partition(pilot_samples(subject, wo, 2048), peak_hints(subject, wo), reflect(wo),
                            64);
  PlaneFunction value = [&](double t, double phi) {
    return channel_of(subject.reference(wo, partition.direction(t, phi), kMode).value, channel);
  };
  auto add = [&](const Rectangle& cell, bool upper) {
    double part = integrate(value, cell, 5e-7, 1e-5, 1000).value;
    (upper == above ? albedo.reflection : albedo.transmission) += part;
  };
  for (const Rectangle& cell : partition.cells()) {
    if (cell.x0 < 1 && (above || subject.transmissive()))
      add({cell.x0, std::min(cell.x1, 1.0), cell.y0, cell.y1}, true);
    if (cell.x1 > 1 && (!above || subject.transmissive()))
      add({std::max(cell.x0, 1.0), cell.x1, cell.y0, cell.y1}, false);
  }
  return albedo;
}

WeightStudy study_weights(const Subject& subject, const Vec3<double>& wo, PlotChannel channel,
                          int samples, uint64_t seed) {
  SampleBatch batch(samples);
  RandomStream random(seed);
  batch.set_all_viewers(to_single(wo));
  batch.draw(random);
  subject.run(batch, kMode);
  std::vector<double> weights(samples, 0);
  double sum = 0, squares = 0;
  for (int i = 0; i < samples; ++i) {
    if (batch.valid(i))
      weights[i] = channel_of(
          Color<double>(batch.weight[0][i], batch.weight[1][i], batch.weight[2][i]), channel);
    sum += weights[i];
  }
  WeightStudy study;
  study.mean = sum / samples;
  for (double w : weights)
    squares += (w - study.mean) * (w - study.mean);
  study.variation = study.mean > 0 ? std::sqrt(squares / samples) / study.mean : kNone;
  constexpr double kShares[] = {0.01, 0.25, 0.5, 0.75, 0.99};
  auto begin = weights.begin();
  for (int k = 0; k < 5; ++k) {
    auto at = weights.begin() + std::ptrdiff_t(kShares[k] * (samples - 1));
    std::nth_element(begin, at, weights.end());
    study.quantiles[k] = *at;
    begin = at;
  }
  return study;
}

double HemisphereMap::mass() const {
  double sum = 0;
  for (double c : cells)
    sum += std::isnan(c) ? 0 : c;
  return sum * solid_angle();
}

Vec2<double> project(const Vec3<double>& w) {
  // r^2 = 1 - |z|, written so that it stays exact near the normal.
  double scale = 1 / std::sqrt(1 + std::abs(w.z));
  return {w.x * scale, w.y * scale};
}

namespace {

/// Inverse of project(), for a point inside the unit disk.
Vec3<double> unproject(double x, double y, bool below) {
  double square = x * x + y * y, scale = std::sqrt(std::max(0.0, 2 - square));
  return {x * scale, y * scale, below ? square - 1 : 1 - square};
}

/// Where a cell begins along either axis.
double edge(int i, int n) {
  return -1 + 2.0 * i / n;
}

bool outside(int column, int row, int n) {
  auto nearest = [n](int i) { return std::max({edge(i, n), -edge(i + 1, n), 0.0}); };
  return std::hypot(nearest(column), nearest(row)) >= 1;
}

} // namespace

HemisphereMap density_map(const Subject& subject, const Vec3<double>& wo, bool below, int n) {
  PlaneFunction density = [&](double x, double y) {
    if (x * x + y * y >= 1)
      return 0.0;
    return subject.reference(wo, unproject(x, y, below), kMode).pdf;
  };
  std::vector<Vec2<double>> peaks;
  for (const Vec3<double>& hint : peak_hints(subject, wo))
    if ((hint.z < 0) == below)
      peaks.push_back(project(hint));
  HemisphereMap map{n, std::vector<double>(size_t(n) * n, kNone)};
  double area = 4.0 / n / n;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) {
      if (outside(column, n - 1 - row, n))
        continue;
      Rectangle cell{edge(column, n), edge(column + 1, n), edge(n - 1 - row, n), edge(n - row, n)};
      // A cell with a peak is cut there: quadrature looks for narrow peaks at corners.
      std::vector<Rectangle> pieces = {cell};
      for (const Vec2<double>& p : peaks)
        if (p.x > cell.x0 && p.x < cell.x1 && p.y > cell.y0 && p.y < cell.y1) {
          pieces = {{cell.x0, p.x, cell.y0, p.y},
                    {p.x, cell.x1, cell.y0, p.y},
                    {cell.x0, p.x, p.y, cell.y1},
                    {p.x, cell.x1, p.y, cell.y1}};
          break;
        }
      double mass = 0;
      for (const Rectangle& piece : pieces)
        mass += integrate(density, piece, 1e-7, 1e-4, pieces.size() > 1 ? 40000 : 2000).value;
      map.cells[size_t(row) * n + column] = mass / area;
    }
  return map;
}

std::vector<HemisphereMap> sample_maps(const Subject& subject, const Vec3<double>& wo, int n,
                                       long samples, uint64_t seed) {
  std::vector<HemisphereMap> maps(2, {n, std::vector<double>(size_t(n) * n, 0)});
  for (HemisphereMap& map : maps)
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column)
        if (outside(column, n - 1 - row, n))
          map.cells[size_t(row) * n + column] = kNone;
  RandomStream random(seed);
  SampleBatch batch(4096);
  batch.set_all_viewers(to_single(wo));
  double share = 1 / (maps[0].solid_angle() * double(samples));
  for (long done = 0; done < samples; done += batch.n) {
    batch.draw(random);
    subject.run(batch, kMode);
    for (int i = 0; i < std::min(long(batch.n), samples - done); ++i) {
      if (!batch.valid(i) || batch.delta(i))
        continue;
      Vec2<double> p = project(to_double(batch.light(i)));
      int column = std::clamp(int((p.x + 1) * n / 2), 0, n - 1);
      int row = n - 1 - std::clamp(int((p.y + 1) * n / 2), 0, n - 1);
      double& cell = maps[batch.wi[2][i] < 0].cells[size_t(row) * n + column];
      cell = (std::isnan(cell) ? 0 : cell) + share;
    }
  }
  return maps;
}

ReciprocityMap reciprocity_map(const Subject& subject, int n) {
  ReciprocityMap map{n, subject.traits().two_sided ? 180.0 : 90.0, {}, 0};
  map.cells.assign(size_t(n) * n, 0);
  std::vector<double> turns = {0};
  if (is_anisotropic(subject))
    turns = {0, 35, 90};
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) {
      double& cell = map.cells[size_t(row) * n + column];
      double ta = (column + 0.5) * map.high / n, tb = (n - row - 0.5) * map.high / n;
      for (double turn : turns)
        for (double between : {0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0}) {
          Vec3<double> a = plane_direction(ta * kDegree, turn);
          Vec3<double> b = plane_direction(tb * kDegree, turn + between);
          Eval<double> there = subject.reference(a, b, TransportMode::radiance);
          Eval<double> back = subject.reference(b, a, TransportMode::importance);
          for (int k = 0; k < 3; ++k) {
            double f = there.value[k] / std::abs(b.z), g = back.value[k] / std::abs(a.z);
            double size = std::max({std::abs(f), std::abs(g), 1e-9});
            cell = std::max(cell, std::abs(f - g) / size);
          }
        }
      map.largest = std::max(map.largest, cell);
    }
  return map;
}

} // namespace faceta
