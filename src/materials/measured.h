#pragma once

#include "bsdf/measured_table.h"

namespace faceta {

/// Reflectance as it was measured, from a file.
template <class T> struct Measured {
  const float* table = nullptr;
  Color<T> tint{T(1)};
  T scale{T(1)}, index{T(1)}, wavelength{T(-1)};
  int format = 0, merl_nodes = 0, utia_color = 0;

  template <class D> static void describe(D& d) {
    using M = Measured;
    d.model("measured", "Measured")
        .equation("f = tint scale f_file(wi, wo), interpolated as the file's format has it")
        .reference("Matusik et al. 2003, A Data-Driven Reflectance Model: MERL")
        .reference("Dupuy and Jakob 2018, An Adaptive Parameterization for Efficient Material "
                   "Acquisition and Rendering: RGL, and the sampling of every table")
        .reference("Dupuy et al. 2015, Extracting Microfacet-based BRDF Parameters from Arbitrary "
                   "Materials with Power Iterations: normals from a table")
        .note("files of any format that `faceta measure info` knows, told apart by content")
        .note("RGL files are sampled by their own warps; for others warps of visible normals and "
              "luminance are made when the file is loaded, with a share of cosine-weighted "
              "directions beside them")
        .file("filename", &M::table, "file of measured reflectance")
        .reflectance("tint", &M::tint, "colour that the values are multiplied with")
        .scalar("scale", &M::scale, {0, kInfinity}, {0, 1}, "",
                "number that the values are multiplied with")
        .choice("format", &M::format,
                {"auto", "merl", "rgl", "pbsdf", "utia", "ngan", "mbsdf", "cornell", "astm",
                 "zemax", "lighttools", "alta", "klems", "tensortree", "curet", "tvbrdf", "csv"},
                "what the file must be")
        .reads_file()
        .choice("merl_nodes", &M::merl_nodes, {"centers", "edges"},
                "where in a cell of a MERL file its value lies")
        .reads_file()
        .choice("utia_color", &M::utia_color, {"scaled_srgb", "srgb", "linear"},
                "what the numbers of a UTIA file are: sRGB times 140, sRGB or linear")
        .reads_file()
        .number("index", &M::index, {1, 1e6}, {1, 3}, "",
                "which material of a file that holds several")
        .reads_file()
        .number("wavelength", &M::wavelength, {-kInfinity, kInfinity}, {400, 700}, "nm",
                "of a file of spectra only this one, as grey; negative: all, as colour")
        .reads_file()
        .traits({.lobes = kReflection,
                 .reciprocal = false,
                 .albedo_bound = kInfinity,
                 .tabulated = true})
        .exemplar("plastic", {{"filename", "demo:plastic"}})
        .exemplar("metal", {{"filename", "demo:metal"}, {"tint", "1,0.9,0.8"}})
        .exemplar("brushed", {{"filename", "demo:brushed"}})
        .exemplar("gloss", {{"filename", "demo:gloss"}, {"scale", "0.5"}});
  }

  FACETA_INLINE Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    Vec3<T> normal{T(0), T(0), T(1)};
    Eval<T> e = MeasuredTable<T>(table).eval(select(above, wo, normal), select(above, wi, normal));
    T factor = select(above, scale, T(0));
    return {tint * e.value * factor, select(above, e.pdf, T(0))};
  }

  FACETA_INLINE Sample<T> sample(const Vec3<T>& wo, const Random<T>& random,
                                 const Context<T>&) const {
    auto above = wo.z > T(0);
    Sample<T> s;
    Eval<T> e;
    s.wi = MeasuredTable<T>(table).sample(select(above, wo, Vec3<T>{T(0), T(0), T(1)}), random, e);
    s.lobe = kReflection;
    s.valid = above & (s.wi.z > T(0));
    e.value = tint * e.value * scale;
    finish_sample(s, e);
    return s;
  }
};

} // namespace faceta
