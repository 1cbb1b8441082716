#include "bsdf/rgl_tables.h"

#include "bsdf/measured_build.h"
#include "bsdf/measured_table.h"
#include "bsdf/rgl_square.h"
#include "sampling/even_point.h"
#include "spectrum/cie.h"

#include <algorithm>
#include <optional>
#include <tbb/parallel_for.h>

namespace faceta {

namespace {

using Direction = Vec3<double>;
using Rgb = std::array<double, 3>;

constexpr double kHorizon = 0.5 * kPi;

Direction direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
Rgb rgb_of(const Color<double>& c) {
  return {c[0], c[1], c[2]};
}

/// The normal at a place of the square: x for inclination, y for azimuth.
Direction normal_at(const Vec2<double>& u) {
  return direction(sqr(u.x) * kHorizon, (2 * u.y - 1) * kPi);
}
/// Solid angle of normals for an area of the square.
double normal_area(double x) {
  return 2 * kPi * kPi * x * std::sin(sqr(x) * kHorizon);
}

/// The density of normals that makes what each viewer sees of them, summed over viewers, what the
/// viewers together get reflected from: D(m) sum_o max(0, o.m) / sigma(o) = sum_o E(o, m), where
/// E(o, m) is the share that m reflects of all that o gets. Solved by iteration; sigma, the
/// projected area, is D's own.
class NormalFit {
public:
  NormalFit(const Reflectance& f, bool isotropic)
      : isotropic_(isotropic), density_(isotropic ? 1024 : 128, isotropic ? 33 : 193) {
    for (int y = 0; y < density_.ny - 1; ++y)
      for (int x = 0; x < density_.nx; ++x) {
        Vec2<double> u{double(x) / (density_.nx - 1), double(y) / (density_.ny - 1)};
        double cells = double(density_.nx - 1) * (density_.ny - 1);
        nodes_.push_back({normal_at(u), normal_area(u.x) / cells});
      }
    for (double theta : {0.0, 20.0, 40.0, 55.0, 67.0, 76.0, 83.0})
      for (int k = 0; k < (isotropic ? 1 : 4); ++k)
        viewers_.push_back(direction(theta * kPi / 180, (k + 0.5) * kPi / 2));
    collect(f);
    for (int iteration = 0; iteration < 30; ++iteration)
      iterate();
    scale();
  }
  const Square& density() const { return density_; }

  /// The projected area of the normals.
  double sigma(const Direction& o) const {
    double sum = 0;
    for (size_t n = 0; n < nodes_.size(); ++n)
      sum += density_.values[n] * nodes_[n].area * std::max(0.0, dot(o, nodes_[n].m));
    return sum;
  }

private:
  static constexpr double kDiffuse = 0.02; ///< share of diffuse reflection put beside the given one
  static constexpr double kFloor = 1e-5;   ///< least density

  /// A node of the density and its solid angle; the last row, which is the first, has none.
  struct Node {
    Direction m;
    double area;
  };

  void collect(const Reflectance& f) {
    std::vector<std::vector<double>> shares(viewers_.size());
    tbb::parallel_for(size_t(0), viewers_.size(), [&](size_t k) {
      const Direction& o = viewers_[k];
      std::vector<double> given(nodes_.size()), diffuse(nodes_.size());
      double total = 0, diffuse_total = 0;
      for (size_t n = 0; n < nodes_.size(); ++n) {
        double cosine = dot(o, nodes_[n].m);
        Direction wi = reflect(o, nodes_[n].m);
        if (cosine <= 0 || wi.z <= 0)
          continue;
        given[n] = luminance(rgb_of(f(o, wi))) * 4 * cosine;
        diffuse[n] = wi.z * 4 * cosine;
        total += given[n] * nodes_[n].area;
        diffuse_total += diffuse[n] * nodes_[n].area;
      }
      for (size_t n = 0; n < nodes_.size(); ++n)
        shares[k].push_back((total > 0 ? (1 - kDiffuse) * given[n] / total : 0) +
                            kDiffuse * diffuse[n] / diffuse_total);
    });
    target_.assign(nodes_.size(), 0);
    for (const std::vector<double>& share : shares)
      for (size_t n = 0; n < target_.size(); ++n)
        target_[n] += share[n];
    std::fill(density_.values.begin(), density_.values.end(), kInvPi);
  }

