#pragma once

#include "bsdf/measured_cells.h"

namespace faceta {

/// What a window, a blind or a cloth reflects and transmits, as it was measured, from a file.
template <class T> struct MeasuredWindow {
  const float* table = nullptr;
  Color<T> tint{T(1)};
  T scale{T(1)};
  int format = 0;

  template <class D> static void describe(D& d) {
    using M = MeasuredWindow;
    d.model("measuredwindow", "Measured window, blind or cloth")
        .equation("f = tint scale f_file(wi, wo), constant over pairs of cells, reflected and "
                  "transmitted from either side")
        .reference("Klems 1994, A New Method for Predicting the Solar Heat Gain of Complex "
                   "Fenestration Systems: Klems matrices")
        .reference("Ward et al. 2012, A Practical Framework for Sharing and Rendering Real-World "
                   "Bidirectional Scattering Distribution Functions: tensor trees")
        .note("Window XML files with Klems matrices or tensor trees, as Radiance, genBSDF and "
              "LBNL Window write them; Klems matrices are sampled exactly, trees by a table of "
              "32 x 32 cells of viewers by 32 x 32 of light and further down by the means of "
              "branches (rank 3: 32 rings by 64 x 64)")
        .note("Values hold for radiance that comes from wi, whichever way light is transported: "
              "no factor of eta, and importance sees the same as radiance")
        .file("filename", &M::table, "file of measured reflectance and transmittance")
        .reflectance("tint", &M::tint, "colour that the values are multiplied with")
        .scalar("scale", &M::scale, {0, kInfinity}, {0, 1}, "",
                "number that the values are multiplied with")
        .choice("format", &M::format, {"auto", "klems", "tensortree"}, "what the file must be")
        .reads_file()
        .traits({.lobes = kReflection | kTransmission,
                 .reciprocal = false,
                 .albedo_bound = kInfinity,
                 .two_sided = true,
                 .tabulated = true})
        .exemplar("Klems matrix", {{"filename", "demo:shade"}})
        .exemplar("tensor tree of rank 4", {{"filename", "demo:tree4"}})
        .exemplar("tensor tree of rank 3", {{"filename", "demo:tree3"}});
  }

  FACETA_INLINE Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto beside = (wo.z != T(0)) & (wi.z != T(0));
    Eval<T> e = MeasuredCells<T>(table).eval(wo, wi);
    T factor = select(beside, scale, T(0));
    return {tint * e.value * factor, select(beside, e.pdf, T(0))};
  }

  FACETA_INLINE Sample<T> sample(const Vec3<T>& wo, const Random<T>& random,
                                 const Context<T>&) const {
    Sample<T> s;
    Eval<T> e;
    s.wi = MeasuredCells<T>(table).sample(wo, random, e);
    s.lobe =
        select(MeasuredCells<T>::passes(wo, s.wi), IntOf<T>(kTransmission), IntOf<T>(kReflection));
    s.valid = wo.z != T(0);
    e.value = tint * e.value * scale;
    finish_sample(s, e);
    return s;
  }
};

} // namespace faceta
