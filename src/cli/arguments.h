#pragma once

#include "bsdf/describe.h"

#include <functional>

namespace faceta::cli {

/// What the arguments ask for: run it for the exit code.
using Action = std::function<int()>;

/// Parses the arguments of the program. Help, version and complaints of the arguments are printed
/// here; then the action returns their exit code.
Action parse_arguments(int argc, char** argv);

/// Splits words of the form name=value; CLI::ValidationError at any other.
Settings settings_of(const std::vector<std::string>& words);

} // namespace faceta::cli
