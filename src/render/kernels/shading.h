#pragma once

/// Materials in lanes: textures, the one virtual call per group, and material trees leaf by leaf.

#include "bsdf/bsdf.h"
#include "render/kernels/texture.h"

namespace faceta {

/// What shading a group of lanes needs to know about the surface and the random numbers.
template <class T> struct ShadingQuery {
  Vec3<T> wo;       ///< local, towards the viewer
  Vec3<T> wi_light; ///< local, towards the sampled light
  Vec2<T> u, uv;
  T uc;
  IntOf<T> root; ///< root material of each lane
  MaskOf<T> active;
};

template <class T> struct ShadingResult {
  Eval<T> light;    ///< value and density towards the sampled light
  Sample<T> sample; ///< in the local frame
};

/// Runs the leaves of classes; owns the lane arrays that kernels read and write.
template <class T> class Shader {
public:
  explicit Shader(const SceneView& scene, int32_t importance = 0)
      : scene_(scene), importance_(importance) {
    for (int k = 0; k < kMaxSlots; ++k)
      slot_pointers_[k] = slots_[k];
  }

  ShadingResult<T> shade(const ClassView& c, const ShadingQuery<T>& q) {
    if (c.single)
      return run_leaf(c.leaf, leaf_rows(q.root), q, q.uc, true);
    return shade_tree(scene_.roots[c.first_root], q);
  }

  /// Fetches ahead the textures that shade() will read.
  void prefetch(const ClassView& c, const IntOf<T>& root, const Vec2<T>& uv,
                MaskOf<T> active) const {
    if (c.single) {
      prefetch_leaf(c.leaf, leaf_rows(root), uv, active);
      return;
    }
    const RootView& r = scene_.roots[c.first_root];
    for (int i = 0; i < r.leaves; ++i) {
      const LeafView& leaf = scene_.leaves[r.first_leaf + i];
      for (int k = 0; k < leaf.weights; ++k)
        prefetch_texture<T>(scene_.textures, scene_.weights[leaf.first_weight + k].texture, uv,
                            active);
      prefetch_leaf(leaf, same_row(leaf.row), uv, active);
    }
  }

private:
  static constexpr int kWidth = kWidthOf<T>;
  static constexpr int kRootWords = sizeof(RootView) / 4;

  /// Which record each lane's parameters are in: `common` if that is not negative.
  struct LeafRows {
    int32_t common;
    IntOf<T> each;
  };
  static LeafRows same_row(int32_t row) { return {row, IntOf<T>(row)}; }
  /// The records of the lanes' roots, where those are single leaves.
  LeafRows leaf_rows(const IntOf<T>& root) const {
    int32_t first = lane(root, 0);
    if (all(root == IntOf<T>(first)))
      return same_row(scene_.roots[first].row);
    return {-1, gather_int<T>(&scene_.roots[0].row, root * IntOf<T>(kRootWords))};
  }

  void prefetch_leaf(const LeafView& leaf, const LeafRows& rows, const Vec2<T>& uv,
                     MaskOf<T> active) const {
    if (leaf.program < 0)
      return;
    const ProgramView& p = scene_.programs[leaf.program];
    for (int k = 0; k < p.texture_slots; ++k) {
      if (rows.common >= 0)
        prefetch_texture<T>(scene_.textures, p.textures[rows.common * p.texture_slots + k], uv,
                            active);
      else
        prefetch_textures<T>(scene_.textures, texture_ids(p, k, rows.each), uv, active);
    }
  }
  static IntOf<T> texture_ids(const ProgramView& p, int k, const IntOf<T>& row) {
    return gather_int<T>(p.textures + k, row * IntOf<T>(p.texture_slots));
  }

  /// One leaf. Directions are mirrored into its side and back.
  ShadingResult<T> run_leaf(const LeafView& leaf, const LeafRows& rows, const ShadingQuery<T>& q,
                            const T& uc, bool with_sample) {
    ShadingResult<T> r;
    T side = T(1);
    if (leaf.mirrored)
      side = leaf.sides == (kFrontSide | kBackSide) ? copysign(T(1), q.wo.z) : T(-1);
    if (leaf.program < 0) {
      r.sample.wi = -q.wo;
      r.sample.pdf = T(1);
      r.sample.weight = Color<T>(T(1));
      r.sample.lobe = IntOf<T>(kNullLobe);
      r.sample.delta = MaskOf<T>(true);
      r.sample.valid = MaskOf<T>(true);
      return r;
    }
    const ProgramView& p = scene_.programs[leaf.program];
    bind_textures(p, rows, q);
    bool common = rows.common >= 0;
    if (!common)
      store(rows_, rows.each);
    MaterialArgs args{common ? p.records + rows.common * int64_t(p.stride) : p.records,
                      p.stride,
                      p.choices,
                      p.tables,
                      p.textured,
                      slot_pointers_,
                      common ? nullptr : rows_,
                      importance_};
    put(wo_, {q.wo.x, q.wo.y, q.wo.z * side});
    put(wi_, {q.wi_light.x, q.wi_light.y, q.wi_light.z * side});
    store(uv_[0], q.uv.x);
    store(uv_[1], q.uv.y);
    EvalArrays e{{wo_[0], wo_[1], wo_[2]},
                 {wi_[0], wi_[1], wi_[2]},
                 {uv_[0], uv_[1]},
                 {value_[0], value_[1], value_[2]},
                 pdf_};
    if (!with_sample) {
      p.kernel->eval(args, e, kWidth);
    } else {
      store(u_[0], q.u.x);
      store(u_[1], q.u.y);
      store(uc_, uc);
      SampleArrays s{{wo_[0], wo_[1], wo_[2]},
                     {u_[0], u_[1]},
                     uc_,
                     {uv_[0], uv_[1]},
                     {si_[0], si_[1], si_[2]},
                     {sv_[0], sv_[1], sv_[2]},
                     sp_,
                     {sw_[0], sw_[1], sw_[2]},
                     se_,
                     flags_};
      p.kernel->eval_sample(args, e, s, kWidth);
      read_sample(r.sample, side);
    }
    r.light.value = get(value_);
    r.light.pdf = load<T>(pdf_);
    return r;
  }

  void read_sample(Sample<T>& s, const T& side) {
    using I = IntOf<T>;
    s.wi = {load<T>(si_[0]), load<T>(si_[1]), load<T>(si_[2]) * side};
    s.value = get(sv_);
    s.pdf = load<T>(sp_);
    s.weight = get(sw_);
    s.eta = load<T>(se_);
    I flags = load_int<T>(flags_);
    s.lobe = flags & I(kLobeMask);
    s.delta = (flags & I(kDeltaFlag)) != I(0);
    s.valid = (flags & I(kValidFlag)) != I(0);
  }

  void bind_textures(const ProgramView& p, const LeafRows& rows, const ShadingQuery<T>& q) {
    for (int k = 0; k < p.texture_slots; ++k) {
      int id = rows.common >= 0 ? p.textures[rows.common * p.texture_slots + k] : -1;
      Color<T> c = id >= 0 ? evaluate_texture<T>(scene_.textures, id, q.uv)
                           : evaluate_textures<T>(scene_.textures, texture_ids(p, k, rows.each),
                                                  q.uv, q.active);
      const TextureSlot& slot = p.slots[k];
      if (slot.count == 3)
        for (int i = 0; i < 3; ++i)
          store(slots_[slot.slot + i], c[i]);
      else
        store(slots_[slot.slot], luminance(c));
    }
  }

  /// The probability (and weight) of a leaf: the product along its path, 0 on a side it is not on.
  T leaf_weight(const LeafView& leaf, const ShadingQuery<T>& q) {
    auto front = q.wo.z > T(0);
    T w = select(front, T(leaf.sides & kFrontSide ? 1 : 0), T(leaf.sides & kBackSide ? 1 : 0));
    for (int i = 0; i < leaf.weights; ++i) {
      const WeightView& step = scene_.weights[leaf.first_weight + i];
      T x = step.texture < 0 ? T(step.constant)
                             : luminance(evaluate_texture<T>(scene_.textures, step.texture, q.uv));
      x = clamp01(x);
      w = w * (step.complement ? T(1) - x : x);
    }
    return w;
  }

  ShadingResult<T> shade_tree(const RootView& root, const ShadingQuery<T>& q) {
    using I = IntOf<T>;
    ShadingResult<T> total;
    I chosen(-1);
    T cumulated = T(0);
    // Leaf by leaf: values towards the light add up; uc picks the leaf that samples.
    for (int i = 0; i < root.leaves; ++i) {
      const LeafView& leaf = scene_.leaves[root.first_leaf + i];
      T w = leaf_weight(leaf, q);
      auto mine = (q.uc >= cumulated) & (q.uc < cumulated + w);
      T rescaled = (q.uc - cumulated) / select(w > T(0), w, T(1));
      rescaled = clamp(rescaled, T(0), T(kOneMinusEpsilon));
      cumulated = cumulated + w;
      ShadingResult<T> r = run_leaf(leaf, same_row(leaf.row), q, rescaled, true);
      total.light.value += r.light.value * w;
      total.light.pdf = fma(r.light.pdf, w, total.light.pdf);
      chosen = select(mine, I(i), chosen);
      take(total.sample, r.sample, mine, w);
    }
    // The mixture's value and density towards the sampled direction, where it is no delta.
    auto mixed = total.sample.valid & !total.sample.delta;
    if (root.leaves > 1 && any(mixed)) {
      ShadingQuery<T> towards = q;
      towards.wi_light = total.sample.wi;
      for (int i = 0; i < root.leaves; ++i) {
        const LeafView& leaf = scene_.leaves[root.first_leaf + i];
        auto others = mixed & (chosen != I(i));
        if (leaf.program < 0 || scene_.programs[leaf.program].delta_only || none(others))
          continue;
        T w = select(others, leaf_weight(leaf, q), T(0));
        ShadingResult<T> r = run_leaf(leaf, same_row(leaf.row), towards, T(0), false);
        total.sample.value += r.light.value * w;
        total.sample.pdf = fma(r.light.pdf, w, total.sample.pdf);
      }
      T inverse = T(1) / select(mixed, total.sample.pdf, T(1));
      total.sample.weight = select(mixed, total.sample.value * inverse, total.sample.weight);
    }
    return total;
  }

  /// Takes over a leaf's sample for the lanes that chose it. A delta keeps its weight: the leaf's
  /// share of the value and its probability cancel.
  static void take(Sample<T>& s, const Sample<T>& leaf, MaskOf<T> mine, const T& w) {
    s.wi = select(mine, leaf.wi, s.wi);
    s.value = select(mine, leaf.value * w, s.value);
    s.pdf = select(mine, leaf.pdf * w, s.pdf);
    s.weight = select(mine, leaf.weight, s.weight);
    s.eta = select(mine, leaf.eta, s.eta);
    s.lobe = select(mine, leaf.lobe, s.lobe);
    s.delta = select(mine, leaf.delta, s.delta);
    s.valid = select(mine, leaf.valid, s.valid);
  }

  static void put(float (&out)[3][kWidth], const Vec3<T>& v) {
    store(out[0], v.x);
    store(out[1], v.y);
    store(out[2], v.z);
  }
  static Color<T> get(const float (&in)[3][kWidth]) {
    return Color<T>(load<T>(in[0]), load<T>(in[1]), load<T>(in[2]));
  }

  const SceneView& scene_;
  int32_t importance_;
  alignas(64) float wo_[3][kWidth], wi_[3][kWidth], u_[2][kWidth], uv_[2][kWidth], uc_[kWidth];
  alignas(64) float value_[3][kWidth], pdf_[kWidth];
  alignas(64) float si_[3][kWidth], sv_[3][kWidth], sp_[kWidth], sw_[3][kWidth], se_[kWidth];
  alignas(64) int32_t flags_[kWidth], rows_[kWidth];
  alignas(64) float slots_[kMaxSlots][kWidth];
  const float* slot_pointers_[kMaxSlots];
};

} // namespace faceta
