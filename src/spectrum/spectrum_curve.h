#pragma once

#include "base/error.h"

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace faceta {

/// A tabulated spectrum: values (any unit) at wavelengths (nm), linear in between and zero outside.
/// Valid if there are at least two pairs, all numbers fit a float and the wavelengths increase
/// strictly. The functions below that make a curve return valid ones only.
struct SpectrumCurve {
  std::vector<double> wavelengths, values;

  friend bool operator==(const SpectrumCurve&, const SpectrumCurve&) = default;
};

/// What a scene file's <spectrum> may say: one value for all wavelengths, or a curve.
using SpectrumValue = std::variant<double, SpectrumCurve>;

/// Throws Error at `where` if the curve is not valid as said above.
void check_spectrum(const SpectrumCurve& curve, const SourcePosition& where = {});

/// The value of a valid curve at a wavelength (nm).
double spectrum_at(const SpectrumCurve& curve, double wavelength);

/// Reads the `value` attribute of <spectrum>: "0.5", or pairs "400:0.1, 700:0.2" separated by
/// commas or white space. Throws Error at `where` on anything else.
SpectrumValue parse_spectrum(std::string_view text, const SourcePosition& where = {});

/// Reads the text of a spectrum file: a wavelength (nm) and a value on each line, separated by
/// white space; `#` starts a comment, empty lines are skipped. `name` is the file's name for
/// messages. Throws Error with file, line and column.
SpectrumCurve parse_spectrum_text(std::string_view text, const std::string& name);

/// Reads a spectrum file, see parse_spectrum_text. Throws Error if it cannot be read, is not a
/// regular file, is longer than 64 MiB, or is malformed.
SpectrumCurve read_spectrum_file(const std::filesystem::path& path);

/// How a spectrum becomes linear sRGB; the rule depends on what it stands for.
enum class SpectrumUse {
  /// A reflectance: the curve is lit by D65, the colour clamped to [0, 1].
  reflectance,
  /// A quantity of the material that may exceed 1 (eta, k, roughness): lit by D65 as well, negative
  /// components become 0.
  unbounded,
  /// Emission: the curve alone, negative components become 0; a single value v is equal energy,
  /// v times xyz_to_srgb(1, 1, 1), which is not grey.
  emission,
  /// The tables of eta and k behind a metal's name: the curve alone, negative components become 0.
  refractive_index,
};

/// Linear sRGB of a valid spectrum for a use. A single value is grey except as emission, and is not
/// clamped. Source: Mitsuba 3.9.1's rules for its RGB mode.
std::array<double, 3> spectrum_to_rgb(const SpectrumValue& spectrum, SpectrumUse use);

/// CIE XYZ of a valid curve, times D65 if `lit_by_d65`, normalised so that Y of the constant 1 is 1
/// (to 2e-5: the sum is a Riemann sum of 1000 steps over [kCieMin, kCieMax], both ends included,
/// as the scene contract wants it).
std::array<double, 3> spectrum_to_xyz(const SpectrumCurve& curve, bool lit_by_d65);

/// <spectrum type="d65"> in RGB: white is grey here, so the illuminant times `scale` is `scale` in
/// every channel.
constexpr std::array<double, 3> d65_to_rgb(double scale) {
  return {scale, scale, scale};
}

} // namespace faceta
