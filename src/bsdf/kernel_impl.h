#pragma once

/// Builds a MaterialKernel from a model: included once per model and instruction set, by the
/// translation units that cmake/Modules.cmake generates.

#include "bsdf/model.h"

namespace faceta {

// A model travels in registers only if everything is inlined into the loop, describe() included.
#define FACETA_FLATTEN __attribute__((flatten))

template <template <class> class Model> struct KernelOf {
  using T = Lanes;

  static FACETA_INLINE Vec3<T> load3(const float* const (&p)[3], int i) {
    return {load<T>(p[0] + i), load<T>(p[1] + i), load<T>(p[2] + i)};
  }
  static FACETA_INLINE Context<T> context(const MaterialArgs& a, const float* const (&uv)[2],
                                          int i) {
    Context<T> c;
    c.mode = a.importance ? TransportMode::importance : TransportMode::radiance;
    if (uv[0])
      c.uv = {load<T>(uv[0] + i), load<T>(uv[1] + i)};
    return c;
  }
  static FACETA_INLINE void eval_at(const Model<T>& m, const MaterialArgs& a, const EvalArrays& e,
                                    int i) {
    Eval<T> r = m.eval(load3(e.wo, i), load3(e.wi, i), context(a, e.uv, i));
    for (int k = 0; k < 3; ++k)
      store(e.value[k] + i, r.value[k]);
    store(e.pdf + i, r.pdf);
  }
  static FACETA_INLINE void sample_at(const Model<T>& m, const MaterialArgs& a,
                                      const SampleArrays& s, int i) {
    Random<T> random{{load<T>(s.u[0] + i), load<T>(s.u[1] + i)}, load<T>(s.uc + i)};
    Sample<T> r = m.sample(load3(s.wo, i), random, context(a, s.uv, i));
    store(s.wi[0] + i, r.wi.x);
    store(s.wi[1] + i, r.wi.y);
    store(s.wi[2] + i, r.wi.z);
    for (int k = 0; k < 3; ++k) {
      store(s.value[k] + i, r.value[k]);
      store(s.weight[k] + i, select(r.valid, r.weight[k], T(0)));
    }
    store(s.pdf + i, r.pdf);
    store(s.eta + i, r.eta);
    using I = IntOf<T>;
    I flags = r.lobe | select(r.delta, I(kDeltaFlag), I(0)) | I(kValidFlag);
    store(s.flags + i, select(r.valid, flags, I(0)));
  }

  static FACETA_FLATTEN void eval(const MaterialArgs& a, const EvalArrays& e, int n) {
    for (int i = 0; i < n; i += kWidthOf<T>)
      eval_at(load_model<Model, T>(a, i), a, e, i);
  }
  static FACETA_FLATTEN void sample(const MaterialArgs& a, const SampleArrays& s, int n) {
    for (int i = 0; i < n; i += kWidthOf<T>)
      sample_at(load_model<Model, T>(a, i), a, s, i);
  }
  static FACETA_FLATTEN void eval_sample(const MaterialArgs& a, const EvalArrays& e,
                                         const SampleArrays& s, int n) {
    for (int i = 0; i < n; i += kWidthOf<T>) {
      Model<T> m = load_model<Model, T>(a, i);
      eval_at(m, a, e, i);
      sample_at(m, a, s, i);
    }
  }
};

} // namespace faceta

/// Defines `const MaterialKernel* faceta_kernel_<symbol>()`.
#define FACETA_MATERIAL_KERNEL(symbol, Type)                                                       \
  const faceta::MaterialKernel* faceta_kernel_##symbol() {                                         \
    using K = faceta::KernelOf<Type>;                                                              \
    static const faceta::MaterialKernel kernel{#symbol, K::eval, K::sample, K::eval_sample};       \
    return &kernel;                                                                                \
  }
