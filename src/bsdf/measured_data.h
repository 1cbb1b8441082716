#pragma once

/// What a file of measured reflectance holds, before it becomes tables for the renderer: the common
/// ground of every reader.
///
/// wi is where the light comes from, wo where the viewer is; both leave the surface, z = normal,
/// and values are f_r in linear sRGB, WITHOUT the cosine (1/sr). Angles are in radians.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace faceta {

/// What the angles of a grid mean; the axes in the order of the array, the last one fastest.
/// phi_i and phi_o are azimuths of wi and wo; dphi = phi_o - phi_i.
enum class MeasuredCoordinates {
  /// theta_h, theta_d, phi_d: h = normalize(wi + wo), d = wi turned by -phi_h about z, then by
  /// -theta_h about y (Rusinkiewicz 1998).
  half_difference,
  /// theta_i, theta_o, dphi: isotropic.
  relative,
  /// theta_i, phi_i, theta_o, dphi.
  relative_rotated,
  /// theta_i, phi_i, theta_o, phi_o.
  absolute,
  /// theta_i, radial, azimuth: isotropic. radial is the angle between wo and r, the mirror
  /// direction of wi; azimuth turns about r from the direction in the plane of incidence in which
  /// theta_o grows towards z cross it.
  specular,
  /// theta_i, phi_i, radial, azimuth.
  specular_rotated,
};

/// How many axes a grid with these coordinates has.
int axis_count(MeasuredCoordinates coordinates);

/// The angles at which a grid has values. Values in between are interpolated linearly, those
/// outside are the outermost node's.
struct MeasuredAxis {
  std::vector<double> nodes; ///< increasing strictly, at least one; finite
  /// 0, or after what angle values repeat: the node after the last is the first plus this. Not
  /// periodic azimuth differences are folded into [0, pi] (a surface symmetric about the plane of
  /// incidence).
  double period = 0;
  bool square_root = false; ///< linear in the square root of the angle
};

/// Values at all combinations of the angles of three or four axes, interpolated linearly in each.
/// Cells that are holes are left out and the weights of the others made to sum to one.
struct MeasuredGrid {
  MeasuredCoordinates coordinates = MeasuredCoordinates::half_difference;
  std::vector<MeasuredAxis> axes;
  /// rgb of a cell side by side, last axis fastest. NaN in the first channel: a hole. No other
  /// value is negative or not finite.
  std::vector<float> rgb;
};

/// Directions measured without any order.
struct MeasuredSample {
  double theta_i, phi_i, theta_o, phi_o;
  std::array<double, 3> rgb;
};

/// The adaptive parametrisation of Dupuy and Jakob 2018, as its files hold it. The file's wi is the
/// viewer (our wo), as in the renderers that use it, and values include the cosine of the light.
struct RglTables {
  std::vector<float> phi_i, theta_i; ///< P and T nodes; isotropic if P <= 2
  int ndf_size[2] = {0, 0};          ///< rows (phi), columns (theta)
  int sigma_size[2] = {0, 0};
  int vndf_size[2] = {0, 0};
  int luminance_size[2] = {0, 0};
  std::vector<float> ndf, sigma;      ///< [rows][columns]
  std::vector<float> vndf, luminance; ///< [P][T][rows][columns]
  std::vector<float> rgb;             ///< [P][T][rows][columns][3], may be negative
  bool jacobian = true;               ///< multiply by ndf / (4 sigma)
};

/// Directions of a hemisphere in rings of cells: ring k from theta[k] to theta[k + 1], cells[k] of
/// them around, the first one centred on azimuth 0, counter-clockwise (Klems 1994).
struct KlemsBasis {
  std::vector<double> theta; ///< from 0 to pi/2
  std::vector<int> cells;
  int size() const {
    int n = 0;
    for (int c : cells)
      n += c;
    return n;
  }
};

/// The bases that files need not define: "lbnl/klems full", half and quarter.
const std::map<std::string, KlemsBasis>& klems_bases();

/// Which way light goes: from the front (z > 0) or the back, reflected or transmitted.
enum MeasuredPass { kFrontReflection, kFrontTransmission, kBackReflection, kBackTransmission };

/// Constant values over pairs of cells. Directions below the surface are those of the cell seen
/// from there: (theta to -z, the same azimuth).
struct MeasuredPatches {
  KlemsBasis incident, outgoing;
  /// For each MeasuredPass [incident cell][outgoing cell][3], or empty: nothing goes there.
  std::array<std::vector<float>, 4> rgb;
};

/// Constant values over a tree of cells (Ward et al. 2012, tensor tree). Positions are in
/// [0, 1)^dimensions: for 4 the squares that wi and wo map to (Shirley and Chiu 1997), for 3
/// 0.5 - 0.5 sin theta_i and wo's square after the surface was turned so that wi lies at azimuth 0
/// seen from below (see the reader).
struct MeasuredTree {
  int dimensions = 4;
  /// For each MeasuredPass the nodes, the root first: node[k] >= 0 is the first of 2^dimensions
  /// children (child bit d is set in the upper half of dimension d; bit 0 = first dimension), -1 -
  /// v a leaf with value number v. Empty: nothing goes there.
  std::array<std::vector<int32_t>, 4> nodes;
  std::array<std::vector<float>, 4> rgb; ///< [value][3]
  int depth = 0;                         ///< of the deepest leaf
};

/// What a file says of itself, and what its reader did with it.
struct MeasuredInfo {
  std::string format; ///< short name: "merl", "rgl", ...
  std::string title;  ///< "MERL BRDF (Matusik et al. 2003)"
  std::string description{};
  std::string resolution{};              ///< "90 x 90 x 180 (theta_h, theta_d, phi_d)"
  std::vector<double> wavelengths{};     ///< nm; empty: the file holds colours
  std::string interpolation{};           ///< one sentence
  std::vector<std::string> symmetries{}; ///< "isotropic", "reciprocal by construction", ...
  std::vector<std::string> notes{};      ///< what was mended or decided: "12 negative cells: 0"
  int64_t cells = 0;                     ///< of the file, one for all wavelengths
  int64_t holes = 0;                     ///< of them without a value
  int64_t negative = 0;                  ///< values below zero that are no holes
  double largest_theta = 0;              ///< of any direction measured; 0: not known
};

/// Everything that a reader returns.
struct MeasuredFile {
  MeasuredInfo info;
  std::variant<MeasuredGrid, RglTables, MeasuredPatches, MeasuredTree> data;
};

/// What a user may say about how a file is read.
struct MeasuredOptions {
  std::string format = "auto";            ///< or the short name that it must have
  std::string merl_nodes = "centers";     ///< "centers" or "edges" of cells carry the values
  std::string utia_color = "scaled_srgb"; ///< "scaled_srgb", "srgb" or "linear"
  int index = 1;                          ///< which material of a file of several, from 1
  double wavelength = -1;                 ///< nm: only this one, as grey; negative: all

  friend bool operator==(const MeasuredOptions&, const MeasuredOptions&) = default;
};

} // namespace faceta
