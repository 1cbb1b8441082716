#include "bsdf/rough_interface.h"

#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"
#include "sampling/quadrature.h"
#include "sampling/warp.h"

namespace faceta {

namespace {

/// Visible normals at the nodes of a square with the weights of the mean; normals at the mirrored
/// second coordinate are left out, their twins count twice.
class VisibleNormals {
public:
  VisibleNormals(int distribution, double alpha, int nodes)
      : surface_({.distribution = distribution}, alpha, alpha), rule_(gauss_legendre(nodes)) {
    int half = (nodes + 1) / 2;
    for (int j = 0; j < half; ++j)
      for (int i = 0; i < nodes; ++i) {
        double twice = 2 * j + 1 == nodes ? 1 : 2;
        weights_.push_back(twice * rule_.weights[i] * rule_.weights[j]);
        if (distribution == kGgx)
          disk_.push_back(concentric_disk(Vec2<double>{rule_.nodes[j], rule_.nodes[i]}));
      }
  }
  const Microfacet<double>& surface() const { return surface_; }

  /// Mean of f(unit normal) over the normals visible from w = (sin, 0, cos).
  template <class F> double mean(const Vec3<double>& w, F f) const {
    int nodes = static_cast<int>(rule_.nodes.size()), count = static_cast<int>(weights_.size());
    double sum = 0;
    if (surface_.options.distribution == kGgx) {
      for (int k = 0; k < count; ++k)
        sum += weights_[k] * f(normalize(ggx_normal(w, disk_[k])));
      return sum;
    }
    // Beckmann's visible slopes along and across the view are independent.
    std::vector<double> along(nodes), across((nodes + 1) / 2);
    for (int i = 0; i < nodes; ++i)
      along[i] =
          surface_.alpha_u * beckmann_visible_slope(w.z / (surface_.alpha_u * w.x), rule_.nodes[i]);
    for (size_t j = 0; j < across.size(); ++j)
      across[j] = surface_.alpha_u * erfinv(2 * rule_.nodes[j] - 1);
    for (int k = 0; k < count; ++k)
      sum += weights_[k] * f(normalize(Vec3<double>{along[k % nodes], across[k / nodes], 1}));
    return sum;
  }

private:
  /// Projected-disc map of Heitz 2018 (Sampling the GGX Distribution of Visible Normals).
  Vec3<double> ggx_normal(const Vec3<double>& w, const Vec2<double>& p) const {
    double alpha = surface_.alpha_u;
    Vec3<double> v = normalize(Vec3<double>{alpha * w.x, 0, w.z});
    double y = lerp(safe_sqrt(1 - p.x * p.x), p.y, 0.5 * (1 + v.z));
    double z = safe_sqrt(1 - p.x * p.x - y * y);
    // The disc's axes are (0, 1, 0) and, towards the normal, (-v.z, 0, v.x).
    return {alpha * (z * v.x - y * v.z), alpha * p.x, max(z * v.z + y * v.x, 1e-12)};
  }

  Microfacet<double> surface_;
  Quadrature rule_;
  std::vector<double> weights_;
  std::vector<Vec2<double>> disk_;
};

int nodes_for(double eta) {
  return eta > 1 ? 32 : 128;
}

} // namespace

RoughInterface rough_interface(int distribution, double alpha, double eta, int cosines) {
  RoughInterface result{std::vector<double>(cosines), 0};
  VisibleNormals outside(distribution, alpha, nodes_for(eta));
  VisibleNormals inside(distribution, alpha, nodes_for(1 / eta));
  for (int k = 0; k < cosines; ++k) {
    double mu = max(1e-6, double(k) / (cosines - 1));
    Vec3<double> w{sqrt(1 - mu * mu), 0, mu};
    result.transmittance[k] = outside.mean(w, [&](const Vec3<double>& m) {
      double c = dot(w, m);
      DielectricFresnel<double> f = fresnel_dielectric(c, eta);
      Vec3<double> out = -refract(w, m, c, f);
      return out.z > 0 ? (1 - f.reflectance) * outside.surface().masking(out) : 0.0;
    });
    double reflected = inside.mean(w, [&](const Vec3<double>& m) {
      Vec3<double> out = reflect(w, m);
      double f = fresnel_dielectric(dot(w, m), 1 / eta).reflectance;
      return out.z > 0 ? f * inside.surface().masking(out) : 0.0;
    });
    result.internal_reflectance += 2.0 / cosines * mu * reflected;
  }
  return result;
}

} // namespace faceta
