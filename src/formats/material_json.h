#pragma once

#include "bsdf/registry.h"

#include <string_view>

/// Materials as JSON, and back: struct to JSON to struct gives the same numbers, bit for bit, and
/// keeps names. One object a material:
///   {"model": "roughconductor", "parameters": {"material": "Au", "alpha": 0.15,
///    "specular_reflectance": [1, 0.5, 0.25], "energy_compensation": true}}
/// Colours are three numbers (or one for all channels), flags are true or false, choices and names
/// are strings. What is not given keeps its default.
namespace faceta {

/// The parameters that were given, as text of two-space indented JSON that ends in a newline.
std::string write_material_json(const Parameters& parameters);

/// Reads one object of that form; models come from Registry::global(). A colour above its range is
/// kept, as scene files may have it.
/// @throws Error: no JSON (with line and column), another form, an unknown, doubled or impossible
/// parameter.
Parameters parse_material_json(std::string_view text, const std::string& name = "<string>");

/// Parameters written as JSON and read back.
Parameters through_json(const Parameters& parameters);

} // namespace faceta
