#include "scene/scene.h"

#include "scene/accel.h"
#include "scene/camera.h"
#include "scene/environment.h"
#include "scene/lights.h"
#include "scene/materials.h"
#include "scene/textures.h"
#include "spectrum/cie.h"

#include <cassert>
#include <cmath>

namespace faceta {

using namespace double3;

struct Scene::Impl {
  struct Shape {
    int material;
    std::string name;
  };

  TextureStore textures;
  MaterialStore materials;
  LightStore lights;
  SceneGeometry geometry;
  Accelerator accelerator;
  std::vector<Shape> shapes;
  std::unique_ptr<EnvironmentTables> environment;
  double environment_weight = 0;
  std::unique_ptr<FilterTable> filter;
  SceneStatistics statistics;
  SceneView view{};
  bool built = false;

  int add_shape(const ShapeDesc& desc);
  LightStore::Emission emission(const AreaEmitter& emitter, const std::string& name) const;
  void build_once();
  void place_environment();
  void connect(Isa isa);
};

namespace {

[[noreturn]] void rethrow(const Error& e, const std::string& shape) {
  throw Error("shape '" + shape + "': " + e.message(), e.where(), e.hint());
}

/// Whether two triangles are the halves of a rectangle as make_rectangle() splits it.
bool is_rectangle(const Mesh& mesh) {
  if (mesh.triangle_count() != 2 || mesh.vertex_count() != 4)
    return false;
  Double3 p[4];
  for (int i = 0; i < 4; ++i)
    p[i] = {mesh.positions[3 * i], mesh.positions[3 * i + 1], mesh.positions[3 * i + 2]};
  Double3 e1 = sub(p[1], p[0]), e2 = sub(p[2], p[0]), rest = sub(sub(p[3], p[1]), e2);
  double size = length(e1) * length(e2);
  return size > 0 && std::abs(dot(e1, e2)) <= 1e-5 * size &&
         length(rest) <= 1e-5 * (length(e1) + length(e2));
}

/// A rectangle as one big triangle from its first corner, as rectangle lights are described.
TriangleRecord corner_of(const Mesh& mesh) {
  Mesh corner = mesh;
  corner.indices = {0, 1, 2};
  SceneGeometry g;
  g.add(corner, 0);
  return g.triangles[0];
}

template <class E, class A> const E* never_null(const std::vector<E, A>& array) {
  static const E kNone{};
  return array.empty() ? &kNone : array.data();
}

} // namespace

Scene::Scene() : impl_(std::make_unique<Impl>()) {}
Scene::~Scene() = default;

int Scene::add_texture(const TextureDesc& texture) {
  assert(!impl_->built);
  return impl_->textures.add(texture);
}

std::array<double, 3> Scene::texture_mean(int texture) const {
  impl_->textures.check(texture, "scene");
  return impl_->textures.mean(texture);
}

int Scene::add_material(const std::shared_ptr<MaterialNode>& root) {
  assert(!impl_->built && root);
  return impl_->materials.add(*root, impl_->textures);
}

int Scene::Impl::add_shape(const ShapeDesc& desc) {
  assert(!built);
  if (desc.material < 0 || desc.material >= materials.count())
    throw Error("it has no material");
  shapes.push_back({desc.material, desc.name});
  return static_cast<int>(shapes.size()) - 1;
}

LightStore::Emission Scene::Impl::emission(const AreaEmitter& emitter,
                                           const std::string& name) const {
  LightStore::Emission e;
  e.radiance = emitter.radiance.value;
  e.texture = emitter.radiance.texture;
  e.sampling_weight = emitter.sampling_weight;
  e.brightness = luminance(e.radiance);
  if (e.texture >= 0) {
    textures.check(e.texture, ("emitter of shape '" + name + "'").c_str());
    e.radiance = {1, 1, 1};
    e.brightness = luminance(textures.mean(e.texture));
  }
  return e;
}

void Scene::add_mesh(const Mesh& mesh, const ShapeDesc& desc, bool rectangle) try {
  int shape = impl_->add_shape(desc);
  SceneGeometry& geometry = impl_->geometry;
  int first = geometry.add(mesh, shape);
  if (!desc.emitter)
    return;
  LightStore::Emission e = impl_->emission(*desc.emitter, desc.name);
  int last = static_cast<int>(geometry.triangles.size());
  if (rectangle && is_rectangle(mesh)) {
    int light = impl_->lights.add_rectangle(corner_of(mesh), first, e);
    for (int i = first; i < last; ++i)
      geometry.triangles[i].light = light;
    return;
  }
  for (int i = first; i < last; ++i)
    geometry.triangles[i].light = impl_->lights.add_triangle(geometry.triangles[i], i, e);
} catch (const Error& e) {
  rethrow(e, desc.name);
}

void Scene::add_sphere(const Sphere& sphere, const ShapeDesc& desc) try {
  int i = impl_->geometry.add(sphere, impl_->add_shape(desc));
  if (desc.emitter)
    impl_->geometry.quadrics[i].light =
        impl_->lights.add_sphere(sphere, i, impl_->emission(*desc.emitter, desc.name));
} catch (const Error& e) {
  rethrow(e, desc.name);
}

void Scene::add_disk(const Disk& disk, const ShapeDesc& desc) try {
  int i = impl_->geometry.add(disk, impl_->add_shape(desc));
  if (desc.emitter)
    impl_->geometry.quadrics[i].light = impl_->lights.add_disk(
        disk, impl_->geometry.quadric_shapes[i].box, i, impl_->emission(*desc.emitter, desc.name));
} catch (const Error& e) {
  rethrow(e, desc.name);
}

void Scene::add_cylinder(const Cylinder& cylinder, const ShapeDesc& desc) try {
  int i = impl_->geometry.add(cylinder, impl_->add_shape(desc));
  if (desc.emitter)
    impl_->geometry.quadrics[i].light =
        impl_->lights.add_cylinder(cylinder, impl_->geometry.quadric_shapes[i].box, i,
                                   impl_->emission(*desc.emitter, desc.name));
} catch (const Error& e) {
  rethrow(e, desc.name);
}

void Scene::add_point_light(const PointLightDesc& light) {
  assert(!impl_->built);
  impl_->lights.add_point(light.position,
                          {light.intensity, -1, luminance(light.intensity), light.sampling_weight});
}

void Scene::set_environment(const EnvironmentDesc& environment) {
  assert(!impl_->built);
  if (impl_->environment)
    throw Error("the scene has two environments", {}, "only one can surround it");
  impl_->environment = std::make_unique<EnvironmentTables>(environment);
  impl_->environment_weight = environment.sampling_weight;
}

void Scene::Impl::build_once() {
  lights.build();
  for (TriangleRecord& t : geometry.triangles)
    t.light = t.light < 0 ? -1 : lights.final_light(t.light);
  for (QuadricRecord& q : geometry.quadrics)
    q.light = q.light < 0 ? -1 : lights.final_light(q.light);
  statistics.triangles = geometry.triangles.size();
  statistics.quadrics = geometry.quadrics.size();
  statistics.lights = size_t(lights.count()) + (environment ? 1 : 0);
  statistics.textures = size_t(textures.count());
  statistics.materials = size_t(materials.count());
  accelerator.build(geometry);
  place_environment();
}

void Scene::Impl::place_environment() {
  EnvironmentView& e = view.environment;
  e = environment ? environment->view() : EnvironmentView{};
  if (!environment) {
    EnvironmentDesc black;
    black.radiance = {0, 0, 0};
    e = EnvironmentTables(black).view(); // valid pointers and rotations
    e.present = 0;
  }
  double weight = environment && !environment->black() ? environment_weight : 0;
  double others = lights.chosen() > 0 ? lights.mean_weight() : 0;
  e.probability = weight > 0 ? static_cast<float>(weight / (weight + others)) : 0;
  const Box& box = geometry.box;
  bool any = box.low[0] <= box.high[0];
  for (int k = 0; k < 3; ++k)
    e.center[k] = any ? static_cast<float>(0.5 * (box.low[k] + box.high[k])) : 0;
  double radius = any ? 0.5 * length(sub(box.high, box.low)) : 0;
  e.scene_radius = radius > 0 ? static_cast<float>(radius) : 1;
}

void Scene::Impl::connect(Isa isa) {
  materials.build(isa);
  for (TriangleRecord& t : geometry.triangles)
    t.material = materials.final_root(shapes[t.shape & ~kSmoothTriangle].material);
  for (QuadricRecord& q : geometry.quadrics)
    q.material = materials.final_root(shapes[q.shape].material);
  view.embree = accelerator.scene();
  view.triangles = never_null(geometry.triangles);
  view.quadrics = never_null(geometry.quadrics);
  view.triangle_count = static_cast<int32_t>(geometry.triangles.size());
  view.quadric_count = static_cast<int32_t>(geometry.quadrics.size());
  view.textures = never_null(textures.views());
  view.programs = never_null(materials.programs());
  view.weights = never_null(materials.weights());
  view.leaves = never_null(materials.leaves());
  view.roots = never_null(materials.roots());
  view.root_count = static_cast<int32_t>(materials.roots().size());
  view.classes = never_null(materials.classes());
  view.class_count = static_cast<int32_t>(materials.classes().size());
  view.lights = never_null(lights.records());
  view.light_count = lights.count();
  view.light_nodes = lights.nodes().data();
  statistics.bytes = textures.bytes() + materials.bytes() + lights.bytes() + geometry.bytes() +
                     accelerator.bytes() + (environment ? environment->bytes() : 0);
}

void Scene::build(Isa isa) {
  if (!impl_->built)
    impl_->build_once();
  impl_->built = true;
  impl_->connect(isa);
}

void Scene::use_sensor(const CameraDesc& camera, const FilmDesc& film) {
  impl_->view.camera = make_camera(camera, film);
  impl_->filter = std::make_unique<FilterTable>(film.filter);
  impl_->view.filter = impl_->filter->view();
}

const SceneView& Scene::view() const {
  assert(impl_->built);
  return impl_->view;
}

int Scene::view_root(int material) const {
  assert(impl_->built);
  return impl_->materials.final_root(material);
}

SceneStatistics Scene::statistics() const {
  return impl_->statistics;
}

} // namespace faceta
