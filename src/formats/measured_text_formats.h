#pragma once

/// The readers of measured reflectance in text; each is registered in measured_formats(), whose
/// notes on recognising and errors hold for them. Numbers that are not finite are errors.

#include "bsdf/measured_data.h"
#include "formats/input_text.h"

#include <string_view>

namespace faceta {

/// Cornell gonioreflectometer, as pbrt-v2 reads it: how many wavelengths, the wavelengths (nm),
/// then rows theta_i phi_i theta_o phi_o and a value for each; radians; the mirror direction is at
/// phi_o = phi_i + pi.
bool is_cornell(std::string_view bytes);
MeasuredFile read_cornell(const InputText& input, const MeasuredOptions& options);

/// ASTM E1392 as Cornell publishes it: keywords, NUM_POINTS, VARS with the names of the columns
/// (theta_i, phi_i, theta_s, phi_s, then R, G, B or X, Y, Z or wavelengths "400nm" or one of any
/// name), rows of comma-separated numbers; radians.
bool is_astm(std::string_view bytes);
MeasuredFile read_astm(const InputText& input, const MeasuredOptions& options);

/// Zemax (Radiant) tabular BSDF. Azimuth 0 points from the mirror direction to the normal and
/// grows counter-clockwise; a sample rotation of 0 has the light at azimuth 90 degrees. BRDF only.
bool is_zemax(std::string_view bytes);
MeasuredFile read_zemax(const InputText& input, const MeasuredOptions& options);

/// LightTools BSDF: spherical angles, the light at azimuth 90 degrees. Blocks of the front's BRDF
/// are read; if they name several wavelengths they are a spectrum.
bool is_lighttools(std::string_view bytes);
MeasuredFile read_lighttools(const InputText& input, const MeasuredOptions& options);

/// ALTA (Inria) text and binary: #DIM, #PARAM_IN, #PARAM_OUT, #VS; see the reader for the
/// parametrisations that are supported. Values with a cosine are divided by that of the light.
bool is_alta(std::string_view bytes);
MeasuredFile read_alta(const InputText& input, const MeasuredOptions& options);

/// BSDF XML of Radiance and LBNL Window: Klems matrices become MeasuredPatches, tensor trees of
/// rank 3 and 4 MeasuredTree. The one reader tells by IncidentDataStructure; see there for the
/// sides and the azimuths.
bool is_klems(std::string_view bytes);
bool is_tensor_tree(std::string_view bytes);
MeasuredFile read_window_xml(const InputText& input, const MeasuredOptions& options);

/// CUReT (Dana et al. 1999): tables of 205 measurements a material, for one colour or all. The
/// directions of the measurements are known (curet_directions()); options.index chooses the
/// material. Of rbrdf.dat, gbrdf.dat and bbrdf.dat in one folder any one stands for all three.
/// Tables of model parameters (op*.dat, kp*.dat) are told apart and refused.
bool is_curet(std::string_view bytes);
MeasuredFile read_curet(const InputText& input, const MeasuredOptions& options);

/// Time-varying BRDF database (Gu et al. 2006): triples of lines "F b g r", "L x y z", "V x y z".
/// F is radiance under a distant light; divided by the cosine of the light it is reflectance, up to
/// a scale that the file does not tell.
bool is_tvbrdf(std::string_view bytes);
MeasuredFile read_tvbrdf(const InputText& input, const MeasuredOptions& options);

/// Comma-separated values. The first line that is no comment (#) names the columns, in any order:
/// theta_i, theta_o and phi_o, or dphi = phi_o - phi_i, and phi_i (0 if missing; only with several
/// values of it the surface counts as anisotropic), then `value`, or r, g, b, or X, Y, Z, or
/// wavelengths 400nm, 410nm, ... Angles are in degrees; a name that ends in _rad says radians, _deg
/// degrees. Values are f_r in 1/sr without the cosine.
bool is_brdf_csv(std::string_view bytes);
MeasuredFile read_brdf_csv(const InputText& input, const MeasuredOptions& options);

} // namespace faceta
