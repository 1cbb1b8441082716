#include "formats/measured_repair.h"

#include "formats/measured_common.h"
#include "formats/measured_convert.h"
#include "formats/reflector.h"
#include "materials/measured_demo.h"
#include "sampling/warp.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace faceta {

namespace {

using Direction = Vec3<double>;

/// The neighbours of a cell of a grid along its axes.
class GridNeighbours {
public:
  explicit GridNeighbours(const MeasuredGrid& grid) {
    for (const MeasuredAxis& axis : grid.axes)
      axes_.push_back({axis.nodes.size(), 1, axis.period > 0});
    for (size_t k = axes_.size() - 1; k-- > 0;)
      axes_[k].stride = axes_[k + 1].stride * axes_[k + 1].size;
  }
  template <class F> void for_each(size_t cell, const F& function) const {
    for (const Axis& a : axes_) {
      size_t index = cell / a.stride % a.size, wrap = a.stride * (a.size - 1);
      if (index > 0 || a.periodic)
        function(index > 0 ? cell - a.stride : cell + wrap);
      if (index + 1 < a.size || a.periodic)
        function(index + 1 < a.size ? cell + a.stride : cell - wrap);
    }
  }

private:
  struct Axis {
    size_t size, stride;
    bool periodic;
  };
  std::vector<Axis> axes_;
};

/// Cells without a value, both of whose directions are above the surface.
std::vector<size_t> holes_of(const MeasuredGrid& grid) {
  std::vector<size_t> holes;
  for (size_t cell = 0; cell < grid.rgb.size() / 3; ++cell) {
    if (!std::isnan(grid.rgb[3 * cell]))
      continue;
    double angles[4] = {};
    size_t rest = cell;
    for (size_t k = grid.axes.size(); k-- > 0;) {
      angles[k] = grid.axes[k].nodes[rest % grid.axes[k].nodes.size()];
      rest /= grid.axes[k].nodes.size();
    }
    Direction wo, wi;
    if (directions_of(grid.coordinates, angles, wo, wi))
      holes.push_back(cell);
  }
  return holes;
}

/// The mean of the neighbours that have a value; false if none has.
bool average(const std::vector<float>& rgb, const GridNeighbours& neighbours, size_t cell,
             float* out) {
  double sum[3] = {};
  int count = 0;
  neighbours.for_each(cell, [&](size_t n) {
    if (std::isnan(rgb[3 * n]))
      return;
    for (size_t c = 0; c < 3; ++c)
      sum[c] += rgb[3 * n + c];
    ++count;
  });
  for (size_t c = 0; count > 0 && c < 3; ++c)
    out[c] = static_cast<float>(sum[c] / count);
  return count > 0;
}

// --- Beyond the inclinations that can be trusted ---

/// The pair with the same half vector whose directions lie no lower than the limit (a cosine).
void pull_up(Direction& wo, Direction& wi, double limit) {
  if (wo.z >= limit && wi.z >= limit)
    return;
  Direction h = wo + wi;
  double size = length(h);
  h = size > 1e-9 ? h * (1 / size) : Direction{0, 0, 1};
  if (h.z <= limit) { // even the half vector lies too low
    double scale = std::sqrt((1 - limit * limit) / std::max(1 - h.z * h.z, 1e-12));
    wo = wi = {h.x * scale, h.y * scale, limit};
    return;
  }
  Direction across = wi - h * dot(wi, h);
  double sine = length(across), angle = std::atan2(sine, dot(wi, h));
  across = sine > 0 ? across * (1 / sine) : across;
  auto pair = [&](double a) {
    wi = h * std::cos(a) + across * std::sin(a);
    wo = h * std::cos(a) - across * std::sin(a);
  };
  double low = 0, high = angle;
  for (int step = 0; step < 40; ++step) {
    double middle = 0.5 * (low + high);
    pair(middle);
    (wo.z >= limit && wi.z >= limit ? low : high) = middle;
  }
  pair(low);
}

Reflectance limited(Reflectance f, double degrees) {
  return [f = std::move(f), limit = std::cos(degrees * kDegree)](const Direction& wo,
                                                                 const Direction& wi) {
    Direction o = wo, i = wi;
    pull_up(o, i, limit);
    return f(o, i) * (wi.z / i.z);
  };
}

// --- Energy ---

/// Factors s(theta) for light and viewer that keep every albedo within a limit.
class EnergyLimit {
public:
  EnergyLimit(const Reflectance& f, const Reflector& sampler, bool isotropic) {
    const size_t around = isotropic ? 1 : 4;
    rays_.resize(kAngles * around);
    tbb::parallel_for(size_t(0), rays_.size(), [&](size_t k) {
      // At the horizon itself a cosine in the denominator says nothing of the data.
      double theta = std::min(88 * kDegree, 0.5 * kPi * double(k / around) / (kAngles - 1));
      collect(f, sampler, direction_of(theta, double(k % around) * 0.25 * kPi), rays_[k]);
    });
    scale_.assign(kAngles, 1);
    for (size_t k = 0; k < kAngles; ++k)
      largest_ = std::max(largest_, albedo_at(k));
    for (int step = 0; largest_ > 1 && step < 60; ++step) {
      std::vector<double> next = scale_;
      for (size_t k = 0; k < kAngles; ++k)
        next[k] *= std::sqrt(std::min(1.0, kLimit / std::max(albedo_at(k), 1e-9)));
      scale_ = next;
    }
  }
  /// Of any viewer, before.
  double largest() const { return largest_; }
  double at(double cosine) const {
    double p = std::acos(std::clamp(cosine, 0.0, 1.0)) / (0.5 * kPi) * (kAngles - 1);
    size_t k = std::min(size_t(p), kAngles - 2);
    return lerp(scale_[k], scale_[k + 1], p - double(k));
  }

private:
  static constexpr size_t kAngles = 46;
  static constexpr int kSamples = 2048;
  static constexpr double kLimit = 0.99;

