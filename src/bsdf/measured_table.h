#pragma once

/// Measured values as the renderer reads them: one block of numbers that begins with a
/// MeasuredHeader. All lanes use the same block, so that what the header says is the same for all.
///
/// Values come from the file's own table: a grid, or the parametrisation of Dupuy and Jakob 2018
/// ("An Adaptive Parameterization for Efficient Material Acquisition and Rendering"). Directions
/// are sampled by that paper's two warps for every table: visible normals, then luminance; beside
/// it comes a share of cosine-weighted directions, which bounds the weights.

#include "bsdf/bsdf.h"
#include "bsdf/describe.h"
#include "bsdf/measured_data.h"
#include "sampling/warp.h"

namespace faceta {

/// What evaluates the values of a block.
enum class MeasuredKind : int32_t { grid, rgl };

/// All offsets count floats from the start of the block.
struct MeasuredHeader {
  MeasuredKind kind;

  /// kind grid. Periodic axes end in their first node once more, and each has at least two.
  struct Axis {
    int32_t cells;       ///< one less than the nodes
    int32_t nodes;       ///< where they are, for axes that are not uniform; else 0
    int32_t stride;      ///< floats from a node's value to the next one's
    int32_t square_root; ///< nodes are square roots of angles
    float first;         ///< node
    float scale;         ///< uniform: one over the distance of nodes
    float period;        ///< 0: none
  };
  MeasuredCoordinates coordinates;
  int32_t axes;
  Axis axis[4];
  int32_t holes;  ///< whether cells are missing, as -1
  int32_t values; ///< red, green, blue side by side

  /// A function of two numbers in [0, 1]^2 at ny rows of nx nodes, bilinear between them; a slice
  /// of them for each viewer of the list, blended linearly.
  struct Warp {
    int32_t nx, ny;
    int32_t data;        ///< slices of [ny][nx], each with a mean of 1 / ((nx - 1) (ny - 1))
    int32_t conditional; ///< sums along the rows, from 0
    int32_t rows;        ///< [ny][2]: sum up to the row, sum of the row
  };
  int32_t phis, thetas;           ///< viewers; one phi: isotropic
  int32_t phi_nodes, theta_nodes; ///< where they are
  int32_t sectors;                ///< phis span one of that many like parts of the circle
  Warp vndf, luminance;
  float cosine_share;

