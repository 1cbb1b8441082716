#pragma once

#include <vector>

namespace faceta {

/// Averages over the normals of a rough dielectric interface, as the rough plastic needs them.
struct RoughInterface {
  /// From outside, at equidistant cosines mu in [0, 1]: mean over the normals m visible from mu of
  /// (1 - F) G1(refracted direction, m).
  std::vector<double> transmittance;
  /// From inside, under uniform diffuse light: 2 int mu <F G1(reflected direction, m)> dmu, as
  /// twice the mean over the same cosines.
  double internal_reflectance;
};

/// distribution: kBeckmann or kGgx; alpha: isotropic roughness; eta: index inside over outside. The
/// quadrature (Gauss-Legendre on the unit square of Heitz's maps to visible normals, 32^2 nodes, or
/// 128^2 where total reflection puts a kink) is the scene contract's: at alpha below 0.01 it is
/// still visible in the third digit near grazing angles, and the contract's values contain it.
RoughInterface rough_interface(int distribution, double alpha, double eta, int cosines);

} // namespace faceta
