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

  /// A density over [0, 1]^2 at ny rows of nx nodes, bilinear between them, for each viewer, linear
  /// between those. Viewers' inclinations are the last axis: neighbours lie side by side.
  struct Warp {
    int32_t nx, ny;
    int32_t data;        ///< [phi][ny][nx][theta]; the cells of a viewer sum to one
    int32_t conditional; ///< the same, sums along the rows from 0
    int32_t rows;        ///< [phi][ny][2][theta]: sum up to the row, sum of the row
  };
  int32_t phis, thetas;           ///< viewers, at least two inclinations; one phi: isotropic
  int32_t phi_nodes, theta_nodes; ///< where they are
  int32_t sectors;                ///< phis span one of that many like parts of the circle
  float sector_x, sector_y;       ///< signs of the components of directions in that part
  Warp vndf, luminance;
  float cosine_share;

  /// kind rgl: two functions without viewers, and the colours at luminance's nodes.
  struct Plain {
    int32_t nx, ny, data;
  };
  Plain ndf, sigma;
  int32_t rgb; ///< [phi][ny][nx][theta][3]
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

/// A viewer among those that a table knows: between two inclinations, and for anisotropic tables
/// between two azimuths.
template <class T> struct MeasuredViewer {
  int phis; ///< 1 or 2
  IntOf<T> phi[2];
  T weight[2];
  IntOf<T> theta; ///< and the next one
  T fraction;
};

/// A cell of nx times ny equidistant nodes over [0, 1]^2.
template <class T> struct MeasuredCell {
  IntOf<T> column, row;
  T x, y; ///< where in it

  FACETA_INLINE MeasuredCell(int nx, int ny, const Vec2<T>& u) {
    T ix = clamp(floor(u.x * T(float(nx - 1))), T(0), T(float(nx - 2)));
    T iy = clamp(floor(u.y * T(float(ny - 1))), T(0), T(float(ny - 2)));
    x = fma(u.x, T(float(nx - 1)), -ix);
    y = fma(u.y, T(float(ny - 1)), -iy);
    column = to_int(ix);
    row = to_int(iy);
  }
};

