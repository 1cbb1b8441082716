#include "scene/primitives.h"

#include "base/error.h"
#include "scene/affine.h"

#include <algorithm>
#include <numbers>

namespace faceta {

using namespace double3;

namespace {

constexpr double kPi = std::numbers::pi;

// Unequal axes beyond this, relative to the longest, are no rounding of a decimal matrix.
constexpr double kShapeTolerance = 1e-5;

ToWorld from_columns(const Double3& x, const Double3& y, const Double3& z, const Double3& origin) {
  return {x[0], y[0], z[0], origin[0], x[1], y[1], z[1], origin[1],
          x[2], y[2], z[2], origin[2], 0,    0,    0,    1};
}

bool equal_lengths(const Double3& a, const Double3& b) {
  double la = length(a), lb = length(b);
  return std::abs(la - lb) <= kShapeTolerance * std::max(la, lb);
}

bool orthogonal(const Double3& a, const Double3& b) {
  return std::abs(dot(normalize(a), normalize(b))) <= kShapeTolerance;
}

bool sheared(const ToWorld& m) {
  Double3 x = column(m, 0), y = column(m, 1), z = column(m, 2);
  return !orthogonal(x, y) || !orthogonal(y, z) || !orthogonal(z, x);
}

void check_radius(double radius, const char* what) {
  if (!std::isfinite(radius) || radius == 0)
    throw Error(std::string("radius of the ") + what + " must be a finite number other than 0");
}

void check_point(const Double3& p, const char* what) {
  if (!finite(p))
    throw Error(std::string(what) + " must be finite");
}

// Azimuth in [0, 2pi]; the end is reached by rounding only.
double azimuth(double x, double y) {
  double phi = std::atan2(y, x);
  return phi < 0 ? phi + 2 * kPi : phi;
}

// Real roots of a t^2 + 2 h t + c, ascending, without cancellation.
std::optional<std::pair<double, double>> solve_quadratic(double a, double h, double c) {
  double discriminant = h * h - a * c;
  if (!(discriminant >= 0) || a == 0)
    return std::nullopt;
  double q = -(h + std::copysign(std::sqrt(discriminant), h));
  if (q == 0)
    return std::pair{0.0, 0.0};
  double t0 = q / a, t1 = c / q;
  return std::pair{std::min(t0, t1), std::max(t0, t1)};
}

} // namespace

Mesh make_rectangle() {
  Mesh mesh;
  mesh.positions = {-1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0};
  mesh.normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  mesh.uvs = {0, 0, 1, 0, 0, 1, 1, 1};
  mesh.indices = {1, 2, 0, 1, 3, 2};
  return mesh;
}

Mesh make_cube() {
  // Per face: the normal and four corners in order; uv runs (0,1) (1,1) (1,0) (0,0) around it.
  struct Face {
    float normal[3];
    float corners[4][3];
  };
  static constexpr Face kFaces[6] = {
      {{0, -1, 0}, {{1, -1, -1}, {1, -1, 1}, {-1, -1, 1}, {-1, -1, -1}}},
      {{0, 1, 0}, {{1, 1, -1}, {-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}}},
      {{1, 0, 0}, {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}}},
      {{0, 0, 1}, {{1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}}},
      {{-1, 0, 0}, {{-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, -1}}},
      {{0, 0, -1}, {{1, 1, -1}, {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}}}};
  Mesh mesh;
  for (uint32_t f = 0; f < 6; ++f) {
    for (const auto& corner : kFaces[f].corners) {
      mesh.positions.insert(mesh.positions.end(), corner, corner + 3);
      mesh.normals.insert(mesh.normals.end(), kFaces[f].normal, kFaces[f].normal + 3);
    }
    mesh.uvs.insert(mesh.uvs.end(), {0, 1, 1, 1, 1, 0, 0, 0});
    for (uint32_t k : {0u, 1u, 2u, 3u, 0u, 2u})
      mesh.indices.push_back(4 * f + k);
  }
  return mesh;
}

