#pragma once

/// The materials of defective.h by name.

#include "bsdf/registry.h"

namespace faceta::defective {

std::vector<Model> defective_models();

inline const Registry& registry() {
  static const Registry defective = [] {
    Registry r;
    r.add(defective_models(), FACETA_TEST_MODULES, "defective");
    return r;
  }();
  return defective;
}

} // namespace faceta::defective
