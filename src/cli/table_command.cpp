#include "cli/commands.h"
#include "cli/scene_material.h"
#include "formats/direction_table.h"
#include "formats/material_docs.h"
#include "formats/measured_loader.h"

namespace faceta::cli {

int run_table(const TableOptions& options) {
  Isa isa = options.isa.value_or(best_isa());
  if (find_scene_node(options.material))
    throw Error("'" + options.material + "' puts materials of a scene file together", {},
                "give the file and the id: --scene FILE --id ID");
  ColumnMaterial material =
      options.material.empty()
          ? load_scene_material(options.scene, options.id, options.defines, isa, options.mode)
          : column_material(parameters_of(model_or_file(options.material, options.settings)), isa,
                            options.mode);
  if (options.sample)
    sample_table(material, options.input, options.output);
  else
    eval_table(material, options.input, options.output);
  return kOk;
}

} // namespace faceta::cli
