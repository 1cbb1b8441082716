#pragma once

/// Makes the tables of the adaptive parametrisation (Dupuy and Jakob 2018) of any reflectance, such
/// that what renderers make of them is the reflectance again.

#include "bsdf/bsdf.h"
#include "bsdf/measured_data.h"

#include <algorithm>
#include <functional>

namespace faceta {

/// f_r |cos theta_i| in linear sRGB, finite and not negative. Both directions lie above the
/// surface. Several threads call it at once.
using Reflectance = std::function<Color<double>(const Vec3<double>& wo, const Vec3<double>& wi)>;

/// Whether turning both directions about the normal changes nothing: looked at over a fixed set of
/// pairs, to 1e-3 of each value.
bool is_isotropic(const Reflectance& f);

/// How finely make_rgl_tables() works.
struct RglResolution {
  int side = 0;            ///< texels a side of the values; 0: as many as the tolerance takes
  int viewers = 96;        ///< at most so many inclinations; a quarter if not isotropic
  double tolerance = 3e-3; ///< relative error of the albedo, also between the viewers' inclinations
};

/// What make_rgl_tables() reached.
struct RglQuality {
  double albedo = 0; ///< largest relative error of the albedo at viewers up to 80 degrees
  double shape = 0;  ///< largest mean of |difference| over the mean value there

  void merge(const RglQuality& other) {
    albedo = std::max(albedo, other.albedo);
    shape = std::max(shape, other.shape);
  }
};

/// The tables. Normals are those whose visible part fits best what all viewers together see; the
/// inclinations of viewers are chosen where interpolation needs them. Tables of surfaces that are
/// not isotropic hold viewers all around.
RglTables make_rgl_tables(const Reflectance& f, const RglResolution& resolution = {},
                          RglQuality* quality = nullptr);

} // namespace faceta
