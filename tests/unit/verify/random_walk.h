#pragma once

/// Light that wanders over a random surface of facets until it leaves: the truth behind microfacet
/// models, all orders of scattering included (Heitz, Hanika, d'Eon and Dachsbacher 2016,
/// "Multiple-Scattering Microfacet BSDFs with the Smith Model"). Shares no code with the models:
/// its distributions, masking, sampling and Fresnel terms are its own. Double precision, isotropic
/// and anisotropic.

#include "verify/random_stream.h"

#include <array>
#include <cmath>

namespace faceta::walk {

using Direction = std::array<double, 3>;

inline double dot(const Direction& a, const Direction& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Direction scaled(const Direction& a, double k) {
  return {a[0] * k, a[1] * k, a[2] * k};
}
inline Direction normalized(const Direction& a) {
  return scaled(a, 1 / std::sqrt(dot(a, a)));
}

/// A surface without correlation between the heights and slopes of neighbouring points (Smith).
struct Surface {
  bool ggx;
  double alpha_u, alpha_v;

  /// Lambda(w) for w.z > 0: the area of the facets that face away, over the projected area.
  double lambda(const Direction& w) const {
    double r = std::hypot(alpha_u * w[0], alpha_v * w[1]);
    if (r < 1e-12)
      return 0;
    double a = w[2] / r;
    if (ggx)
      return 0.5 * (std::sqrt(1 + 1 / (a * a)) - 1);
    return 0.5 * (std::exp(-a * a) / (a * std::sqrt(M_PI)) - std::erfc(a));
  }
  /// The same for a ray in any direction, as it governs how far the ray gets.
  double lambda_of_ray(const Direction& w) const {
    return w[2] > 0 ? lambda(w) : -1 - lambda({-w[0], -w[1], -w[2]});
  }

  /// The share of first-order light that is neither masked nor shadowed on the same side, and on
  /// opposite sides (the heights then depend on each other the other way round).
  double reflected_share(double lambda_o, double lambda_i) const {
    return 1 / (1 + lambda_o + lambda_i);
  }
  double transmitted_share(double lambda_o, double lambda_i) const {
    return std::exp(std::lgamma(1 + lambda_o) + std::lgamma(1 + lambda_i) -
                    std::lgamma(2 + lambda_o + lambda_i));
  }

  /// A facet as it is seen from w, which may lie below the horizon.
  Direction visible_normal(const Direction& w, RandomStream& random) const {
    Direction v = normalized({alpha_u * w[0], alpha_v * w[1], w[2]}); // of the unit surface
    Direction m = ggx ? half_sphere(v, random) : gaussian(v, random);
    return normalized({alpha_u * m[0], alpha_v * m[1], m[2]});
  }

private:
  /// The unit surface of GGX is the upper half of a sphere: points spread evenly over its
  /// projection, those of the lower half thrown away.
  static Direction half_sphere(const Direction& v, RandomStream& random) {
    Direction t = std::abs(v[2]) < 0.9 ? Direction{-v[1], v[0], 0} : Direction{0, -v[2], v[1]};
    t = normalized(t);
    Direction b{v[1] * t[2] - v[2] * t[1], v[2] * t[0] - v[0] * t[2], v[0] * t[1] - v[1] * t[0]};
    for (;;) {
      double x = 2 * random.next() - 1, y = 2 * random.next() - 1, z2 = 1 - x * x - y * y;
      if (z2 <= 0)
        continue;
      double z = std::sqrt(z2);
      Direction m{x * t[0] + y * b[0] + z * v[0], x * t[1] + y * b[1] + z * v[1],
                  x * t[2] + y * b[2] + z * v[2]};
      if (m[2] > 0)
        return m;
    }
  }
  /// Beckmann's unit surface has normal slopes; those along the view weigh (a + x)+.
  static Direction gaussian(const Direction& v, RandomStream& random) {
    double sine = std::hypot(v[0], v[1]);
    double c = sine > 0 ? v[0] / sine : 1, s = sine > 0 ? v[1] / sine : 0;
    double x = visible_slope(v[2] / std::max(sine, 1e-9), random.next());
    double radius = std::sqrt(-std::log(1 - random.next()));
    double y = radius * std::cos(2 * M_PI * random.next());
    return {x * c - y * s, x * s + y * c, 1};
  }
  /// Where the distribution function of (a + x)+ exp(-x^2) reaches u, by bisection.
  static double visible_slope(double a, double u) {
    auto below = [a](double x) { // 2 / sqrt(pi) times the integral from -a to x
      return a * (std::erf(x) + std::erf(a)) +
             (std::exp(-a * a) - std::exp(-x * x)) / std::sqrt(M_PI);
    };
    double low = std::max(-a, -6.0), high = std::max(-a + 3, 6.0), target = u * below(high);
    for (int i = 0; i < 30; ++i) {
      double middle = 0.5 * (low + high);
      (below(middle) < target ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
};

/// Both polarisations of an interface, averaged; eta is the far side's index over the near side's.
inline double dielectric_reflectance(double cosine, double eta) {
  double squared = 1 - (1 - cosine * cosine) / (eta * eta);
  if (squared <= 0)
    return 1;
  double t = std::sqrt(squared);
  double s = (cosine - eta * t) / (cosine + eta * t), p = (eta * cosine - t) / (eta * cosine + t);
  return 0.5 * (s * s + p * p);
}

/// What became of one ray.
struct Exit {
  Direction direction; ///< away from the surface; z < 0: through it
  int order = 0;       ///< facets met
  double weight = 1;   ///< what the facets left of it
};

/// Meets facets until the ray escapes. facet(w, m, side, new_w): scatters the ray that comes from w
/// at the facet m in the frame of its side (+1 outside, -1 inside, z away from the surface towards
/// the ray's medium), returns a weight and sets the new direction of travel; a direction on the
/// other side has crossed the facet (m . new_w < 0).
template <class Facet>
Exit wander(const Surface& surface, const Direction& from, RandomStream& random, Facet facet) {
  int side = from[2] > 0 ? 1 : -1;
  Direction w = scaled(from, -1);
  w[2] *= side;
  double height = 1; // the share of the surface below: 1 is above everything
  Exit exit;
  for (;;) {
    double lambda = surface.lambda_of_ray(w), u = 1 - random.next();
    if (w[2] > 0 && u <= std::pow(height, lambda)) {
      exit.direction = {w[0], w[1], side * w[2]};
      return exit;
    }
    height = std::min(height / std::pow(u, 1 / lambda), 1.0);
    Direction back = scaled(w, -1), m = surface.visible_normal(back, random), next;
    exit.weight *= facet(back, m, side, next);
    if (++exit.order > 1000 || exit.weight < 1e-9)
      return {{0, 0, 1}, exit.order, 0};
    if (dot(next, m) < 0) { // on the other side up is down, and what was below is above
      next[2] = -next[2];
      side = -side;
      height = 1 - height;
    }
    w = next;
  }
}

inline Direction mirrored(const Direction& w, const Direction& m) {
  double k = 2 * dot(w, m);
  return {k * m[0] - w[0], k * m[1] - w[1], k * m[2] - w[2]};
}

/// A ray on metal whose facets reflect the share reflectance(cosine).
template <class Reflectance> Exit wander_on_metal(const Surface& surface, const Direction& from,
                                                  RandomStream& random, Reflectance reflectance) {
  return wander(surface, from, random,
                [&](const Direction& w, const Direction& m, int, Direction& next) {
                  next = mirrored(w, m);
                  return reflectance(std::min(dot(w, m), 1.0));
                });
}

/// A ray at a glass surface, eta = index below over index above; facets reflect or refract it.
inline Exit wander_through_glass(const Surface& surface, const Direction& from, double eta,
                                 RandomStream& random) {
  return wander(surface, from, random,
                [&](const Direction& w, const Direction& m, int side, Direction& next) {
                  double relative = side > 0 ? eta : 1 / eta, cosine = std::min(dot(w, m), 1.0);
                  if (random.next() < dielectric_reflectance(cosine, relative)) {
                    next = mirrored(w, m);
                    return 1.0;
                  }
                  double k = cosine / relative -
                             std::sqrt(1 - (1 - cosine * cosine) / (relative * relative));
                  for (int i = 0; i < 3; ++i)
                    next[i] = k * m[i] - w[i] / relative;
                  return 1.0;
                });
}

} // namespace faceta::walk
