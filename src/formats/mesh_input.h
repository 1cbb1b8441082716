#pragma once

#include "formats/input_text.h"

namespace faceta {

/// How a mesh file is read; the defaults of flip_tex_coords differ between formats.
struct MeshOptions {
  bool flip_tex_coords = false; ///< v becomes 1 - v
  bool face_normals = false;    ///< vertex normals of the file are checked, then dropped
  bool flip_normals = false;    ///< copied into Mesh::flip_normals
};

} // namespace faceta