  void iterate() {
    std::vector<double> seen(nodes_.size());
    for (const Direction& o : viewers_) {
      double inverse = 1 / sigma(o);
      for (size_t n = 0; n < nodes_.size(); ++n)
        seen[n] += inverse * std::max(0.0, dot(o, nodes_[n].m));
    }
    const size_t columns = size_t(density_.nx);
    for (size_t x = 0; x < columns; ++x) {
      double wanted = 0, there = 0;
      for (size_t n = x; n < nodes_.size(); n += columns) {
        wanted += target_[n];
        there += seen[n];
      }
      for (size_t n = x; n < nodes_.size(); n += columns)
        density_.values[n] = std::max(kFloor, isotropic_ ? wanted / std::max(there, 1e-9)
                                                         : target_[n] / std::max(seen[n], 1e-9));
    }
    std::copy_n(density_.values.begin(), columns, density_.values.end() - density_.nx);
  }

  /// A projected area of one for the viewer above, in single precision.
  void scale() {
    double area = sigma({0, 0, 1});
    for (double& v : density_.values)
      v /= area;
    density_.round();
  }

  bool isotropic_;
  Square density_;
  std::vector<Node> nodes_;
  std::vector<Direction> viewers_;
  std::vector<double> target_;
};

using Mismatch = RglQuality;

class RglBuilder {
public:
  RglBuilder(const Reflectance& f, const RglResolution& resolution)
      : f_(f), resolution_(resolution), isotropic_(is_isotropic(f)), normals_(f, isotropic_),
        side_(resolution.side > 0 ? resolution.side : 32), rows_(isotropic_ ? 65 : 129),
        sigma_(128, isotropic_ ? 2 : 65) {
    set_azimuths(isotropic_ ? 0 : 16);
    choose_columns();
    project();
  }

  RglTables run(RglQuality& quality) {
    for (double theta : {0.0, 20.0, 38.0, 52.0, 64.0, 74.0, 82.0, 90.0})
      rings_.push_back(ring_at(theta * kPi / 180));
    while (true) {
      RglTables tables = assemble();
      measure(tables);
      quality = worst_between();
      quality.merge(worst_at());
      if (!add_inclinations() && !add_azimuths() && !add_texels())
        return tables;
    }
  }

private:
  struct Slice {
    std::vector<float> vndf, luminance, rgb;
  };
  /// The viewers of an inclination.
  struct Ring {
    double theta;
    std::vector<Slice> slices;     ///< one for each azimuth
    std::optional<Mismatch> at;    ///< for viewers there, once measured
    std::optional<Mismatch> after; ///< for those halfway to the next ring
    double middle(const Ring& next) const { return 0.5 * (theta + next.theta); }
  };

  void set_azimuths(int turns) {
    phis_.clear();
    for (int k = 0; k <= turns; ++k)
      phis_.push_back(turns == 0 ? 0 : (2.0 * k / turns - 1) * kPi);
  }

  /// As many columns of visible normals as the narrowest part of the density needs.
  void choose_columns() {
    const Square& d = normals_.density();
    double total = 0;
    std::vector<double> mass(size_t(d.nx));
    for (int x = 0; x < d.nx; ++x)
      for (int y = 0; y < d.ny - 1; ++y) {
        double u = double(x) / (d.nx - 1);
        mass[size_t(x)] += d.node(x, y) * normal_area(u) * std::cos(sqr(u) * kHorizon);
        total += d.node(x, y) * normal_area(u) * std::cos(sqr(u) * kHorizon);
      }
    double sum = 0, u = 0;
    for (int x = 0; x < d.nx && sum < 0.1 * total; ++x) {
      sum += mass[size_t(x)];
      u = double(x) / (d.nx - 1);
    }
    while (columns_ < (isotropic_ ? 512 : 256) && u * columns_ < 12)
      columns_ *= 2;
  }

