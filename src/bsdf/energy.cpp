#include "bsdf/energy.h"

#include <cmath>

namespace faceta {

namespace {

using Layout = EnergyTableLayout;

struct Quadrature {
  std::vector<double> x, weight;
};

/// Gauss and Legendre's nodes on [0, 1], by Newton's iteration on the Legendre polynomial.
Quadrature gauss_legendre(int n) {
  Quadrature q;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 60; ++step) {
      double p = 1, before = 0;
      for (int k = 1; k <= n; ++k) {
        double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = n * (x * p - before) / (x * x - 1);
      x -= p / slope;
      if (std::fabs(p / slope) < 1e-15)
        break;
    }
    q.x.push_back(0.5 * (1 - x));
    q.weight.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return q;
}

/// The visible normals of wo at the nodes of the quadrature, by maps that are smooth in both
/// numbers.
std::vector<Vec3<double>> directions(const Microfacet<double>& surface, const Vec3<double>& wo,
                                     const Quadrature& q) {
  std::vector<Vec3<double>> result;
  size_t n = q.x.size();
  if (surface.options.distribution == kGgx) {
    for (size_t k = 0; k < n * n; ++k)
      result.push_back(surface.sample_reflection(wo, {q.x[k / n], q.x[k % n]}));
    return result;
  }
  double x = surface.alpha_u * wo.x, y = surface.alpha_v * wo.y, r = std::hypot(x, y);
  double c = r > 0 ? x / r : 1, s = r > 0 ? y / r : 0;
  std::vector<double> along;
  for (double u : q.x)
    along.push_back(beckmann_visible_slope(wo.z / std::max(r, 1e-30), u));
  for (size_t k = 0; k < n * n; ++k) {
    double a = along[k / n], b = erfinv(2 * q.x[k % n] - 1);
    Vec3<double> m{surface.alpha_u * (a * c - b * s), surface.alpha_v * (a * s + b * c), 1};
    result.push_back(reflect(wo, normalize(m)));
  }
  return result;
}

double albedo(const Microfacet<double>& surface, const Vec3<double>& wo, const Quadrature& q) {
  double sum = 0;
  size_t n = q.x.size();
  std::vector<Vec3<double>> wi = directions(surface, wo, q);
  for (size_t k = 0; k < n * n; ++k) {
    MicrofacetReflection<double> r = surface.reflection(wo, wi[k]);
    if (r.pdf > 0)
      sum += q.weight[k / n] * q.weight[k % n] * r.value / r.pdf;
  }
  return sum;
}

/// cos theta of an inclination coordinate: the inverse of Layout::inclination.
double cosine_of(double coordinate, double roughness) {
  return coordinate * roughness / (1 + roughness - coordinate);
}

/// Cosine-weighted mean over the hemisphere of one slice as EnergyLookup interpolates it, so that
/// what is added is exactly what the table says is lost.
double mean_of_slice(const double* slice, double roughness) {
  static const Quadrature q = gauss_legendre(4);
  double azimuth_mean[Layout::kInclinations] = {};
  // The azimuth's coordinate is cos^2 phi: integrate each linear piece over phi in closed form.
  for (int k = 0; k + 1 < Layout::kAzimuths; ++k) {
    double steps = Layout::kAzimuths - 1, c0 = k / steps, c1 = (k + 1) / steps;
    double p0 = std::acos(std::sqrt(c0)), p1 = std::acos(std::sqrt(c1));
    double length = (p0 - p1) / (kPi / 2);
    double cos2 = 0.5 * length + 0.25 * (std::sin(2 * p0) - std::sin(2 * p1)) / (kPi / 2);
    double far = (cos2 - c0 * length) * steps;
    for (int i = 0; i < Layout::kInclinations; ++i)
      azimuth_mean[i] += slice[k * Layout::kInclinations + i] * (length - far) +
                         slice[(k + 1) * Layout::kInclinations + i] * far;
  }
  double sum = 0;
  for (int i = 0; i + 1 < Layout::kInclinations; ++i) {
    double steps = Layout::kInclinations - 1;
    double m0 = cosine_of(i / steps, roughness), m1 = cosine_of((i + 1) / steps, roughness);
    for (size_t a = 0; a < q.x.size(); ++a) {
      double mu = m0 + (m1 - m0) * q.x[a];
      double t = Layout::inclination(mu, roughness) * steps - i;
      double value = azimuth_mean[i] + (azimuth_mean[i + 1] - azimuth_mean[i]) * t;
      sum += 2 * mu * value * q.weight[a] * (m1 - m0);
    }
  }
  return sum;
}

} // namespace

double microfacet_albedo(const MicrofacetOptions& options, double alpha_u, double alpha_v,
                         const Vec3<double>& wo, int n) {
  MicrofacetOptions visible = options;
  visible.sample_visible = 1; // the quadrature's business only
  visible.bounded = 1;
  return albedo(Microfacet<double>(visible, alpha_u, alpha_v), wo, gauss_legendre(n));
}

std::vector<double> make_energy_table(const MicrofacetOptions& given, double alpha_u,
                                      double alpha_v) {
  MicrofacetOptions options = given;
  options.sample_visible = 1; // the quadrature's business only
  options.bounded = 1;
  alpha_u = std::max(alpha_u, 1e-4);
  alpha_v = std::max(alpha_v, 1e-4);
  double own = std::sqrt(alpha_u * alpha_v), largest = std::max(1.0, 2 * own);
  double stretch = std::sqrt(alpha_u / alpha_v);
  static const Quadrature q = gauss_legendre(24);
  std::vector<double> table{own, largest}, means;
  for (int s = 0; s < Layout::kRoughnesses; ++s) {
    double roughness = s <= Layout::kBelow
                           ? own * s / Layout::kBelow
                           : own + (largest - own) * (s - Layout::kBelow) / Layout::kAbove;
    roughness = std::max(roughness, 1e-4);
    Microfacet<double> surface(options, roughness * stretch, roughness / stretch);
    std::vector<double> slice;
    for (int a = 0; a < Layout::kAzimuths; ++a) {
      if (a > 0 && alpha_u == alpha_v) { // isotropic: all azimuths are alike
        for (int i = 0; i < Layout::kInclinations; ++i)
          slice.push_back(slice[i]);
        continue;
      }
      double cos2 = a / double(Layout::kAzimuths - 1);
      for (int i = 0; i < Layout::kInclinations; ++i) {
        double mu = cosine_of(i / double(Layout::kInclinations - 1), roughness);
        mu = std::min(std::max(mu, 1e-6), 1.0);
        double sine = std::sqrt(1 - mu * mu);
        Vec3<double> wo{sine * std::sqrt(cos2), sine * std::sqrt(1 - cos2), mu};
        slice.push_back(std::min(std::max(1 - albedo(surface, wo, q), 0.0), 1.0));
      }
    }
    means.push_back(mean_of_slice(slice.data(), roughness));
    table.insert(table.end(), slice.begin(), slice.end());
  }
  table.insert(table.end(), means.begin(), means.end());
  return table;
}

} // namespace faceta
