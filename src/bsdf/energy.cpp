#include "bsdf/energy.h"

#include "sampling/quadrature.h"

#include <cmath>

namespace faceta {

namespace {

using Layout = EnergyTableLayout;

/// What wo's visible normals reflect it to, at the nodes of the quadrature: maps that are smooth in
/// both numbers, and periodic in the azimuth of GGX, whose nodes are equidistant for that reason.
std::vector<Vec3<double>> directions(const Microfacet<double>& surface, const Vec3<double>& wo,
                                     const Quadrature& q) {
  std::vector<Vec3<double>> result;
  size_t n = q.nodes.size();
  if (surface.options.distribution == kGgx) {
    for (size_t k = 0; k < n * n; ++k)
      result.push_back(surface.sample_reflection(wo, {q.nodes[k / n], (k % n + 0.5) / double(n)}));
    return result;
  }
  double x = surface.alpha_u * wo.x, y = surface.alpha_v * wo.y, r = std::hypot(x, y);
  double c = r > 0 ? x / r : 1, s = r > 0 ? y / r : 0;
  std::vector<double> along, across;
  for (double u : q.nodes) {
    along.push_back(beckmann_visible_slope(wo.z / std::max(r, 1e-30), u));
    across.push_back(erfinv(2 * u - 1));
  }
  for (size_t k = 0; k < n * n; ++k) {
    double a = along[k / n], b = across[k % n];
    Vec3<double> m{surface.alpha_u * (a * c - b * s), surface.alpha_v * (a * s + b * c), 1};
    result.push_back(reflect(wo, normalize(m)));
  }
  return result;
}

double albedo(const Microfacet<double>& surface, const Vec3<double>& wo, const Quadrature& q) {
  double sum = 0;
  size_t n = q.nodes.size();
  bool periodic = surface.options.distribution == kGgx;
  std::vector<Vec3<double>> wi = directions(surface, wo, q);
  for (size_t k = 0; k < n * n; ++k) {
    MicrofacetReflection<double> r = surface.reflection(wo, wi[k]);
    if (r.pdf > 0)
      sum += q.weights[k / n] * (periodic ? 1.0 / n : q.weights[k % n]) * r.value / r.pdf;
  }
  return sum;
}

/// cos theta of an inclination coordinate: the inverse of EnergyCoordinates, `along` being the
/// roughness along the view.
double cosine_of(double coordinate, double along) {
  double x = coordinate * coordinate;
  return x * along / (1 + along - x);
}

/// Direction of an azimuth coordinate and the roughness along it.
struct Azimuth {
  double x, y, along;
  Azimuth(double coordinate, double roughness, double ratio) {
    double x2 = coordinate / ratio, y2 = 1 - coordinate, sum = x2 + y2;
    x = std::sqrt(x2 / sum);
    y = std::sqrt(y2 / sum);
    along = roughness * std::sqrt((x2 * ratio + y2 / ratio) / sum);
  }
};

/// Cosine-weighted mean over the hemisphere of one slice as EnergyLookup interpolates it, so that
/// what is added is exactly what the table says is lost.
double mean_of_slice(const double* slice, double roughness, double ratio) {
  static const Quadrature inner = gauss_legendre(4);
  const int steps = Layout::kInclinations - 1, azimuths = ratio == 1 ? 1 : 256;
  double sum = 0;
  for (int k = 0; k < azimuths; ++k) {
    double phi = 0.5 * kPi * (k + 0.5) / azimuths, x = std::cos(phi), y = std::sin(phi);
    double along = roughness * std::sqrt(x * x * ratio + y * y / ratio);
    double position = x * x * ratio / (x * x * ratio + y * y) * (Layout::kAzimuths - 1);
    int a = std::min(int(position), Layout::kAzimuths - 2);
    auto value = [&](int i) {
      const double* row = slice + a * Layout::kInclinations + i;
      return row[0] + (row[Layout::kInclinations] - row[0]) * (position - a);
    };
    for (int i = 0; i < steps; ++i) {
      double c0 = i / double(steps), c1 = (i + 1) / double(steps);
      double m0 = cosine_of(c0, along), m1 = cosine_of(c1, along), v0 = value(i), v1 = value(i + 1);
      for (size_t q = 0; q < inner.nodes.size(); ++q) {
        double mu = m0 + (m1 - m0) * inner.nodes[q];
        double t = std::sqrt(mu * (1 + along) / (mu + along)) * steps - i;
        sum += 2 * mu * (v0 + (v1 - v0) * t) * inner.weights[q] * (m1 - m0) / azimuths;
      }
    }
  }
  return sum;
}

/// 1 - albedo of one roughness over all azimuths and inclinations.
std::vector<double> make_slice(const Microfacet<double>& surface, const Quadrature& q) {
  double ratio = surface.alpha_u / surface.alpha_v;
  double roughness = std::sqrt(surface.alpha_u * surface.alpha_v);
  std::vector<double> slice;
  for (int a = 0; a < Layout::kAzimuths; ++a) {
    Azimuth azimuth(a / double(Layout::kAzimuths - 1), roughness, ratio);
    for (int i = 0; i < Layout::kInclinations; ++i) {
      if (a > 0 && ratio == 1) { // isotropic: all azimuths are alike
        slice.push_back(slice[i]);
        continue;
      }
      double mu = cosine_of(i / double(Layout::kInclinations - 1), azimuth.along);
      mu = std::min(std::max(mu, 1e-6), 1.0);
      double sine = std::sqrt(1 - mu * mu);
      double e = albedo(surface, {sine * azimuth.x, sine * azimuth.y, mu}, q);
      slice.push_back(std::min(std::max(1 - e, 0.0), 1.0));
    }
  }
  return slice;
}

/// The roughnesses of a table.
struct Nodes {
  double own, largest;
  explicit Nodes(double r) : own(r), largest(std::max(1.0, 2 * r)) {}
  double at(int s) const {
    return s <= Layout::kBelow ? own * s / Layout::kBelow
                               : own + (largest - own) * (s - Layout::kBelow) / Layout::kAbove;
  }
};

/// `unit` is the geometric mean of alpha_u and alpha_v at roughness 1. The quadrature has more
/// nodes, if at all, at the material's own roughness: the other slices serve textures only.
void add_part(std::vector<double>& table, MicrofacetOptions options, const Nodes& nodes,
              double ratio, double unit, int own_nodes) {
  static const Quadrature coarse = gauss_legendre(16);
  const Quadrature fine = gauss_legendre(own_nodes);
  options.sample_visible = 1; // the quadrature's business only
  options.bounded = 1;
  std::vector<double> means;
  for (int s = 0; s < Layout::kRoughnesses; ++s) {
    double stretch = std::sqrt(ratio);
    double roughness = std::max(unit * nodes.at(s), 1e-4 * std::max(stretch, 1 / stretch));
    Microfacet<double> surface(options, roughness * stretch, roughness / stretch);
    std::vector<double> slice = make_slice(surface, s == Layout::kBelow ? fine : coarse);
    means.push_back(mean_of_slice(slice.data(), roughness, ratio));
    table.insert(table.end(), slice.begin(), slice.end());
  }
  table.insert(table.end(), means.begin(), means.end());
}

} // namespace

double microfacet_albedo(const MicrofacetOptions& options, double alpha_u, double alpha_v,
                         const Vec3<double>& wo, int n) {
  MicrofacetOptions visible = options;
  visible.sample_visible = 1; // the quadrature's business only
  visible.bounded = 1;
  return albedo(Microfacet<double>(visible, alpha_u, alpha_v), wo, gauss_legendre(n));
}

std::vector<double> make_energy_table(const MicrofacetOptions& options, double alpha_u,
                                      double alpha_v) {
  alpha_u = std::max(alpha_u, 1e-4);
  alpha_v = std::max(alpha_v, 1e-4);
  Nodes nodes(std::sqrt(alpha_u * alpha_v));
  double ratio = alpha_u / alpha_v;
  std::vector<double> table{nodes.own, nodes.largest, ratio, 1 / ratio};
  add_part(table, options, nodes, ratio, 1, ratio == 1 ? 64 : 48);
  return table;
}

std::vector<double> make_energy_table_of_ratios(const MicrofacetOptions& options, double alpha_u,
                                                double alpha_v) {
  Nodes nodes(0.5 * (std::max(alpha_u, 1e-4) + std::max(alpha_v, 1e-4)));
  std::vector<double> table{nodes.own, nodes.largest, 0, 0};
  for (int j = 0; j < Layout::kRatios; ++j) {
    double root = 1 - Layout::kLastRatio * j / (Layout::kRatios - 1);
    double unit = 2 * root / (1 + root * root); // of 2 / (1 + root^2) and root^2 times that
    add_part(table, options, nodes, 1 / (root * root), unit, 16);
  }
  return table;
}

} // namespace faceta
