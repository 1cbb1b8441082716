#include "materials/builtin.h"

#include "materials/measured_demo.h"

namespace faceta {

Registry& Registry::global() {
  static Registry registry = [] {
    Registry r;
    if (FileLoader full = set_file_loader(load_demo))
      set_file_loader(full);
    r.add(builtin_models(), module_directory(), "builtin");
    return r;
  }();
  return registry;
}

Parameters make_parameters(const std::string& model, const Settings& settings) {
  Parameters p(Registry::global().get(model));
  for (const auto& [key, value] : settings)
    p.set(key, value);
  p.check();
  return p;
}

} // namespace faceta
