#include "cli/scene_material.h"

namespace faceta::cli {

ColumnMaterial load_scene_material(const std::string& scene, const std::string& id, const Settings&,
                                   Isa, TransportMode) {
  throw Error("material '" + id + "': materials of scene files cannot be read yet", {scene},
              "name the material and its parameters instead");
}

} // namespace faceta::cli
