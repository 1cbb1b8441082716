#include "base/error.h"
#include "hit_checks.h"
#include "scene/mesh.h"

#include <limits>

using namespace faceta;
using namespace faceta::double3;

namespace {

ToWorld scaling(double x, double y, double z) {
  return {x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1};
}

void expect_near_list(const std::vector<float>& ours, const std::vector<double>& theirs,
                      double tolerance) {
  ASSERT_EQ(ours.size(), theirs.size());
  for (size_t i = 0; i < ours.size(); ++i)
    EXPECT_NEAR(ours[i], theirs[i], tolerance) << i;
}

// The triangle that the rays of mitsuba_hits.h were shot at.
Mesh triangle(bool with_uvs, bool flat_uvs, bool with_normals) {
  Mesh mesh;
  mesh.positions = {0, 0, 0, 2, 0, .5, 0, 2, -.3f};
  mesh.indices = {0, 1, 2};
  if (with_uvs) // as the file has them, v turned over
    mesh.uvs = {.1f, .8f, .8f, .7f, .4f, .1f};
  if (flat_uvs)
    mesh.uvs = {.25, .5, .5, .5, .75, .5};
  if (with_normals)
    mesh.normals = {0, .2f, 1, .3f, 0, 1, -.3f, .1f, 2};
  return mesh;
}

void expect_hits(const std::vector<mitsuba::Hit>& hits, const Mesh& object) {
  for (const mitsuba::Hit& hit : hits) {
    SCOPED_TRACE(hit.label);
    Mesh mesh = object;
    mesh.flip_normals = hit.flip_normals;
    transform(mesh, kIdentityToWorld); // file readers hand over unit normals
    place(mesh, hit.to_world);
    expect_same_hit(surface_point(mesh, hit.triangle, hit.barycentric[0], hit.barycentric[1]), hit);
  }
}

TEST(Mesh, PlainTriangleHitsAsInMitsuba) {
  expect_hits(mitsuba::plain, triangle(false, false, false));
}
TEST(Mesh, TriangleWithUvsHitsAsInMitsuba) {
  expect_hits(mitsuba::uv, triangle(true, false, false));
}
TEST(Mesh, TriangleWithFlatUvsHitsAsInMitsuba) {
  expect_hits(mitsuba::flatuv, triangle(false, true, false));
}
TEST(Mesh, TriangleWithNormalsHitsAsInMitsuba) {
  expect_hits(mitsuba::normals, triangle(false, false, true));
}
TEST(Mesh, TriangleWithBothHitsAsInMitsuba) {
  expect_hits(mitsuba::both, triangle(true, false, true));
}

Mesh tent() {
  Mesh mesh;
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, .3f, 1};
  mesh.indices = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 4};
  return mesh;
}

TEST(Mesh, ComputedNormalsAreMitsubas) {
  Mesh mesh = tent();
  place(mesh, kIdentityToWorld);
  // vertex_normals of this mesh, Mitsuba 3.9.1
  expect_near_list(mesh.normals,
                   {0.57735026, 0.57735026, 0.57735026, -0.1445763, 0.76822156, 0.62364525,
                    0.70710683, 0, 0.70710683, -0.23258792, 0.56151664, -0.79410458, -0.70710677, 0,
                    -0.70710677},
                   3e-7);
}

TEST(Mesh, NormalsAreComputedInTheWorld) {
  Mesh mesh = tent();
  place(mesh, scaling(-1, 2, 1.5));
  // vertex_normals after to_world = scale(-1, 2, 1.5), Mitsuba 3.9.1
  expect_near_list(mesh.normals,
                   {0.57735026, -0.57735026, -0.57735026, -0.19392709, -0.71294498, -0.6738708,
                    0.8113389, 0, -0.58457601, -0.3397229, -0.52611297, 0.77961111, -0.83205026, 0,
                    0.5547002},
                   3e-7);
}

TEST(Mesh, FaceNormalsDropVertexNormals) {
  Mesh mesh = triangle(true, false, true);
  mesh.face_normals = true;
  place(mesh, kIdentityToWorld);
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_EQ(mesh.uvs.size(), 6u);
  SurfacePoint hit = surface_point(mesh, 0, .2, .3);
  EXPECT_EQ(hit.n, hit.sh_n);
}

