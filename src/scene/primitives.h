#pragma once

#include "scene/mesh.h"

#include <optional>
#include <string>

namespace faceta {

/// The square [-1,1]^2 in the plane z = 0: normal +z, uv = ((x+1)/2, (y+1)/2), two triangles split
/// along x + y = 0, with vertex normals: a mesh in every respect, as in Mitsuba 3.9.1.
Mesh make_rectangle();

/// The cube [-1,1]^3 with outward normals: 24 vertices, 12 triangles, each face mapped to [0,1]^2,
/// in the vertex and triangle order of Mitsuba 3.9.1.
Mesh make_cube();

/// Analytic shapes. to_world is the full map from the canonical shape (unit sphere; unit disk in
/// z = 0; unit cylinder around z, z in [0,1]) to the world, the shape's own parameters included;
/// to_object is its inverse. flip tells that normals are to be negated, once everything is counted.
/// warning is empty, or says what of to_world the shape cannot follow (Mitsuba 3.9.1 warns, too,
/// and goes on).

/// Normal (p - center) / radius, outward; flip = flip_normals xor (det to_world < 0), so that a
/// mirrored sphere points inward, as in Mitsuba 3.9.1. radius is the length of to_world's first
/// column: non-uniform scale or shear gives that round sphere, with a warning.
/// With local = to_object p: uv = (phi / 2pi, theta / pi), phi = atan2(y, x) in [0, 2pi], theta
/// from +z; dp_du = 2pi to_world (-y, x, 0); dp_dv = pi to_world (z cos phi, z sin phi, -r), r =
/// |(x, y)|; at the poles dp_du = 0 and dp_dv = pi to_world (1, 0, 0).
struct Sphere {
  Double3 center{};
  double radius = 1;
  bool flip = false;
  ToWorld to_world{}, to_object{};
  std::string warning;
};

/// The ellipse that to_world makes of the unit disk; any scale and shear, no warning. Normal:
/// (0, 0, 1) by the inverse transpose; flip = flip_normals. A to_world that flattens z only is
/// accepted. With local (x, y), r = |(x, y)|: uv = (r, phi / 2pi); dp_du = to_world (cos phi, sin
/// phi, 0), dp_dv = 2pi r to_world (-sin phi, cos phi, 0); both are 0 at the centre.
struct Disk {
  Double3 center{};
  Double3 normal{0, 0, 1}; ///< unit, flip counted in
  bool flip = false;
  ToWorld to_world{}, to_object{};
};

/// Open tube. flip = flip_normals xor (det to_world < 0); the normal is normalize(dp_du x dp_dv),
/// negated by flip: outward without flip_normals, mirrored or not, as in Mitsuba 3.9.1.
/// Non-uniform scale and shear give the elliptic tube that to_world makes (radius and p0-p1 then
/// only describe one axis of it), with a warning.
/// With local = to_object p: uv = (phi / 2pi, z), z in [0,1] from p0 to p1; dp_du = 2pi to_world
/// (-y, x, 0), dp_dv = to_world (0, 0, 1) = p1 - p0.
struct Cylinder {
  Double3 p0{}, p1{}; ///< in the world
  double radius = 1;
  bool flip = false;
  ToWorld to_world{}, to_object{};
  std::string warning;
};

/// Throw Error if radius is 0 or not finite, or if to_world is singular, projective or not finite.
/// A negative radius is a point reflection, as in Mitsuba 3.9.1.
Sphere make_sphere(const Double3& center, double radius, bool flip_normals,
                   const ToWorld& to_world);
Disk make_disk(bool flip_normals, const ToWorld& to_world);
/// The angle phi starts at orthonormal_basis((p1 - p0) / |p1 - p0|).s. Also throws if p0 = p1.
Cylinder make_cylinder(const Double3& p0, const Double3& p1, double radius, bool flip_normals,
                       const ToWorld& to_world);

/// Distance t in [t_min, t_max] along o + t d (d need not be unit) to the nearest hit, or nothing.
std::optional<double> intersect(const Sphere& sphere, const Double3& o, const Double3& d,
                                double t_min, double t_max);
std::optional<double> intersect(const Disk& disk, const Double3& o, const Double3& d, double t_min,
                                double t_max);
std::optional<double> intersect(const Cylinder& cylinder, const Double3& o, const Double3& d,
                                double t_min, double t_max);

/// The surface at p, a point on (or, by rounding, near) it; the result's p lies on it.
SurfacePoint surface_point(const Sphere& sphere, const Double3& p);
SurfacePoint surface_point(const Disk& disk, const Double3& p);
SurfacePoint surface_point(const Cylinder& cylinder, const Double3& p);

double surface_area(const Sphere& sphere);
double surface_area(const Disk& disk);
double surface_area(const Cylinder& cylinder);

} // namespace faceta
