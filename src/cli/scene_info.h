#pragma once

#include "bsdf/registry.h"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace faceta::cli {

/// What is in a scene file, read with all the files that it names: shapes, materials, textures and
/// emitters by type, triangles, memory, integrator and sensors. Error as for rendering it.
nlohmann::ordered_json scene_json(const std::string& file, const Settings& defines);

/// The same as text.
std::string scene_text(const nlohmann::ordered_json& scene);

} // namespace faceta::cli
