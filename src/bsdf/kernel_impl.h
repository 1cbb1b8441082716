#pragma once

/// Builds a MaterialKernel from a model: included once per model and instruction set, by the
/// translation units that cmake/Modules.cmake generates.

#include "bsdf/model.h"

#include <algorithm>
#include <iterator>

namespace faceta {

// Instructions are scheduled before registers are given out where that is known to pay.
#if defined(__clang__) || defined(FACETA_SANITIZED)
#define FACETA_SCHEDULED
#else
#define FACETA_SCHEDULED __attribute__((optimize("schedule-insns", "sched-pressure")))
#endif

/// How many rows `static constexpr std::array<int, choices> kUsualChoices[]` a model has: choices
/// and flags, in the order of describe(), for which samples are drawn by code of their own. Such a
/// model has sample() in two steps: sample_direction(wo, random, context) and weigh(wo, what that
/// returned, context). One that derives from it with a sample() of its own sets kUsualChoices = 0.
template <class M> constexpr int usual_choices() {
  if constexpr (requires { std::size(M::kUsualChoices); })
    return static_cast<int>(std::size(M::kUsualChoices));
  else
    return 0;
}

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
  static FACETA_INLINE Random<T> random_at(const SampleArrays& s, int i) {
    return {{load<T>(s.u[0] + i), load<T>(s.u[1] + i)}, load<T>(s.uc + i)};
  }
  static FACETA_INLINE void store_sample(const Sample<T>& r, const SampleArrays& s, int i) {
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
  static FACETA_INLINE void sample_at(const Model<T>& m, const MaterialArgs& a,
                                      const SampleArrays& s, int i) {
    store_sample(m.sample(load3(s.wo, i), random_at(s, i), context(a, s.uv, i)), s, i);
  }
  /// sample() in its two steps, the next group's first before this one's second: two chains of
  /// dependences side by side.
  static FACETA_INLINE void sample_overlapped(const Model<T>& m, const MaterialArgs& a,
                                              const SampleArrays& s, int n) {
    auto direction_at = [&](int i) FACETA_INLINE_LAMBDA {
      return m.sample_direction(load3(s.wo, i), random_at(s, i), context(a, s.uv, i));
    };
    auto next = direction_at(0);
    for (int i = 0; i < n; i += kWidthOf<T>) {
      auto direction = next;
      next = direction_at(i + kWidthOf<T> < n ? i + kWidthOf<T> : i);
      store_sample(m.weigh(load3(s.wo, i), direction, context(a, s.uv, i)), s, i);
    }
  }

  static FACETA_INLINE bool shared(const MaterialArgs& a) { return !a.rows && !a.textured; }
  /// Calls do_group(model, first lane) for each group of lanes; a model that all groups share is
  /// read once.
  template <class F>
  static FACETA_INLINE void for_groups(const MaterialArgs& a, int n, F do_group) {
    if (n <= 0)
      return;
    Model<T> m = load_model<Model, T>(a, a.choices, 0);
    for (int i = 0; i < n; i += kWidthOf<T>) {
      if (i > 0 && !shared(a))
        m = load_model<Model, T>(a, a.choices, i);
      do_group(m, i);
    }
  }

  static FACETA_FLATTEN void eval(const MaterialArgs& a, const EvalArrays& e, int n) {
    for_groups(a, n, [&](const Model<T>& m, int i) { eval_at(m, a, e, i); });
  }
  /// Overlapped, and without a branch on choices, where they are one of the model's kUsualChoices.
  template <int K = 0>
  static FACETA_INLINE bool sample_usual(const MaterialArgs& a, const SampleArrays& s, int n) {
    if constexpr (K < usual_choices<Model<T>>()) {
      constexpr auto& usual = Model<T>::kUsualChoices[K];
      if (!std::equal(usual.begin(), usual.end(), a.choices))
        return sample_usual<K + 1>(a, s, n);
      sample_overlapped(load_model<Model, T>(a, usual, 0), a, s, n);
      return true;
    } else {
      return false;
    }
  }
  static FACETA_SCHEDULED FACETA_FLATTEN void sample(const MaterialArgs& a, const SampleArrays& s,
                                                     int n) {
    if (shared(a) && n > kWidthOf<T> && sample_usual(a, s, n))
      return;
    for_groups(a, n, [&](const Model<T>& m, int i) { sample_at(m, a, s, i); });
  }
  static FACETA_FLATTEN void eval_sample(const MaterialArgs& a, const EvalArrays& e,
                                         const SampleArrays& s, int n) {
    for_groups(a, n, [&](const Model<T>& m, int i) {
      eval_at(m, a, e, i);
      sample_at(m, a, s, i);
    });
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
