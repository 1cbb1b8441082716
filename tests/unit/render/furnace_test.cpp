// Physics of whole pictures: nothing is lost in a white world, strategies agree at every depth, and
// radiance is scaled by eta^2 where it crosses an interface.

#include "bsdf/columns.h"
#include "materials/builtin.h"
#include "render/render.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace faceta;

namespace {

using Node = std::shared_ptr<MaterialNode>;

Node model(const char* name, const Settings& settings = {}) {
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(make_parameters(name, settings));
  return node;
}

std::shared_ptr<AreaEmitter> emitter(double radiance) {
  auto e = std::make_shared<AreaEmitter>();
  e->radiance.value = {radiance, radiance, radiance};
  return e;
}

void add_sphere(Scene& scene, const Node& material, double radius,
                std::shared_ptr<AreaEmitter> light = nullptr, bool inwards = false) {
  ShapeDesc shape;
  shape.material = scene.add_material(material);
  shape.emitter = std::move(light);
  scene.add_sphere(make_sphere({0, 0, 0}, radius, inwards, kIdentityToWorld), shape);
}
/// A rectangle of half sides `size` at the height z, facing up or down.
void add_square(Scene& scene, const Node& material, double size, double z, bool up = true,
                std::shared_ptr<AreaEmitter> light = nullptr) {
  ShapeDesc shape;
  shape.material = scene.add_material(material);
  shape.emitter = std::move(light);
  Mesh mesh = make_rectangle();
  double s = up ? 1 : -1;
  place(mesh, {size, 0, 0, 0, 0, s * size, 0, 0, 0, 0, s, z, 0, 0, 0, 1});
  scene.add_mesh(mesh, shape, true);
}

struct Mean {
  std::array<double, 3> value{};
  double error = 0;
};
/// Over a picture from (0, 0, 4) down z.
Mean picture(Scene& scene, const RenderSettings& settings, int spp, double fov = 28) {
  scene.build(best_isa());
  CameraDesc camera;
  camera.to_world = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 4, 0, 0, 0, 1};
  camera.x_fov = fov;
  FilmDesc film;
  film.width = film.height = film.crop_width = film.crop_height = 16;
  film.filter.type = FilterType::box;
  scene.use_sensor(camera, film);
  RenderOptions options;
  options.settings = settings;
  options.spp = spp;
  options.threads = 2;
  Film f = render(scene, options).film;
  EXPECT_EQ(f.non_finite, 0u);
  Image variance = f.variance();
  Mean m;
  for (int i = 0; i < 256; ++i)
    for (int c = 0; c < 3; ++c) {
      m.value[c] += f.sums[4 * i + c] / double(f.samples) / 256;
      m.error += variance.data[3 * i + c] / (3 * 256.0 * 256);
    }
  m.error = std::sqrt(m.error);
  return m;
}
RenderSettings path(int max_depth = -1) {
  IntegratorDesc integrator;
  integrator.max_depth = max_depth;
  return render_settings(integrator, SamplerDesc{"independent", 1, 1});
}

/// Exemplars that claim to lose nothing.
struct Lossless {
  std::string model, exemplar;
  Settings settings;
  double tolerance;
};
std::vector<Lossless> lossless_exemplars() {
  std::vector<Lossless> list;
  for (const auto& m : Registry::global().models())
    for (const Exemplar& e : m->descriptor.exemplars)
      if (e.lossless) // what comes from a table keeps the promise of 1e-3
        list.push_back(
            {m->name(), e.name, e.settings, m->descriptor.table_slots.empty() ? 2e-5 : 1e-3});
  return list;
}

} // namespace

TEST(Furnace, LosslessSpheresAreInvisibleUnderAWhiteSky) {
  std::vector<Lossless> list = lossless_exemplars();
  ASSERT_GT(list.size(), 10u);
  for (const Lossless& l : list) {
    Scene scene;
    add_sphere(scene, model(l.model.c_str(), l.settings), 1.2);
    scene.set_environment(EnvironmentDesc{});
    Mean m = picture(scene, path(), 144);
    for (double value : m.value)
      EXPECT_NEAR(value, 1, 3 * m.error + l.tolerance) << l.model << " " << l.exemplar;
  }
}

TEST(Furnace, LosslessSpheresAreInvisibleInAShiningSphere) {
  for (const Lossless& l : lossless_exemplars()) {
    Scene scene;
    add_sphere(scene, model(l.model.c_str(), l.settings), 1.2);
    add_sphere(scene, model("diffuse", {{"reflectance", "0"}}), 6, emitter(1), true);
    Mean m = picture(scene, path(), 144);
    for (double value : m.value)
      EXPECT_NEAR(value, 1, 3 * m.error + l.tolerance) << l.model << " " << l.exemplar;
  }
}

// A loss of 1 % shows.
TEST(Furnace, AnAlmostWhiteSphereIsSeen) {
  Scene scene;
  add_sphere(scene, model("diffuse", {{"reflectance", "0.99"}}), 1.2);
  scene.set_environment(EnvironmentDesc{});
  Mean m = picture(scene, path(), 144, 20);
  EXPECT_LT(m.value[0], 1 - 3 * m.error - 2e-3);
}

