#pragma once

/// The binary formats of measured reflectance, one by one; measured_reader.h chooses among them.
/// Each reader throws Error, with the file and where in it, at what is damaged or not supported.

#include "bsdf/measured_data.h"
#include "formats/input_text.h"

namespace faceta {

/// RGL/EPFL material database (Dupuy and Jakob 2018), `.bsdf`: a tensor_file. Isotropic and
/// anisotropic, colours or spectra, which become linear sRGB (wavelength_weights); components
/// stay negative where a colour is out of gamut, for whoever evaluates the table to clamp.
bool is_rgl(std::string_view bytes);
MeasuredFile read_rgl(const InputText& input, const MeasuredOptions& options);

/// KAIST/EPFL polarised materials (Baek et al. 2020), `.pbsdf`: a tensor_file with Mueller
/// matrices, of which the reflectance of unpolarised light (entry 0, 0) is read. A cell in which
/// any wavelength that counts is not finite is a hole, negative values are 0. Wavelengths become
/// linear sRGB, constant beyond the first and the last.
bool is_pbsdf(std::string_view bytes);
MeasuredFile read_pbsdf(const InputText& input, const MeasuredOptions& options);

/// UTIA (Filip and Vavra 2014): `.bin`, raw float64 without any header, recognised by the size of
/// exactly 3 x 288 x 288 of them and by plausible first values; or `.exr` of 288 x 288 pixels with
/// R, G and B, rows from the top: directions of light, columns: of view. Values not finite are
/// holes, negative ones 0. MeasuredOptions::utia_color says what the numbers are:
///   scaled_srgb  100 eotf(v / 140), the sRGB curve, as the database's author is quoted to read it
///   srgb         eotf(v)
///   linear       v
bool is_utia(std::string_view bytes);
MeasuredFile read_utia(const InputText& input, const MeasuredOptions& options);

/// Anisotropic measurements of MIT (Ngan et al. 2005), `.dat`: sixteen int32, then float32 planes
/// red, green, blue of [theta_i][theta_o][phi_o - phi_i][phi_i]. Negative values and those not
/// finite are holes. The file's azimuths are those of the directions of propagation of light
/// (measuredAniso.func of BRDF Explorer), half a turn from ours.
bool is_ngan(std::string_view bytes);
MeasuredFile read_ngan(const InputText& input, const MeasuredOptions& options);

/// NVIDIA MDL, `.mbsdf` (MDL specification, appendix B). The reflection only. f(i, o) and f(o, i)
/// are averaged, as the SDK does, then negative values become 0; not finite ones are holes.
bool is_mbsdf(std::string_view bytes);
MeasuredFile read_mbsdf(const InputText& input, const MeasuredOptions& options);

} // namespace faceta