  void project() {
    tbb::parallel_for(0, sigma_.nx, [&](int x) {
      for (int y = 0; y < (isotropic_ ? 1 : sigma_.ny); ++y) {
        Vec2<double> u{double(x) / (sigma_.nx - 1), double(y) / (sigma_.ny - 1)};
        sigma_.node(x, y) = normals_.sigma(normal_at(u));
        if (isotropic_)
          sigma_.node(x, 1) = sigma_.node(x, 0);
      }
    });
    sigma_.round();
  }

  Ring ring_at(double theta) const {
    Ring ring{theta, std::vector<Slice>(phis_.size()), {}, {}};
    // A full turn ends where it began.
    tbb::parallel_for(size_t(0), std::max<size_t>(phis_.size() - 1, 1), [&](size_t k) {
      ring.slices[k] = slice(std::min(theta, kHorizon - 1e-3), phis_[k]);
    });
    if (phis_.size() > 1)
      ring.slices.back() = ring.slices.front();
    return ring;
  }

  /// The visible normals of a viewer: D(m) max(0, o.m) over the square.
  Square visible_normals(const Direction& o) const {
    Square visible(columns_, rows_);
    for (int y = 0; y < rows_; ++y)
      for (int x = 0; x < columns_; ++x) {
        Vec2<double> u{double(x) / (columns_ - 1), double(y) / (rows_ - 1)};
        visible.node(x, y) =
            normals_.density().at(u) * std::max(0.0, dot(o, normal_at(u))) * normal_area(u.x);
      }
    visible.round();
    return visible;
  }

  Slice slice(double theta, double phi) const {
    const Direction o = direction(theta, phi);
    const Square visible = visible_normals(o);
    const SquareSampler sampler(visible);
    const double sigma =
        sigma_.at({std::sqrt(theta / kHorizon), isotropic_ ? 0.5 : (phi / kPi + 1) / 2});
    const int points = kSubsamples * (side_ - 1);
    TexelFit above(side_, points), all(side_, points);
    std::vector<double> values[3], light;
    for (int j = 0; j < points; ++j)
      for (int i = 0; i < points; ++i) {
        auto [u, density] = sampler.sample({(i + 0.5) / points, (j + 0.5) / points});
        const Direction m = normal_at(u), wi = reflect(o, m);
        const double cosine = dot(o, m), normals = normals_.density().at(u);
        all.add(i, j);
        light.push_back(0);
        if (wi.z <= 0 || cosine <= 0)
          continue;
        Rgb rgb = rgb_of(f_(o, wi));
        above.add(i, j);
        for (size_t c = 0; c < 3; ++c)
          values[c].push_back(rgb[c] * 4 * sigma / normals);
        light.back() = luminance(rgb) * 4 * cosine * normal_area(u.x) / density;
      }
    Slice s{visible.floats(), {}, std::vector<float>(3 * size_t(side_) * size_t(side_))};
    for (double v : all.solve(light))
      s.luminance.push_back(static_cast<float>(v));
    if (*std::max_element(s.luminance.begin(), s.luminance.end()) <= 0)
      std::fill(s.luminance.begin(), s.luminance.end(), 1.0f);
    for (size_t c = 0; c < 3; ++c) {
      std::vector<double> nodes = above.solve(values[c]);
      for (size_t n = 0; n < nodes.size(); ++n)
        s.rgb[3 * n + c] = static_cast<float>(nodes[n]);
    }
    return s;
  }

  RglTables assemble() const {
    RglTables t;
    t.phi_i.assign(phis_.begin(), phis_.end());
    for (const Ring& ring : rings_)
      t.theta_i.push_back(static_cast<float>(ring.theta));
    const Square& density = normals_.density();
    t.ndf_size[0] = isotropic_ ? 2 : density.ny, t.ndf_size[1] = density.nx;
    t.ndf = density.floats();
    t.ndf.resize(size_t(t.ndf_size[0]) * size_t(t.ndf_size[1]));
    t.sigma_size[0] = sigma_.ny, t.sigma_size[1] = sigma_.nx;
    t.sigma = sigma_.floats();
    t.vndf_size[0] = rows_, t.vndf_size[1] = columns_;
    t.luminance_size[0] = t.luminance_size[1] = side_;
    for (size_t p = 0; p < phis_.size(); ++p)
      for (const Ring& ring : rings_) {
        const Slice& s = ring.slices[p];
        t.vndf.insert(t.vndf.end(), s.vndf.begin(), s.vndf.end());
        t.luminance.insert(t.luminance.end(), s.luminance.begin(), s.luminance.end());
        t.rgb.insert(t.rgb.end(), s.rgb.begin(), s.rgb.end());
      }
    return t;
  }

