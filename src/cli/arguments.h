#pragma once

#include <functional>

namespace faceta::cli {

/// What the arguments ask for: run it for the exit code.
using Action = std::function<int()>;

/// Parses the arguments of the program. Help, version and complaints of the arguments are printed
/// here; then the action returns their exit code.
Action parse_arguments(int argc, char** argv);

} // namespace faceta::cli
