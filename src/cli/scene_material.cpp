#include "cli/scene_material.h"

#include "formats/mitsuba_scene.h"
#include "render/job.h"

namespace faceta::cli {

ColumnMaterial load_scene_material(const std::string& scene, const std::string& id,
                                   const Settings& defines, Isa isa, TransportMode mode) {
  const RenderKernels* kernels = Registry::global().render_kernels(isa);
  if (!kernels)
    throw Error(std::string("this processor cannot run the instruction set '") +
                kIsaNames[static_cast<int>(isa)] + "'");
  ReadOptions options;
  options.defines = defines;
  auto holder = std::make_shared<Scene>();
  int material = holder->add_material(read_mitsuba_material(scene, id, *holder, options));
  holder->build(isa);
  holder->use_sensor(CameraDesc{}, FilmDesc{});
  int root = holder->view_root(material);
  int importance = mode == TransportMode::importance;
  return {[=](EvalColumns& columns) {
            EvalArrays arrays = columns.arrays();
            kernels->scatter(holder->view(), root, importance, &arrays, nullptr, columns.count);
          },
          [=](SampleColumns& columns) {
            SampleArrays arrays = columns.arrays();
            kernels->scatter(holder->view(), root, importance, nullptr, &arrays, columns.count);
          }};
}

} // namespace faceta::cli
