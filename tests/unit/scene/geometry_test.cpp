#include "hit_checks.h"
#include "scene/geometry.h"
#include "test_models.h"
#include "view_math.h"

#include <random>

using namespace faceta;
using namespace faceta::double3;

namespace {

/// Shoots Mitsuba's ray at the shape alone in a scene and compares the whole way: Embree, records,
/// frames.
template <class Add> void expect_hit(const mitsuba::Hit& hit, int geometry, Add add_shape) {
  SCOPED_TRACE(hit.label);
  Scene scene;
  add_shape(scene, test::grey_shape(scene));
  scene.build(Isa::scalar);
  Double3 d = normalize(hit.direction);
  for (int packet : {1, 8}) {
    test::Hit found = test::trace(scene.view(), hit.origin, d, packet);
    ASSERT_EQ(found.geometry, geometry);
    SurfacePoint s = test::surface(scene.view(), found, hit.origin, d);
    expect_near3(s.p, hit.p, "p");
    expect_near3(s.n, hit.n, "n");
    expect_near3(s.sh_n, hit.sh_n, "sh_n");
    EXPECT_NEAR(s.u, hit.uv[0], 1e-5);
    EXPECT_NEAR(s.v, hit.uv[1], 1e-5);
    if (geometry == 0)
      expect_near3(s.dp_du, hit.dp_du, "dp_du");
    expect_near3(s.s, hit.s, "s");
    expect_near3(s.t, hit.t_axis, "t");
    EXPECT_TRUE(test::occluded(scene.view(), hit.origin, d, found.t * 1.001));
    EXPECT_FALSE(test::occluded(scene.view(), hit.origin, d, found.t * 0.999));
  }
}

TEST(SceneGeometry, SpheresAreHitAsInMitsuba) {
  for (const mitsuba::Hit& hit : mitsuba::sphere)
    expect_hit(hit, 1, [&](Scene& scene, const ShapeDesc& shape) {
      scene.add_sphere(make_sphere(hit.p0, hit.radius, hit.flip_normals, hit.to_world), shape);
    });
}

TEST(SceneGeometry, DisksAreHitAsInMitsuba) {
  for (const mitsuba::Hit& hit : mitsuba::disk)
    expect_hit(hit, 1, [&](Scene& scene, const ShapeDesc& shape) {
      scene.add_disk(make_disk(hit.flip_normals, hit.to_world), shape);
    });
}

TEST(SceneGeometry, CylindersAreHitAsInMitsuba) {
  for (const mitsuba::Hit& hit : mitsuba::cylinder)
    expect_hit(hit, 1, [&](Scene& scene, const ShapeDesc& shape) {
      scene.add_cylinder(make_cylinder(hit.p0, hit.p1, hit.radius, hit.flip_normals, hit.to_world),
                         shape);
    });
}

TEST(SceneGeometry, MeshesAreHitAsInMitsuba) {
  for (bool cube : {false, true})
    for (const mitsuba::Hit& hit : cube ? mitsuba::cube : mitsuba::rectangle)
      expect_hit(hit, 0, [&](Scene& scene, const ShapeDesc& shape) {
        Mesh mesh = cube ? make_cube() : make_rectangle();
        mesh.flip_normals = hit.flip_normals;
        place(mesh, hit.to_world);
        scene.add_mesh(mesh, shape);
      });
}

/// Three random triangles, with or without normals and uvs.
Mesh random_mesh(std::mt19937& random, bool normals, bool uvs, bool flip) {
  std::uniform_real_distribution<float> number(-1, 1);
  Mesh mesh;
  mesh.flip_normals = flip;
  for (int i = 0; i < 9; ++i) {
    Double3 n = normalize({number(random), number(random), 1.5});
    for (int k = 0; k < 3; ++k) {
      mesh.positions.push_back(number(random) + 4 * static_cast<float>(i / 3));
      if (normals)
        mesh.normals.push_back(static_cast<float>(n[k]));
    }
    for (int k = 0; k < 2 && uvs; ++k)
      mesh.uvs.push_back(number(random));
    mesh.indices.push_back(i);
  }
  if (uvs)
    for (int i : {6, 7, 8}) // the last triangle has one uv for all: no tangents
      mesh.uvs[2 * i] = mesh.uvs[2 * i + 1] = 0.5f;
  return mesh;
}

TEST(SceneGeometry, TriangleRecordsGiveTheMeshesPoints) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 0.5);
  for (int kind = 0; kind < 8; ++kind) {
    SCOPED_TRACE(kind);
    Mesh mesh = random_mesh(random, kind & 1, kind & 2, kind & 4);
    Scene scene;
    scene.add_mesh(mesh, test::grey_shape(scene));
    scene.build(Isa::scalar);
    for (uint32_t f = 0; f < 3; ++f) {
      SurfacePoint expected = surface_point(mesh, f, unit(random), unit(random));
      Double3 d = scale(face_normal(mesh, f), -1), o = sub(expected.p, scale(d, 0.5));
      SurfacePoint s = test::surface(scene.view(), {0, static_cast<int>(f), 0.5}, o, d);
      expect_near3(s.p, expected.p, "p");
      expect_near3(s.n, expected.n, "n");
      expect_near3(s.sh_n, expected.sh_n, "sh_n");
      EXPECT_NEAR(s.u, expected.u, 1e-5);
      EXPECT_NEAR(s.v, expected.v, 1e-5);
      expect_near3(s.s, expected.s, "s");
      expect_near3(s.t, expected.t, "t");
    }
  }
}

