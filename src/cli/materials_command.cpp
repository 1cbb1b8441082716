#include "cli/commands.h"
#include "formats/material_docs.h"

#include <cstdio>

namespace faceta::cli {

int run_materials(const MaterialsOptions& options) {
  const Registry& registry = Registry::global();
  std::string text;
  if (options.name.empty())
    text = options.json       ? list_materials_json(registry)
           : options.markdown ? list_materials_markdown(registry)
                              : list_materials(registry);
  else {
    const Descriptor& d = material_descriptor(registry, options.name);
    text = options.json       ? describe_material_json(d)
           : options.markdown ? describe_material_markdown(d)
                              : describe_material(d);
  }
  std::fputs(text.c_str(), stdout);
  return kOk;
}

} // namespace faceta::cli
