#include "base/error.h"
#include "scene/light_bvh.h"
#include "test_models.h"
#include "view_math.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

using namespace faceta;
using namespace faceta::double3;

namespace {

constexpr double kPi = std::numbers::pi;

/// An upper bound of what arrives at p from a node, by angles (Pharr, Jakob and Humphreys 2023,
/// section 12.6.3): 0 only where nothing can.
double importance(const LightNode& node, const Double3& p) {
  Double3 offset = sub(p, test::load(node.center));
  double radius = std::sqrt(node.radius2), distance = length(offset);
  if (distance <= radius)
    return node.power / std::max(radius * radius, 1e-12);
  double angle = std::acos(std::clamp(dot(offset, test::load(node.axis)) / distance, -1.0, 1.0));
  double spread = std::acos(node.cos_spread), emission = std::acos(node.cos_emission);
  double left = angle - spread - std::asin(radius / distance);
  if (left >= emission + 1e-5)
    return 0;
  return node.power * std::max(0.0, std::cos(std::max(0.0, left))) / (distance * distance) + 1e-20;
}

/// The probabilities of all lights at p, by descending into every branch; the last entry is that of
/// ending above two children that both send nothing.
void descend(const LightNode* nodes, int node, double p_node, const Double3& p,
             std::vector<double>& result) {
  if (nodes[node].child < 0) {
    if (nodes[node].light >= 0)
      result[nodes[node].light] += p_node;
    return;
  }
  int child = nodes[node].child;
  double a = importance(nodes[child], p), b = importance(nodes[child + 1], p);
  if (!(a + b > 0)) {
    result.back() += p_node;
    return;
  }
  descend(nodes, child, p_node * a / (a + b), p, result);
  descend(nodes, child + 1, p_node * b / (a + b), p, result);
}

/// The probability of one light, along its trail.
double follow(const SceneView& view, const LightRecord& light, const Double3& p) {
  int node = 0;
  double probability = 1;
  for (int level = 0; level < light.depth; ++level) {
    int child = view.light_nodes[node].child;
    EXPECT_GE(child, 0);
    double a = importance(view.light_nodes[child], p);
    double b = importance(view.light_nodes[child + 1], p);
    bool second = light.trail >> level & 1;
    probability *= a + b > 0 ? (second ? b : a) / (a + b) : 0;
    node = child + (second ? 1 : 0);
  }
  EXPECT_EQ(view.light_nodes[node].light, &light - view.lights);
  return probability;
}

/// Lights of all kinds in the cube of side 10 about the origin.
void add_many_lights(Scene& scene, int rounds) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-1, 1);
  ShapeDesc shape = test::grey_shape(scene);
  for (int i = 0; i < rounds; ++i) {
    shape.emitter = test::emitter(std::exp(3 * number(random)), i % 5 ? 1 : 2);
    Double3 c{5 * number(random), 5 * number(random), 5 * number(random)};
    ToWorld m = {.3, -.1, 0, c[0], .1, .3, 0, c[1], 0, 0, .3162277660, c[2], 0, 0, 0, 1};
    scene.add_sphere(make_sphere(c, 0.1 + 0.1 * std::abs(number(random)), i % 2, kIdentityToWorld),
                     shape);
    scene.add_disk(make_disk(i % 2, m), shape);
    scene.add_cylinder(make_cylinder(c, {1, 2, 3}, 0.05, i % 2, kIdentityToWorld), shape);
    scene.add_point_light({c, {1, 2, 3}, 1});
    Mesh mesh = i % 2 ? make_rectangle() : make_cube();
    place(mesh, m);
    scene.add_mesh(mesh, shape, i % 2);
  }
}

TEST(LightTree, ProbabilitiesAddUpAndTrailsLeadToTheirLights) {
  Scene scene;
  add_many_lights(scene, 40);
  scene.build(Isa::scalar);
  const SceneView& view = scene.view();
  ASSERT_EQ(view.light_count, 40 * 4 + 20 * (1 + 12));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-8, 8);
  for (int i = 0; i < 50; ++i) {
    Double3 p{number(random), number(random), number(random)};
    std::vector<double> all(view.light_count + 1);
    descend(view.light_nodes, 0, 1, p, all);
    EXPECT_LT(all.back(), 0.1);
    double sum = all.back();
    for (int k = 0; k < view.light_count; ++k) {
      EXPECT_NEAR(follow(view, view.lights[k], p), all[k], 1e-9);
      sum += all[k];
    }
    EXPECT_NEAR(sum, 1, 1e-9);
  }
}

