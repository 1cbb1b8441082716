#include "scene/mesh.h"

#include "base/error.h"
#include "scene/affine.h"

#include <algorithm>

namespace faceta {

using namespace double3;

namespace {

Double3 load3(const std::vector<float>& data, uint32_t i) {
  return {data[3 * size_t{i}], data[3 * size_t{i} + 1], data[3 * size_t{i} + 2]};
}

void store3(std::vector<float>& data, size_t i, const Double3& value) {
  for (int k = 0; k < 3; ++k)
    data[3 * i + k] = static_cast<float>(value[k]);
}

struct Triangle {
  Double3 p0, p1, p2;
};

Triangle load_triangle(const Mesh& mesh, uint32_t triangle) {
  const uint32_t* i = &mesh.indices[3 * size_t{triangle}];
  return {load3(mesh.positions, i[0]), load3(mesh.positions, i[1]), load3(mesh.positions, i[2])};
}

// The angle from the sine and the cosine stays exact for slivers, where acos alone does not.
double angle_between(const Double3& a, const Double3& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

// Angle-weighted sums of face normals, one per vertex; not normalized.
std::vector<Double3> sum_face_normals(const Mesh& mesh) {
  std::vector<Double3> sums(mesh.vertex_count(), Double3{});
  for (uint32_t f = 0; f < mesh.triangle_count(); ++f) {
    Triangle tri = load_triangle(mesh, f);
    Double3 n = normalize(cross(sub(tri.p1, tri.p0), sub(tri.p2, tri.p0)));
    if (dot(n, n) == 0)
      continue;
    const Double3* p[3] = {&tri.p0, &tri.p1, &tri.p2};
    for (int k = 0; k < 3; ++k) {
      double angle = angle_between(sub(*p[(k + 1) % 3], *p[k]), sub(*p[(k + 2) % 3], *p[k]));
      Double3& sum = sums[mesh.indices[3 * size_t{f} + k]];
      sum = add(sum, scale(n, angle));
    }
  }
  return sums;
}

std::vector<Double3> mean_face_normals(const Mesh& mesh) {
  std::vector<Double3> normals = sum_face_normals(mesh);
  std::vector<uint32_t> unsettled;
  for (uint32_t i = 0; i < normals.size(); ++i) {
    // The faces of a sheet that is modelled twice, back to back, cancel up to rounding: below this
    // length the direction would be noise.
    bool settled = length(normals[i]) > 1e-9;
    normals[i] = settled ? normalize(normals[i]) : Double3{1, 0, 0};
    if (!settled)
      unsettled.push_back(i);
  }
  if (unsettled.empty())
    return normals;
  // Such vertices take the side of their first face. Backwards, so that the first one stays.
  for (uint32_t f = static_cast<uint32_t>(mesh.triangle_count()); f-- > 0;) {
    Double3 n = face_normal(mesh, f);
    for (int k = 0; k < 3 && dot(n, n) > 0; ++k) {
      uint32_t i = mesh.indices[3 * size_t{f} + k];
      if (std::binary_search(unsettled.begin(), unsettled.end(), i))
        normals[i] = n;
    }
  }
  return normals;
}

bool is_zero_normal(const Mesh& mesh, size_t i) {
  return mesh.normals[3 * i] == 0 && mesh.normals[3 * i + 1] == 0 && mesh.normals[3 * i + 2] == 0;
}

void complete_vertex_normals(Mesh& mesh) {
  if (mesh.normals.empty())
    return compute_vertex_normals(mesh);
  bool missing = false;
  for (size_t i = 0; i < mesh.vertex_count() && !missing; ++i)
    missing = is_zero_normal(mesh, i);
  if (!missing)
    return;
  std::vector<Double3> computed = mean_face_normals(mesh);
  for (size_t i = 0; i < mesh.vertex_count(); ++i)
    if (is_zero_normal(mesh, i))
      store3(mesh.normals, i, computed[i]);
}

// uv and its tangents from the vertices' uvs.
void map_uvs(const Mesh& mesh, const uint32_t* index, const double* b, const Double3& e1,
             const Double3& e2, SurfacePoint& hit) {
  float u[3], v[3];
  for (int k = 0; k < 3; ++k) {
    u[k] = mesh.uvs[2 * size_t{index[k]}];
    v[k] = mesh.uvs[2 * size_t{index[k]} + 1];
  }
  hit.u = b[0] * u[0] + b[1] * u[1] + b[2] * u[2];
  hit.v = b[0] * v[0] + b[1] * v[1] + b[2] * v[2];
  // In float, as the renderer does it: whether det is exactly 0 decides the frame.
  float du1 = u[1] - u[0], du2 = u[2] - u[0], dv1 = v[1] - v[0], dv2 = v[2] - v[0];
  double det = std::fma(du1, dv2, -(dv1 * du2));
  if (det == 0) {
    Basis basis = orthonormal_basis(hit.n);
    hit.dp_du = basis.s;
    hit.dp_dv = basis.t;
    return;
  }
  hit.dp_du = scale(sub(scale(e1, dv2), scale(e2, dv1)), 1 / det);
  hit.dp_dv = scale(sub(scale(e2, du1), scale(e1, du2)), 1 / det);
}

} // namespace

void transform(Mesh& mesh, const ToWorld& to_world) {
  check_affine(to_world);
  for (size_t i = 0; i < mesh.vertex_count(); ++i) {
    Double3 p = map_point(to_world, load3(mesh.positions, i));
    for (double x : p)
      if (!std::isfinite(static_cast<float>(x)))
        throw Error("to_world moves a vertex of the mesh out of the range of numbers");
    store3(mesh.positions, i, p);
  }
  NormalMap map(to_world);
  for (size_t i = 0; 3 * i < mesh.normals.size(); ++i)
    store3(mesh.normals, i, map(load3(mesh.normals, i)));
}

void compute_vertex_normals(Mesh& mesh) {
  std::vector<Double3> computed = mean_face_normals(mesh);
  mesh.normals.resize(mesh.positions.size());
  for (size_t i = 0; i < mesh.vertex_count(); ++i)
    store3(mesh.normals, i, computed[i]);
}

void place(Mesh& mesh, const ToWorld& to_world) {
  if (mesh.face_normals)
    mesh.normals.clear();
  transform(mesh, to_world);
  if (!mesh.face_normals)
    complete_vertex_normals(mesh);
}

Double3 face_normal(const Mesh& mesh, uint32_t triangle) {
  Triangle tri = load_triangle(mesh, triangle);
  return normalize(cross(sub(tri.p1, tri.p0), sub(tri.p2, tri.p0)));
}

double triangle_area(const Mesh& mesh, uint32_t triangle) {
  Triangle tri = load_triangle(mesh, triangle);
  return 0.5 * length(cross(sub(tri.p1, tri.p0), sub(tri.p2, tri.p0)));
}

double surface_area(const Mesh& mesh) {
  double sum = 0;
  for (uint32_t f = 0; f < mesh.triangle_count(); ++f)
    sum += triangle_area(mesh, f);
  return sum;
}

SurfacePoint surface_point(const Mesh& mesh, uint32_t triangle, double b1, double b2) {
  Triangle tri = load_triangle(mesh, triangle);
  const uint32_t* index = &mesh.indices[3 * size_t{triangle}];
  double b[3] = {1 - b1 - b2, b1, b2};
  SurfacePoint hit;
  hit.p = add(add(scale(tri.p0, b[0]), scale(tri.p1, b[1])), scale(tri.p2, b[2]));
  hit.n = face_normal(mesh, triangle);
  Double3 e1 = sub(tri.p1, tri.p0), e2 = sub(tri.p2, tri.p0);
  hit.dp_du = e1;
  hit.dp_dv = e2;
  hit.u = b1;
  hit.v = b2;
  if (!mesh.uvs.empty())
    map_uvs(mesh, index, b, e1, e2, hit);

  hit.sh_n = hit.n;
  if (!mesh.normals.empty()) {
    Double3 n{};
    for (int k = 0; k < 3; ++k)
      n = add(n, scale(load3(mesh.normals, index[k]), b[k]));
    // Opposite vertex normals can cancel at one point; the face's own normal steps in.
    if (dot(n, n) > 0)
      hit.sh_n = normalize(n);
  }
  if (mesh.flip_normals) {
    hit.n = scale(hit.n, -1);
    hit.sh_n = scale(hit.sh_n, -1);
  }
  complete_frame(hit);
  return hit;
}

} // namespace faceta
