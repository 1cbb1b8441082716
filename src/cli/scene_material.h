#pragma once

#include "bsdf/columns.h"

namespace faceta::cli {

/// The material that a scene file gives an id, textures and nesting included, ready to be run over
/// arrays.
/// \param defines the `$name` substitutions of the file
/// Error: as for reading the scene; no material with this id (with the ids there are).
ColumnMaterial load_scene_material(const std::string& scene, const std::string& id,
                                   const Settings& defines, Isa isa, TransportMode mode);

} // namespace faceta::cli
