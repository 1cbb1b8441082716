#include "bsdf/measured_build.h"

#include "base/error.h"
#include "bsdf/kernel.h"
#include "bsdf/measured_table.h"
#include "spectrum/cie.h"

#include <algorithm>
#include <tbb/parallel_for.h>

namespace faceta {

int axis_count(MeasuredCoordinates coordinates) {
  switch (coordinates) {
  case MeasuredCoordinates::half_difference:
  case MeasuredCoordinates::relative:
  case MeasuredCoordinates::specular:
    return 3;
  default:
    return 4;
  }
}

namespace {

using Warp = MeasuredHeader::Warp;

/// The block while it grows; the header is written at the end.
class Block {
public:
  MeasuredHeader header{};

  Block() : values_(sizeof(MeasuredHeader) / sizeof(float)) {}

  int32_t add(size_t count) {
    size_t at = values_.size();
    if (at + count > size_t(INT32_MAX))
      throw Error("a measured table of more than 2^31 numbers");
    values_.resize(at + count);
    return static_cast<int32_t>(at);
  }
  int32_t add(const std::vector<float>& values) {
    int32_t at = add(values.size());
    std::copy(values.begin(), values.end(), values_.begin() + at);
    return at;
  }
  int32_t size() const { return static_cast<int32_t>(values_.size()); }
  float* at(int32_t offset) { return values_.data() + offset; }
  const float* data() {
    std::memcpy(values_.data(), &header, sizeof header);
    return values_.data();
  }
  HugeVector<float> finish() {
    add(kLanePadding);
    data();
    return std::move(values_);
  }

private:
  HugeVector<float> values_;
};

Warp add_warp(Block& block, int nx, int ny) {
  Warp w{nx, ny, 0, 0, 0};
  size_t viewers = size_t(block.header.phis) * size_t(block.header.thetas);
  w.data = block.add(size_t(nx) * size_t(ny) * viewers);
  w.conditional = block.add(size_t(nx) * size_t(ny) * viewers);
  w.rows = block.add(size_t(2) * size_t(ny) * viewers);
  return w;
}

/// One of the viewers of a block.
struct Viewer {
  int phi, theta;
};

/// Fills in a viewer: values (scaled to sum to one over the cells) and their sums.
void fill_viewer(Block& block, const Warp& w, Viewer viewer, const double* values) {
  const size_t size = size_t(w.nx) * size_t(w.ny);
  std::vector<double> sums(size), rows(size_t(w.ny)), before(size_t(w.ny));
  auto sum_up = [&](const double* v) {
    for (int y = 0; y < w.ny; ++y) {
      double* sum = &sums[size_t(y) * size_t(w.nx)];
      const double* row = v + size_t(y) * size_t(w.nx);
      for (int x = 0; x + 1 < w.nx; ++x)
        sum[x + 1] = sum[x] + 0.5 * (row[x] + row[x + 1]);
      rows[size_t(y)] = sum[w.nx - 1];
      if (y > 0)
        before[size_t(y)] = before[size_t(y) - 1] + 0.5 * (rows[size_t(y) - 1] + rows[size_t(y)]);
    }
    return before.back();
  };
  double total = sum_up(values);
  std::vector<double> ones;
  if (!(total > 0)) { // black from here: any density will do
    ones.assign(size, 1.0);
    values = ones.data();
    total = sum_up(values);
  }
  const size_t thetas = size_t(block.header.thetas);
  size_t at = size * size_t(viewer.phi) * thetas + size_t(viewer.theta);
  for (size_t k = 0; k < size; ++k, at += thetas) {
    block.at(w.data)[at] = static_cast<float>(values[k] / total);
    block.at(w.conditional)[at] = static_cast<float>(sums[k] / total);
  }
  float* row =
      block.at(w.rows) + 2 * rows.size() * size_t(viewer.phi) * thetas + size_t(viewer.theta);
  for (size_t y = 0; y < rows.size(); ++y, row += 2 * thetas) {
    row[0] = static_cast<float>(before[y] / total);
    row[thetas] = static_cast<float>(rows[y] / total);
  }
}

void check(bool good, const char* what) {
  if (!good)
    throw Error(std::string("a measured table is inconsistent: ") + what);
}

// --- Grids ---

/// Nodes as the header wants them: roots taken, the first once more at the end of a period.
std::vector<double> stored_nodes(const MeasuredAxis& axis) {
  check(!axis.nodes.empty(), "an axis has no nodes");
  std::vector<double> nodes = axis.nodes;
  for (double& node : nodes) {
    check(std::isfinite(node) && (!axis.square_root || node >= 0), "an angle is out of range");
    node = axis.square_root ? std::sqrt(node) : node;
  }
  if (axis.period > 0)
    nodes.push_back(nodes.front() + axis.period);
  else if (nodes.size() == 1)
    nodes.push_back(nodes.front() + 1);
  for (size_t k = 1; k < nodes.size(); ++k)
    check(nodes[k] > nodes[k - 1], "the angles of an axis do not increase");
  return nodes;
}

MeasuredHeader::Axis add_axis(Block& block, const MeasuredAxis& axis) {
  std::vector<double> nodes = stored_nodes(axis);
  MeasuredHeader::Axis a{};
  a.cells = static_cast<int32_t>(nodes.size()) - 1;
  a.square_root = axis.square_root;
  a.period = static_cast<float>(axis.period);
  a.first = static_cast<float>(nodes.front());
  double step = (nodes.back() - nodes.front()) / a.cells;
  a.scale = static_cast<float>(1 / step);
  bool uniform = true;
  for (size_t k = 0; k < nodes.size(); ++k)
    uniform = uniform && std::abs(nodes[k] - (nodes.front() + step * double(k))) < 1e-6 * step;
  if (!uniform)
    a.nodes = block.add(std::vector<float>(nodes.begin(), nodes.end()));
  return a;
}

void add_values(Block& block, const MeasuredGrid& grid) {
  MeasuredHeader& h = block.header;
  int32_t count[4] = {1, 1, 1, 1}, own[4] = {1, 1, 1, 1};
  size_t cells = 1;
  for (int k = 0; k < h.axes; ++k) {
    count[k] = h.axis[k].cells + 1;
    own[k] = static_cast<int32_t>(grid.axes[size_t(k)].nodes.size());
    cells *= size_t(own[k]);
  }
  check(grid.rgb.size() == 3 * cells, "a grid has not one colour a cell");
  int64_t stride = 3;
  for (int k = h.axes - 1; k >= 0; --k) {
    h.axis[k].stride = static_cast<int32_t>(stride);
    stride *= count[k];
    if (stride > INT32_MAX)
      throw Error("a measured table of more than 2^31 numbers");
  }
  h.values = block.add(size_t(stride));
  float* out = block.at(h.values);
  for (int a = 0; a < count[0]; ++a)
    for (int b = 0; b < count[1]; ++b)
      for (int c = 0; c < count[2]; ++c) {
        size_t row = ((size_t(a % own[0]) * size_t(own[1]) + size_t(b % own[1])) * size_t(own[2]) +
                      size_t(c % own[2])) *
                     size_t(own[3]);
        for (int d = 0; d < count[3]; ++d, out += 3) {
          const float* rgb = &grid.rgb[3 * (row + size_t(d % own[3]))];
          bool hole = std::isnan(rgb[0]);
          h.holes |= hole;
          for (int i = 0; i < 3; ++i) {
            check(hole || (rgb[i] >= 0 && std::isfinite(rgb[i])), "a value is out of range");
            out[i] = hole ? -1 : rgb[i];
          }
        }
      }
}

// --- Sampling ---

/// Mean over the azimuth of max(0, a.b) for two directions by their inclinations.
double mean_projection(double a, double b) {
  double p = std::cos(a) * std::cos(b), q = std::sin(a) * std::sin(b);
  if (p >= q)
    return p;
  double end = std::acos(-p / q);
  return (p * end + q * std::sin(end)) * kInvPi;
}

double brightness(const Color<double>& c) {
  return luminance({c[0], c[1], c[2]});
}

Vec3<double> direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

double inclination_of(double u) {
  return sqr(u) * 0.5 * kPi;
}

/// Density of normals over inclination (by u) and azimuth, bilinear. Anisotropic surfaces have
/// several columns of azimuth, others one.
struct NormalDensity {
  int thetas, phis;
  std::vector<double> values; ///< [theta][phi]

