#pragma once

#include "bsdf/describe.h"
#include "bsdf/energy.h"
#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"
#include "sampling/warp.h"

#include <array>

namespace faceta {

/// Rough metal: microfacets that reflect like a smooth metal.
template <class T> struct RoughConductor {
  Color<T> eta{T(0)}, k{T(1)}, specular_reflectance{T(1)};
  int distribution = kBeckmann;
  T alpha_u = T(0.1), alpha_v = T(0.1);
  int sample_visible = 1, energy_compensation = 0, height_correlated = 0, bounded_sampling = 1;

  static constexpr std::array<int, 5> kUsualChoices[] = {{kBeckmann, 1, 0, 0, 1},
                                                         {kGgx, 1, 0, 0, 1}};

  template <class D> static FACETA_INLINE void describe(D& d) {
    using M = RoughConductor;
    d.model("roughconductor", "Rough metal")
        .equation("f = F(wi.h) D(h) G(wi, wo) / (4 cos theta_i cos theta_o),  h = (wi + wo) / "
                  "|wi + wo|")
        .reference("Cook and Torrance 1982, A Reflectance Model for Computer Graphics")
        .reference("Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces, "
                   "eq. 20")
        .reference("Heitz and d'Eon 2014, Importance Sampling Microfacet-Based BSDFs using the "
                   "Distribution of Visible Normals")
        .reference("Dupuy and Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps")
        .reference("Eto and Tokuyoshi 2023, Bounded VNDF Sampling for Smith-GGX Reflections")
        .reference("Kulla and Conty 2017, Revisiting Physically Based Shading at Imageworks "
                   "(energy_compensation)")
        .note("Light scattered more than once between facets is lost unless energy_compensation "
              "is set: at alpha = 1 a white GGX metal reflects 31 % at normal incidence.")
        .note("Beckmann's masking is Walter's rational fit (0.35 %) as in the scene contract; the "
              "density of visible normals and height_correlated use the exact one.")
        .spectrum("eta", &M::eta, {0, 5}, "real part of the index of refraction")
        .spectrum("k", &M::k, {0, 10}, "imaginary part of the index of refraction")
        .metal("material", "none", "a metal by name, instead of eta and k")
        .reflectance("specular_reflectance", &M::specular_reflectance,
                     "factor on the reflection, 1 for a real metal")
        .choice("distribution", &M::distribution, {"beckmann", "ggx"}, "distribution of normals")
        .roughness(&M::alpha_u, &M::alpha_v, "roughness of the microfacets")
        .flag("sample_visible", &M::sample_visible, "sample visible normals only")
        .flag("energy_compensation", &M::energy_compensation,
              "add the light that scatters more than once between facets")
        .flag("height_correlated", &M::height_correlated,
              "masking and shadowing correlated by height")
        .flag("bounded_sampling", &M::bounded_sampling,
              "GGX: sample only the visible normals that may reflect upwards")
        .table(&M::energy_)
        .traits({.lobes = kReflection});
    describe_proof(d);
  }

  /// What is known of it, and the parameter sets to prove.
  template <class D> static FACETA_INLINE void describe_proof(D& d) {
    // The table is for the exact masking, from which Beckmann's separable one is off by 0.35 %.
    const char* kTable = "quadrature over 1500 x 1500 directions";
    d.limit({{"alpha", "0"}}, "conductor", {}, 1e-3)
        .known_albedo({{"distribution", "ggx"}, {"alpha", "0.1"}}, 0.988, 0.969, 0.873, 1e-3,
                      kTable)
        .known_albedo({{"distribution", "ggx"}, {"alpha", "0.3"}}, 0.877, 0.818, 0.842, 1e-3,
                      kTable)
        .known_albedo({{"distribution", "ggx"}, {"alpha", "0.5"}}, 0.688, 0.686, 0.772, 1e-3,
                      kTable)
        .known_albedo({{"distribution", "ggx"}, {"alpha", "1"}}, 0.307, 0.409, 0.558, 1e-3, kTable)
        .known_albedo({{"distribution", "ggx"}, {"alpha", "0.1"}, {"height_correlated", "true"}},
                      0.988, 0.969, 0.884, 1e-3, kTable)
        .known_albedo({{"distribution", "ggx"}, {"alpha", "0.3"}, {"height_correlated", "true"}},
                      0.877, 0.822, 0.889, 1e-3, kTable)
        .known_albedo({{"distribution", "ggx"}, {"alpha", "0.5"}, {"height_correlated", "true"}},
                      0.688, 0.698, 0.86, 1e-3, kTable)
        .known_albedo({{"distribution", "ggx"}, {"alpha", "1"}, {"height_correlated", "true"}},
                      0.307, 0.451, 0.76, 1e-3, kTable)
        .known_albedo({{"alpha", "0.5"}, {"height_correlated", "true"}}, 0.943, 0.869, 0.955, 1e-3,
                      kTable)
        .known_albedo({{"alpha", "1"}, {"height_correlated", "true"}}, 0.462, 0.767, 0.953, 1e-3,
                      kTable)
        .known_albedo({{"alpha", "0.5"}}, 0.943, 0.869, 0.936, 3.5e-3, kTable)
        .known_albedo({{"alpha", "1"}}, 0.462, 0.756, 0.902, 3.5e-3, kTable)
        .exemplar("gold of the course", {{"material", "gold"}, {"alpha", "0.15"}})
        .exemplar("almost a mirror", {{"material", "gold"}, {"alpha", "0.001"}})
        .exemplar(
            "brushed",
            {{"material", "Al"}, {"distribution", "ggx"}, {"alpha_u", "0.05"}, {"alpha_v", "0.3"}})
        .exemplar("very rough", {{"distribution", "ggx"}, {"alpha", "1"}})
        .exemplar("all normals", {{"material", "Cu"},
                                  {"alpha_u", "0.3"},
                                  {"alpha_v", "0.15"},
                                  {"sample_visible", "false"}})
        .exemplar("height-correlated", {{"material", "silver"},
                                        {"distribution", "ggx"},
                                        {"alpha", "0.5"},
                                        {"height_correlated", "true"},
                                        {"bounded_sampling", "false"}})
        .exemplar("compensated",
                  {{"energy_compensation", "true"}, {"distribution", "ggx"}, {"alpha", "0.8"}},
                  true)
        .exemplar("compensated gold", {{"energy_compensation", "true"},
                                       {"material", "gold"},
                                       {"alpha_u", "0.2"},
                                       {"alpha_v", "0.6"},
                                       {"specular_reflectance", "0.9,0.8,1"}});
  }

  void prepare_once(PrepareOnce& context)
    requires std::is_same_v<T, double>
  {
    if (!energy_compensation)
      return;
    bool ratios = context.has_texture("alpha_u") || context.has_texture("alpha_v");
    auto make = ratios ? make_energy_table_of_ratios : make_energy_table;
    energy_ = context.add_table(make(options(), alpha_u, alpha_v));
  }

  FACETA_INLINE void prepare() {
    surface_ = {options(), alpha_u, alpha_v};
    indices_ = {eta, k};
  }

  FACETA_INLINE Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi, const Context<T>&) const {
    MicrofacetReflection<T> r = surface_.reflection(wo, wi);
    Eval<T> e;
    e.value = specular_reflectance * indices_.reflectance(r.cos2_h) * r.value;
    e.pdf = r.pdf;
    if (energy_compensation)
      add_multiple_scattering(e, wo, wi);
    return e;
  }

