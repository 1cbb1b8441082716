#pragma once

#include "formats/mesh_input.h"
#include "scene/mesh.h"

namespace faceta {

/// Reads a PLY file (ascii, binary_little_endian or binary_big_endian, version 1.0) as one mesh in
/// object space (see place()).
///
/// From element "vertex": x y z; nx ny nz if all three are there; and as uv the first pair of (u,
/// v), (texture_u, texture_v), (s, t). From element "face": the list vertex_indices or
/// vertex_index; polygons are split into a fan around their first corner, faces with fewer than
/// three corners are skipped. Properties may have any type (of PLY: char to double; also int8 to
/// float64, long, ulong, half) and stand in any order; all others are skipped and their names kept
/// in Mesh::ignored_attributes ("vertex_red", "face_flags", "edge"). A normal of length 0 counts as
/// missing (place() computes it). A file with no faces at all gives a mesh without triangles.
///
/// Throws Error for a malformed header, counts larger than the file can hold, data that ends early
/// or goes on after the last element, numbers that are malformed or not finite, indices out of
/// range and triangle strips; with line and column for text, the byte offset for binary data.
/// Memory stays within a small multiple of the file's size.
Mesh read_ply(const std::string& path, const MeshOptions& options = {});

/// The same for bytes in memory; `name` stands in error messages.
Mesh parse_ply(std::string_view bytes, const std::string& name, const MeshOptions& options = {});

} // namespace faceta
