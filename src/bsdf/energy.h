#pragma once

/// The energy that microfacet surfaces lose because light is followed for one bounce only: tables
/// of the directional albedo, for the compensation of Kulla and Conty 2017 ("Revisiting Physically
/// Based Shading at Imageworks").

#include "bsdf/describe.h"
#include "bsdf/microfacet.h"

namespace faceta {

/// Albedo of a white (F = 1) surface seen from wo, by quadrature over `n`^2 visible normals; the
/// surface as in the options. 2e-4 absolute at n = 24.
double microfacet_albedo(const MicrofacetOptions& options, double alpha_u, double alpha_v,
                         const Vec3<double>& wo, int n = 24);

/// The table that EnergyLookup reads: 1 - albedo over inclination, azimuth and roughness (at the
/// ratio alpha_u / alpha_v given), with nodes at the roughness given. About 50 ms.
std::vector<double> make_energy_table(const MicrofacetOptions& options, double alpha_u,
                                      double alpha_v);

/// The layout of the table, shared by its maker and its reader.
struct EnergyTableLayout {
  static constexpr int kInclinations = 32, kAzimuths = 5;
  static constexpr int kBelow = 6,
                       kAbove = 6; ///< steps of roughness up to the material's own, and beyond
  static constexpr int kRoughnesses = kBelow + kAbove + 1;
  static constexpr int kHeader = 2; ///< the material's own roughness, the largest tabulated
  static constexpr int kSlice = kInclinations * kAzimuths;
  static constexpr int kMeans = kHeader + kSlice * kRoughnesses;
  static constexpr int kSize = kMeans + kRoughnesses;

  /// Coordinate in [0, 1] of cos theta: resolves angles as grazing as the roughness, where the
  /// albedo dips, for any roughness.
  template <class T> static FACETA_INLINE T inclination(const T& cos, const T& roughness) {
    return cos * (T(1) + roughness) / (cos + roughness);
  }
  /// Coordinate in [0, 1] of the azimuth: cos^2 phi.
  template <class T> static FACETA_INLINE T azimuth(const Vec3<T>& w) {
    T x2 = w.x * w.x;
    return x2 / max(fma(w.y, w.y, x2), T(1e-30));
  }
};

/// Reads the table at the roughness of each lane.
template <class T> struct EnergyLookup {
  using Layout = EnergyTableLayout;

  FACETA_INLINE EnergyLookup(const Table<T>& t, const T& alpha_u, const T& alpha_v) : table(t) {
    roughness = sqrt(max(alpha_u, T(1e-4)) * max(alpha_v, T(1e-4)));
    T own = table.at(IntOf<T>(0)), largest = table.at(IntOf<T>(1));
    T below = roughness * T(Layout::kBelow) / own;
    T above = T(Layout::kBelow) + (roughness - own) * T(Layout::kAbove) / (largest - own);
    T position = clamp(select(roughness <= own, below, above), T(0), T(Layout::kRoughnesses - 1));
    T whole = min(floor(position), T(Layout::kRoughnesses - 2));
    fraction = position - whole;
    index = to_int(whole);
  }

  /// 1 - albedo seen from w, in [0, 1].
  FACETA_INLINE T lost(const Vec3<T>& w) const {
    T x = clamp01(Layout::inclination(max(w.z, T(0)), roughness)) * T(Layout::kInclinations - 1);
    T y = clamp01(Layout::azimuth(w)) * T(Layout::kAzimuths - 1);
    T xi = min(floor(x), T(Layout::kInclinations - 2)),
      yi = min(floor(y), T(Layout::kAzimuths - 2));
    IntOf<T> i = IntOf<T>(Layout::kHeader) + index * IntOf<T>(Layout::kSlice) +
                 to_int(yi) * IntOf<T>(Layout::kInclinations) + to_int(xi);
    T rough[2];
    for (int k = 0; k < 2; ++k) {
      IntOf<T> j = i + IntOf<T>(k * Layout::kSlice);
      T near = lerp(table.at(j), table.at(j + IntOf<T>(1)), x - xi);
      j = j + IntOf<T>(Layout::kInclinations);
      T far = lerp(table.at(j), table.at(j + IntOf<T>(1)), x - xi);
      rough[k] = lerp(near, far, y - yi);
    }
    return clamp01(lerp(rough[0], rough[1], fraction));
  }
  /// The mean of lost() over the hemisphere, weighted by the cosine.
  FACETA_INLINE T mean_lost() const {
    IntOf<T> i = IntOf<T>(Layout::kMeans) + index;
    return lerp(table.at(i), table.at(i + IntOf<T>(1)), fraction);
  }

private:
  Table<T> table;
  T roughness, fraction;
  IntOf<T> index;
};

} // namespace faceta
