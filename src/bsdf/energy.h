#pragma once

/// The energy that microfacet surfaces lose because light is followed for one bounce only: tables
/// of the directional albedo, for the compensation of Kulla and Conty 2017 ("Revisiting Physically
/// Based Shading at Imageworks").

#include "bsdf/describe.h"
#include "bsdf/microfacet.h"

namespace faceta {

/// Albedo of a white (F = 1) surface seen from wo, by quadrature over `n`^2 visible normals; the
/// surface as in the options. 4e-4 absolute at n = 64.
double microfacet_albedo(const MicrofacetOptions& options, double alpha_u, double alpha_v,
                         const Vec3<double>& wo, int n = 64);

/// The table that EnergyLookup reads: 1 - albedo over inclination, azimuth and roughness (at the
/// ratio alpha_u / alpha_v given), with nodes at the roughness given. About 30 ms, 160 ms for
/// anisotropic surfaces.
std::vector<double> make_energy_table(const MicrofacetOptions& options, double alpha_u,
                                      double alpha_v);

/// The layout of the table, shared by its maker and its reader: 1 - albedo over roughness, azimuth
/// and inclination; then the mean over the hemisphere for each roughness.
struct EnergyTableLayout {
  static constexpr int kInclinations = 64, kAzimuths = 9;
  /// Steps of roughness up to the material's own, and beyond.
  static constexpr int kBelow = 4, kAbove = 4;
  static constexpr int kRoughnesses = kBelow + kAbove + 1;
  /// The material's own roughness, the largest one tabulated, alpha_u / alpha_v and its inverse.
  static constexpr int kHeader = 4;
  static constexpr int kSlice = kInclinations * kAzimuths;
  static constexpr int kMeans = kHeader + kSlice * kRoughnesses;
  static constexpr int kSize = kMeans + kRoughnesses;
};

/// Where a direction falls in the table; both coordinates in [0, 1].
template <class T> struct EnergyCoordinates {
  T inclination, azimuth;

  /// roughness = sqrt(alpha_u alpha_v), ratio = alpha_u / alpha_v.
  FACETA_INLINE EnergyCoordinates(const Vec3<T>& w, const T& roughness, const T& ratio,
                                  const T& inverse_ratio) {
    // cos^2 of an azimuth between the given and the stretched surface's, where the albedo varies
    // evenly.
    T x2 = w.x * w.x, y2 = w.y * w.y;
    azimuth = clamp01(x2 * ratio / max(fma(x2, ratio, y2), T(1e-30)));
    T sum = fma(x2, ratio, y2 * inverse_ratio);
    // Resolves angles as grazing as the roughness along the view, where the albedo dips.
    T along = roughness * sqrt(sum / max(x2 + y2, T(1e-30)));
    T z = max(w.z, T(0));
    inclination = sqrt(clamp01(z * (T(1) + along) / (z + along)));
  }
};

/// Reads the table at the roughness of each lane.
template <class T> struct EnergyLookup {
  using Layout = EnergyTableLayout;

  FACETA_INLINE EnergyLookup(const Table<T>& t, const T& alpha_u, const T& alpha_v) : table_(t) {
    roughness_ = sqrt(max(alpha_u, T(1e-4)) * max(alpha_v, T(1e-4)));
    T own = table_.at(IntOf<T>(0)), largest = table_.at(IntOf<T>(1));
    T below = roughness_ * T(Layout::kBelow) / own;
    T above = T(Layout::kBelow) + (roughness_ - own) * T(Layout::kAbove) / (largest - own);
    T position = clamp(select(roughness_ <= own, below, above), T(0), T(Layout::kRoughnesses - 1));
    T whole = min(floor(position), T(Layout::kRoughnesses - 2));
    fraction_ = position - whole;
    index_ = to_int(whole);
  }

  /// 1 - albedo seen from w, in [0, 1].
  FACETA_INLINE T lost(const Vec3<T>& w) const {
    EnergyCoordinates<T> c(w, roughness_, table_.at(IntOf<T>(2)), table_.at(IntOf<T>(3)));
    T x = c.inclination * T(Layout::kInclinations - 1), y = c.azimuth * T(Layout::kAzimuths - 1);
    T xi = min(floor(x), T(Layout::kInclinations - 2));
    T yi = min(floor(y), T(Layout::kAzimuths - 2));
    IntOf<T> i = IntOf<T>(Layout::kHeader) + index_ * IntOf<T>(Layout::kSlice) +
                 to_int(yi) * IntOf<T>(Layout::kInclinations) + to_int(xi);
    T rough[2];
    for (int k = 0; k < 2; ++k) {
      IntOf<T> j = i + IntOf<T>(k * Layout::kSlice);
      T near = lerp(table_.at(j), table_.at(j + IntOf<T>(1)), x - xi);
      j = j + IntOf<T>(Layout::kInclinations);
      T far = lerp(table_.at(j), table_.at(j + IntOf<T>(1)), x - xi);
      rough[k] = lerp(near, far, y - yi);
    }
    return clamp01(lerp(rough[0], rough[1], fraction_));
  }
  /// The mean of lost() over the hemisphere, weighted by the cosine.
  FACETA_INLINE T mean_lost() const {
    IntOf<T> i = IntOf<T>(Layout::kMeans) + index_;
    return lerp(table_.at(i), table_.at(i + IntOf<T>(1)), fraction_);
  }

private:
  Table<T> table_;
  T roughness_, fraction_;
  IntOf<T> index_;
};

} // namespace faceta
