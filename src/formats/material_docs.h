#pragma once

#include "bsdf/registry.h"

namespace faceta {

/// What a descriptor says of a model, for readers and for programs. Everything here is generated:
/// a new model needs nothing.

/// "name  title" of every model, a line each.
std::string list_materials(const Registry& registry);
/// The same as a Markdown table with the parameters.
std::string list_materials_markdown(const Registry& registry);
/// An array of describe_material_json() of every model.
std::string list_materials_json(const Registry& registry);

/// Equation, parameters with unit, default and range, references, known exceptions, parameter sets
/// and an XML snippet, for a terminal.
std::string describe_material(const Model& model);
/// The same as a Markdown section.
std::string describe_material_markdown(const Model& model);
/// The same as a JSON object: name, title, equation, parameters, references, notes, exceptions,
/// exemplars, traits, xml.
std::string describe_material_json(const Model& model);

/// The model as a scene file writes it, with every parameter at its default. Where parameters
/// exclude each other, the first way to give them stands there and the others in a comment.
std::string material_xml_snippet(const Model& model);

} // namespace faceta