  /// How far the tables are from the reflectance for a viewer, by the tables' own samples.
  Mismatch mismatch_at(const MeasuredTable<double>& table, double theta) const {
    // Azimuths at and between those of the table.
    return isotropic_ ? mismatch_at(table, theta, {0.2})
                      : mismatch_at(table, theta, {0, 0.25 * kPi, 0.3 * kPi, -0.6 * kPi});
  }
  Mismatch mismatch_at(const MeasuredTable<double>& table, double theta,
                       const std::vector<double>& phis) const {
    const int samples = 2048, around = int(phis.size());
    Rgb difference{}, mean{};
    double apart = 0, all = 0;
    for (int k = 0; k < samples; ++k) {
      Direction o = direction(theta, phis[size_t(k % around)]);
      Vec3<double> e = even_point(k);
      Eval<double> made;
      Direction wi = table.sample(o, {{e.x, e.y}, e.z}, made);
      if (wi.z <= 0 || made.pdf <= 0)
        continue;
      Rgb wanted = rgb_of(f_(o, wi)), got = rgb_of(made.value);
      apart += std::abs(luminance(got) - luminance(wanted)) / made.pdf;
      all += luminance(wanted) / made.pdf;
      for (size_t c = 0; c < 3; ++c) {
        difference[c] += (got[c] - wanted[c]) / made.pdf;
        mean[c] += wanted[c] / made.pdf;
      }
    }
    double worst = 0;
    for (size_t c = 0; c < 3; ++c)
      if (double scale = std::max(mean[c], 0.05 * all); scale > 0)
        worst = std::max(worst, std::abs(difference[c]) / scale);
    return {worst, all > 0 ? apart / all : 0};
  }

  /// Compares where that was not done yet.
  void measure(const RglTables& tables) {
    const HugeVector<float> block = measured_block(tables);
    const MeasuredTable<double> table(block.data());
    tbb::parallel_for(size_t(0), 2 * rings_.size() - 1, [&](size_t k) {
      Ring& ring = rings_[k / 2];
      if (k % 2 == 0 && !ring.at)
        ring.at = mismatch_at(table, std::min(ring.theta, kHorizon - 1e-3));
      if (k % 2 == 1 && !ring.after)
        ring.after = mismatch_at(table, ring.middle(rings_[k / 2 + 1]));
    });
    if (isotropic_)
      return;
    // Azimuths matter most for light that comes in low.
    size_t low = 0;
    while (rings_[low].theta < kLow)
      ++low;
    auto half = [&](size_t k) { return 0.5 * (phis_[k] + phis_[k + 1]); };
    azimuth_at_ = mismatch_at(table, rings_[low].theta, {phis_[1], phis_[3], phis_[5]});
    azimuth_between_ = mismatch_at(table, rings_[low].theta, {half(1), half(3), half(5)});
  }
  Mismatch worst_at() const {
    Mismatch worst;
    for (const Ring& ring : rings_)
      if (ring.theta < kTrusted)
        worst.merge(*ring.at);
    return worst;
  }
  Mismatch worst_between() const {
    Mismatch worst;
    for (size_t k = 0; k + 1 < rings_.size(); ++k)
      if (rings_[k].middle(rings_[k + 1]) < kTrusted)
        worst.merge(*rings_[k].after);
    return worst;
  }