Sphere make_sphere(const Double3& center, double radius, bool flip_normals,
                   const ToWorld& to_world) {
  check_affine(to_world);
  check_radius(radius, "sphere");
  check_point(center, "centre of the sphere");
  Sphere sphere;
  sphere.to_world =
      multiply(to_world, from_columns({radius, 0, 0}, {0, radius, 0}, {0, 0, radius}, center));
  const ToWorld& m = sphere.to_world;
  sphere.to_object = inverse(m, "sphere");
  sphere.center = column(m, 3);
  sphere.radius = length(column(m, 0));
  sphere.flip = flip_normals != (relative_determinant(m) < 0);
  if (!equal_lengths(column(m, 0), column(m, 1)) || !equal_lengths(column(m, 0), column(m, 2)) ||
      sheared(m))
    sphere.warning = "to_world of the sphere holds a non-uniform scale or a shear, which a sphere "
                     "cannot follow; its radius is the scale of the x axis";
  return sphere;
}

Disk make_disk(bool flip_normals, const ToWorld& to_world) {
  check_affine(to_world);
  Disk disk;
  Double3 n = NormalMap(to_world)({0, 0, 1});
  disk.to_world = to_world;
  // A flat disk has no use for the third column: one that is missing is replaced by the normal.
  if (std::abs(relative_determinant(to_world)) < 1e-12 && dot(n, n) > 0)
    disk.to_world = from_columns(column(to_world, 0), column(to_world, 1), n, column(to_world, 3));
  disk.to_object = inverse(disk.to_world, "disk");
  disk.center = column(to_world, 3);
  disk.normal = flip_normals ? scale(n, -1) : n;
  disk.flip = flip_normals;
  return disk;
}

Cylinder make_cylinder(const Double3& p0, const Double3& p1, double radius, bool flip_normals,
                       const ToWorld& to_world) {
  check_affine(to_world);
  check_radius(radius, "cylinder");
  check_point(p0, "p0 of the cylinder");
  check_point(p1, "p1 of the cylinder");
  Double3 axis = sub(p1, p0);
  if (!(length(axis) > 0) || !finite(axis))
    throw Error("p0 and p1 of the cylinder must be two different points");
  Basis basis = orthonormal_basis(normalize(axis));
  Cylinder cylinder;
  cylinder.to_world =
      multiply(to_world, from_columns(scale(basis.s, radius), scale(basis.t, radius), axis, p0));
  const ToWorld& m = cylinder.to_world;
  cylinder.to_object = inverse(m, "cylinder");
  cylinder.p0 = column(m, 3);
  cylinder.p1 = map_point(m, {0, 0, 1});
  cylinder.radius = length(column(m, 0));
  cylinder.flip = flip_normals != (relative_determinant(m) < 0);
  if (!equal_lengths(column(m, 0), column(m, 1)) || sheared(m))
    cylinder.warning = "to_world of the cylinder holds a non-uniform scale across its axis or a "
                       "shear; the tube becomes elliptic or slanted";
  return cylinder;
}

std::optional<double> intersect(const Sphere& sphere, const Double3& o, const Double3& d,
                                double t_min, double t_max) {
  // Roots are sought around the point nearest to the centre, where no large numbers cancel.
  Double3 l = sub(o, sphere.center);
  double dd = dot(d, d);
  if (!(dd > 0))
    return std::nullopt;
  double t_near = -dot(l, d) / dd;
  Double3 closest = add(l, scale(d, t_near));
  double c = dot(closest, closest) - sphere.radius * sphere.radius;
  auto roots = solve_quadratic(dd, dot(closest, d), c);
  if (!roots)
    return std::nullopt;
  for (double t : {roots->first + t_near, roots->second + t_near})
    if (t >= t_min && t <= t_max)
      return t;
  return std::nullopt;
}

std::optional<double> intersect(const Disk& disk, const Double3& o, const Double3& d, double t_min,
                                double t_max) {
  Double3 lo = map_point(disk.to_object, o), ld = map_vector(disk.to_object, d);
  double t = -lo[2] / ld[2];
  double x = lo[0] + t * ld[0], y = lo[1] + t * ld[1];
  if (t >= t_min && t <= t_max && x * x + y * y <= 1)
    return t;
  return std::nullopt;
}

