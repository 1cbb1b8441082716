#pragma once

#include "formats/mitsuba_scene.h"

#include <functional>

/// Materials as scene files write them, and back: struct to XML to struct gives the same numbers,
/// bit for bit, and keeps names (material="Au", int_ior="bk7").
namespace faceta {

/// Gives the <texture> of a texture of the scene; see material_to_xml.
using TextureToXml = std::function<xml::NodePtr(int texture)>;

/// The <bsdf> of a model with the parameters that were given; the others keep their defaults.
xml::NodePtr parameters_to_xml(const Parameters& parameters);

/// The <bsdf> of a tree of materials. A material that occurs twice in it is one node.
/// @throws Error if it has a texture and `texture` is empty.
xml::NodePtr material_to_xml(const MaterialNode& material, const TextureToXml& texture = {});

/// The same as the text of a file that holds this one <bsdf>.
std::string write_material(const Parameters& parameters);
std::string write_material(const MaterialNode& material, const TextureToXml& texture = {});

/// Parameters written as XML and read back.
Parameters through_xml(const Parameters& parameters);

/// Reads the text of a file that holds one <bsdf>, as read_mitsuba_scene reads it in a scene.
/// Textures are added to `scene`; without a scene they are an Error.
std::shared_ptr<MaterialNode> parse_material(std::string_view text,
                                             const std::string& name = "<string>",
                                             Scene* scene = nullptr,
                                             const ReadOptions& options = {});

} // namespace faceta
