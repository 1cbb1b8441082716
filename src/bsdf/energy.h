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

/// The same over the ratio too, for textures that change it; the roughness given is their mean's.
/// About 400 ms.
std::vector<double> make_energy_table_of_ratios(const MicrofacetOptions& options, double alpha_u,
                                                double alpha_v);

/// The layout of the table, shared by its makers and its reader: a header; then one part for each
/// ratio: 1 - albedo over roughness, azimuth and inclination, and its mean over the hemisphere for
/// each roughness.
struct EnergyTableLayout {
  static constexpr int kInclinations = 64, kAzimuths = 9;
  /// Steps of roughness up to the material's own, and beyond.
  static constexpr int kBelow = 4, kAbove = 4;
  static constexpr int kRoughnesses = kBelow + kAbove + 1;
  /// Parts of a table of ratios: evenly spread over 1 - sqrt(1 / ratio) from 1 to 100. Surfaces
  /// with alpha_u < alpha_v are those with the axes exchanged.
  static constexpr int kRatios = 7;
  static constexpr double kLargestRatio = 100, kLastRatio = 0.9;
  /// The material's own roughness, the largest one tabulated; alpha_u / alpha_v and its inverse, or
  /// 0 and 0 where there is a part for each ratio. Roughness is the geometric mean of alpha_u and
  /// alpha_v, with a part for each ratio their mean, at which the loss depends on the ratio least.
  static constexpr int kHeader = 4;
  static constexpr int kSlice = kInclinations * kAzimuths;
  static constexpr int kMeans = kSlice * kRoughnesses; ///< from the start of a part
  static constexpr int kPart = kMeans + kRoughnesses;
  static constexpr int kSize = kHeader + kPart; ///< of a table for one ratio
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
    T u = max(alpha_u, T(1e-4)), v = max(alpha_v, T(1e-4));
    roughness_ = sqrt(u * v);
    ratio_ = table_.at(IntOf<T>(2));
    inverse_ratio_ = table_.at(IntOf<T>(3));
    first_ = second_ = IntOf<T>(Layout::kHeader);
    auto several = ratio_ <= T(0);
    has_ratios_ = any(several);
    T size = roughness_;
    if (has_ratios_) {
      size = select(several, T(0.5) * (u + v), size);
      find_ratio(several, u, v);
    }
    T own = table_.at(IntOf<T>(0)), largest = table_.at(IntOf<T>(1));
    T below = size * T(Layout::kBelow) / own;
    T above = T(Layout::kBelow) + (size - own) * T(Layout::kAbove) / (largest - own);
    T position = clamp(select(size <= own, below, above), T(0), T(Layout::kRoughnesses - 1));
    T whole = min(floor(position), T(Layout::kRoughnesses - 2));
    fraction_ = position - whole;
    index_ = to_int(whole);
  }

  /// 1 - albedo seen from w, in [0, 1].
  FACETA_INLINE T lost(const Vec3<T>& w) const {
    if (!has_ratios_)
      return clamp01(lost_in(first_, {w, roughness_, ratio_, inverse_ratio_}));
    Vec3<T> along{select(exchanged_, w.y, w.x), select(exchanged_, w.x, w.y), w.z};
    EnergyCoordinates<T> c(along, roughness_, ratio_, inverse_ratio_);
    return clamp01(lerp(lost_in(first_, c), lost_in(second_, c), ratio_fraction_));
  }
  /// The mean of lost() over the hemisphere, weighted by the cosine.
  FACETA_INLINE T mean_lost() const {
    T mean = mean_in(first_);
    return has_ratios_ ? lerp(mean, mean_in(second_), ratio_fraction_) : mean;
  }

private:
  Table<T> table_;
  T roughness_, fraction_, ratio_, inverse_ratio_, ratio_fraction_{0};
  IntOf<T> index_, first_, second_; ///< the parts between which the ratio lies
  MaskOf<T> exchanged_{};
  bool has_ratios_;

  /// Lanes whose table has parts for each ratio use their own one instead of the table's.
  FACETA_INLINE void find_ratio(const MaskOf<T>& several, const T& u, const T& v) {
    exchanged_ = several & (u < v);
    T ratio = min(max(u, v) / min(u, v), T(Layout::kLargestRatio));
    ratio_ = select(several, ratio, ratio_);
    inverse_ratio_ = T(1) / ratio_;
    T step = T((Layout::kRatios - 1) / Layout::kLastRatio);
    T position = select(several, (T(1) - sqrt(inverse_ratio_)) * step, T(0));
    T whole = min(floor(position), T(Layout::kRatios - 2));
    ratio_fraction_ = position - whole;
    first_ = first_ + to_int(whole) * IntOf<T>(Layout::kPart);
    second_ = first_ + select(several, IntOf<T>(Layout::kPart), IntOf<T>(0));
  }
  FACETA_INLINE T lost_in(const IntOf<T>& part, const EnergyCoordinates<T>& c) const {
    T x = c.inclination * T(Layout::kInclinations - 1), y = c.azimuth * T(Layout::kAzimuths - 1);
    T xi = min(floor(x), T(Layout::kInclinations - 2));
    T yi = min(floor(y), T(Layout::kAzimuths - 2));
    IntOf<T> i = part + index_ * IntOf<T>(Layout::kSlice) +
                 to_int(yi) * IntOf<T>(Layout::kInclinations) + to_int(xi);
    T rough[2];
    for (int k = 0; k < 2; ++k) {
      IntOf<T> j = i + IntOf<T>(k * Layout::kSlice);
      T near = table_.between(j, x - xi);
      j = j + IntOf<T>(Layout::kInclinations);
      T far = table_.between(j, x - xi);
      rough[k] = lerp(near, far, y - yi);
    }
    return lerp(rough[0], rough[1], fraction_);
  }
  FACETA_INLINE T mean_in(const IntOf<T>& part) const {
    IntOf<T> i = part + IntOf<T>(Layout::kMeans) + index_;
    return table_.between(i, fraction_);
  }
};

} // namespace faceta