std::optional<double> intersect(const Cylinder& cylinder, const Double3& o, const Double3& d,
                                double t_min, double t_max) {
  Double3 lo = map_point(cylinder.to_object, o), ld = map_vector(cylinder.to_object, d);
  double a = ld[0] * ld[0] + ld[1] * ld[1];
  double h = ld[0] * lo[0] + ld[1] * lo[1];
  auto roots = solve_quadratic(a, h, lo[0] * lo[0] + lo[1] * lo[1] - 1);
  if (!roots)
    return std::nullopt;
  for (double t : {roots->first, roots->second}) {
    double z = lo[2] + t * ld[2];
    if (t >= t_min && t <= t_max && z >= 0 && z <= 1)
      return t;
  }
  return std::nullopt;
}

SurfacePoint surface_point(const Sphere& sphere, const Double3& p) {
  SurfacePoint hit;
  hit.n = normalize(sub(p, sphere.center));
  hit.p = add(sphere.center, scale(hit.n, sphere.radius));
  Double3 local = map_point(sphere.to_object, hit.p);
  double x = local[0], y = local[1], z = local[2];
  double r = std::hypot(x, y);
  hit.u = azimuth(x, y) / (2 * kPi);
  hit.v = std::atan2(r, z) / kPi;
  Double3 dv = r > 0 ? Double3{z * x / r, z * y / r, -r} : Double3{1, 0, 0};
  hit.dp_du = scale(map_vector(sphere.to_world, {-y, x, 0}), 2 * kPi);
  hit.dp_dv = scale(map_vector(sphere.to_world, dv), kPi);
  if (sphere.flip)
    hit.n = scale(hit.n, -1);
  hit.sh_n = hit.n;
  complete_frame(hit);
  return hit;
}

SurfacePoint surface_point(const Disk& disk, const Double3& p) {
  SurfacePoint hit;
  Double3 local = map_point(disk.to_object, p);
  double x = local[0], y = local[1], r = std::hypot(x, y);
  hit.p = map_point(disk.to_world, {x, y, 0});
  hit.u = r;
  hit.v = azimuth(x, y) / (2 * kPi);
  if (r > 0) {
    hit.dp_du = map_vector(disk.to_world, {x / r, y / r, 0});
    hit.dp_dv = scale(map_vector(disk.to_world, {-y, x, 0}), 2 * kPi);
  }
  hit.n = hit.sh_n = disk.normal;
  complete_frame(hit);
  return hit;
}

SurfacePoint surface_point(const Cylinder& cylinder, const Double3& p) {
  SurfacePoint hit;
  Double3 local = map_point(cylinder.to_object, p);
  double phi = azimuth(local[0], local[1]);
  double r = std::hypot(local[0], local[1]);
  double x = r > 0 ? local[0] / r : 1.0, y = r > 0 ? local[1] / r : 0.0;
  hit.p = map_point(cylinder.to_world, {x, y, local[2]});
  hit.u = phi / (2 * kPi);
  hit.v = local[2];
  hit.dp_du = scale(map_vector(cylinder.to_world, {-y, x, 0}), 2 * kPi);
  hit.dp_dv = column(cylinder.to_world, 2);
  hit.n = normalize(cross(hit.dp_du, hit.dp_dv));
  if (cylinder.flip)
    hit.n = scale(hit.n, -1);
  hit.sh_n = hit.n;
  complete_frame(hit);
  return hit;
}

double surface_area(const Sphere& sphere) {
  return 4 * kPi * sphere.radius * sphere.radius;
}

double surface_area(const Disk& disk) {
  return kPi * length(cross(column(disk.to_world, 0), column(disk.to_world, 1)));
}

double surface_area(const Cylinder& cylinder) {
  // The integrand |dp_du x dp_dv| is periodic and smooth in u: equal steps converge exponentially.
  constexpr int kSteps = 512;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    double phi = 2 * kPi * (i + 0.5) / kSteps;
    Double3 du = map_vector(cylinder.to_world, {-std::sin(phi), std::cos(phi), 0});
    sum += length(cross(du, column(cylinder.to_world, 2)));
  }
  return 2 * kPi * sum / kSteps;
}

} // namespace faceta
