#pragma once

#include "scene/surface_point.h"

#include <cstdint>
#include <string>
#include <vector>

namespace faceta {

/// A triangle mesh. File readers and primitives make it in object space; place() brings it into
/// the world. Indices are always in range and all numbers finite.
///
/// Degenerate triangles (repeated vertices, zero area) are kept, so that triangle numbers match the
/// file. They do no harm: they give no weight to vertex normals, no ray hits them, and their area,
/// the weight by which lights choose triangles, is 0.
struct Mesh {
  std::vector<float> positions;  ///< x y z per vertex
  std::vector<float> normals;    ///< unit x y z per vertex, or empty: shade with face normals.
                                 ///< Before place(), a zero vector means "none in the file".
  std::vector<float> uvs;        ///< u v per vertex, or empty
  std::vector<uint32_t> indices; ///< three per triangle
  bool face_normals = false;     ///< place() drops vertex normals and makes none
  bool flip_normals = false;     ///< the renderer negates n and sh_n at each hit; data unchanged
  std::vector<std::string> ignored_attributes; ///< what the file holds beyond this, by name

  size_t vertex_count() const { return positions.size() / 3; }
  size_t triangle_count() const { return indices.size() / 3; }
};

/// Applies to_world: positions as points; normals by the inverse transpose, then normalized.
/// As in Mitsuba 3.9.1, a negative determinant changes neither the order of indices nor the sign
/// of given normals: the geometric normal (from positions) then faces away from the shading normal.
/// Singular matrices are allowed: a normal that the matrix leaves without direction becomes zero.
/// Throws Error for a non-finite or projective matrix, or if a position leaves the range of float.
void transform(Mesh& mesh, const ToWorld& to_world);

/// Replaces all vertex normals by the mean of the adjacent face normals, weighted by the angle of
/// each face at the vertex (Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets",
/// JGT 3(1), 1998). A vertex without any proper face gets (1, 0, 0), as in Mitsuba 3.9.1; one whose
/// faces cancel (a sheet modelled from both sides) the normal of the first of them, where Mitsuba
/// gives the direction of its rounding error.
void compute_vertex_normals(Mesh& mesh);

/// Brings a mesh into the world, in Mitsuba 3.9.1's order: transform(); then, with face_normals,
/// all vertex normals are dropped; without, missing (empty or zero) ones are computed from the
/// *world-space* triangles, so that they follow the winding after a mirroring transform.
void place(Mesh& mesh, const ToWorld& to_world);

/// Unit geometric normal of a triangle, (p1 - p0) x (p2 - p0), before flip_normals; zero if the
/// triangle has no area.
Double3 face_normal(const Mesh& mesh, uint32_t triangle);

/// Area of a triangle, and of them all.
double triangle_area(const Mesh& mesh, uint32_t triangle);
double surface_area(const Mesh& mesh);

/// The hit at barycentric (b1, b2) of a triangle: p = (1-b1-b2) p0 + b1 p1 + b2 p2. With e_i =
/// p_i - p_0, (du_i, dv_i) = uv_i - uv_0 and det = fma(du1, dv2, -(dv1 du2)), all in float:
///   with uvs and det != 0:  dp_du = (dv2 e1 - dv1 e2) / det,  dp_dv = (du1 e2 - du2 e1) / det;
///   with uvs and det = 0:   (dp_du, dp_dv) = orthonormal_basis(face normal before flip_normals);
///   without uvs:            uv = (b1, b2), dp_du = e1, dp_dv = e2.
/// sh_n is the normalized interpolated vertex normal if there are normals, else n.
SurfacePoint surface_point(const Mesh& mesh, uint32_t triangle, double b1, double b2);

} // namespace faceta
