#include "render/scene_material.h"

namespace faceta {

SceneMaterial::SceneMaterial(std::unique_ptr<Scene> scene, int material, Isa isa)
    : scene_(std::move(scene)), kernels_(Registry::global().render_kernels(isa)) {
  if (!kernels_)
    throw Error(std::string("this processor cannot run the instruction set '") +
                kIsaNames[static_cast<int>(isa)] + "'");
  scene_->build(isa);
  scene_->use_sensor(CameraDesc{}, FilmDesc{});
  root_ = scene_->view_root(material);
}

void SceneMaterial::eval(const EvalArrays& arrays, int n, TransportMode mode) const {
  kernels_->scatter(scene_->view(), root_, mode == TransportMode::importance, &arrays, nullptr, n);
}

void SceneMaterial::sample(const SampleArrays& arrays, int n, TransportMode mode) const {
  kernels_->scatter(scene_->view(), root_, mode == TransportMode::importance, nullptr, &arrays, n);
}

} // namespace faceta