TEST(LightTree, LosesNoLightThatCanBeSeen) {
  Scene scene;
  add_many_lights(scene, 40);
  scene.build(Isa::scalar);
  const SceneView& view = scene.view();
  std::mt19937 random(8);
  std::uniform_real_distribution<double> number(-8, 8);
  int seen = 0;
  for (int i = 0; i < 50; ++i) {
    Double3 p{number(random), number(random), number(random)};
    for (int k = 0; k < view.light_count; ++k) {
      const LightRecord& l = view.lights[k];
      auto type = static_cast<LightType>(l.type);
      bool flat =
          type == LightType::triangle || type == LightType::rectangle || type == LightType::disk;
      if (flat && dot(sub(p, test::load(l.p)), test::load(l.n)) <= 0)
        continue;
      ++seen;
      EXPECT_GT(follow(view, l, p), 0);
    }
  }
  EXPECT_GT(seen, 5000);
}

TEST(LightTree, UnitedConesHoldBoth) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  auto direction = [&] { return normalize({normal(random), normal(random), normal(random)}); };
  int proper = 0;
  for (int i = 0; i < 2000; ++i) {
    LightBounds cones[2];
    for (LightBounds& c : cones) {
      c.axis = direction();
      c.cos_spread = std::cos(unit(random) * 1.5);
    }
    if (i % 3 == 0) // near one another, or equal, or opposite
      cones[1].axis = i % 9 ? cones[0].axis : scale(cones[0].axis, -1);
    LightBounds both = unite(cones[0], cones[1]);
    double spread = std::acos(both.cos_spread);
    proper += both.cos_spread > -1;
    for (const LightBounds& c : cones) {
      // The direction of the cone that is farthest from the common axis.
      double between = std::atan2(length(cross(both.axis, c.axis)), dot(both.axis, c.axis));
      EXPECT_GE(spread + 1e-9, std::min(kPi, between + std::acos(c.cos_spread)));
    }
    EXPECT_NEAR(length(both.axis), 1, 1e-12);
  }
  EXPECT_GT(proper, 1000);
}

/// The leaves below a node.
void collect(const LightNode* nodes, int node, std::vector<const LightNode*>& leaves) {
  if (nodes[node].child < 0)
    leaves.push_back(nodes + node);
  else
    for (int k : {0, 1})
      collect(nodes, nodes[node].child + k, leaves);
}

/// Points that enclose a light or lie on its rim.
std::vector<Double3> extremes(const SceneView& view, const LightRecord& l) {
  Double3 p = test::load(l.p), a = add(p, test::load(l.e1)), b = add(p, test::load(l.e2));
  auto type = static_cast<LightType>(l.type);
  if (type == LightType::triangle)
    return {p, a, b};
  if (type == LightType::rectangle)
    return {p, a, b, sub(add(a, b), p)};
  if (type == LightType::point)
    return {p};
  std::vector<Double3> points;
  if (type == LightType::sphere) {
    for (int corner = 0; corner < 8; ++corner) {
      points.push_back(p);
      for (int k = 0; k < 3; ++k)
        points.back()[k] += corner >> k & 1 ? l.radius : -l.radius;
    }
    return points;
  }
  const float* m = view.quadrics[l.primitive].to_world;
  for (int i = 0; i < 64; ++i) {
    double phi = 2 * kPi * i / 32, z = type == LightType::cylinder ? i / 32 : 0;
    Double3 q;
    for (int k = 0; k < 3; ++k)
      q[k] =
          m[4 * k] * std::cos(phi) + m[4 * k + 1] * std::sin(phi) + m[4 * k + 2] * z + m[4 * k + 3];
    points.push_back(q);
  }
  return points;
}

TEST(LightTree, NodesBoundTheirLights) {
  Scene scene;
  add_many_lights(scene, 40);
  scene.build(Isa::scalar);
  const LightNode* nodes = scene.view().light_nodes;
  int inner = 0, cones = 0, count = 2 * scene.view().light_count - 1;
  for (int i = 0; i < count; ++i) {
    const LightNode& n = nodes[i];
    EXPECT_NE(n.child < 0, n.light < 0);
    inner += n.child >= 0;
    cones += n.child >= 0 && n.cos_spread > -1;
    std::vector<const LightNode*> leaves;
    collect(nodes, i, leaves);
    double power = 0;
    for (const LightNode* leaf : leaves) {
      power += leaf->power;
      for (const Double3& p : extremes(scene.view(), scene.view().lights[leaf->light]))
        EXPECT_LE(length(sub(p, test::load(n.center))), std::sqrt(n.radius2) + 1e-6);
      EXPECT_NEAR(n.sin_spread, std::sqrt(1 - n.cos_spread * n.cos_spread), 1e-6);
      if (n.cos_spread <= -1)
        continue;
      Double3 a = test::load(n.axis), b = test::load(leaf->axis);
      double between = std::atan2(length(cross(a, b)), dot(a, b));
      EXPECT_GE(std::acos(n.cos_spread) + 1e-5, between + std::acos(leaf->cos_spread));
    }
    EXPECT_NEAR(n.power, power, 1e-5 * power);
  }
  EXPECT_EQ(inner, scene.view().light_count - 1);
  EXPECT_GT(cones, 20);
}