  /// Whether what lies between is bad, by more than it may be and than what is at the ends.
  bool lacks(const Mismatch& between, const Mismatch& ends, double factor) const {
    return between.albedo > factor * std::max(resolution_.tolerance, 2 * ends.albedo) ||
           between.shape > factor * std::max(10 * resolution_.tolerance, 2 * ends.shape);
  }
  bool add_inclinations() {
    bool added = false;
    for (size_t k = rings_.size() - 1; k-- > 0;) {
      double middle = rings_[k].middle(rings_[k + 1]);
      Mismatch ends = *rings_[k].at;
      ends.merge(*rings_[k + 1].at);
      // Towards the horizon, where little light comes from, more is allowed.
      if (!lacks(*rings_[k].after, ends, middle < kTrusted ? 1 : 4) ||
          middle - rings_[k].theta < kClosest ||
          int(rings_.size()) >= resolution_.viewers / (isotropic_ ? 1 : 4))
        continue;
      rings_[k].after.reset();
      rings_.insert(rings_.begin() + std::ptrdiff_t(k) + 1, ring_at(middle));
      added = true;
    }
    return added;
  }
  bool add_azimuths() {
    if (isotropic_ || phis_.size() > 17 || !lacks(*azimuth_between_, *azimuth_at_, 1))
      return false;
    set_azimuths(32);
    make_again();
    return true;
  }
  bool add_texels() {
    const Mismatch worst = worst_at();
    bool bad = worst.albedo > 2 * resolution_.tolerance || worst.shape > 20 * resolution_.tolerance;
    bool helps = worst.shape < 0.85 * before_.shape || worst.albedo < 0.85 * before_.albedo;
    before_ = worst;
    double points = double(rings_.size() * phis_.size()) * sqr(2.0 * kSubsamples * side_);
    if (!bad || !helps || resolution_.side > 0 || side_ >= 128 || points > kMostPoints)
      return false;
    side_ *= 2;
    make_again();
    return true;
  }
  void make_again() {
    for (Ring& ring : rings_)
      ring = ring_at(ring.theta);
  }

  static constexpr double kLow = 70 * kPi / 180;
  static constexpr double kTrusted = 80.5 * kPi / 180; ///< inclinations that the quality counts
  static constexpr double kClosest = 0.5 * kPi / 180;  ///< inclinations
  static constexpr double kMostPoints = 9e6;           ///< evaluations that more texels may cost
  static constexpr int kSubsamples = 3;                ///< points a cell of values and side
  const Reflectance& f_;
  const RglResolution& resolution_;
  bool isotropic_;
  NormalFit normals_;
  int side_, rows_, columns_ = 128;
  Square sigma_;
  std::vector<double> phis_;
  std::vector<Ring> rings_;
  std::optional<Mismatch> azimuth_at_, azimuth_between_; ///< on one ring
  Mismatch before_{1e30, 1e30};                          ///< with half the texels
};

} // namespace

bool is_isotropic(const Reflectance& f) {
  for (int k = 0; k < 256; ++k) {
    Vec3<double> e = even_point(k);
    // Normals near the surface's own find sharp lobes, others the rest.
    double spread = std::pow(10.0, -0.5 * (k % 7));
    Direction m = normal_at({e.x * spread, e.y});
    double theta = e.z * 80 * kPi / 180;
    double first = -1, largest = 0;
    for (int turn = 0; turn < 7; ++turn) {
      double angle = turn * 0.9;
      Direction o = direction(theta, angle);
      Direction turned{m.x * std::cos(angle) - m.y * std::sin(angle),
                       m.x * std::sin(angle) + m.y * std::cos(angle), m.z};
      Direction wi = reflect(o, turned);
      if (wi.z < 1e-3 || dot(o, turned) <= 0)
        break;
      Rgb rgb = rgb_of(f(o, wi));
      double value = rgb[0] + rgb[1] + rgb[2];
      first = first < 0 ? value : first;
      largest = std::max(largest, value);
      if (std::abs(value - first) > 1e-3 * largest)
        return false;
    }
  }
  return true;
}

RglTables make_rgl_tables(const Reflectance& f, const RglResolution& resolution,
                          RglQuality* quality) {
  RglQuality reached;
  RglTables tables = RglBuilder(f, resolution).run(reached);
  if (quality)
    *quality = reached;
  return tables;
}

} // namespace faceta
