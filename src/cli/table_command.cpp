#include "cli/commands.h"
#include "cli/scene_material.h"
#include "formats/direction_table.h"

namespace faceta::cli {

int run_table(const TableOptions& options) {
  Isa isa = options.isa.value_or(best_isa());
  ColumnMaterial material =
      options.material.empty()
          ? load_scene_material(options.scene, options.id, options.defines, isa, options.mode)
          : column_material(make_parameters(options.material, options.settings), isa, options.mode);
  if (options.sample)
    sample_table(material, options.input, options.output);
  else
    eval_table(material, options.input, options.output);
  return kOk;
}

} // namespace faceta::cli