  double at(double u, double phi) const {
    double p = std::clamp(u * thetas - 0.5, 0.0, thetas - 1.0);
    int i = std::min(int(p), std::max(0, thetas - 2)), j = std::min(i + 1, thetas - 1);
    double x = phi * kInvTwoPi;
    x = (x - std::floor(x)) * phis;
    int k = int(x) % phis, l = (k + 1) % phis;
    double t = p - i, s = x - std::floor(x);
    auto v = [&](int a, int b) { return values[size_t(a * phis + b)]; };
    return lerp(lerp(v(i, k), v(j, k), t), lerp(v(i, l), v(j, l), t), s);
  }
};

/// A cell that reflects nothing back (or was not measured) still has normals: a little of what its
/// neighbours have.
void fill_gaps(std::vector<double>& retro) {
  double largest = *std::max_element(retro.begin(), retro.end());
  for (double& r : retro)
    r = std::max(r, 1e-6 * largest);
  if (!(largest > 0))
    retro.assign(retro.size(), 1.0);
}

constexpr int kInclinations = 128; ///< of isotropic normals

NormalDensity anisotropic_normals(const MeasuredTable<double>& table) {
  NormalDensity d{40, 36, {}};
  std::vector<Vec3<double>> directions;
  std::vector<double> area, retro;
  for (int i = 0; i < d.thetas; ++i)
    for (int k = 0; k < d.phis; ++k) {
      double theta = inclination_of((i + 0.5) / d.thetas);
      Vec3<double> o = direction(theta, 2 * kPi * k / d.phis);
      directions.push_back(o);
      area.push_back((i + 0.5) * std::sin(theta));
      retro.push_back(brightness(table.grid_value(o, o)));
    }
  fill_gaps(retro);
  size_t n = directions.size();
  d.values.assign(n, 1.0);
  for (int iteration = 0; iteration < 4; ++iteration) {
    std::vector<double> next(n);
    tbb::parallel_for(size_t(0), n, [&](size_t o) {
      double sum = 0;
      for (size_t m = 0; m < n; ++m)
        sum += d.values[m] * area[m] * std::max(0.0, dot(directions[o], directions[m]));
      next[o] = retro[o] * sum;
    });
    double largest = *std::max_element(next.begin(), next.end());
    for (size_t k = 0; k < n; ++k)
      d.values[k] = next[k] / largest;
  }
  return d;
}

NormalDensity isotropic_normals(const MeasuredTable<double>& table) {
  std::vector<double> retro;
  for (int k = 0; k < kInclinations; ++k) {
    Vec3<double> o = direction(inclination_of((k + 0.5) / kInclinations), 0);
    retro.push_back(brightness(table.grid_value(o, o)));
  }
  return {kInclinations, 1, normals_of_retroreflection(retro)};
}

/// Normals by what they mirror: the mean over viewers of 4 f cos_i, which visible normals would
/// have to follow. For tables whose mirror peak is not seen in what they reflect back.
NormalDensity mirroring_normals(const MeasuredTable<double>& table) {
  constexpr int kAround = 12;
  NormalDensity d{kInclinations, 1, std::vector<double>(kInclinations)};
  for (double viewer : {0.1, 0.35, 0.6, 0.85, 1.1, 1.3}) {
    Vec3<double> wo = direction(viewer, 0);
    std::vector<double> seen(kInclinations);
    double total = 0;
    for (int k = 0; k < kInclinations; ++k) {
      double theta = inclination_of((k + 0.5) / kInclinations);
      for (int j = 0; j < kAround; ++j) {
        Vec3<double> m = direction(theta, 2 * kPi * (j + 0.5) / kAround), wi = reflect(wo, m);
        if (dot(wo, m) > 0 && wi.z > 0)
          seen[size_t(k)] += brightness(table.grid_value(wo, wi)) / kAround;
      }
      total += seen[size_t(k)] * (k + 0.5) * std::sin(theta);
    }
    for (int k = 0; k < kInclinations && total > 0; ++k)
      d.values[size_t(k)] += seen[size_t(k)] / total;
  }
  fill_gaps(d.values);
  return d;
}

/// Viewers' inclinations: those of the table if it has them, as it is linear in between; else
/// denser towards the horizon, where the share of what is mirrored changes.
std::vector<float> viewer_inclinations(const MeasuredGrid& grid) {
  using C = MeasuredCoordinates;
  const MeasuredAxis* axis = nullptr;
  if (grid.coordinates == C::relative)
    axis = &grid.axes[1];
  if (axis && !axis->square_root && axis->nodes.size() >= 12 && axis->nodes.size() <= 64) {
    std::vector<float> list(axis->nodes.begin(), axis->nodes.end());
    if (list.front() > 0)
      list.insert(list.begin(), 0);
    if (list.back() < float(0.5 * kPi))
      list.push_back(float(0.5 * kPi));
    return list;
  }
  std::vector<float> list;
  for (double degrees :
       {0.0, 14.0, 27.0, 38.0, 48.0, 56.0, 63.0, 69.0, 74.0, 78.0, 81.5, 84.5, 87.0, 90.0})
    list.push_back(static_cast<float>(degrees * kPi / 180));
  return list;
}

class SamplerBuilder {
public:
  /// `fine`: luminance with twice the nodes, and a viewer between each two.
  SamplerBuilder(Block& block, const MeasuredGrid& grid, bool fine)
      : block_(block), isotropic_(grid.axes.size() == 3), theta_(viewer_inclinations(grid)),
        phi_{0} {
    for (size_t k = 1; fine && k < theta_.size(); k += 2)
      theta_.insert(theta_.begin() + std::ptrdiff_t(k), 0.5f * (theta_[k - 1] + theta_[k]));
    if (!isotropic_) {
      phi_.clear();
      for (int k = 0; k <= kAzimuths; ++k)
        phi_.push_back(static_cast<float>(2 * kPi * k / kAzimuths - kPi));
    }
    MeasuredHeader& h = block.header;
    h.thetas = static_cast<int32_t>(theta_.size());
    h.phis = static_cast<int32_t>(phi_.size());
    h.theta_nodes = block.add(theta_);
    h.phi_nodes = block.add(phi_);
    h.sectors = 1;
    h.cosine_share = 0.05f;
    // Around the normal visible normals change slowly unless the surface is anisotropic.
    h.vndf = isotropic_ ? add_warp(block, 128, 32) : add_warp(block, 64, 64);
    h.luminance = add_warp(block, fine ? 64 : 32, fine ? 64 : 32);
  }

