#pragma once

#include <string>

namespace faceta {

/// What the processor calls itself ("AMD EPYC 9B45 ..."); "unknown" if it does not say.
std::string cpu_brand();

} // namespace faceta
