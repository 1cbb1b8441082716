#pragma once

#include "formats/mesh_input.h"
#include "scene/mesh.h"

namespace faceta {

inline constexpr MeshOptions kObjDefaults{.flip_tex_coords = true};

/// Reads a Wavefront OBJ file as one mesh in object space (see place()).
///
/// v, vt, vn and f are read; every other statement (groups, materials, smoothing, lines, ...) is
/// skipped, as are further numbers of v (weight, colour) and vt. Corners with the same (v, vt, vn)
/// become one vertex, in order of first use. Polygons are split into a fan around their first
/// corner; faces with fewer than three corners have no area and are skipped. Indices may be
/// negative (counted from the last one so far) or point to later lines. LF, CRLF and CR line ends,
/// comments and backslash continuation are understood. A vt with one number has v = 0.
///
/// A corner without vt in a mesh that has some gets uv (0, 0); one without vn (or whose vn is the
/// zero vector) gets a zero normal, which place() replaces by the computed one. A mesh where no
/// corner has a vt (vn) has no uvs (normals).
///
/// Throws Error with file, line and column for numbers that are malformed or not finite, indices
/// that are 0 or out of range, and files without any face. Memory stays within a small multiple of
/// the file's size.
Mesh read_obj(const std::string& path, const MeshOptions& options = kObjDefaults);

/// The same for text in memory; `name` stands in error messages.
Mesh parse_obj(std::string_view text, const std::string& name,
               const MeshOptions& options = kObjDefaults);

} // namespace faceta