  /// Fills the warps: of two guesses at the normals the one that samples better. Returns the mean
  /// variance of the weights (isotropic tables; else 0).
  double build() {
    MeasuredTable<double> table(block_.data());
    if (!isotropic_) {
      fill(table, anisotropic_normals(table));
      return 0;
    }
    fill(table, isotropic_normals(table));
    double first_variance = weight_variance(table);
    const float* warps = block_.at(block_.header.vndf.data); // what was added last
    std::vector<float> first(warps, warps + block_.size() - block_.header.vndf.data);
    fill(table, mirroring_normals(table));
    double variance = weight_variance(table);
    if (first_variance < variance)
      std::copy(first.begin(), first.end(), block_.at(block_.header.vndf.data));
    return std::min(first_variance, variance);
  }

private:
  static constexpr int kAzimuths = 16;

  void fill(const MeasuredTable<double>& table, const NormalDensity& normals) {
    const MeasuredHeader& h = block_.header;
    tbb::parallel_for(0, h.thetas * h.phis, [&](int k) {
      Viewer viewer{k / h.thetas, k % h.thetas};
      double inclination = std::min<double>(theta_[size_t(viewer.theta)], 0.5 * kPi - 1e-3);
      Vec3<double> wo = direction(inclination, phi_[size_t(viewer.phi)]);
      fill_normals(normals, viewer, wo);
      fill_luminance(table, viewer, wo);
    });
  }

