#include "materials/builtin.h"
#include "render/render.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace faceta;

namespace {

using Node = std::shared_ptr<MaterialNode>;
using Kind = MaterialNode::Kind;

Node model(const char* name, double reflectance = -1) {
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(Registry::global().get(name));
  if (reflectance >= 0)
    node->parameters->set_number("reflectance", reflectance);
  return node;
}

Node null_node() {
  auto node = std::make_shared<MaterialNode>();
  node->kind = Kind::null;
  return node;
}

Node mask(double opacity, Node child) {
  auto node = std::make_shared<MaterialNode>();
  node->kind = Kind::mask;
  node->weight.value = {opacity, opacity, opacity};
  node->children = {child};
  return node;
}

std::shared_ptr<AreaEmitter> emitter(double radiance) {
  auto e = std::make_shared<AreaEmitter>();
  e->radiance.value = {radiance, radiance, radiance};
  return e;
}

/// Squares that fill the view, the first nearest to the camera at z = 4, facing it.
struct Stack {
  std::vector<Node> materials;
  bool environment = false, last_emits = false;
};

void fill(Scene& scene, const Stack& stack) {
  for (size_t i = 0; i < stack.materials.size(); ++i) {
    ShapeDesc shape;
    shape.material = scene.add_material(stack.materials[i]);
    if (stack.last_emits && i + 1 == stack.materials.size())
      shape.emitter = emitter(3);
    Mesh mesh = make_rectangle();
    place(mesh, {9, 0, 0, 0, 0, 9, 0, 0, 0, 0, 1, -double(i), 0, 0, 0, 1});
    scene.add_mesh(mesh, shape, true);
  }
  if (stack.environment)
    scene.set_environment(EnvironmentDesc{});
}

/// The mean over a small picture, of a camera at (0, 0, 4) that looks down z.
struct Mean {
  double radiance, alpha, error;
};
Mean picture(Scene& scene, const IntegratorDesc& integrator, int spp) {
  scene.build(best_isa());
  CameraDesc camera;
  camera.to_world = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 4, 0, 0, 0, 1};
  camera.x_fov = 30;
  FilmDesc film;
  film.width = film.height = film.crop_width = film.crop_height = 16;
  film.filter.type = FilterType::box;
  scene.use_sensor(camera, film);
  RenderOptions options;
  options.settings = render_settings(integrator, SamplerDesc{"independent", spp, 0});
  options.spp = spp;
  options.threads = 2;
  Film f = render(scene, options).film;
  Image variance = f.variance();
  Mean m{};
  for (int i = 0; i < 256; ++i) {
    m.radiance += f.sums[4 * i] / double(f.samples) / 256;
    m.alpha += f.sums[4 * i + 3] / double(f.samples) / 256;
    m.error += variance.data[3 * i] / (256.0 * 256);
  }
  m.error = std::sqrt(m.error);
  return m;
}

Mean picture(const Stack& stack, const IntegratorDesc& integrator, int spp = 64) {
  Scene scene;
  fill(scene, stack);
  return picture(scene, integrator, spp);
}

IntegratorDesc path(int max_depth = -1, bool hide = false) {
  IntegratorDesc d;
  d.max_depth = max_depth;
  d.hide_emitters = hide;
  return d;
}

} // namespace

// Inside a sphere that emits L and reflects a share r of what arrives, L / (1 - r) is seen.
TEST(RussianRoulette, LeavesTheMeanOfAFurnace) {
  for (double albedo : {0.5, 0.8})
    for (int rr_depth : {1, 2, 5, 20}) {
      Scene scene;
      ShapeDesc shape;
      shape.material = scene.add_material(model("diffuse", albedo));
      shape.emitter = emitter(1);
      scene.add_sphere(make_sphere({0, 0, 0}, 6, true, kIdentityToWorld), shape);
      IntegratorDesc integrator;
      integrator.rr_depth = rr_depth;
      Mean m = picture(scene, integrator, 128);
      EXPECT_NEAR(m.radiance, 1 / (1 - albedo), 4 * m.error + 1e-4) << "rr_depth " << rr_depth;
      EXPECT_LT(m.error, 0.02 / (1 - albedo));
      if (rr_depth == 1) {
        EXPECT_GT(m.error, 1e-4); // it did play
      }
    }
}

// Radiance grows by eta^2 inside of glass: roulette must not take that for a bright path.
TEST(RussianRoulette, LeavesGlassInvisibleInAWhiteWorld) {
  for (int rr_depth : {1, 3, 1000}) {
    Scene scene;
    ShapeDesc shape;
    shape.material = scene.add_material(model("dielectric"));
    scene.add_sphere(make_sphere({0, 0, 0}, 1.5, false, kIdentityToWorld), shape);
    scene.set_environment(EnvironmentDesc{});
    IntegratorDesc integrator;
    integrator.rr_depth = rr_depth;
    Mean m = picture(scene, integrator, 128);
    EXPECT_NEAR(m.radiance, 1, 4 * m.error + 1e-4) << "rr_depth " << rr_depth;
  }
}

