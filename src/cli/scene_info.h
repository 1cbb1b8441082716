#pragma once

#include "bsdf/registry.h"

#include <string>

namespace faceta::cli {

struct SceneInfo {
  std::string json, text;
};

/// What is in a scene file, read with all the files that it names: shapes, materials, textures and
/// emitters by type, triangles, memory, integrator and sensors. Error as for rendering it.
SceneInfo scene_info(const std::string& file, const Settings& defines);

} // namespace faceta::cli
