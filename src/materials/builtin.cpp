#include "materials/builtin.h"

namespace faceta {

Registry& Registry::global() {
  static Registry registry = [] {
    Registry r;
    r.add(builtin_models(), module_directory(), "builtin");
    return r;
  }();
  return registry;
}

} // namespace faceta