  struct Ray {
    double cosine;
    std::array<double, 3> weight;
  };

  /// Half of the samples are the table's own, half are spread by the cosine: what was mended may
  /// be bright where the table is black.
  static void collect(const Reflectance& f, const Reflector& sampler, const Direction& wo,
                      std::vector<Ray>& rays) {
    for (int k = 0; k < kSamples; ++k) {
      Vec3<double> e = even_point(k / 2);
      Direction wi = k % 2 == 0 ? sampler.sample(wo, {{e.x, e.y}, e.z}).wi
                                : cosine_hemisphere(Vec2<double>{e.x, e.y});
      if (wi.z <= 1e-6)
        continue;
      double density = 0.5 * (sampler.density(wo, wi) + wi.z * kInvPi);
      Color<double> value = f(wo, wi);
      Ray ray{wi.z, {}};
      for (int c = 0; c < 3; ++c)
        ray.weight[size_t(c)] = value[c] / density / kSamples;
      rays.push_back(ray);
    }
  }
  /// The largest of any azimuth and channel.
  double albedo_at(size_t angle) const {
    const size_t around = rays_.size() / kAngles;
    double largest = 0;
    for (size_t k = 0; k < around; ++k) {
      std::array<double, 3> sum{};
      for (const Ray& ray : rays_[angle * around + k]) {
        double s = at(ray.cosine) * scale_[angle];
        for (size_t c = 0; c < 3; ++c)
          sum[c] += s * ray.weight[c];
      }
      largest = std::max(largest, *std::max_element(sum.begin(), sum.end()));
    }
    return largest;
  }

  std::vector<std::vector<Ray>> rays_; ///< [angle][azimuth]
  std::vector<double> scale_;
  double largest_ = 0;
};

} // namespace

int64_t fill_holes(MeasuredGrid& grid) {
  const std::vector<size_t> holes = holes_of(grid);
  const GridNeighbours neighbours(grid);
  // First values from the rims inwards, a cell a pass; then all holes towards harmony.
  std::vector<size_t> empty = holes;
  while (!empty.empty()) {
    std::vector<std::pair<size_t, std::array<float, 3>>> found;
    std::vector<size_t> left;
    for (size_t cell : empty) {
      std::array<float, 3> value{};
      if (average(grid.rgb, neighbours, cell, value.data()))
        found.emplace_back(cell, value);
      else
        left.push_back(cell);
    }
    if (found.empty())
      break;
    for (const auto& [cell, value] : found)
      std::copy(value.begin(), value.end(), &grid.rgb[3 * cell]);
    empty = std::move(left);
  }
  for (int sweep = 0; sweep < 100; ++sweep)
    for (size_t cell : holes)
      average(grid.rgb, neighbours, cell, &grid.rgb[3 * cell]);
  return int64_t(holes.size() - empty.size());
}

Repaired repaired(MeasuredFile file, const std::string& name, const RepairOptions& options) {
  if (options.max_theta != 0 && !(options.max_theta >= 10 && options.max_theta < 90))
    throw Error(fmt::format("the largest inclination {} makes no sense", options.max_theta), {name},
                "10 to 90 degrees do");
  Repaired result;
  auto note = [&](std::string text) { result.notes.push_back(std::move(text)); };
  if (auto* grid = std::get_if<MeasuredGrid>(&file.data))
    if (int64_t filled = fill_holes(*grid); filled > 0)
      note(fmt::format("{} holes filled from their neighbours", filled));
  if (file.info.negative > 0)
    note(fmt::format("{} negative values: 0", file.info.negative));
  auto reflector = std::make_shared<Reflector>(file, name);
  Reflectance f = [reflector](const Direction& wo, const Direction& wi) {
    return reflector->value(wo, wi);
  };
  if (options.max_theta > 0) {
    f = limited(std::move(f), options.max_theta);
    note(fmt::format("drawn from below {} degrees beyond", options.max_theta));
  }
  if (options.symmetrise) {
    f = symmetrised(std::move(f));
    note("f(a, b) and f(b, a) averaged");
  }
  auto energy = std::make_shared<EnergyLimit>(f, *reflector, is_isotropic(f));
  if (energy->largest() > 1) {
    note(fmt::format("albedo of up to {:.3f} limited to 0.99", energy->largest()));
    f = [f, energy](const Direction& wo, const Direction& wi) {
      return f(wo, wi) * (energy->at(wo.z) * energy->at(wi.z));
    };
  }
  result.value = std::move(f);
  return result;
}

} // namespace faceta