  /// kind rgl: two functions with data only; rgb has three numbers a node, slices as luminance.
  Warp ndf, sigma; ///< as they are, divided by (nx - 1) (ny - 1)
  int32_t rgb;
  int32_t jacobian;
};
static_assert(sizeof(MeasuredHeader) % sizeof(float) == 0);

/// A colour of a file.
template <class T> struct MeasuredRgb {
  T r{0}, g{0}, b{0};

  FACETA_INLINE void add(const T& weight, const MeasuredRgb& other) {
    r = fma(weight, other.r, r);
    g = fma(weight, other.g, g);
    b = fma(weight, other.b, b);
  }
  /// Over the channels of a colour, the three again and again.
  FACETA_INLINE Color<T> color() const {
    Color<T> c;
    for (int i = 0; i < Color<T>::size(); ++i)
      c[i] = i % 3 == 0 ? r : i % 3 == 1 ? g : b;
    return c;
  }
};

/// Three numbers at base[index] and the three after them.
template <class T> struct MeasuredRgbPair {
  MeasuredRgb<T> first, second;
  FACETA_INLINE MeasuredRgbPair(const float* base, const IntOf<T>& index) {
    Neighbours<T> a = gather_pair<T>(base, index), b = gather_pair<T>(base, index + IntOf<T>(2)),
                  c = gather_pair<T>(base, index + IntOf<T>(4));
    first = {a.first, a.second, b.first};
    second = {b.second, c.first, c.second};
  }
};

/// The interval of increasing nodes that x lies in (the outermost beyond them), and where in it.
template <class T> struct MeasuredInterval {
  IntOf<T> index;
  T fraction;

  /// n >= 2 nodes.
  FACETA_INLINE MeasuredInterval(const float* nodes, int n, const T& x) : index(0) {
    int step = 1;
    while (2 * step <= n - 2)
      step *= 2;
    for (; step > 0; step /= 2) {
      IntOf<T> candidate = min(index + IntOf<T>(step), IntOf<T>(n - 2));
      index = select(gather<T>(nodes, candidate) <= x, candidate, index);
    }
    Neighbours<T> ends = gather_pair<T>(nodes, index);
    fraction = clamp01((x - ends.first) / (ends.second - ends.first));
  }
};

/// The slices of a warp for a viewer, with their weights.
template <class T> struct MeasuredSlices {
  int count;
  IntOf<T> index[4];
  T weight[4];
};

/// A Warp at a viewer's slices.
template <class T> class MeasuredWarp {
public:
  FACETA_INLINE MeasuredWarp(const float* base, const MeasuredHeader::Warp& warp,
                             const MeasuredSlices<T>& slices)
      : base_(base), w_(warp), slices_(slices) {
    for (int k = 0; k < slices.count; ++k) {
      start_[k] = slices.index[k] * IntOf<T>(w_.nx * w_.ny);
      row_start_[k] = slices.index[k] * IntOf<T>(2 * w_.ny);
    }
  }

  struct Point {
    Vec2<T> u;
    T density;
  };

  /// The density at u.
  FACETA_INLINE T density(const Vec2<T>& u) const {
    Cell c(w_, u);
    Corners d = corners(c.index);
    return lerp(lerp(d.v00, d.v10, c.x), lerp(d.v01, d.v11, c.x), c.y) * scale();
  }
  /// The uniform numbers that sample() makes u of, and the density there.
  FACETA_INLINE Point invert(const Vec2<T>& u) const {
    Cell c(w_, u);
    Corners d = corners(c.index);
    T before0 = at(w_.conditional, start_, c.index),
      before1 = at(w_.conditional, start_, c.index + IntOf<T>(w_.nx));
    Rows r = rows(c.row);
    T left = lerp(d.v00, d.v01, c.y), right = lerp(d.v10, d.v11, c.y);
    T x = fma(c.x, fma(T(0.5) * c.x, right - left, left), lerp(before0, before1, c.y));
    T total = lerp(r.sum0, r.sum1, c.y);
    x = select(total > T(0), x / max(total, T(kTiny)), T(0));
    T y = fma(c.y, fma(T(0.5) * c.y, r.sum1 - r.sum0, r.sum0), r.before);
    return {{clamp01(x), clamp01(y)}, lerp(left, right, c.x) * scale()};
  }
  /// A point with that density from uniform numbers: rows by u.y, then along them by u.x.
  FACETA_INLINE Point sample(const Vec2<T>& u) const {
    auto sum_before = [&](const IntOf<T>& j)
                          FACETA_INLINE_LAMBDA { return at(w_.rows, row_start_, j + j); };
    IntOf<T> row = search(w_.ny, u.y, sum_before);
    Rows r = rows(row);
    T y = solve(u.y - r.before, r.sum0, r.sum1);
    T x = u.x * lerp(r.sum0, r.sum1, y);
    IntOf<T> first = row * IntOf<T>(w_.nx);
    auto before = [&](const IntOf<T>& i) FACETA_INLINE_LAMBDA {
      IntOf<T> cell = first + i;
      return lerp(at(w_.conditional, start_, cell),
                  at(w_.conditional, start_, cell + IntOf<T>(w_.nx)), y);
    };
    IntOf<T> column = search(w_.nx, x, before);
    Corners d = corners(first + column);
    T left = lerp(d.v00, d.v01, y), right = lerp(d.v10, d.v11, y);
    T along = solve(x - before(column), left, right);
    return {{clamp01((to_number(column) + along) * T(1.0f / float(w_.nx - 1))),
             clamp01((to_number(row) + y) * T(1.0f / float(w_.ny - 1)))},
            lerp(left, right, along) * scale()};
  }

private:
  static constexpr float kTiny = 1e-30f;

  struct Cell {
    IntOf<T> index, row;
    T x, y;
    FACETA_INLINE Cell(const MeasuredHeader::Warp& w, const Vec2<T>& u) {
      T px = u.x * T(float(w.nx - 1)), py = u.y * T(float(w.ny - 1));
      T ix = clamp(floor(px), T(0), T(float(w.nx - 2)));
      T iy = clamp(floor(py), T(0), T(float(w.ny - 2)));
      x = px - ix;
      y = py - iy;
      row = to_int(iy);
      index = row * IntOf<T>(w.nx) + to_int(ix);
    }
  };
  struct Corners {
    T v00{0}, v10{0}, v01{0}, v11{0};
  };
  struct Rows {
    T before{0}, sum0{0}, sum1{0};
  };

  FACETA_INLINE T scale() const { return T(float((w_.nx - 1) * (w_.ny - 1))); }
  static FACETA_INLINE T to_number(const IntOf<T>& i) {
    if constexpr (kWidthOf<T> > 1)
      return to_float(i);
    else
      return T(i);
  }
  FACETA_INLINE T at(int32_t offset, const IntOf<T> (&start)[4], const IntOf<T>& i) const {
    T sum = slices_.weight[0] * gather<T>(base_ + offset, start[0] + i);
    for (int k = 1; k < slices_.count; ++k)
      sum = fma(slices_.weight[k], gather<T>(base_ + offset, start[k] + i), sum);
    return sum;
  }
  FACETA_INLINE Corners corners(const IntOf<T>& cell) const {
    Corners c;
    for (int k = 0; k < slices_.count; ++k) {
      Neighbours<T> low = gather_pair<T>(base_ + w_.data, start_[k] + cell);
      Neighbours<T> high = gather_pair<T>(base_ + w_.data, start_[k] + cell + IntOf<T>(w_.nx));
      const T& w = slices_.weight[k];
      c.v00 = fma(w, low.first, c.v00);
      c.v10 = fma(w, low.second, c.v10);
      c.v01 = fma(w, high.first, c.v01);
      c.v11 = fma(w, high.second, c.v11);
    }
    return c;
  }
  FACETA_INLINE Rows rows(const IntOf<T>& row) const {
    Rows r;
    for (int k = 0; k < slices_.count; ++k) {
      IntOf<T> i = row_start_[k] + row + row;
      Neighbours<T> low = gather_pair<T>(base_ + w_.rows, i);
      const T& w = slices_.weight[k];
      r.before = fma(w, low.first, r.before);
      r.sum0 = fma(w, low.second, r.sum0);
      r.sum1 = fma(w, gather<T>(base_ + w_.rows, i + IntOf<T>(3)), r.sum1);
    }
    return r;
  }
  /// The last of the first n - 1 places whose sum is below x.
  template <class F> static FACETA_INLINE IntOf<T> search(int n, const T& x, const F& sum_before) {
    int step = 1;
    while (2 * step <= n - 2)
      step *= 2;
    IntOf<T> index(0);
    for (; step > 0; step /= 2) {
      IntOf<T> candidate = min(index + IntOf<T>(step), IntOf<T>(n - 2));
      index = select(sum_before(candidate) < x, candidate, index);
    }
    return index;
  }
  /// Where the integral of lerp(a, b, t) from 0 is y.
  static FACETA_INLINE T solve(const T& y, const T& a, const T& b) {
    T rest = max(y, T(0));
    T root = safe_sqrt(fma(a, a, T(2) * rest * (b - a)));
    return clamp01(T(2) * rest / max(a + root, T(kTiny)));
  }

  const float* base_;
  const MeasuredHeader::Warp& w_;
  const MeasuredSlices<T>& slices_;
  IntOf<T> start_[4], row_start_[4];
};

/// The block, read for lanes of directions.
template <class T> class MeasuredTable {
public:
  explicit FACETA_INLINE MeasuredTable(const float* base) : base_(base) {
    std::memcpy(&h_, base, sizeof h_);
  }

  /// f_r |cos theta_i| of the file and the density of sample(). Both directions above the surface.
  FACETA_INLINE Eval<T> eval(Vec3<T> wo, Vec3<T> wi) const {
    Vec2<T> signs = sector(wo);
    wo = mirrored(wo, signs);
    wi = mirrored(wi, signs);
    Half half(wo, wi);
    MeasuredSlices<T> slices = viewer_slices(wo);
    MeasuredWarp<T> normals(base_, h_.vndf, slices);
    Vec2<T> u = half.square(isotropic_azimuth(wo));
    auto warped = normals.invert(u);
    MeasuredWarp<T> light(base_, h_.luminance, slices);
    T pdf = warped.density * light.density(warped.u) / jacobian(half, u);
    Eval<T> e;
    e.value = h_.kind == MeasuredKind::rgl ? rgl_value(wo, u, warped.u, slices)
                                           : grid_value(wo, wi, half) * wi.z;
    T share(h_.cosine_share);
    e.pdf = fma(T(1) - share, pdf, share * T(kInvPi) * wi.z);
    return e;
  }

  /// What eval() gives for tables that need no warps (all kinds but rgl).
  FACETA_INLINE Color<T> grid_value(const Vec3<T>& wo, const Vec3<T>& wi) const {
    return grid_value(wo, wi, Half(wo, wi)) * wi.z;
  }

  /// A direction above or below the surface; the caller refuses the latter.
  FACETA_INLINE Vec3<T> sample(Vec3<T> wo, const Random<T>& random) const {
    Vec2<T> signs = sector(wo);
    wo = mirrored(wo, signs);
    MeasuredSlices<T> slices = viewer_slices(wo);
    // Luminance by the numbers in this order, as in the paper's own implementation.
    Vec2<T> s = MeasuredWarp<T>(base_, h_.luminance, slices).sample({random.u.y, random.u.x}).u;
    Vec2<T> u = MeasuredWarp<T>(base_, h_.vndf, slices).sample(s).u;
    SinCos<T> theta = sincos(sqr(u.x) * T(0.5 * kPi));
    SinCos<T> phi = sincos(fma(T(2), u.y, T(-1)) * T(kPi));
    Vec3<T> m{theta.sin * phi.cos, theta.sin * phi.sin, theta.cos};
    if (h_.phis == 1)
      m = turned(m, azimuth(wo));
    Vec3<T> wi = mirrored(reflect(wo, m), signs);
    if (h_.cosine_share > 0)
      wi = select(random.uc < T(h_.cosine_share), cosine_hemisphere(random.u), wi);
    return wi;
  }

private:
  /// Cosine and sine of an azimuth; (1, 0) where it has none.
  static FACETA_INLINE Vec2<T> azimuth(const Vec3<T>& w) {
    T r2 = sin_theta_squared(w);
    auto none = !(r2 > T(0));
    T inverse = T(1) / sqrt(select(none, T(1), r2));
    return {select(none, T(1), w.x * inverse), w.y * inverse};
  }
  static FACETA_INLINE T angle(const T& y, const T& x) {
    auto none = (y == T(0)) & (x == T(0));
    return atan2(y, select(none, T(1), x)); // 0 has no slope
  }
  /// Signs that bring a viewer into the sector that the table holds.
  FACETA_INLINE Vec2<T> sector(const Vec3<T>& wo) const {
    if (h_.sectors < 2)
      return {T(1), T(1)};
    T y = copysign(T(1), wo.y);
    return {h_.sectors == 4 ? copysign(T(1), wo.x) : y, y};
  }
  static FACETA_INLINE Vec3<T> mirrored(const Vec3<T>& w, const Vec2<T>& signs) {
    return {w.x * signs.x, w.y * signs.y, w.z};
  }
  static FACETA_INLINE T inclination(const Vec3<T>& w) {
    return angle(sqrt(sin_theta_squared(w)), w.z);
  }
  /// w turned about the normal by the azimuth a.
  static FACETA_INLINE Vec3<T> turned(const Vec3<T>& w, const Vec2<T>& a) {
    return {fma(w.x, a.x, -(w.y * a.y)), fma(w.x, a.y, w.y * a.x), w.z};
  }

  /// The half vector and what grids and warps ask of it.
  struct Half {
    Vec3<T> m;
    T cosine, sine; ///< of the angle between m and either direction
    FACETA_INLINE Half(const Vec3<T>& wo, const Vec3<T>& wi) {
      Vec3<T> sum = wo + wi, difference = wo - wi;
      T length = sqrt(dot(sum, sum));
      auto opposite = !(length > T(1e-6)); // along the horizon: any normal will do
      m = select(opposite, Vec3<T>{T(0), T(0), T(1)}, sum * (T(1) / max(length, T(1e-6))));
      cosine = max(T(0.5) * length, T(1e-6));
      sine = T(0.5) * sqrt(dot(difference, difference));
    }
    /// Where it is in the square of the warps; `turn` is taken from its azimuth.
    FACETA_INLINE Vec2<T> square(const Vec2<T>& turn) const {
      Vec3<T> local = turned(m, {turn.x, -turn.y});
      T y = fma(angle(local.y, local.x), T(kInvTwoPi), T(0.5));
      return {sqrt(inclination(m) * T(2 * kInvPi)), y - floor(y)};
    }
  };

  FACETA_INLINE Vec2<T> isotropic_azimuth(const Vec3<T>& wo) const {
    return h_.phis == 1 ? azimuth(wo) : Vec2<T>{T(1), T(0)};
  }
  /// Solid angle of wi for an area of the square of normals.
  static FACETA_INLINE T jacobian(const Half& half, const Vec2<T>& u) {
    T sine = sqrt(sin_theta_squared(half.m));
    return max(T(2 * kPi * kPi) * u.x * sine, T(1e-6)) * (T(4) * half.cosine);
  }

  FACETA_INLINE MeasuredSlices<T> viewer_slices(const Vec3<T>& wo) const {
    MeasuredInterval<T> theta(base_ + h_.theta_nodes, h_.thetas, inclination(wo));
    MeasuredSlices<T> s;
    s.count = 2;
    s.index[0] = theta.index;
    s.index[1] = theta.index + IntOf<T>(1);
    s.weight[0] = T(1) - theta.fraction;
    s.weight[1] = theta.fraction;
    if (h_.phis == 1)
      return s;
    MeasuredInterval<T> phi(base_ + h_.phi_nodes, h_.phis, angle(wo.y, wo.x));
    s.count = 4;
    for (int k = 3; k >= 0; --k) {
      const T& w = s.weight[k & 1];
      s.weight[k] = w * (k < 2 ? T(1) - phi.fraction : phi.fraction);
      s.index[k] = s.index[k & 1] + (phi.index + IntOf<T>(k / 2)) * IntOf<T>(h_.thetas);
    }
    return s;
  }

  /// Dupuy and Jakob 2018, eq. 3 with the values in the square of luminance.
  FACETA_INLINE Color<T> rgl_value(const Vec3<T>& wo, const Vec2<T>& normal, const Vec2<T>& light,
                                   const MeasuredSlices<T>& slices) const {
    const MeasuredHeader::Warp& w = h_.luminance;
    T px = light.x * T(float(w.nx - 1)), py = light.y * T(float(w.ny - 1));
    T ix = clamp(floor(px), T(0), T(float(w.nx - 2)));
    T iy = clamp(floor(py), T(0), T(float(w.ny - 2)));
    T x = px - ix, y = py - iy;
    IntOf<T> cell = to_int(iy) * IntOf<T>(w.nx) + to_int(ix);
    MeasuredRgb<T> sum;
    for (int k = 0; k < slices.count; ++k) {
      IntOf<T> at = (slices.index[k] * IntOf<T>(w.nx * w.ny) + cell) * IntOf<T>(3);
      MeasuredRgbPair<T> low(base_ + h_.rgb, at);
      MeasuredRgbPair<T> high(base_ + h_.rgb, at + IntOf<T>(3 * w.nx));
      T near = slices.weight[k] * (T(1) - y), far = slices.weight[k] * y;
      sum.add(near * (T(1) - x), low.first);
      sum.add(near * x, low.second);
      sum.add(far * (T(1) - x), high.first);
      sum.add(far * x, high.second);
    }
    T factor(1);
    if (h_.jacobian) {
      MeasuredSlices<T> one{1, {IntOf<T>(0)}, {T(1)}};
      T phi = fma(angle(wo.y, wo.x), T(kInvTwoPi), T(0.5));
      Vec2<T> viewer{sqrt(inclination(wo) * T(2 * kInvPi)), phi};
      T sigma = MeasuredWarp<T>(base_, h_.sigma, one).density(viewer);
      factor = MeasuredWarp<T>(base_, h_.ndf, one).density(normal) / (T(4) * sigma);
    }
    return sum.color().map([&](const T& v) { return max(v, T(0)) * factor; });
  }

  struct Place {
    IntOf<T> offset;
    T fraction;
  };
  /// The node at or before an angle, and how far it is to the next.
  FACETA_INLINE Place place(const MeasuredHeader::Axis& axis, T x) const {
    if (axis.square_root)
      x = sqrt(x);
    if (axis.period > 0) {
      T turns = (x - T(axis.first)) * T(1 / axis.period);
      x = fma(turns - floor(turns), T(axis.period), T(axis.first));
    }
    if (axis.nodes) {
      MeasuredInterval<T> i(base_ + axis.nodes, axis.cells + 1, x);
      return {i.index * IntOf<T>(axis.stride), i.fraction};
    }
    T p = clamp((x - T(axis.first)) * T(axis.scale), T(0), T(float(axis.cells)));
    T whole = min(floor(p), T(float(axis.cells - 1)));
    return {to_int(whole) * IntOf<T>(axis.stride), p - whole};
  }
  /// An azimuth or a difference of two for an axis: folded if it is not periodic.
  static FACETA_INLINE T folded(const MeasuredHeader::Axis& axis, const T& phi) {
    return axis.period > 0 ? phi : abs(phi);
  }
  static FACETA_INLINE T azimuth_angle(const Vec3<T>& w) { return angle(w.y, w.x); }

  /// The coordinates of a pair of directions; see MeasuredCoordinates.
  FACETA_INLINE void coordinates(const Vec3<T>& wo, const Vec3<T>& wi, const Half& half,
                                 T (&x)[4]) const {
    T difference = angle(fma(wi.x, wo.y, -(wi.y * wo.x)), fma(wi.x, wo.x, wi.y * wo.y));
    switch (h_.coordinates) {
    case MeasuredCoordinates::half_difference: {
      Vec2<T> a = azimuth(half.m);
      Vec3<T> local = turned(wi, {a.x, -a.y});
      T sine = sqrt(sin_theta_squared(half.m));
      x[0] = inclination(half.m);
      x[1] = angle(half.sine, half.cosine);
      x[2] = folded(h_.axis[2], angle(local.y, fma(local.x, half.m.z, -(local.z * sine))));
      return;
    }
    case MeasuredCoordinates::relative:
      x[0] = inclination(wi);
      x[1] = inclination(wo);
      x[2] = folded(h_.axis[2], difference);
      return;
    case MeasuredCoordinates::relative_rotated:
    case MeasuredCoordinates::absolute:
      x[0] = inclination(wi);
      x[1] = folded(h_.axis[1], azimuth_angle(wi));
      x[2] = inclination(wo);
      x[3] = folded(h_.axis[3], h_.coordinates == MeasuredCoordinates::absolute ? azimuth_angle(wo)
                                                                                : difference);
      return;
    case MeasuredCoordinates::specular:
    case MeasuredCoordinates::specular_rotated: {
      bool rotated = h_.coordinates == MeasuredCoordinates::specular_rotated;
      x[0] = inclination(wi);
      x[1] = rotated ? folded(h_.axis[1], azimuth_angle(wi)) : T(0);
      // Frame about the mirror direction: in the plane of incidence, and across it.
      Vec2<T> a = azimuth(Vec3<T>{-wi.x, -wi.y, wi.z});
      Vec3<T> local = turned(wo, {a.x, -a.y});
      T sine = sqrt(sin_theta_squared(wi));
      T along = fma(local.x, wi.z, -(local.z * sine)), up = fma(local.x, sine, local.z * wi.z);
      int k = rotated ? 2 : 1;
      x[k] = angle(sqrt(fma(along, along, local.y * local.y)), up);
      x[k + 1] = folded(h_.axis[k + 1], angle(local.y, along));
      return;
    }
    }
  }

  FACETA_INLINE Color<T> grid_value(const Vec3<T>& wo, const Vec3<T>& wi, const Half& half) const {
    T x[4];
    coordinates(wo, wi, half, x);
    const int last = h_.axes - 1;
    Place places[4];
    for (int k = 0; k < h_.axes; ++k) {
      places[k] = place(h_.axis[k], x[k]);
      // Next to holes what is left of the weights keeps enough digits to be made one.
      if (h_.holes)
        places[k].fraction = clamp(places[k].fraction, T(0x1p-12), T(1 - 0x1p-12));
    }
    MeasuredRgb<T> sum;
    T weights(0);
    // All corners of the cell, two at a time along the last axis.
    for (int corner = 0; corner < (1 << last); ++corner) {
      IntOf<T> at = places[last].offset;
      T weight(1);
      for (int k = 0; k < last; ++k) {
        bool next = (corner >> k) & 1;
        at = at + places[k].offset + IntOf<T>(next ? h_.axis[k].stride : 0);
        weight = weight * (next ? places[k].fraction : T(1) - places[k].fraction);
      }
      MeasuredRgbPair<T> pair(base_ + h_.values, at);
      T second = weight * places[last].fraction, first = weight - second;
      if (h_.holes) {
        first = select(pair.first.r < T(0), T(0), first);
        second = select(pair.second.r < T(0), T(0), second);
        weights = weights + (first + second);
      }
      sum.add(first, pair.first);
      sum.add(second, pair.second);
    }
    Color<T> value = sum.color();
    return h_.holes ? value * select(weights > T(0), T(1) / max(weights, T(1e-20)), T(0)) : value;
  }

  const float* base_;
  MeasuredHeader h_;
};

} // namespace faceta
