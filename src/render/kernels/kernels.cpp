#include "render/kernels/wavefront.h"

namespace faceta {

namespace {

using T = Lanes;

Vec3<T> load3(const float* const (&p)[3], int i) {
  return {load<T>(p[0] + i), load<T>(p[1] + i), load<T>(p[2] + i)};
}

ShadingQuery<T> query(int root, const float* const (&wo)[3], const float* const (&uv)[2], int i) {
  ShadingQuery<T> q;
  q.wo = load3(wo, i);
  q.wi_light = q.wo;
  q.uv = {load<T>(uv[0] + i), load<T>(uv[1] + i)};
  q.u = {T(0.5f), T(0.5f)};
  q.uc = T(0.5f);
  q.root = IntOf<T>(root);
  q.active = MaskOf<T>(true);
  return q;
}

void store_sample(const Sample<T>& r, const SampleArrays& s, int i) {
  using I = IntOf<T>;
  store(s.wi[0] + i, r.wi.x);
  store(s.wi[1] + i, r.wi.y);
  store(s.wi[2] + i, r.wi.z);
  for (int k = 0; k < 3; ++k) {
    store(s.value[k] + i, select(r.delta, T(0), r.value[k]));
    store(s.weight[k] + i, select(r.valid, r.weight[k], T(0)));
  }
  store(s.pdf + i, r.pdf);
  store(s.eta + i, r.eta);
  I flags = r.lobe | select(r.delta, I(kDeltaFlag), I(0)) | I(kValidFlag);
  store(s.flags + i, select(r.valid, flags, I(0)));
}

void scatter(const SceneView& scene, int32_t root, int32_t importance, const EvalArrays* eval,
             const SampleArrays* sample, int n) {
  auto shader = std::make_unique<Shader<T>>(scene, importance);
  const ClassView& c = scene.classes[scene.roots[root].class_index];
  for (int i = 0; i < n; i += kWidthOf<T>) {
    if (eval) {
      ShadingQuery<T> q = query(root, eval->wo, eval->uv, i);
      q.wi_light = load3(eval->wi, i);
      ShadingResult<T> r = shader->shade(c, q);
      for (int k = 0; k < 3; ++k)
        store(eval->value[k] + i, r.light.value[k]);
      store(eval->pdf + i, r.light.pdf);
    }
    if (sample) {
      ShadingQuery<T> q = query(root, sample->wo, sample->uv, i);
      q.u = {load<T>(sample->u[0] + i), load<T>(sample->u[1] + i)};
      q.uc = load<T>(sample->uc + i);
      store_sample(shader->shade(c, q).sample, *sample, i);
    }
  }
}

void run(const RenderJob& job, RenderCounters& counters) {
  Wavefront(job, counters).run();
}

} // namespace

} // namespace faceta

const faceta::RenderKernels* faceta_render_kernels() {
  static const faceta::RenderKernels kernels{faceta::Wavefront::W, faceta::run, faceta::scatter};
  return &kernels;
}
