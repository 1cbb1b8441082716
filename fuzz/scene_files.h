#pragma once

#include "fuzz.h"

namespace faceta::fuzz {

/// A folder with one small file of each kind that a scene can name.
inline const Folder& scene_folder() {
  static const Folder folder;
  static const bool written = [] {
    folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    folder.write("mesh.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    std::string picture = "PF\n2 3\n-1\n";
    for (int i = 0; i < 18; ++i)
      picture += std::string("\0\0\0\x3f", 4); // 0.5
    folder.write("picture.pfm", picture);
    folder.write("curve.spd", "400 0.1\n500 0.5\n700 0.9\n");
    folder.write("part.xml", "<scene version='3.0.0'><bsdf type='diffuse' id='part'/></scene>");
    return true;
  }();
  (void)written;
  return folder;
}

} // namespace faceta::fuzz
