#pragma once

/// A partition of the sphere of directions into cells that are small where samples are dense: what
/// the chi-square test and the integral of a density run over.

#include "base/vec.h"
#include "verify/quadrature.h"

#include <vector>

namespace faceta {

/// Cylindrical coordinates of a direction that stay exact near the pole: t = 1 - cos(theta) in
/// [0, 2], so that d(omega) = dt d(phi), and phi in [-pi, pi] counted from an axis of the caller's.
struct SpherePoint {
  double t = 0, phi = 0;
};

/// The cells are the leaves of a k-d tree over (t, phi), split at the medians of given directions
/// (say samples of a density: then every cell holds about the same share of it, be the lobe ever so
/// narrow) together with points spread over the sphere and, ever denser, around given hints.
class SpherePartition {
public:
  /// `axis` is the direction whose azimuth becomes phi = 0; `leaf` is the most points in a cell.
  SpherePartition(const std::vector<Vec3<double>>& directions,
                  const std::vector<Vec3<double>>& hints, const Vec3<double>& axis, int leaf);

  const std::vector<Rectangle>& cells() const { return cells_; } ///< x is t, y is phi
  int locate(const Vec3<double>& direction) const;
  SpherePoint coordinates(const Vec3<double>& direction) const;
  Vec3<double> direction(double t, double phi) const;

private:
  // Inside the tree phi is replaced by a rational function of the direction that grows with it, so
  // that locating a sample takes no arc tangent.
  struct Point {
    double c[2];
  };
  struct Node {
    int axis = -1; ///< -1: a leaf, `first` is its cell
    double split = 0;
    int first = 0; ///< index of the lower child; the upper one follows it
  };
  Point place(const Vec3<double>& direction) const;
  void split(int node, std::vector<Point>& points, size_t begin, size_t end, Rectangle area,
             int axis, int leaf);
  static double angle_of(double pseudo);

  std::vector<Node> nodes_;
  std::vector<Rectangle> cells_;
  double cos_axis_ = 1, sin_axis_ = 0;
};

} // namespace faceta