TEST(Mesh, MirroredMeshKeepsWindingAndNormals) {
  Mesh mesh = triangle(false, false, false);
  mesh.normals = {0, 0, 1, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f};
  place(mesh, scaling(-1, 1, 1));
  // vertex_normals and faces in Mitsuba 3.9.1: unchanged
  expect_near_list(mesh.normals, {0, 0, 1, 0, .6, .8, 0, .6, .8}, 1e-7);
  EXPECT_EQ(mesh.indices, (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_LT(face_normal(mesh, 0)[2], 0);
}

TEST(Mesh, MissingNormalsAreFilledIn) {
  Mesh mesh = tent();
  mesh.normals.assign(15, 0.0f);
  mesh.normals[6] = 1; // one vertex has its own
  place(mesh, kIdentityToWorld);
  EXPECT_EQ(mesh.normals[6], 1.0f);
  EXPECT_NEAR(mesh.normals[0], 0.57735026, 3e-7);
}

TEST(Mesh, DegenerateTrianglesAreHarmless) {
  Mesh mesh = tent();
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 2, 2, 2});
  Mesh clean = tent();
  place(mesh, kIdentityToWorld);
  place(clean, kIdentityToWorld);
  EXPECT_EQ(mesh.normals, clean.normals);
  EXPECT_EQ(triangle_area(mesh, 4), 0);
  EXPECT_EQ(surface_area(mesh), surface_area(clean));
  EXPECT_EQ(face_normal(mesh, 5), (Double3{0, 0, 0}));
  mesh.indices = {0, 0, 1};
  compute_vertex_normals(mesh);
  EXPECT_EQ(mesh.normals[0], 1.0f); // Mitsuba 3.9.1: (1, 0, 0)
  EXPECT_EQ(mesh.normals[1], 0.0f);
}

TEST(Mesh, SheetsModelledTwiceKeepANormal) {
  Mesh mesh = triangle(false, false, false);
  mesh.indices = {0, 1, 2, 1, 0, 2};
  Double3 n = face_normal(mesh, 0);
  compute_vertex_normals(mesh);
  for (size_t i = 0; i < mesh.normals.size(); ++i)
    EXPECT_NEAR(mesh.normals[i], n[i % 3], 1e-7);
}

TEST(Mesh, FlatteningLeavesFiniteNormals) {
  Mesh mesh = tent();
  mesh.normals = {1, 0, 0, 0, 0, 1, .6f, 0, .8f, 1, 0, 0, 0, 1, 0};
  place(mesh, scaling(1, 1, 0));
  for (size_t i = 0; i < mesh.vertex_count(); ++i) {
    Double3 n = {mesh.normals[3 * i], mesh.normals[3 * i + 1], mesh.normals[3 * i + 2]};
    EXPECT_NEAR(length(n), 1, 1e-6) << i;
  }
  EXPECT_EQ(mesh.normals[8], 1.0f); // (.6, 0, .8) has nothing left but z
}

TEST(Mesh, NormalsFollowTheInverseTranspose) {
  Mesh mesh = triangle(false, false, false);
  compute_vertex_normals(mesh);
  ToWorld m = {.9, -.4, .3, 1, .5, .8, -.1, 2, -.2, .3, 1.1, 3, 0, 0, 0, 1};
  transform(mesh, m);
  Double3 n = {mesh.normals[0], mesh.normals[1], mesh.normals[2]};
  EXPECT_NEAR(dot(n, face_normal(mesh, 0)), 1, 1e-6);
}

TEST(Mesh, RefusesBadTransforms) {
  Mesh mesh = tent();
  ToWorld m = kIdentityToWorld;
  m[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(place(mesh, m), Error);
  m = kIdentityToWorld;
  m[13] = 1;
  EXPECT_THROW(place(mesh, m), Error);
  EXPECT_THROW(place(mesh, scaling(1e39, 1, 1)), Error);
}

TEST(Mesh, OpposedNormalsFallBackToTheFace) {
  Mesh mesh = triangle(false, false, false);
  mesh.normals = {0, 0, 1, 0, 0, -1, 0, 0, 1};
  SurfacePoint hit = surface_point(mesh, 0, .5, 0);
  EXPECT_EQ(hit.sh_n, hit.n);
}

} // namespace
