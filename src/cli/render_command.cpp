#include "cli/render_command.h"

namespace faceta::cli {

int run_render(const RenderOptions& options) {
  throw Error("the renderer is not built yet", {options.scene});
}

int run_gallery(const RenderOptions&) {
  throw Error("the gallery is not built yet");
}

} // namespace faceta::cli