  /// Mean over viewers of the relative variance of a sample's brightness.
  static double weight_variance(const MeasuredTable<double>& table) {
    constexpr int kViewers = 12, kSide = 24;
    double sum = 0;
    for (int k = 0; k < kViewers; ++k) {
      Vec3<double> wo = direction((k + 0.37) / kViewers * 1.4, 0);
      double first = 0, second = 0;
      for (int i = 0; i < kSide * kSide; ++i) {
        double share = i * 0.6180339887498949;
        Random<double> random{{(i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide},
                              share - std::floor(share)};
        Eval<double> e;
        Vec3<double> wi = table.sample(wo, random, e);
        double weight = wi.z > 0 && e.pdf > 0 ? brightness(e.value) / e.pdf : 0;
        first += weight;
        second += weight * weight;
      }
      if (first > 0)
        sum += second * kSide * kSide / sqr(first) - 1;
    }
    return sum / kViewers;
  }

  /// D(m) max(0, wo.m) over the square.
  void fill_normals(const NormalDensity& normals, Viewer viewer, const Vec3<double>& wo) {
    const Warp& w = block_.header.vndf;
    std::vector<double> values;
    for (int y = 0; y < w.ny; ++y)
      for (int x = 0; x < w.nx; ++x) {
        double u = double(x) / (w.nx - 1), phi = (2.0 * y / (w.ny - 1) - 1) * kPi;
        Vec3<double> m = direction(inclination_of(u), phi);
        double area = u * std::sin(inclination_of(u));
        values.push_back(normals.at(u, phi) * std::max(0.0, dot(wo, m)) * area);
      }
    fill_viewer(block_, w, viewer, values.data());
  }

  /// What is reflected to the viewer, over the density of the visible normals: at the nodes the
  /// root of the mean square of the points around them, which gives the least variance.
  void fill_luminance(const MeasuredTable<double>& table, Viewer viewer, const Vec3<double>& wo) {
    const Warp& w = block_.header.luminance;
    const MeasuredHeader& h = block_.header;
    int below = std::min(viewer.theta, h.thetas - 2);
    MeasuredViewer<double> place{
        h.phis > 1 ? 2 : 1, {viewer.phi, viewer.phi}, {1, 0}, below, double(viewer.theta - below)};
    MeasuredWarp<double> normals(block_.at(0), h, h.vndf, place);
    int points = (isotropic_ ? 3 : 2) * (w.nx - 1);
    std::vector<double> sums(size_t(w.nx) * size_t(w.ny)), weights(sums.size());
    for (int j = 0; j < points; ++j)
      for (int i = 0; i < points; ++i) {
        Vec2<double> s{(i + 0.5) / points, (j + 0.5) / points};
        auto normal = normals.sample(s);
        double theta = inclination_of(normal.u.x);
        Vec3<double> m = direction(theta, (2 * normal.u.y - 1) * kPi);
        Vec3<double> wi = reflect(wo, m);
        double value = 0;
        if (wi.z > 0 && normal.density > 0) {
          double area = std::max(2 * kPi * kPi * normal.u.x * std::sin(theta), 1e-6);
          value = brightness(table.grid_value(wo, wi)) * area * 4 * dot(wo, m) / normal.density;
        }
        deposit(w, s, value, sums, weights);
      }
    for (size_t k = 0; k < sums.size(); ++k)
      sums[k] = std::sqrt(std::max(0.0, sums[k] / weights[k]));
    fill_viewer(block_, w, viewer, sums.data());
  }
  static void deposit(const Warp& w, const Vec2<double>& s, double value, std::vector<double>& sums,
                      std::vector<double>& weights) {
    double x = s.x * (w.nx - 1), y = s.y * (w.ny - 1);
    int i = std::min(int(x), w.nx - 2), j = std::min(int(y), w.ny - 2);
    for (int corner = 0; corner < 4; ++corner) {
      int dx = corner & 1, dy = corner >> 1;
      double weight = (dx ? x - i : 1 - (x - i)) * (dy ? y - j : 1 - (y - j));
      size_t k = size_t(j + dy) * size_t(w.nx) + size_t(i + dx);
      sums[k] += weight * sqr(value);
      weights[k] += weight;
    }
  }

  Block& block_;
  bool isotropic_;
  std::vector<float> theta_, phi_; ///< viewers
};

// --- The adaptive parametrisation ---

MeasuredHeader::Plain add_plain(Block& block, const std::vector<float>& values,
                                const int (&size)[2]) {
  check(size[0] >= 2 && size[1] >= 2 && values.size() == size_t(size[0]) * size_t(size[1]),
        "a table has not the size it says");
  return {size[1], size[0], block.add(values)};
}

Warp add_file_warp(Block& block, const std::vector<float>& values, const int (&size)[2]) {
  const MeasuredHeader& h = block.header;
  size_t nodes = size_t(size[0]) * size_t(size[1]);
  check(size[0] >= 2 && size[1] >= 2 && values.size() >= nodes * size_t(h.phis) * size_t(h.thetas),
        "a table has not the size it says");
  Warp w = add_warp(block, size[1], size[0]);
  std::vector<double> slice(nodes);
  const float* in = values.data();
  for (int phi = 0; phi < h.phis; ++phi)
    for (int theta = 0; theta < h.thetas; ++theta, in += nodes) {
      for (size_t i = 0; i < nodes; ++i)
        slice[i] = std::max(0.0f, in[i]);
      fill_viewer(block, w, {phi, theta}, slice.data());
    }
  return w;
}

/// Colours with the viewers' inclinations last.
int32_t add_colors(Block& block, const std::vector<float>& rgb) {
  const MeasuredHeader& h = block.header;
  size_t nodes = size_t(h.luminance.nx) * size_t(h.luminance.ny), thetas = size_t(h.thetas);
  check(rgb.size() >= 3 * nodes * thetas * size_t(h.phis),
        "its colours are fewer than its luminance");
  int32_t at = block.add(3 * nodes * thetas * size_t(h.phis));
  const float* in = rgb.data();
  for (size_t phi = 0; phi < size_t(h.phis); ++phi)
    for (size_t theta = 0; theta < thetas; ++theta)
      for (size_t n = 0; n < nodes; ++n, in += 3)
        std::copy(in, in + 3, block.at(at) + 3 * ((phi * nodes + n) * thetas + theta));
  return at;
}

} // namespace

std::vector<double> normals_of_retroreflection(const std::vector<double>& given) {
  const size_t n = given.size();
  std::vector<double> retro = given, theta(n), area(n), normals(n, 1.0);
  fill_gaps(retro);
  for (size_t k = 0; k < n; ++k) {
    double u = (double(k) + 0.5) / double(n);
    theta[k] = inclination_of(u);
    area[k] = 2 * kPi * kPi * u * std::sin(theta[k]) / double(n); // sin theta dtheta, around
  }
  auto projected = [&](double a) {
    double sum = 0;
    for (size_t m = 0; m < n; ++m)
      sum += normals[m] * area[m] * mean_projection(a, theta[m]);
    return sum;
  };
  // The second eigenvalue is far below the first: four steps are enough.
  for (int iteration = 0; iteration < 4; ++iteration) {
    std::vector<double> next(n);
    for (size_t k = 0; k < n; ++k)
      next[k] = retro[k] * projected(theta[k]);
    normals = next;
    double scale = projected(0);
    for (double& v : normals)
      v /= scale;
  }
  return normals;
}

HugeVector<float> measured_block(const MeasuredGrid& grid) {
  constexpr double kGoodVariance = 0.06; // of most files
  for (bool fine : {false, true}) {
    Block block;
    MeasuredHeader& h = block.header;
    h.kind = MeasuredKind::grid;
    h.coordinates = grid.coordinates;
    h.axes = axis_count(grid.coordinates);
    check(grid.axes.size() == size_t(h.axes), "a grid has not the axes of its coordinates");
    for (int k = 0; k < h.axes; ++k)
      h.axis[k] = add_axis(block, grid.axes[size_t(k)]);
    add_values(block, grid);
    if (SamplerBuilder(block, grid, fine).build() < kGoodVariance || fine)
      return block.finish();
  }
  return {};
}

HugeVector<float> measured_block(const MeasuredFile& file) {
  return std::visit([](const auto& data) { return measured_block(data); }, file.data);
}

HugeVector<float> measured_block(const RglTables& t) {
  Block block;
  MeasuredHeader& h = block.header;
  h.kind = MeasuredKind::rgl;
  check(t.theta_i.size() >= 2 && !t.phi_i.empty(), "a file has too few viewers");
  h.thetas = static_cast<int32_t>(t.theta_i.size());
  h.phis = t.phi_i.size() <= 2 ? 1 : static_cast<int32_t>(t.phi_i.size());
  h.theta_nodes = block.add(t.theta_i);
  h.phi_nodes = block.add(t.phi_i);
  h.sectors =
      h.phis == 1 ? 1 : static_cast<int32_t>(std::lround(2 * kPi / (t.phi_i.back() - t.phi_i[0])));
  double middle = 0.5 * (double(t.phi_i.front()) + double(t.phi_i.back()));
  h.sector_x = std::cos(middle) < 0 ? -1.0f : 1.0f;
  h.sector_y = std::sin(middle) < 0 ? -1.0f : 1.0f;
  check(h.sectors == 1 || h.sectors == 2 || h.sectors == 4,
        "its azimuths span neither the circle nor a half nor a quarter of it");
  h.vndf = add_file_warp(block, t.vndf, t.vndf_size);
  h.luminance = add_file_warp(block, t.luminance, t.luminance_size);
  h.ndf = add_plain(block, t.ndf, t.ndf_size);
  h.sigma = add_plain(block, t.sigma, t.sigma_size);
  h.rgb = add_colors(block, t.rgb);
  h.jacobian = t.jacobian;
  return block.finish();
}

} // namespace faceta
