#include "scene/geometry.h"

#include "base/error.h"
#include "scene/affine.h"

#include <algorithm>
#include <cmath>

namespace faceta {

using namespace double3;

namespace {

// Kernels count words of records in 32 bits.
constexpr size_t kMaxPrimitives = size_t(1) << 26;

void check_count(size_t count) {
  if (count >= kMaxPrimitives)
    throw Error("the scene has more than 2^26 triangles or quadrics");
}

void put(float (&to)[3], const Double3& from) {
  for (int k = 0; k < 3; ++k)
    to[k] = static_cast<float>(from[k]);
}

Double3 vertex(const std::vector<float>& data, uint32_t i) {
  return {data[3 * size_t(i)], data[3 * size_t(i) + 1], data[3 * size_t(i) + 2]};
}

/// The tangent as the kernels want it: only its direction counts, so extreme lengths are mended.
Double3 safe_tangent(const Double3& dp_du) {
  double l = length(dp_du);
  return l < 1e-3 || l > 1e9 ? normalize(dp_du) : dp_du;
}

TriangleRecord make_triangle(const Mesh& mesh, uint32_t f, int shape) {
  const uint32_t* index = &mesh.indices[3 * size_t(f)];
  SurfacePoint point = surface_point(mesh, f, 0, 0);
  // Reversed winding turns the geometric normal over; the tangent stays that of the file's order.
  int order[3] = {0, 1, 2};
  if (mesh.flip_normals)
    std::swap(order[1], order[2]);
  double sign = mesh.flip_normals ? -1 : 1;
  constexpr float kBarycentric[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  TriangleRecord r{};
  float(*normals[3])[3] = {&r.n0, &r.n1, &r.n2};
  float(*uvs[3])[2] = {&r.uv0, &r.uv1, &r.uv2};
  Double3 p[3];
  for (int k = 0; k < 3; ++k) {
    uint32_t v = index[order[k]];
    p[k] = vertex(mesh.positions, v);
    put(*normals[k], mesh.normals.empty() ? point.n : scale(vertex(mesh.normals, v), sign));
    for (int c = 0; c < 2; ++c)
      (*uvs[k])[c] = mesh.uvs.empty() ? kBarycentric[order[k]][c] : mesh.uvs[2 * size_t(v) + c];
  }
  put(r.v0, p[0]);
  put(r.e1, sub(p[1], p[0]));
  put(r.e2, sub(p[2], p[0]));
  auto rounded = [](const float(&v)[3]) { return Double3{v[0], v[1], v[2]}; };
  double doubled_area = length(cross(rounded(r.e1), rounded(r.e2)));
  r.inverse_cross = doubled_area > 1e-38 ? static_cast<float>(1 / doubled_area) : 0.0f;
  put(r.dpdu, safe_tangent(point.dp_du));
  r.light = -1;
  Double3 face = cross(rounded(r.e1), rounded(r.e2));
  bool flat = doubled_area > 1e-38;
  for (const auto* n : {&r.n0, &r.n1, &r.n2})
    flat = flat && dot(rounded(*n), face) > (1 - 1e-7) * doubled_area;
  r.shape = shape | (flat ? 0 : kSmoothTriangle);
  return r;
}

void grow(Box& box, const Double3& p) {
  for (int k = 0; k < 3; ++k) {
    box.low[k] = std::min(box.low[k], p[k]);
    box.high[k] = std::max(box.high[k], p[k]);
  }
}

/// The box around the image of a unit quadric.
Box quadric_box(QuadricType type, const ToWorld& m) {
  Box box;
  Double3 center = column(m, 3), axis = column(m, 2);
  for (int k = 0; k < 3; ++k) {
    double z = type == QuadricType::sphere ? m[4 * k + 2] : 0;
    double reach = std::hypot(m[4 * k], m[4 * k + 1], z);
    double end = type == QuadricType::cylinder ? axis[k] : 0;
    box.low[k] = center[k] - reach + std::min(end, 0.0);
    box.high[k] = center[k] + reach + std::max(end, 0.0);
  }
  return box;
}

/// The round sphere that a to_world with unequal axes stands for.
ToWorld round_off(const Sphere& sphere) {
  if (sphere.warning.empty())
    return sphere.to_world;
  const ToWorld& m = sphere.to_world;
  Double3 x = normalize(column(m, 0)), y = column(m, 1);
  y = normalize(sub(y, scale(x, dot(x, y))));
  Double3 z = scale(cross(x, y), determinant(m) < 0 ? -1 : 1);
  ToWorld r = m;
  for (int k = 0; k < 3; ++k) {
    r[4 * k] = sphere.radius * x[k];
    r[4 * k + 1] = sphere.radius * y[k];
    r[4 * k + 2] = sphere.radius * z[k];
  }
  return r;
}

} // namespace

int SceneGeometry::add(const Mesh& mesh, int shape) {
  size_t first = triangles.size(), base = positions.size() / 3;
  check_count(first + mesh.triangle_count());
  check_count(base + mesh.vertex_count());
  for (uint32_t f = 0; f < mesh.triangle_count(); ++f)
    triangles.push_back(make_triangle(mesh, f, shape));
  positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
  for (uint32_t i : mesh.indices) {
    indices.push_back(static_cast<uint32_t>(base + i));
    grow(box, vertex(mesh.positions, i));
  }
  return static_cast<int>(first);
}

int SceneGeometry::add_quadric(QuadricType type, const ToWorld& m, bool inward, double area,
                               int shape) {
  check_count(quadrics.size() + 1);
  QuadricRecord r{};
  QuadricShape q{};
  ToWorld inverted = inverse(m, "shape");
  for (int i = 0; i < 12; ++i) {
    r.to_world[i] = static_cast<float>(m[i]);
    r.to_local[i] = static_cast<float>(inverted[i]);
    q.to_local[i] = inverted[i];
  }
  r.type = static_cast<int32_t>(type);
  r.shape = shape;
  r.light = -1;
  r.flip = inward ? -1.0f : 1.0f;
  r.area = static_cast<float>(area);
  q.type = type;
  q.box = quadric_box(type, m);
  grow(box, q.box.low);
  grow(box, q.box.high);
  quadrics.push_back(r);
  quadric_shapes.push_back(q);
  return static_cast<int>(quadrics.size()) - 1;
}

int SceneGeometry::add(const Sphere& sphere, int shape) {
  return add_quadric(QuadricType::sphere, round_off(sphere), sphere.flip, surface_area(sphere),
                     shape);
}

int SceneGeometry::add(const Disk& disk, int shape) {
  return add_quadric(QuadricType::disk, disk.to_world, disk.flip, surface_area(disk), shape);
}

int SceneGeometry::add(const Cylinder& cylinder, int shape) {
  // Kernels map normals by the inverse transpose, which keeps them outward when the map mirrors;
  // Cylinder::flip speaks of dp_du x dp_dv, which turns inward.
  bool inward = cylinder.flip != (determinant(cylinder.to_world) < 0);
  return add_quadric(QuadricType::cylinder, cylinder.to_world, inward, surface_area(cylinder),
                     shape);
}

size_t SceneGeometry::bytes() const {
  return triangles.size() * sizeof(TriangleRecord) + quadrics.size() * sizeof(QuadricRecord) +
         quadric_shapes.size() * sizeof(QuadricShape) + (positions.size() + indices.size()) * 4;
}

double intersect(const QuadricShape& quadric, const Double3& o, const Double3& d, double t_min,
                 double t_max) {
  const double* m = quadric.to_local;
  double lo[3], ld[3];
  for (int k = 0; k < 3; ++k) {
    const double* row = m + 4 * k;
    lo[k] = row[0] * o[0] + row[1] * o[1] + row[2] * o[2] + row[3];
    ld[k] = row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
  }
  auto inside = [&](double t) { return t >= t_min && t <= t_max; };
  if (quadric.type == QuadricType::disk) {
    double t = -lo[2] / ld[2];
    double x = lo[0] + t * ld[0], y = lo[1] + t * ld[1];
    return inside(t) && x * x + y * y <= 1 ? t : -1;
  }
  bool sphere = quadric.type == QuadricType::sphere;
  // Roots about the point of the ray nearest to the centre or axis: no large numbers cancel.
  double z = sphere ? ld[2] : 0;
  double a = ld[0] * ld[0] + ld[1] * ld[1] + z * z;
  if (!(a > 0))
    return -1;
  double nearest = -(lo[0] * ld[0] + lo[1] * ld[1] + lo[2] * z) / a;
  double x = lo[0] + nearest * ld[0], y = lo[1] + nearest * ld[1];
  double h = sphere ? lo[2] + nearest * ld[2] : 0;
  double c = 1 - (x * x + y * y + h * h);
  if (!(c >= 0))
    return -1;
  double half = std::sqrt(c / a);
  for (double t : {nearest - half, nearest + half}) {
    double height = lo[2] + t * ld[2];
    if (inside(t) && (sphere || (height >= 0 && height <= 1)))
      return t;
  }
  return -1;
}

} // namespace faceta