/// A Warp as a viewer sees it.
template <class T> class MeasuredWarp {
public:
  FACETA_INLINE MeasuredWarp(const float* base, const MeasuredHeader& header,
                             const MeasuredHeader::Warp& warp, const MeasuredViewer<T>& viewer)
      : base_(base), thetas_(header.thetas), w_(warp), viewer_(viewer) {}

  struct Point {
    Vec2<T> u;
    T density;
  };

  /// The density at u.
  FACETA_INLINE T density(const Vec2<T>& u) const {
    MeasuredCell<T> c(w_.nx, w_.ny, u);
    Corners d = corners(node(c.row, c.column));
    return lerp(lerp(d.v00, d.v10, c.x), lerp(d.v01, d.v11, c.x), c.y) * scale();
  }
  /// The uniform numbers that sample() makes u of, and the density there.
  FACETA_INLINE Point invert(const Vec2<T>& u) const {
    MeasuredCell<T> c(w_.nx, w_.ny, u);
    IntOf<T> first = node(c.row, c.column);
    Corners d = corners(first);
    T before = lerp(at(w_.conditional, nodes(), first),
                    at(w_.conditional, nodes(), first + IntOf<T>(w_.nx)), c.y);
    Rows r = rows(c.row);
    T left = lerp(d.v00, d.v01, c.y), right = lerp(d.v10, d.v11, c.y);
    T x = fma(c.x, fma(T(0.5) * c.x, right - left, left), before);
    T total = lerp(r.sum0, r.sum1, c.y);
    x = select(total > T(0), x / max(total, T(kTiny)), T(0));
    T y = fma(c.y, fma(T(0.5) * c.y, r.sum1 - r.sum0, r.sum0), r.before);
    return {{clamp01(x), clamp01(y)}, lerp(left, right, c.x) * scale()};
  }
  /// A point with that density from uniform numbers: rows by u.y, then along them by u.x.
  FACETA_INLINE Point sample(const Vec2<T>& u) const {
    auto sum_before = [&](const IntOf<T>& j)
                          FACETA_INLINE_LAMBDA { return at(w_.rows, 2 * w_.ny, j + j); };
    IntOf<T> row = search(w_.ny, u.y, sum_before);
    Rows r = rows(row);
    T y = solve(u.y - r.before, r.sum0, r.sum1);
    T x = u.x * lerp(r.sum0, r.sum1, y);
    IntOf<T> first = row * IntOf<T>(w_.nx);
    auto before = [&](const IntOf<T>& i) FACETA_INLINE_LAMBDA {
      IntOf<T> n = first + i;
      return lerp(at(w_.conditional, nodes(), n), at(w_.conditional, nodes(), n + IntOf<T>(w_.nx)),
                  y);
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

  struct Corners {
    T v00, v10, v01, v11;
  };
  struct Rows {
    T before, sum0, sum1;
  };

  int nodes() const { return w_.nx * w_.ny; }
  FACETA_INLINE IntOf<T> node(const IntOf<T>& row, const IntOf<T>& column) const {
    return row * IntOf<T>(w_.nx) + column;
  }
  FACETA_INLINE T scale() const { return T(float((w_.nx - 1) * (w_.ny - 1))); }
  static FACETA_INLINE T to_number(const IntOf<T>& i) {
    if constexpr (kWidthOf<T> > 1)
      return to_float(i);
    else
      return T(i);
  }
  /// Number i of `count` that each viewer has.
  FACETA_INLINE T at(int32_t offset, int count, const IntOf<T>& i) const {
    T sum(0);
    for (int k = 0; k < viewer_.phis; ++k) {
      IntOf<T> n = viewer_.phis > 1 ? viewer_.phi[k] * IntOf<T>(count) + i : i;
      Neighbours<T> ends = gather_pair<T>(base_ + offset, n * IntOf<T>(thetas_) + viewer_.theta);
      T value = lerp(ends.first, ends.second, viewer_.fraction);
      sum = viewer_.phis > 1 ? fma(viewer_.weight[k], value, sum) : value;
    }
    return sum;
  }
  FACETA_INLINE Corners corners(const IntOf<T>& n) const {
    auto corner = [&](int k) FACETA_INLINE_LAMBDA { return at(w_.data, nodes(), n + IntOf<T>(k)); };
    return {corner(0), corner(1), corner(w_.nx), corner(w_.nx + 1)};
  }
  FACETA_INLINE Rows rows(const IntOf<T>& row) const {
    auto number = [&](int k) FACETA_INLINE_LAMBDA {
      return at(w_.rows, 2 * w_.ny, row + row + IntOf<T>(k));
    };
    return {number(0), number(1), number(3)};
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
  int thetas_;
  const MeasuredHeader::Warp& w_;
  const MeasuredViewer<T>& viewer_;
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
    MeasuredViewer<T> viewer = find_viewer(wo);
    Vec2<T> u = half.square(h_.phis == 1 ? azimuth(wo) : Vec2<T>{T(1), T(0)});
    auto warped = warp(h_.vndf, viewer).invert(u);
    T pdf = warped.density * warp(h_.luminance, viewer).density(warped.u) / jacobian(half, u);
    Eval<T> e;
    e.value = h_.kind == MeasuredKind::rgl ? rgl_value(wo, u, warped.u, viewer)
                                           : grid_value(wo, wi, half) * wi.z;
    T share(h_.cosine_share);
    e.pdf = fma(T(1) - share, pdf, share * T(kInvPi) * wi.z);
    return e;
  }

  /// What eval() gives for tables that need no warps (all kinds but rgl).
  FACETA_INLINE Color<T> grid_value(const Vec3<T>& wo, const Vec3<T>& wi) const {
    return grid_value(wo, wi, Half(wo, wi)) * wi.z;
  }

  /// A direction, with its value and density if it lies above the surface.
  FACETA_INLINE Vec3<T> sample(const Vec3<T>& viewer_direction, const Random<T>& random,
                               Eval<T>& e) const {
    Vec2<T> signs = sector(viewer_direction);
    Vec3<T> wo = mirrored(viewer_direction, signs);
    MeasuredViewer<T> viewer = find_viewer(wo);
    // Luminance by the numbers in this order, as in the paper's own implementation.
    auto light = warp(h_.luminance, viewer).sample({random.u.y, random.u.x});
    auto normal = warp(h_.vndf, viewer).sample(light.u);
    SinCos<T> theta = sincos(sqr(normal.u.x) * T(0.5 * kPi));
    SinCos<T> phi = sincos(fma(T(2), normal.u.y, T(-1)) * T(kPi));
    Vec3<T> m{theta.sin * phi.cos, theta.sin * phi.sin, theta.cos};
    if (h_.phis == 1)
      m = turned(m, azimuth(wo));
    Vec3<T> wi = mirrored(reflect(wo, m), signs);
    if (h_.kind == MeasuredKind::rgl) {
      Half half(wo, mirrored(wi, signs));
      e.value = rgl_value(wo, normal.u, light.u, viewer);
      e.pdf = light.density * normal.density / jacobian(half, normal.u);
      return wi;
    }
    wi = select(random.uc < T(h_.cosine_share), cosine_hemisphere(random.u), wi);
    auto above = wi.z > T(0);
    e = eval(viewer_direction, select(above, wi, Vec3<T>{T(0), T(0), T(1)}));
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
    T y = copysign(T(1), wo.y) * T(h_.sector_y);
    T x = copysign(T(1), wo.x) * T(h_.sector_x);
    return {h_.sectors == 4 ? x : y, y};
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

  /// Solid angle of wi for an area of the square of normals.
  static FACETA_INLINE T jacobian(const Half& half, const Vec2<T>& u) {
    T sine = sqrt(sin_theta_squared(half.m));
    return max(T(2 * kPi * kPi) * u.x * sine, T(1e-6)) * (T(4) * half.cosine);
  }

  FACETA_INLINE MeasuredViewer<T> find_viewer(const Vec3<T>& wo) const {
    MeasuredInterval<T> theta(base_ + h_.theta_nodes, h_.thetas, inclination(wo));
    MeasuredViewer<T> v;
    v.theta = theta.index;
    v.fraction = theta.fraction;
    v.phis = h_.phis > 1 ? 2 : 1;
    v.phi[0] = v.phi[1] = IntOf<T>(0);
    v.weight[0] = v.weight[1] = T(1);
    if (h_.phis > 1) {
      MeasuredInterval<T> phi(base_ + h_.phi_nodes, h_.phis, angle(wo.y, wo.x));
      v.phi[0] = phi.index;
      v.phi[1] = phi.index + IntOf<T>(1);
      v.weight[0] = T(1) - phi.fraction;
      v.weight[1] = phi.fraction;
    }
    return v;
  }
  FACETA_INLINE MeasuredWarp<T> warp(const MeasuredHeader::Warp& w,
                                     const MeasuredViewer<T>& viewer) const {
    return {base_, h_, w, viewer};
  }
  FACETA_INLINE T plain(const MeasuredHeader::Plain& p, const Vec2<T>& u) const {
    MeasuredCell<T> c(p.nx, p.ny, u);
    IntOf<T> n = c.row * IntOf<T>(p.nx) + c.column;
    Neighbours<T> low = gather_pair<T>(base_ + p.data, n);
    Neighbours<T> high = gather_pair<T>(base_ + p.data, n + IntOf<T>(p.nx));
    return lerp(lerp(low.first, low.second, c.x), lerp(high.first, high.second, c.x), c.y);
  }

  /// Dupuy and Jakob 2018, eq. 3 with the values in the square of luminance.
  FACETA_INLINE Color<T> rgl_value(const Vec3<T>& wo, const Vec2<T>& normal, const Vec2<T>& light,
                                   const MeasuredViewer<T>& viewer) const {
    const MeasuredHeader::Warp& w = h_.luminance;
    MeasuredCell<T> c(w.nx, w.ny, light);
    IntOf<T> first = c.row * IntOf<T>(w.nx) + c.column;
    MeasuredRgb<T> sum;
    for (int k = 0; k < viewer.phis; ++k)
      for (int corner = 0; corner < 4; ++corner) {
        IntOf<T> n = first + IntOf<T>((corner & 1) + (corner >> 1) * w.nx);
        if (viewer.phis > 1)
          n = n + viewer.phi[k] * IntOf<T>(w.nx * w.ny);
        IntOf<T> at = n * IntOf<T>(h_.thetas) + viewer.theta;
        MeasuredRgbPair<T> ends(base_ + h_.rgb, at * IntOf<T>(3));
        T weight = (corner & 1 ? c.x : T(1) - c.x) * (corner >> 1 ? c.y : T(1) - c.y);
        if (viewer.phis > 1)
          weight = weight * viewer.weight[k];
        T second = weight * viewer.fraction;
        sum.add(weight - second, ends.first);
        sum.add(second, ends.second);
      }
    T factor(1);
    if (h_.jacobian) {
      T phi = fma(angle(wo.y, wo.x), T(kInvTwoPi), T(0.5));
      T sigma = plain(h_.sigma, {sqrt(inclination(wo) * T(2 * kInvPi)), phi});
      factor = plain(h_.ndf, normal) / (T(4) * sigma);
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
