#pragma once

#include <array>

namespace faceta {

/// First and last wavelength of the colour matching functions, nm; everything outside is invisible.
inline constexpr double kCieMin = 360, kCieMax = 830;

/// Scales XYZ so that a spectrum of value 1 everywhere has Y = 1: one over the integral of the
/// luminosity function as the Mitsuba 3.9.1 scene contract states it.
inline constexpr double kCieYNormalization = 1 / 106.7502593994140625;

/// Scales the table of D65 (100 at 560 nm) so that the illuminant has luminance 1.
inline constexpr double kCieD65Normalization = 1 / 98.99741751876255;

/// Colour matching functions x, y, z of the CIE 1931 2 degree standard observer at `wavelength`
/// (nm), linear between the published values every 5 nm; zero outside [kCieMin, kCieMax].
/// Not normalised: y is 1 at 555 nm. Source: CIE 15:2004, table T.4.
std::array<double, 3> cie1931_xyz(double wavelength);

/// Relative power of the standard illuminant D65 at `wavelength` (nm), linear between the published
/// values every 5 nm and scaled by kCieD65Normalization; zero outside [kCieMin, kCieMax].
/// Source: CIE 15:2004, table T.1.
double cie_d65(double wavelength);

/// CIE XYZ to linear sRGB (ITU-R BT.709 primaries, white D65). Unbounded: colours outside the gamut
/// have negative components. XYZ (1, 1, 1), the equal-energy white, is not grey. The matrix has the
/// six decimals of the scene contract; srgb_to_xyz is its inverse to that precision.
std::array<double, 3> xyz_to_srgb(const std::array<double, 3>& xyz);

/// Linear sRGB to CIE XYZ; see xyz_to_srgb.
std::array<double, 3> srgb_to_xyz(const std::array<double, 3>& rgb);

/// CIE Y of a linear sRGB colour: the second row of srgb_to_xyz.
constexpr double luminance(const std::array<double, 3>& rgb) {
  return 0.212671 * rgb[0] + 0.715160 * rgb[1] + 0.072169 * rgb[2];
}

} // namespace faceta
