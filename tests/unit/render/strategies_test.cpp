#include "materials/builtin.h"
#include "render/render.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace faceta;

namespace {

int add_diffuse(Scene& scene, double albedo) {
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(Registry::global().get("diffuse"));
  node->parameters->set_number("reflectance", albedo);
  return scene.add_material(node);
}

Mesh rectangle_at(const ToWorld& to_world) {
  Mesh mesh = make_rectangle();
  place(mesh, to_world);
  return mesh;
}

/// A camera at (0, 0, distance) that looks down z at the origin.
void look_down(Scene& scene, double distance, int size) {
  CameraDesc camera;
  camera.to_world = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, distance, 0, 0, 0, 1};
  camera.x_fov = 40;
  FilmDesc film;
  film.width = film.height = film.crop_width = film.crop_height = size;
  film.filter.type = FilterType::box;
  scene.use_sensor(camera, film);
}

RenderResult render_direct(const Scene& scene, int lights, int bsdfs, int spp) {
  IntegratorDesc integrator;
  integrator.type = "direct";
  integrator.emitter_samples = lights;
  integrator.bsdf_samples = bsdfs;
  RenderOptions options;
  options.settings = render_settings(integrator, SamplerDesc{"independent", spp, 1});
  options.spp = spp;
  return render(scene, options);
}

/// Means of all pixels, and the standard error of that mean, of the red channel.
struct Mean {
  double value, error;
};
Mean mean_of(const Film& film) {
  double sum = 0, variance = 0;
  size_t n = size_t(film.width) * film.height;
  Image v = film.variance();
  for (size_t i = 0; i < n; ++i) {
    sum += film.sums[4 * i] / double(film.samples);
    variance += v.data[3 * i];
  }
  return {sum / double(n), std::sqrt(variance) / double(n)};
}

/// A floor z = 0 and a lamp that `add` puts above it, given its emission and black material; both
/// strategies must find the same light.
template <class Add> void expect_strategies_agree(const Add& add) {
  Scene scene;
  ShapeDesc floor;
  floor.material = add_diffuse(scene, 0.8);
  scene.add_mesh(rectangle_at({2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}), floor);
  ShapeDesc lamp;
  lamp.material = add_diffuse(scene, 0);
  lamp.emitter = std::make_shared<AreaEmitter>();
  lamp.emitter->radiance.value = {3, 3, 3};
  add(scene, lamp);
  scene.build(best_isa());
  look_down(scene, 4, 32);
  Mean lights = mean_of(render_direct(scene, 1, 0, 256).film);
  Mean bsdf = mean_of(render_direct(scene, 0, 1, 1024).film);
  Mean both = mean_of(render_direct(scene, 2, 1, 256).film);
  EXPECT_GT(lights.value, 0);
  EXPECT_NEAR(lights.value, bsdf.value, 4 * std::hypot(lights.error, bsdf.error));
  EXPECT_NEAR(lights.value, both.value, 4 * std::hypot(lights.error, both.error));
}

void expect_rectangle_agrees(const ToWorld& to_world) {
  expect_strategies_agree([&](Scene& scene, const ShapeDesc& lamp) {
    scene.add_mesh(rectangle_at(to_world), lamp, true);
  });
}

} // namespace

TEST(Strategies, WideRectangleOverhead) {
  // Faces down from just above the floor, outside of the camera's view of it.
  expect_rectangle_agrees({0.5, 0, 0, 0.9, 0, -0.5, 0, 0.9, 0, 0, -1, 0.3, 0, 0, 0, 1});
}

TEST(Strategies, RectangleThatStandsOnTheFloor) {
  // Its plane cuts the floor: points in it see the light edge-on.
  expect_rectangle_agrees({0, 0, 1, -0.5, 0, 0.6, 0, 0, -0.6, 0, 0, 0.6, 0, 0, 0, 1});
}

TEST(Strategies, TexturedSphere) {
  // The lower half of the sphere shines: sampled points must know their uv.
  expect_strategies_agree([](Scene& scene, ShapeDesc lamp) {
    TextureDesc checkers;
    checkers.type = TextureType::checkerboard;
    checkers.to_uv = {0.5, 0, 0, 0, 1, 0};
    checkers.color[0] = {0, 0, 0};
    checkers.color[1] = {9, 9, 9};
    lamp.emitter->radiance.texture = scene.add_texture(checkers);
    ToWorld tilted{0.8, 0, 0.6, 0, 0, 1, 0, 0, -0.6, 0, 0.8, 0.7, 0, 0, 0, 1};
    scene.add_sphere(make_sphere({0, 0, 0}, 0.4, false, tilted), lamp);
  });
}

TEST(Furnace, WhiteSphereInAWhiteWorldIsInvisible) {
  Scene scene;
  ShapeDesc shape;
  shape.material = add_diffuse(scene, 1);
  scene.add_sphere(make_sphere({0, 0, 0}, 1, false, kIdentityToWorld), shape);
  scene.set_environment(EnvironmentDesc{});
  scene.build(best_isa());
  look_down(scene, 4, 16);
  RenderOptions options;
  options.settings = render_settings(IntegratorDesc{}, SamplerDesc{});
  options.spp = 256;
  Film film = render(scene, options).film;
  Mean mean = mean_of(film);
  EXPECT_NEAR(mean.value, 1, 3 * mean.error + 1e-6);
  EXPECT_EQ(film.non_finite, 0u);
}
