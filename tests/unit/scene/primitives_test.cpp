#include "base/error.h"
#include "hit_checks.h"
#include "scene/primitives.h"

#include <limits>
#include <numbers>

using namespace faceta;
using namespace faceta::double3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Shape> void expect_hit(const Shape& shape, const mitsuba::Hit& hit) {
  SCOPED_TRACE(hit.label);
  auto t = intersect(shape, hit.origin, hit.direction, 0, kInfinity);
  ASSERT_TRUE(t);
  // Mitsuba's rays carry unit directions.
  EXPECT_NEAR(*t * length(hit.direction), hit.t * length(hit.direction), 2e-5 * (1 + hit.t));
  expect_same_hit(surface_point(shape, add(hit.origin, scale(hit.direction, *t))), hit);
}

ToWorld scaling(double x, double y, double z) {
  return {x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1};
}

// Central differences of the position over uv: what dp_du and dp_dv claim to be.
template <class Shape>
void expect_tangents_are_derivatives(const Shape& shape, const Double3& start) {
  SurfacePoint hit = surface_point(shape, start);
  for (const Double3& direction : {hit.dp_du, hit.dp_dv}) {
    double h = 1e-5;
    SurfacePoint a = surface_point(shape, add(hit.p, scale(direction, -h)));
    SurfacePoint b = surface_point(shape, add(hit.p, scale(direction, h)));
    double du = (b.u - a.u) / (2 * h), dv = (b.v - a.v) / (2 * h);
    bool along_u = direction == hit.dp_du;
    EXPECT_NEAR(du, along_u ? 1 : 0, 1e-6);
    EXPECT_NEAR(dv, along_u ? 0 : 1, 1e-6);
  }
}

TEST(Sphere, HitsAsInMitsuba) {
  for (const mitsuba::Hit& hit : mitsuba::sphere) {
    Sphere sphere = make_sphere(hit.p0, hit.radius, hit.flip_normals, hit.to_world);
    expect_hit(sphere, hit);
    EXPECT_EQ(sphere.warning, "");
  }
}

TEST(Disk, HitsAsInMitsuba) {
  for (const mitsuba::Hit& hit : mitsuba::disk)
    expect_hit(make_disk(hit.flip_normals, hit.to_world), hit);
}

TEST(Cylinder, HitsAsInMitsuba) {
  for (const mitsuba::Hit& hit : mitsuba::cylinder)
    expect_hit(make_cylinder(hit.p0, hit.p1, hit.radius, hit.flip_normals, hit.to_world), hit);
}

template <class Make> void expect_mesh_hits(const std::vector<mitsuba::Hit>& hits, Make make) {
  for (const mitsuba::Hit& hit : hits) {
    SCOPED_TRACE(hit.label);
    Mesh mesh = make();
    mesh.flip_normals = hit.flip_normals;
    place(mesh, hit.to_world);
    expect_same_hit(surface_point(mesh, hit.triangle, hit.barycentric[0], hit.barycentric[1]), hit);
  }
}

TEST(Rectangle, HitsAsInMitsuba) {
  expect_mesh_hits(mitsuba::rectangle, make_rectangle);
}
TEST(Cube, HitsAsInMitsuba) {
  expect_mesh_hits(mitsuba::cube, make_cube);
}

TEST(Cube, FacesLookOutward) {
  Mesh cube = make_cube();
  ASSERT_EQ(cube.triangle_count(), 12u);
  for (uint32_t f = 0; f < 12; ++f) {
    SurfacePoint hit = surface_point(cube, f, 1. / 3, 1. / 3);
    EXPECT_GT(dot(hit.n, hit.p), 0.9);
    EXPECT_NEAR(dot(hit.n, hit.sh_n), 1, 1e-12);
  }
  place(cube, scaling(1, 2, 3));
  EXPECT_NEAR(surface_area(cube), 88, 1e-5);
}

TEST(Primitives, TangentsAreDerivatives) {
  ToWorld m = {.9, -.4, .3, 1, .5, .8, -.1, 2, -.2, .3, 1.1, 3, 0, 0, 0, 1};
  ToWorld rotation = {0, -1, 0, 1, 0, 0, -1, 2, 1, 0, 0, 3, 0, 0, 0, 1};
  expect_tangents_are_derivatives(make_sphere({0, 0, 0}, 2, false, rotation), {1.5, 3, 4.2});
  expect_tangents_are_derivatives(make_disk(false, m), {1.3, 2.5, 3.2});
  expect_tangents_are_derivatives(make_cylinder({0, 1, 0}, {1, 0, 3}, .7, false, m), {3, 4, 5});
}

TEST(Primitives, AreasAgreeWithGeometry) {
  // The first three also by Mitsuba 3.9.1: 36.316814, 6.2831855, 9.2258043.
  EXPECT_NEAR(surface_area(make_sphere({0, 0, 0}, 1.7, false, kIdentityToWorld)), 36.316811075,
              1e-8);
  EXPECT_NEAR(surface_area(make_disk(false, scaling(1, 2, 3))), 2 * kPi, 1e-12);
  EXPECT_NEAR(
      surface_area(make_cylinder({.1, .2, -.5}, {.3, -.4, 1.5}, .7, false, kIdentityToWorld)),
      2 * kPi * .7 * std::sqrt(4.4), 1e-12);
  // The elliptic tube: its perimeter is 4 a E(e).
  EXPECT_NEAR(surface_area(make_cylinder({0, 0, 0}, {0, 0, 1}, 1, false, scaling(1, 2, 3))),
              3 * 4 * 2 * std::comp_ellint_2(std::sqrt(0.75)), 1e-10);
}

