#pragma once

#include "bsdf/registry.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace faceta::cli {

/// What stands in the arguments of `render` and `gallery`; what is empty, the scene decides.
struct RenderOptions {
  std::string scene; ///< empty for `gallery`
  std::vector<std::string> outputs;
  std::optional<int> spp;
  std::optional<uint32_t> seed;
  int threads = 0;                        ///< 0: all
  std::optional<std::array<int, 2>> size; ///< width, height
  std::optional<std::array<int, 4>> crop; ///< left, top, width, height
  int sensor = 0;                         ///< which of the scene's
  std::string sampler;                    ///< independent | sobol
  std::optional<Isa> isa;                 ///< nothing: the best
  Settings defines;                       ///< -D
  double exposure = 0;                    ///< stops, for PNG
  bool full_floats = false;               ///< EXR with 32 bits a value
  std::string variance;                   ///< EXR file for the variance of the mean; empty: none
  int tile = 0;                           ///< pixels a side; 0: chosen
  bool permissive = false;                ///< warn of what the scene's plugins do not know
  std::vector<std::string> measured;      ///< of `gallery`: these files instead
  int verbosity = 0;                      ///< -1: quiet, 1: verbose
};

/// Renders a scene to the outputs (at least one). Returns an exit code.
int run_render(const RenderOptions& options);

/// Renders the contact sheet of all materials to the outputs (at least one).
int run_gallery(const RenderOptions& options);

} // namespace faceta::cli
