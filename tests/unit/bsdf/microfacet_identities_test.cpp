// What Smith's microfacet model is built on, for every distribution from almost smooth to fully
// rough, isotropic and not, by quadrature: all normals project to the unit area, the visible ones
// to cos theta, and a white surface that masks only gives back all light (the weak white furnace).
// These hold with the exact Lambda only.

#include "bsdf/microfacet.h"
#include "sampling/quadrature.h"

#include <gtest/gtest.h>

namespace faceta {
namespace {

using Direction = Vec3<double>;

struct Surface {
  int distribution;
  double alpha_u, alpha_v;
  Microfacet<double> make() const { return {{.distribution = distribution}, alpha_u, alpha_v}; }
};

std::vector<Surface> surfaces() {
  std::vector<Surface> all;
  for (int distribution : {kBeckmann, kGgx}) {
    for (double alpha : {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 0.6, 1.0})
      all.push_back({distribution, alpha, alpha});
    for (auto [u, v] : {std::pair{0.001, 0.01}, {0.05, 0.3}, {0.4, 0.1}, {1.0, 0.2}, {0.001, 1.0}})
      all.push_back({distribution, u, v});
  }
  return all;
}

std::vector<Direction> views(const Surface& s) {
  std::vector<Direction> all;
  for (double degrees : {0.0, 30.0, 60.0, 80.0, 89.0})
    for (double azimuth : {0.7, 0.0, 0.5 * kPi, 2.5}) {
      if (azimuth != 0.7 && (s.alpha_u == s.alpha_v || degrees == 0))
        continue;
      double theta = degrees * kPi / 180;
      all.push_back({std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
                     std::cos(theta)});
    }
  return all;
}

std::string name(const Surface& s, const Direction& w) {
  return (s.distribution == kGgx ? "ggx " : "beckmann ") + std::to_string(s.alpha_u) + " " +
         std::to_string(s.alpha_v) + ", cos theta " + std::to_string(w.z) + ", x " +
         std::to_string(w.x);
}

const Quadrature& fine() {
  static const Quadrature q = gauss_legendre(96);
  return q;
}

/// The integral of max(0, w.m) D(m) over all normals m, along rays of slopes m = (-slope, 1) with
/// the roughness taken out. Each ray ends where the normals turn away from w.
double visible_area(const Microfacet<double>& s, const Direction& w) {
  const int rays = 256;
  double sum = 0;
  for (int j = 0; j < rays; ++j) {
    double phi = 2 * kPi * (j + 0.5) / rays;
    double x = s.alpha_u * std::cos(phi), y = s.alpha_v * std::sin(phi);
    double slope = x * w.x + y * w.y; // w.m = w.z + radius * slope
    double last = slope < 0 ? w.z / -slope : INFINITY;
    double end = last < INFINITY ? last / (1 + last) : 1; // of radius / (1 + radius)
    for (size_t i = 0; i < fine().nodes.size(); ++i) {
      double t = end * fine().nodes[i], radius = t / (1 - t);
      Direction m{radius * x, radius * y, 1};
      // dm = cos^3 dslope; w and D take the unit normal.
      double cos2 = 1 / dot(m, m);
      double area = s.alpha_u * s.alpha_v * radius / sqr(1 - t) * end * fine().weights[i];
      sum += s.density(m) * dot(w, m) * cos2 * cos2 * area * 2 * kPi / rays;
    }
  }
  return sum;
}

TEST(MicrofacetIdentities, NormalsProjectToOne) {
  for (const Surface& surface : surfaces())
    EXPECT_NEAR(visible_area(surface.make(), {0, 0, 1}), 1, 1e-9) << name(surface, {0, 0, 1});
}

TEST(MicrofacetIdentities, ProjectedAreaIsTheCosine) {
  for (const Surface& surface : surfaces())
    for (const Direction& w : views(surface)) {
      Microfacet<double> s = surface.make();
      double area = visible_area(s, w);
      EXPECT_NEAR(s.projected_area(w) / area, 1, 2e-5) << name(surface, w);
      // Times the exact masking, which is the same for all visible normals.
      double masking = w.z / s.projected_area(w);
      EXPECT_NEAR(masking * area, w.z, 2e-5 * w.z) << name(surface, w);
      // The models' masking: exact, or Walter's rational fit to it.
      double fit = surface.distribution == kGgx ? 1e-12 : 3.5e-3;
      EXPECT_NEAR(s.masking(w) / masking, 1, fit) << name(surface, w);
    }
}

/// Heitz 2014, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", eq. 33:
/// the integral of D(h) G1(wo) / (4 cos theta_o) over all wi, below the surface too. In circles
/// around the mirror direction, whose radii grow exponentially: from far narrower than any lobe.
double weak_furnace(const Microfacet<double>& s, const Direction& wo) {
  const int sectors = 256;
  const double narrowest = 1e-9;
  Direction mirror = reflect(wo);
  Direction side = std::abs(mirror.x) > 0.9 ? Direction{0, 1, 0} : Direction{1, 0, 0};
  Direction a = normalize(side - mirror * dot(side, mirror)), b = cross(mirror, a);
  double masking = wo.z / s.projected_area(wo), sum = 0;
  for (int j = 0; j < sectors; ++j) {
    double psi = 2 * kPi * (j + 0.5) / sectors;
    Direction outward = a * std::cos(psi) + b * std::sin(psi);
    // The circle on which h is horizontal, wi.z = -wo.z: where facets turn away.
    double turn = std::atan2(outward.z, mirror.z);
    double end = std::log((outward.z < 0 ? kPi + 2 * turn : kPi) / narrowest);
    for (int part = 0; part < 3; ++part)
      for (size_t i = 0; i < fine().nodes.size(); ++i) {
        double radius = narrowest * std::exp(end * (part + fine().nodes[i]) / 3);
        // wo + wi from its small parts: at alpha = 0.001 it is almost vertical.
        Direction h{0, 0, 2 * wo.z};
        h = h + outward * std::sin(radius) - mirror * (2 * sqr(std::sin(0.5 * radius)));
        if (h.z > 0)
          sum += s.density(h) * masking / (4 * wo.z) * std::sin(radius) * radius * end / 3 *
                 fine().weights[i] * 2 * kPi / sectors;
      }
  }
  return sum;
}

TEST(MicrofacetIdentities, WeakWhiteFurnace) {
  for (const Surface& surface : surfaces())
    for (const Direction& wo : views(surface)) {
      // Lobes far longer than wide are too narrow for circles.
      double longest = std::max(surface.alpha_u, surface.alpha_v);
      double elongation = longest / (wo.z * std::min(surface.alpha_u, surface.alpha_v));
      if (elongation < 10) {
        EXPECT_NEAR(weak_furnace(surface.make(), wo), 1, elongation < 4 ? 1e-4 : 1e-3)
            << name(surface, wo);
      }
    }
}

} // namespace
} // namespace faceta
