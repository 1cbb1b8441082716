#include "cli/scene_material.h"

#include "formats/mitsuba_scene.h"
#include "render/scene_material.h"

namespace faceta::cli {

ColumnMaterial load_scene_material(const std::string& scene, const std::string& id,
                                   const Settings& defines, Isa isa, TransportMode mode) {
  ReadOptions options;
  options.defines = defines;
  auto holder = std::make_unique<Scene>();
  int material = holder->add_material(read_mitsuba_material(scene, id, *holder, options));
  auto ready = std::make_shared<const SceneMaterial>(std::move(holder), material, isa);
  return {[=](EvalColumns& columns) { ready->eval(columns.arrays(), columns.count, mode); },
          [=](SampleColumns& columns) { ready->sample(columns.arrays(), columns.count, mode); }};
}

} // namespace faceta::cli
