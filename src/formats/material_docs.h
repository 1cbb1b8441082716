#pragma once

#include "scene/nodes.h"

namespace faceta {

/// What descriptors say of the models, for readers and for programs. Everything here is generated:
/// a new model needs nothing. Behind the models stand the scene's nodes.

/// The descriptor of a model or node. Error, with a suggestion, if there is none.
const Descriptor& material_descriptor(const Registry& registry, const std::string& name);

/// "name  title" of every model and node, a line each.
std::string list_materials(const Registry& registry);
/// The same as a Markdown table with the parameters.
std::string list_materials_markdown(const Registry& registry);
/// An array of describe_material_json() of every model and node.
std::string list_materials_json(const Registry& registry);

/// Equation, parameters with unit, default and range, references, known exceptions, parameter sets
/// and an XML snippet, for a terminal.
std::string describe_material(const Descriptor& d);
/// The same as a Markdown section.
std::string describe_material_markdown(const Descriptor& d);
/// The same as a JSON object: name, title, equation, role (model | node), parameters, references,
/// notes, exceptions, exemplars (name, settings and lossless; of nodes name and xml), traits, xml.
std::string describe_material_json(const Descriptor& d);

/// The parameters as a table of texts: a row of headings (name, kind, default, range, unit,
/// texture, meaning), then a row each.
std::vector<std::vector<std::string>> parameter_table(const Descriptor& d);
/// "reflection, transmission, some delta, reciprocal"; empty for nodes whose bsdfs decide.
std::string lobes_summary(const Descriptor& d);

/// The model or node as a scene file writes it, with every parameter at its default. Where
/// parameters exclude each other, the first way to give them stands there and the others in a
/// comment.
std::string material_xml_snippet(const Descriptor& d);

} // namespace faceta
