#pragma once

#include "bsdf/registry.h"

namespace faceta {

/// The built-in models, in the order of the registration list in src/materials/CMakeLists.txt.
std::vector<Model> builtin_models();

} // namespace faceta
