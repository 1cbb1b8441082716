#pragma once

/// The numbers behind the plots of a material: by the double reference, but for samples, which the
/// widest kernel draws. Values are those of importance transport: without the factor 1/eta^2 that
/// radiance takes on when it crosses an interface, so that energy can be read off.

#include "verify/subject.h"

#include <functional>

namespace faceta {

/// What of a colour is plotted. Luminance is Rec. 709's.
enum class PlotChannel { luminance, red, green, blue };
double channel_of(const Color<double>& colour, PlotChannel channel);

/// The viewer in the plane of incidence that stands at an azimuth, degrees: on the side of negative
/// x for phi = 0, so that mirror directions lie on the positive side. theta > 90: from below.
Vec3<double> plot_viewer(double theta, double phi);
/// A direction in that plane: `angle` (radians) from the normal towards the mirror side.
Vec3<double> plane_direction(double angle, double phi);

/// Whether light comes out on the other side, be it refracted or straight on.
inline bool passes_through(const Subject& subject) {
  return (subject.traits().lobes & (kTransmission | kNullLobe)) != 0;
}

/// A delta lobe seen from one direction.
struct DeltaLobe {
  Vec3<double> wi;
  int lobe;
  double probability; ///< that sample() chooses it
  double weight;      ///< share of the energy that goes there
};
/// \param channel of the weights
std::vector<DeltaLobe> delta_lobes(const Subject& subject, const Vec3<double>& wo,
                                   PlotChannel channel);

/// Values (with |cos theta_i|, 1/sr) in the plane of incidence: x is the angle in radians in
/// [-pi, pi], y the value; as many points as a smooth curve needs.
/// \param radius what is drawn of a value; points lie so close that straight lines between their
/// radii are off by at most `tolerance`.
std::vector<Vec2<double>> polar_curve(const Subject& subject, double theta, double phi,
                                      PlotChannel channel,
                                      const std::function<double(double)>& radius,
                                      double tolerance);

/// Where energy goes, delta lobes included.
struct Albedo {
  double reflection = 0, transmission = 0;
  double total() const { return reflection + transmission; }
};
/// By quadrature of the reference, to about 1e-4 of the value.
Albedo directional_albedo(const Subject& subject, const Vec3<double>& wo, PlotChannel channel);

/// The distribution of the weights of samples, failed ones counted as 0.
struct WeightStudy {
  double mean = 0;
  double variation = 0;     ///< standard deviation over mean; NaN if all are 0
  double quantiles[5] = {}; ///< at 1, 25, 50, 75 and 99 %
};
WeightStudy study_weights(const Subject& subject, const Vec3<double>& wo, PlotChannel channel,
                          int samples, uint64_t seed);

/// Values without the cosine over theta_h (columns, from 0) and theta_d (rows, from 90 degrees at
/// the top), phi_d = 90 degrees, at the centres of n x n cells of [0, 90] x [0, 90] degrees (Burley
/// 2012, "Physically-Based Shading at Disney").
/// \param phi azimuth of the half vector, degrees
std::vector<double> image_slice(const Subject& subject, int n, double phi, PlotChannel channel);

/// A hemisphere on a square of n x n cells by Lambert's equal-area azimuthal projection: the disk
/// around the normal, each cell 8 / n^2 sr; y upwards, row 0 at the top. The lower hemisphere is
/// seen from above, through the surface. Cells outside of the disk hold NaN.
struct HemisphereMap {
  int n = 0;
  std::vector<double> cells; ///< densities in 1/sr
  double solid_angle() const { return 8.0 / n / n; }
  double mass() const; ///< the integral
};
/// Where a direction lies in the unit disk of its hemisphere.
Vec2<double> project(const Vec3<double>& w);
/// Mean density of sample() in each cell, by adaptive quadrature of the reference.
HemisphereMap density_map(const Subject& subject, const Vec3<double>& wo, bool below, int n);
/// The same by counting: [0] above, [1] below; delta lobes left out.
std::vector<HemisphereMap> sample_maps(const Subject& subject, const Vec3<double>& wo, int n,
                                       long samples, uint64_t seed);

/// |f(a, b) - f(b, a)| over the larger of the two, b to a by radiance; the largest over channels
/// and azimuths. Columns: theta_a, rows: theta_b from 0 at the bottom, in cells of [0, high]^2
/// degrees; `high` is 180 for models that scatter below as well.
struct ReciprocityMap {
  int n = 0;
  double high = 90;
  std::vector<double> cells;
  double largest = 0;
};
ReciprocityMap reciprocity_map(const Subject& subject, int n);

} // namespace faceta
