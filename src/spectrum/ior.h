#pragma once

#include "spectrum/spectrum_curve.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace faceta {

/// The complex index of refraction of a conductor, eta + i k, relative to vacuum, per channel of
/// linear sRGB, under the name that stands in lists and written files.
struct ConductorIor {
  std::string name;
  std::array<double, 3> eta{}, k{};
};

/// The spectral tables behind a conductor's name: eta and k at the same wavelengths (nm).
struct ConductorSpectrum {
  std::string name;
  SpectrumCurve eta, k;
};

/// The conductor of a name:
/// - the 71 names of the Mitsuba scene contract ("Au", "Cu_palik", ...), case-sensitive: spectral
///   tables integrated by SpectrumUse::refractive_index;
/// - "none", case-sensitive: the perfect mirror, eta 0 and k 1;
/// - the course's RGB rows in English or Spanish ("gold", "oro", ...), in any case. Their
///   canonical name is the English one.
/// Nothing if the name is unknown; conductor_names() then feeds suggestion().
std::optional<ConductorIor> find_conductor(std::string_view name);

/// The spectral tables of one of the 71 case-sensitive names. Origin: data/README.md.
std::optional<ConductorSpectrum> find_conductor_spectrum(std::string_view name);

/// All names find_conductor knows: "none", the course's in English, in Spanish, then the 71.
std::vector<std::string> conductor_names();

/// Index of refraction of a dielectric by name, in any case: the 23 of the Mitsuba scene contract,
/// then the course's names in English and Spanish. Where both have a value for one name (air,
/// diamond) the contract's counts; the Spanish name (aire, diamante) has the course's. Accents may
/// be left out. Nothing if unknown; dielectric_names() then feeds suggestion().
std::optional<double> find_dielectric(std::string_view name);

/// All names find_dielectric knows, the contract's first.
std::vector<std::string> dielectric_names();

} // namespace faceta