TEST(LightTree, LevelsFitIntoATrail) {
  // Centres and powers that fall by powers of two would make a list of a tree.
  std::vector<LightBounds> lights;
  for (int i = 0; i < 3000; ++i) {
    double x = std::ldexp(1.0, -(i % 500));
    lights.push_back({.low = {x, 0, 0}, .high = {x, 0, 0}, .power = std::ldexp(1.0, i % 60)});
  }
  LightTree tree = build_light_tree(lights);
  EXPECT_EQ(tree.nodes.size(), 5999u);
  int deepest = 0;
  for (const LightTree::Trail& t : tree.trails)
    deepest = std::max(deepest, t.depth);
  EXPECT_LE(deepest, 32);
  EXPECT_GE(deepest, 12);
  // Equal lights cannot be told apart, but are halved.
  tree = build_light_tree(std::vector<LightBounds>(1024, LightBounds{.power = 1}));
  for (const LightTree::Trail& t : tree.trails)
    EXPECT_EQ(t.depth, 10);
}

TEST(LightTree, OneLightIsTheRoot) {
  Scene scene;
  scene.add_point_light({{1, 2, 3}, {1, 1, 1}, 1});
  scene.build(Isa::scalar);
  EXPECT_EQ(scene.view().light_nodes[0].light, 0);
  EXPECT_EQ(scene.view().light_nodes[0].child, -1);
  EXPECT_EQ(scene.view().lights[0].depth, 0);
  EXPECT_FLOAT_EQ(scene.view().light_nodes[0].power, static_cast<float>(4 * kPi));
}

TEST(Lights, WithoutWeightOrPowerAreNeverChosen) {
  Scene scene;
  ShapeDesc shape = test::grey_shape(scene);
  shape.emitter = test::emitter(1, 0);
  scene.add_mesh(make_rectangle(), shape, true);
  shape.emitter = test::emitter(2);
  scene.add_sphere(make_sphere({0, 0, 5}, 1, false, kIdentityToWorld), shape);
  shape.emitter = test::emitter(0);
  scene.add_disk(make_disk(false, kIdentityToWorld), shape);
  shape.emitter = test::emitter(3);
  // Elliptic: (phi, z) is not uniform on it.
  scene.add_cylinder(make_cylinder({0, 0, 0}, {0, 0, 1}, 1, false,
                                   {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}),
                     shape);
  scene.build(Isa::scalar);
  const SceneView& v = scene.view();
  ASSERT_EQ(v.light_count, 4);
  EXPECT_EQ(v.light_nodes[0].light, 0);
  EXPECT_EQ(v.lights[0].type, static_cast<int32_t>(LightType::sphere));
  EXPECT_EQ(v.lights[0].depth, 0);
  for (int k = 1; k < 4; ++k)
    EXPECT_EQ(v.lights[k].depth, -1);
  // Shapes point at their own lights, which shine when met.
  EXPECT_EQ(v.lights[v.triangles[0].light].radiance[0], 1);
  EXPECT_EQ(v.triangles[0].light, v.triangles[1].light);
  EXPECT_EQ(v.quadrics[0].light, 0);
  EXPECT_EQ(v.lights[v.quadrics[1].light].radiance[0], 0);
  EXPECT_EQ(v.lights[v.quadrics[2].light].radiance[0], 3);
}

/// Points of a flat light's own parametrisation against hits of the shape it belongs to.
void expect_same_surface(const SceneView& v, int light) {
  const LightRecord& l = v.lights[light];
  Double3 n = test::load(l.n);
  EXPECT_NEAR(length(n), 1, 1e-6);
  for (double b1 : {0.1, 0.3, 0.6})
    for (double b2 : {0.05, 0.35}) {
      Double3 q =
          add(test::load(l.p), add(scale(test::load(l.e1), b1), scale(test::load(l.e2), b2)));
      // From in front: the side that emits is the side of the shading normal.
      Double3 o = add(q, n), d = scale(n, -1);
      test::Hit hit = test::trace(v, o, d);
      ASSERT_EQ(hit.geometry, 0);
      EXPECT_EQ(v.triangles[hit.primitive].light, light);
      SurfacePoint s = test::surface(v, hit, o, d);
      EXPECT_GT(dot(s.sh_n, n), 0.9);
      EXPECT_NEAR(s.u, l.uv0[0] + b1 * l.duv1[0] + b2 * l.duv2[0], 1e-5);
      EXPECT_NEAR(s.v, l.uv0[1] + b1 * l.duv1[1] + b2 * l.duv2[1], 1e-5);
    }
}