// With the densities' shares of multiple importance sampling at 0 only one strategy finds light.
TEST(Strategies, HaveTheSameMeanAtEveryDepth) {
  struct Case {
    const char *name, *model;
    Settings settings;
  };
  const Case cases[] = {
      {"diffuse", "diffuse", {{"reflectance", "0.8,0.5,0.3"}}},
      {"rough metal", "roughconductor", {{"material", "gold"}, {"alpha", "0.3"}}},
      {"rough metal of bounded caps",
       "roughconductor",
       {{"material", "Cu"}, {"alpha", "0.5"}, {"distribution", "ggx"}}},
      {"plastic", "roughplastic", {{"alpha", "0.3"}, {"diffuse_reflectance", "0.2,0.5,0.7"}}},
      {"rough glass", "roughdielectric", {{"alpha", "0.4"}}}};
  for (const Case& c : cases) {
    Scene scene;
    add_sphere(scene, model(c.model, c.settings), 0.8);
    add_square(scene, model("diffuse", {{"reflectance", "0.7"}}), 3, -1);
    add_square(scene, model(c.model, c.settings), 3, -0.95);
    add_square(scene, model("diffuse", {{"reflectance", "0"}}), 1.5, 6, false, emitter(3));
    EnvironmentDesc sky;
    sky.radiance = {0.3, 0.3, 0.3};
    scene.set_environment(sky);
    for (int max_depth : {1, 2, 3, 4, 7}) {
      RenderSettings both = path(max_depth), lights = both, bsdf = both;
      lights.bsdf_fraction = 0;
      bsdf.light_fraction = bsdf.light_scale = 0;
      Mean a = picture(scene, both, 100), b = picture(scene, lights, 200),
           d = picture(scene, bsdf, 200);
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(a.value[k], b.value[k], 4 * std::hypot(a.error, b.error) + 1e-5)
            << c.name << ", lights only, depth " << max_depth;
        EXPECT_NEAR(a.value[k], d.value[k], 4 * std::hypot(a.error, d.error) + 1e-5)
            << c.name << ", bsdf only, depth " << max_depth;
      }
      if (max_depth == 3) { // they are three strategies
        EXPECT_GT(std::abs(a.error - d.error), 1e-4);
        EXPECT_NE(a.value, b.value);
        EXPECT_NE(b.value, d.value);
      }
    }
  }
}

// A lamp of radiance 1 at the bottom of a pool: above the water its radiance is (1 - F) / eta^2.
TEST(Interface, RadianceIsScaledByTheSquaredIndex) {
  for (double eta : {1.333, 0.75}) {
    Scene scene;
    add_square(scene, model("dielectric", {{"int_ior", std::to_string(eta)}, {"ext_ior", "1"}}), 50,
               0);
    add_square(scene, model("diffuse", {{"reflectance", "0"}}), 50, -1, true, emitter(1));
    Mean m = picture(scene, path(), 64, 4); // rays down to 3 degrees: F of normal incidence
    double f = std::pow((eta - 1) / (eta + 1), 2);
    for (double value : m.value)
      EXPECT_NEAR(value, (1 - f) / (eta * eta), 4 * m.error + 1e-5) << eta;
    EXPECT_LT(m.error, 0.01);
  }
}

// Every weight and value of radiance is that of importance times the square of the ratio of the
// indices, where a direction crosses the interface, in the kernels that render.
TEST(Interface, TransportModesDifferByTheSquaredIndex) {
  const double eta = 1.5;
  Node nested = std::make_shared<MaterialNode>();
  nested->kind = MaterialNode::Kind::blend;
  nested->weight.value = {0.4, 0.4, 0.4};
  nested->children = {
      model("roughdielectric", {{"int_ior", "1.5"}, {"ext_ior", "1"}, {"alpha", "0.3"}}),
      model("dielectric", {{"int_ior", "1.5"}, {"ext_ior", "1"}})};
  for (const Node& node : {nested, nested->children[0], nested->children[1]}) {
    Scene scene;
    int material = scene.add_material(node);
    scene.build(best_isa());
    scene.use_sensor(CameraDesc{}, FilmDesc{});
    const RenderKernels& kernels = *Registry::global().render_kernels(best_isa());
    constexpr int kCount = 2000;
    SampleColumns radiance(kCount);
    for (int i = 0; i < kCount; ++i) {
      auto fraction = [i](double step) { return float(std::fmod(0.5 + i * step, 1.0)); };
      float z = 2 * fraction(0.618034) - 1, phi = 6.2831853f * fraction(0.754878);
      float sine = std::sqrt(std::max(1 - z * z, 0.0f));
      radiance.wo[0][i] = sine * std::cos(phi);
      radiance.wo[1][i] = sine * std::sin(phi);
      radiance.wo[2][i] = z;
      radiance.u[0][i] = fraction(0.819173);
      radiance.u[1][i] = fraction(0.671044);
      radiance.uc[i] = fraction(0.549700);
    }
    SampleColumns importance = radiance;
    for (bool is_importance : {false, true}) {
      SampleArrays arrays = (is_importance ? importance : radiance).arrays();
      kernels.scatter(scene.view(), scene.view_root(material), is_importance, nullptr, &arrays,
                      kCount);
    }
    int crossed = 0;
    for (int i = 0; i < kCount; ++i) {
      ASSERT_EQ(radiance.wi[2][i], importance.wi[2][i]);
      ASSERT_EQ(radiance.pdf[i], importance.pdf[i]);
      bool through = radiance.wo[2][i] * radiance.wi[2][i] < 0;
      crossed += through && radiance.weight[0][i] > 0;
      double ratio = !through ? 1 : radiance.wo[2][i] > 0 ? 1 / (eta * eta) : eta * eta;
      EXPECT_NEAR(radiance.weight[0][i], ratio * importance.weight[0][i],
                  1e-6 * ratio * importance.weight[0][i]);
      EXPECT_NEAR(radiance.value[0][i], ratio * importance.value[0][i],
                  1e-6 * ratio * importance.value[0][i]);
    }
    EXPECT_GT(crossed, 200);
  }
}