  FACETA_INLINE Sample<T> sample(const Vec3<T>& wo, const Random<T>& random,
                                 const Context<T>& context) const {
    return weigh(wo, sample_direction(wo, random, context), context);
  }
  FACETA_INLINE ReflectedDirection<T> sample_direction(const Vec3<T>& wo, const Random<T>& random,
                                                       const Context<T>&) const {
    if (!energy_compensation)
      return surface_.sample_direction(wo, random.u, random.uc);
    ReflectedDirection<T> d;
    d.wi = select(random.uc < lookup().lost(wo), cosine_hemisphere(random.u),
                  surface_.sample_reflection(wo, random.u));
    return d;
  }
  FACETA_INLINE Sample<T> weigh(const Vec3<T>& wo, const ReflectedDirection<T>& d,
                                const Context<T>& context) const {
    Sample<T> s;
    s.wi = d.wi;
    s.lobe = kReflection;
    s.valid = (wo.z > T(0)) & (s.wi.z > T(0));
    if (energy_compensation) {
      finish_sample(s, eval(wo, s.wi, context));
      return s;
    }
    WeighedReflection<T> r = surface_.weigh(wo, d);
    s.valid = s.valid & (r.pdf > T(kSmallestDensity));
    s.pdf = select(s.valid, r.pdf, T(0));
    s.weight =
        specular_reflectance * indices_.reflectance(r.cos2_h) * select(s.valid, r.weight, T(0));
    s.value = s.weight * s.pdf;
    return s;
  }

private:
  Table<T> energy_;
  Microfacet<T> surface_;
  ConductorIndices<T> indices_;

  FACETA_INLINE MicrofacetOptions options() const {
    return {distribution, sample_visible, height_correlated, bounded_sampling};
  }
  FACETA_INLINE EnergyLookup<T> lookup() const { return {energy_, alpha_u, alpha_v}; }

  /// Kulla and Conty's lobe (1 - E(wo)) (1 - E(wi)) / (pi (1 - Eavg)), coloured by the Fresnel
  /// reflectance of all further bounces; sampled with probability 1 - E(wo).
  FACETA_INLINE void add_multiple_scattering(Eval<T>& e, const Vec3<T>& wo,
                                             const Vec3<T>& wi) const {
    auto above = (wo.z > T(0)) & (wi.z > T(0));
    EnergyLookup<T> table = lookup();
    T lost_o = table.lost(wo), lost_i = table.lost(wi), lost = table.mean_lost();
    T lobe = lost_o * lost_i * wi.z * T(kInvPi) / max(lost, T(1e-6));
    Color<T> f = fresnel_conductor_mean(eta, k);
    Color<T> colour = f.map([&](const T& c) { return c * c * (T(1) - lost) / (T(1) - c * lost); });
    e.value += specular_reflectance * colour * select(above, lobe, T(0));
    T pdf = fma(lost_o, wi.z * T(kInvPi) - e.pdf, e.pdf);
    e.pdf = select(above, pdf, T(0));
  }
};

} // namespace faceta
