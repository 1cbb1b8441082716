#pragma once

/// Measurements without order, and the values in between.

#include "bsdf/measured_data.h"

#include <memory>
#include <span>

namespace faceta {

/// What ScatteredReflectance takes for granted, for MeasuredInfo.
inline constexpr const char* kScatteredSymmetries =
    "reciprocal; isotropic data also symmetric about the plane of incidence";

/// A smooth function through measurements without order.
///
/// Every pair of directions becomes a point at which reflectance is smooth: the square root of the
/// angle of the half vector (highlights are narrow near 0), the angle between half vector and light
/// (Fresnel), and what turns the one about the other, scaled so that it fades where it means
/// nothing. The points of (wi, wo) and (wo, wi) are the same, and those of mirror images too if the
/// surface is isotropic: each measurement counts for all of them. The logarithm of a value is that
/// of a weighted least-squares fit, linear in the point (moving least squares, Lancaster and
/// Salkauskas 1981), to the nearest measurements, weights (1 - t^2)^2 / (t^2 + 0.01) of the
/// relative distance t: smooth, nearly exact at measurements, and never further than a factor
/// of 1.3 outside the range of its neighbours.
class ScatteredReflectance {
public:
  /// At least one sample; theta in [0, pi/2], values finite and not negative.
  ScatteredReflectance(std::span<const MeasuredSample> samples, bool isotropic);
  ~ScatteredReflectance();

  std::array<double, 3> at(double theta_i, double phi_i, double theta_o, double phi_o) const;
  /// The value at a half vector and a difference vector (Rusinkiewicz 1998), isotropic data only;
  /// one of the directions may lie below the horizon.
  std::array<double, 3> at_half(double theta_h, double theta_d, double phi_d) const;
  /// The value at the directions of a sample from all others that do not share its point: what
  /// leave-one-out validation compares.
  std::array<double, 3> without(const MeasuredSample& sample) const;

private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Values at the nodes of a grid: isotropic data as half_difference, 90 x 46 x 48 nodes with a
/// square_root theta_h; other data as relative_rotated, 16 x 18 x 31 x 36. No holes: where nothing
/// was measured the nearest measurements are carried on. 0.3 s for a thousand samples.
MeasuredGrid grid_from_samples(std::span<const MeasuredSample> samples, bool isotropic);

} // namespace faceta