TEST(SceneGeometry, QuadricsAgreeWithThePrimitives) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  ToWorld m = {.9, -.4, .3, 1, .5, .8, -.1, 2, -.2, .3, 1.1, 3, 0, 0, 0, 1};
  ToWorld rotation = {0, -2, 0, 1, 0, 0, -2, 2, 2, 0, 0, 3, 0, 0, 0, 1};
  Sphere sphere = make_sphere({0, 0.5, 0}, 1.3, false, rotation);
  Disk disk = make_disk(false, m);
  Cylinder cylinder = make_cylinder({0, 1, 0}, {1, 0, 3}, .7, false, m);
  SceneGeometry g;
  g.add(sphere, 0);
  g.add(disk, 0);
  g.add(cylinder, 0);
  int hits[3] = {};
  for (int i = 0; i < 3000; ++i) {
    Double3 o{5 * normal(random), 5 * normal(random), 5 * normal(random)};
    Double3 target{1 + normal(random), 2 + normal(random), 3 + normal(random)};
    Double3 d = sub(target, o);
    double low = i % 3 ? 0 : 0.9, high = i % 2 ? 1.2 : 1e30;
    std::optional<double> expected[3] = {intersect(sphere, o, d, low, high),
                                         intersect(disk, o, d, low, high),
                                         intersect(cylinder, o, d, low, high)};
    for (int k = 0; k < 3; ++k) {
      double t = intersect(g.quadric_shapes[k], o, d, low, high);
      ASSERT_EQ(t >= 0, expected[k].has_value());
      if (!expected[k])
        continue;
      ++hits[k];
      EXPECT_NEAR(t, *expected[k], 1e-9);
      Double3 p = add(o, scale(d, t));
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(p[c], g.quadric_shapes[k].box.low[c] - 1e-9);
        EXPECT_LE(p[c], g.quadric_shapes[k].box.high[c] + 1e-9);
      }
    }
  }
  for (int count : hits)
    EXPECT_GT(count, 200);
}

TEST(SceneGeometry, EmptySceneHasNothingToHitAndValidArrays) {
  Scene scene;
  scene.build(Isa::scalar);
  const SceneView& v = scene.view();
  EXPECT_EQ(test::trace(v, {0, 0, 0}, {0, 0, 1}).geometry, -1);
  EXPECT_NE(v.triangles, nullptr);
  EXPECT_NE(v.quadrics, nullptr);
  EXPECT_NE(v.lights, nullptr);
  EXPECT_EQ(v.light_nodes[0].child, -1);
  EXPECT_EQ(v.light_nodes[0].light, -1);
  EXPECT_EQ(v.environment.present, 0);
  EXPECT_EQ(v.environment.probability, 0);
}

TEST(SceneGeometry, KnowsItsBoundsAndCounts) {
  Scene scene;
  ShapeDesc shape = test::grey_shape(scene);
  scene.add_mesh(make_cube(), shape);
  scene.add_sphere(make_sphere({4, 0, 0}, 1, false, kIdentityToWorld), shape);
  scene.build(Isa::scalar);
  const EnvironmentView& e = scene.view().environment;
  EXPECT_FLOAT_EQ(e.center[0], 2);
  EXPECT_FLOAT_EQ(e.scene_radius, std::sqrt(9.0f + 1 + 1));
  SceneStatistics s = scene.statistics();
  EXPECT_EQ(s.triangles, 12u);
  EXPECT_EQ(s.quadrics, 1u);
  EXPECT_EQ(s.materials, 1u);
  EXPECT_EQ(s.lights, 0u);
  EXPECT_GT(s.bytes, 13 * sizeof(TriangleRecord));
  // With both geometries the nearer one is found.
  EXPECT_EQ(test::trace(scene.view(), {10, 0.1, 0}, {-1, 0, 0}).geometry, 1);
  EXPECT_EQ(test::trace(scene.view(), {-10, 0.1, 0}, {1, 0, 0}).geometry, 0);
}

} // namespace