TEST(HideEmitters, LampsAreSeenThroughButShine) {
  // A lamp before a wall, and the same wall lit by the lamp alone.
  auto build = [](bool lamp_faces_camera) {
    Stack stack{{model("diffuse", 0.5)}};
    auto scene = std::make_unique<Scene>();
    fill(*scene, stack);
    ShapeDesc shape;
    shape.material = scene->add_material(model("diffuse", 0));
    shape.emitter = emitter(5);
    Mesh mesh = make_rectangle();
    double z = lamp_faces_camera ? 1 : -1;
    place(mesh, {1, 0, 0, 0, 0, z, 0, 0, 0, 0, z, 2, 0, 0, 0, 1});
    scene->add_mesh(mesh, shape, true);
    return scene;
  };
  EXPECT_GT(picture(*build(true), path(), 16).radiance, 1);
  EXPECT_EQ(picture(*build(true), path(-1, true), 16).radiance, 0); // the lit side is its other one
  // A lamp that faces the wall hides part of it; hidden, all of the wall is seen.
  Mean covered = picture(*build(false), path(2), 64),
       free = picture(*build(false), path(2, true), 64);
  EXPECT_GT(free.radiance, 1.5 * covered.radiance);
  EXPECT_EQ(free.alpha, 1);
}

TEST(HideEmitters, TheSkyIsNotSeenButShines) {
  Mean shown = picture(Stack{{model("diffuse", 0.5)}, true}, path());
  Mean hidden = picture(Stack{{model("diffuse", 0.5)}, true}, path(-1, true));
  EXPECT_NEAR(shown.radiance, 0.5, 4 * shown.error);
  EXPECT_NEAR(hidden.radiance, 0.5, 4 * hidden.error);
  Mean empty = picture(Stack{{}, true}, path(-1, true));
  EXPECT_EQ(empty.radiance, 0);
  EXPECT_EQ(empty.alpha, 0);
  // Nor through null surfaces and masks.
  EXPECT_EQ(picture(Stack{{null_node()}, true}, path(-1, true)).radiance, 0);
  Mean mean = picture(Stack{{mask(0.5, model("diffuse", 0.5))}, true}, path(-1, true));
  EXPECT_NEAR(mean.radiance, 0.25, 4 * mean.error);
}

// The values are those of Mitsuba 3.9.1's path and direct integrators.
TEST(Alpha, OfWhatPathsMeet) {
  Node grey = model("diffuse", 0.5), black = model("diffuse", 0), none = null_node();
  Node half = mask(0.5, grey);
  struct Case {
    const char* name;
    Stack stack;
    double path, hidden, direct; ///< alpha
  };
  const Case cases[] = {
      {"nothing", {{}}, 0, 0, 0},
      {"sky", {{}, true}, 1, 0, 0},
      {"null", {{none}}, 0, 0, 1},
      {"null before the sky", {{none}, true}, 1, 0, 1},
      {"two nulls", {{none, none}}, 0, 0, 1},
      {"mask", {{half}}, 0.5, 0.5, 1},
      {"mask before the sky", {{half}, true}, 1, 0.5, 1},
      {"two masks", {{half, half}}, 0.75, 0.75, 1},
      {"wall", {{grey}}, 1, 1, 1},
      {"black wall", {{black}}, 1, 1, 1},
      {"wall behind null", {{none, grey}}, 1, 1, 1},
      {"lamp", {{grey}, false, true}, 1, 0, 1},
  };
  IntegratorDesc direct;
  direct.type = "direct";
  for (const Case& c : cases) {
    // 16384 paths a picture.
    EXPECT_NEAR(picture(c.stack, path()).alpha, c.path, 0.015) << c.name;
    EXPECT_NEAR(picture(c.stack, path(-1, true)).alpha, c.hidden, 0.015) << c.name;
    EXPECT_EQ(picture(c.stack, direct, 16).alpha, c.direct) << c.name;
  }
}

TEST(Alpha, OfPathsThatEndEarly) {
  Node grey = model("diffuse", 0.5), none = null_node();
  struct Case {
    Stack stack;
    int max_depth;
    double alpha;
  };
  for (const Case& c : {Case{{{grey}}, 1, 0},
                        {{{grey}}, 2, 1},
                        {{{none, grey}}, 2, 0},
                        {{{none, grey}}, 3, 1},
                        {{{grey}, false, true}, 1, 1},
                        {{{none, grey}, false, true}, 1, 0},
                        {{{none, grey}, false, true}, 2, 1}})
    EXPECT_EQ(picture(c.stack, path(c.max_depth), 16).alpha, c.alpha)
        << c.stack.materials.size() << " surfaces, max_depth " << c.max_depth;
}