TEST(Primitives, IntersectionKeepsToTheInterval) {
  Sphere sphere = make_sphere({0, 0, 0}, 1, false, kIdentityToWorld);
  EXPECT_NEAR(*intersect(sphere, {0, 0, 3}, {0, 0, -1}, 0, 10), 2, 1e-15);
  EXPECT_NEAR(*intersect(sphere, {0, 0, 3}, {0, 0, -1}, 2.5, 10), 4, 1e-15);
  EXPECT_FALSE(intersect(sphere, {0, 0, 3}, {0, 0, -1}, 0, 1.9));
  EXPECT_FALSE(intersect(sphere, {0, 0, 3}, {0, 0, 1}, 0, 10));
  EXPECT_FALSE(intersect(sphere, {0, 1.001, 3}, {0, 0, -1}, 0, 10));
  // From 1e6 away the hit is still good to 1e-9: nothing cancels.
  EXPECT_NEAR(*intersect(sphere, {0.6, 0, 1e6}, {0, 0, -1}, 0, kInfinity), 1e6 - 0.8, 1e-9);
  Cylinder tube = make_cylinder({0, 0, 0}, {0, 0, 1}, 1, false, kIdentityToWorld);
  EXPECT_NEAR(*intersect(tube, {3, 0, 1.5}, {-1, 0, -.3}, 0, 10), 2, 1e-12);
  EXPECT_NEAR(*intersect(tube, {3, 0, 2}, {-1, 0, -.4}, 0, 10), 4, 1e-12);
  EXPECT_FALSE(intersect(tube, {0, 0, 5}, {0, 0, -1}, 0, 10));
  Disk disk = make_disk(false, kIdentityToWorld);
  EXPECT_FALSE(intersect(disk, {0, 0, 1}, {1, 0, 0}, 0, kInfinity));
  EXPECT_FALSE(intersect(disk, {.8, .7, 1}, {0, 0, -1}, 0, kInfinity));
}

TEST(Primitives, WarnOfWhatTheyCannotFollow) {
  EXPECT_NE(make_sphere({0, 0, 0}, 1, false, scaling(1, 2, 1)).warning, "");
  EXPECT_NEAR(make_sphere({0, 0, 0}, 1, false, scaling(3, 2, 1)).radius, 3, 1e-15);
  EXPECT_NE(make_cylinder({0, 0, 0}, {0, 0, 1}, 1, false, scaling(1, 2, 1)).warning, "");
  EXPECT_EQ(make_cylinder({0, 0, 0}, {0, 0, 1}, 1, false, scaling(2, 2, 1)).warning, "");
}

TEST(Primitives, FlattenedDiskKeepsItsPlane) {
  Disk disk = make_disk(false, scaling(2, 3, 0));
  EXPECT_NEAR(*intersect(disk, {1.9, 0, 5}, {0, 0, -1}, 0, 10), 5, 1e-12);
  EXPECT_NEAR(disk.normal[2], 1, 1e-15);
}

TEST(Primitives, RefuseWhatHasNoSurface) {
  double nan = std::numeric_limits<double>::quiet_NaN();
  ToWorld projective = kIdentityToWorld;
  projective[12] = 0.1;
  EXPECT_THROW(make_sphere({0, 0, 0}, 0, false, kIdentityToWorld), Error);
  EXPECT_THROW(make_sphere({0, nan, 0}, 1, false, kIdentityToWorld), Error);
  EXPECT_THROW(make_sphere({0, 0, 0}, 1, false, scaling(1, 0, 1)), Error);
  EXPECT_THROW(make_sphere({0, 0, 0}, 1, false, scaling(1, kInfinity, 1)), Error);
  EXPECT_THROW(make_sphere({0, 0, 0}, 1, false, projective), Error);
  EXPECT_THROW(make_disk(false, scaling(1, 0, 1)), Error);
  EXPECT_THROW(make_cylinder({1, 1, 1}, {1, 1, 1}, 1, false, kIdentityToWorld), Error);
  EXPECT_THROW(make_cylinder({0, 0, 0}, {0, 0, 1}, nan, false, kIdentityToWorld), Error);
  EXPECT_THROW(make_cylinder({0, 0, 0}, {0, 0, 1}, 1, false, scaling(1, 1, 0)), Error);
}

TEST(OrthonormalBasis, IsOrthonormalEverywhere) {
  for (double theta : {0.0, 1e-9, 0.3, kPi / 2, 2.5, kPi - 1e-9, kPi})
    for (double phi : {0.0, 1.0, 2.0, 4.0}) {
      Double3 n = {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                   std::cos(theta)};
      Basis basis = orthonormal_basis(n);
      EXPECT_NEAR(length(basis.s), 1, 1e-14);
      EXPECT_NEAR(length(basis.t), 1, 1e-14);
      EXPECT_NEAR(dot(cross(basis.s, basis.t), n), 1, 1e-14);
    }
}

} // namespace