TEST(Lights, RectanglesAndTrianglesLieOnTheirShapes) {
  ToWorld turned = {.6, 1.6, 0, 1, -.8, 1.2, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1};
  ToWorld sheared = {1, .5, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  ToWorld mirrored = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  for (const ToWorld& m : {kIdentityToWorld, turned, sheared, mirrored})
    for (bool flip : {false, true})
      for (bool rectangle : {false, true}) {
        Scene scene;
        ShapeDesc shape = test::grey_shape(scene);
        shape.emitter = test::emitter(1);
        Mesh mesh = make_rectangle();
        mesh.flip_normals = flip;
        place(mesh, m);
        scene.add_mesh(mesh, shape, rectangle);
        scene.build(Isa::scalar);
        const SceneView& v = scene.view();
        bool one = rectangle && m != sheared;
        ASSERT_EQ(v.light_count, one ? 1 : 2);
        double area = 0;
        for (int k = 0; k < v.light_count; ++k) {
          expect_same_surface(v, k);
          area += v.lights[k].area;
        }
        EXPECT_NEAR(area, surface_area(mesh), 1e-5);
        EXPECT_NEAR(v.light_nodes[0].power, kPi * area, 1e-4);
      }
}

TEST(Lights, QuadricRecordsHoldTheirShapes) {
  Scene scene;
  ShapeDesc shape = test::grey_shape(scene);
  shape.emitter = test::emitter(1);
  Sphere sphere = make_sphere({1, 2, 3}, 2, true, kIdentityToWorld);
  Disk disk = make_disk(true, {2, 0, 0, 5, 0, 0, -2, 6, 0, 2, 0, 7, 0, 0, 0, 1});
  Cylinder tube = make_cylinder({0, 0, 0}, {0, 3, 0}, 0.5, false, kIdentityToWorld);
  scene.add_sphere(sphere, shape);
  scene.add_disk(disk, shape);
  scene.add_cylinder(tube, shape);
  scene.build(Isa::scalar);
  const SceneView& v = scene.view();
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(v.lights[v.quadrics[k].light].primitive, k);
  const LightRecord& s = v.lights[v.quadrics[0].light];
  EXPECT_EQ(s.radius, 2);
  EXPECT_EQ(s.n[0], -1); // emits inward
  EXPECT_NEAR(s.area, 16 * kPi, 1e-4);
  const LightRecord& d = v.lights[v.quadrics[1].light];
  EXPECT_NEAR(d.area, 4 * kPi, 1e-5);
  EXPECT_NEAR(d.n[1], 1, 1e-6); // the disk's z axis is -y, flipped
  EXPECT_EQ(d.duv1[0], 1);
  EXPECT_EQ(d.duv2[1], 1);
  EXPECT_NEAR(v.lights[v.quadrics[2].light].area, 3 * kPi, 1e-5);
  EXPECT_NEAR(v.light_nodes[0].power, kPi * (16 + 4 + 3) * kPi, 1e-3);
}

TEST(Lights, TexturesFactorIntoPower) {
  Scene scene;
  TextureDesc texture;
  texture.color[0] = {2, 2, 2};
  ShapeDesc shape = test::grey_shape(scene);
  shape.emitter = test::emitter(77, 3);
  shape.emitter->radiance.texture = scene.add_texture(texture);
  scene.add_mesh(make_rectangle(), shape, true);
  scene.build(Isa::scalar);
  const LightRecord& l = scene.view().lights[0];
  EXPECT_EQ(l.texture, 0);
  EXPECT_EQ(l.radiance[0], 1);
  EXPECT_NEAR(scene.view().light_nodes[0].power, 3 * 2 * kPi * 4, 1e-4);
}

TEST(Lights, RefuseWhatIsNoLight) {
  Scene scene;
  ShapeDesc shape = test::grey_shape(scene);
  shape.emitter = test::emitter(1, -1);
  EXPECT_THROW(scene.add_mesh(make_rectangle(), shape), Error);
  shape.emitter = test::emitter(INFINITY);
  EXPECT_THROW(scene.add_mesh(make_rectangle(), shape), Error);
  shape.emitter = test::emitter(1);
  shape.emitter->radiance.texture = 3;
  EXPECT_THROW(scene.add_mesh(make_rectangle(), shape), Error);
  EXPECT_THROW(scene.add_point_light({{NAN, 0, 0}, {1, 1, 1}, 1}), Error);
}

} // namespace
