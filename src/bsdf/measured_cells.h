#pragma once

/// Measured values that are constant over pairs of cells, reflected and transmitted, as the
/// renderer reads them: one block of numbers that begins with a MeasuredCellsHeader.
///
/// Light is sampled by a table: for each cell of viewers the probabilities of the cells of light,
/// uniform in projected solid angle inside them. Klems matrices (Klems 1994) have their own cells,
/// so that samples follow the values exactly; for tensor trees (Ward et al. 2012) it has squares,
/// inside which samples of trees of rank 4 go on by the means of what is below a branch.

#include "bsdf/measured_data.h"
#include "bsdf/measured_table.h"

namespace faceta {

enum class CellsKind : int32_t { klems, tree3, tree4 };

/// All offsets count floats from the start of the block. Sides: 0 in front of the surface, 1
/// behind. Whole numbers are stored as floats, below 2^24.
struct MeasuredCellsHeader {
  CellsKind kind;

  /// kind klems: the rings of a KlemsBasis.
  struct Basis {
    int32_t rings;
    int32_t cosines; ///< [ring]: of the outer edge, which belongs to the next ring
    int32_t places;  ///< [ring][2]: number of its first cell, how many it has
    int32_t areas;   ///< [ring][2]: squared sine of the inner edge, that of a cell's share
    int32_t numbers; ///< [cell]: its ring
  };
  Basis incident, outgoing;
  int32_t values; ///< [side of the viewer][viewer][light: reflected, then transmitted][rgb]

  /// Trees, for each MeasuredPass: the root, then blocks of 2^dimensions children. A node is the
  /// number of its block of children or, if negative, -1 - the number of its colour.
  int32_t depth;
  int32_t nodes[4], colors[4];
  int32_t means[4]; ///< tree4: of the brightness below each node, in the order of the nodes

  /// Sampling.
  int32_t side;    ///< trees: squares of light along an edge
  int32_t fine;    ///< tree4: levels below those squares
  int32_t viewers; ///< cells; for tree3 rings of equal width in the sine
  int32_t lights;  ///< cells on one side of the surface
  int32_t sums; ///< [side of the viewer][viewer][2 lights + 1]: probabilities of the lights before
};
static_assert(sizeof(MeasuredCellsHeader) % sizeof(float) == 0);

/// Where in the unit square concentric_disk() takes a point of the unit disk from.
template <class T> FACETA_INLINE Vec2<T> concentric_square(const T& x, const T& y) {
  auto wide = abs(x) > abs(y);
  T large = select(wide, x, y), small = select(wide, y, x);
  T radius = sqrt(fma(x, x, y * y));
  T r = copysign(radius, large);
  T turn = atan2(copysign(T(1), large) * small, abs(large)) * T(4 * kInvPi) * r;
  Vec2<T> s{select(wide, r, turn), select(wide, turn, r)};
  return {clamp01(fma(T(0.5), s.x, T(0.5))), clamp01(fma(T(0.5), s.y, T(0.5)))};
}

/// The block, read for lanes of directions.
template <class T> class MeasuredCells {
public:
  explicit FACETA_INLINE MeasuredCells(const float* base) : base_(base) {
    std::memcpy(&h_, base, sizeof h_);
  }

  /// f_r |cos theta_i| and the density of sample(). Neither direction in the surface.
  FACETA_INLINE Eval<T> eval(const Vec3<T>& wo, const Vec3<T>& wi) const {
    auto through = passes(wo, wi);
    IntOf<T> viewer = viewer_row(wo);
    Light light = light_of(wo, wi);
    IntOf<T> cell = light.cell + select(through, IntOf<T>(h_.lights), IntOf<T>(0));
    T cosine = abs(wi.z);
    Leaf leaf{IntOf<T>(h_.values) + (viewer * IntOf<T>(2 * h_.lights) + cell) * IntOf<T>(3), T(1)};
    if (h_.kind != CellsKind::klems)
      leaf = leaf_of(wo, wi, through);
    Eval<T> e;
    e.value = color(leaf.color).color() * cosine;
    Neighbours<T> sums = gather_pair<T>(base_ + h_.sums, first_sum(viewer) + cell);
    e.pdf = (sums.second - sums.first) * leaf.density * light.inverse_area * cosine;
    return e;
  }

  /// Whether light from wi passes through the surface; exact however near either is to it.
  static FACETA_INLINE MaskOf<T> passes(const Vec3<T>& wo, const Vec3<T>& wi) {
    return (wo.z < T(0)) ^ (wi.z < T(0));
  }

  /// f_r of a tree.
  FACETA_INLINE MeasuredRgb<T> tree_color(const Vec3<T>& wo, const Vec3<T>& wi,
                                          const MaskOf<T>& through) const {
    return color(leaf_of(wo, wi, through).color);
  }

  /// A direction, with its value and density.
  FACETA_INLINE Vec3<T> sample(const Vec3<T>& wo, const Random<T>& random, Eval<T>& e) const {
    IntOf<T> first = first_sum(viewer_row(wo));
    IntOf<T> cell = search(first, random.uc);
    auto through = cell >= IntOf<T>(h_.lights);
    cell = cell - select(through, IntOf<T>(h_.lights), IntOf<T>(0));
    Vec3<T> wi = h_.kind == CellsKind::klems ? inside_ring(cell, random.u)
                                             : inside_square(cell, random.u, wo, through);
    auto below = (wo.z < T(0)) ^ through;
    wi.z = select(below, -wi.z, wi.z);
    e = eval(wo, wi);
    return wi;
  }

private:
  static FACETA_INLINE T to_number(const IntOf<T>& i) {
    if constexpr (kWidthOf<T> > 1)
      return to_float(i);
    else
      return T(i);
  }
  static FACETA_INLINE T sine(const Vec3<T>& w) { return sqrt(sin_theta_squared(w)); }
  /// Cosine and sine of an azimuth; (1, 0) where it has none.
  static FACETA_INLINE Vec2<T> azimuth(const Vec3<T>& w) {
    T r = sine(w);
    auto none = !(r > T(1e-15)); // below, squares of floats vanish
    T inverse = T(1) / select(none, T(1), r);
    return {select(none, T(1), w.x * inverse), w.y * inverse};
  }
  /// w turned about the normal by the azimuth a.
  static FACETA_INLINE Vec3<T> turned(const Vec3<T>& w, const Vec2<T>& a) {
    return {fma(w.x, a.x, -(w.y * a.y)), fma(w.x, a.y, w.y * a.x), w.z};
  }
  FACETA_INLINE MeasuredRgb<T> color(const IntOf<T>& at) const {
    Neighbours<T> rg = gather_pair<T>(base_, at);
    return {rg.first, rg.second, gather<T>(base_, at + IntOf<T>(2))};
  }
  static FACETA_INLINE IntOf<T> by_pass(const int32_t (&offsets)[4], const MaskOf<T>& from_back,
                                        const MaskOf<T>& through) {
    auto choose = [&](int reflected, int transmitted) FACETA_INLINE_LAMBDA {
      return select(through, IntOf<T>(offsets[transmitted]), IntOf<T>(offsets[reflected]));
    };
    return select(from_back, choose(kBackReflection, kBackTransmission),
                  choose(kFrontReflection, kFrontTransmission));
  }

  // --- Trees ---

  FACETA_INLINE IntOf<T> place_of(const T& x) const {
    const int cells = 1 << h_.depth;
    return min(to_int(x * T(float(cells))), IntOf<T>(cells - 1));
  }
  static FACETA_INLINE IntOf<T> bit(const IntOf<T>& place, int level) {
    return (place >> level) & IntOf<T>(1);
  }

  /// The probabilities of the four children for light of a branch: by their means, with a share
  /// that bounds the weights.
  struct Choice {
    T p[4];
    FACETA_INLINE Choice(const float* base, const IntOf<T>& first) {
      Neighbours<T> low = gather_pair<T>(base, first),
                    high = gather_pair<T>(base, first + IntOf<T>(2));
      T sum = (low.first + low.second) + (high.first + high.second);
      auto black = !(sum > T(0));
      T scale = T(0.9) / select(black, T(1), sum), rest = select(black, T(0.25), T(0.025));
      for (int k = 0; k < 4; ++k)
        p[k] = fma(k < 2 ? (k ? low.second : low.first) : (k == 2 ? high.first : high.second),
                   scale, rest);
    }
    FACETA_INLINE T of(const IntOf<T>& x, const IntOf<T>& y) const {
      auto right = x > IntOf<T>(0);
      return select(y > IntOf<T>(0), select(right, p[3], p[2]), select(right, p[1], p[0]));
    }
  };

  /// A place in a tree on the way down.
  struct Descent {
    const int dimensions;
    IntOf<T> nodes, means, node;
    FACETA_INLINE Descent(const MeasuredCells& cells, const MaskOf<T>& from_back,
                          const MaskOf<T>& through)
        : dimensions(cells.h_.kind == CellsKind::tree3 ? 3 : 4),
          nodes(by_pass(cells.h_.nodes, from_back, through)),
          means(by_pass(cells.h_.means, from_back, through)),
          node(to_int(gather<T>(cells.base_, nodes))) {}
    FACETA_INLINE MaskOf<T> at_leaf() const { return node < IntOf<T>(0); }
    /// The number of the first child, 1 at leaves.
    FACETA_INLINE IntOf<T> first() const {
      return (select(at_leaf(), IntOf<T>(0), node) << dimensions) + IntOf<T>(1);
    }
    FACETA_INLINE void descend(const float* base, const IntOf<T>& child) {
      IntOf<T> next = to_int(gather<T>(base, select(at_leaf(), nodes, nodes + first() + child)));
      node = select(at_leaf(), node, next);
    }
  };

  struct Leaf {
    IntOf<T> color; ///< where it is
    T density;      ///< of light inside its square of the table, 1 for uniform
  };
  FACETA_INLINE Leaf leaf_of(const Vec3<T>& wo, const Vec3<T>& wi, const MaskOf<T>& through) const {
    IntOf<T> place[4];
    if (h_.kind == CellsKind::tree3) {
      Vec2<T> a = azimuth(wi);
      Vec3<T> turned_wo = turned(wo, {-a.x, a.y}); // minus the light comes to azimuth 0
      Vec2<T> o = concentric_square(turned_wo.x, turned_wo.y);
      place[0] = place_of(fma(T(-0.5), min(sine(wi), T(1)), T(0.5)));
      place[1] = place_of(o.x);
      place[2] = place_of(o.y);
    } else {
      Vec2<T> i = concentric_square(wi.x, wi.y), o = concentric_square(wo.x, wo.y);
      place[0] = place_of(i.x);
      place[1] = place_of(i.y);
      place[2] = place_of(o.x);
      place[3] = place_of(o.y);
    }
    auto from_back = wi.z < T(0);
    Descent tree(*this, from_back, through);
    T density(1);
    for (int level = h_.depth - 1; level >= 0 && !all(tree.at_leaf()); --level) {
      IntOf<T> child(0);
      for (int d = 0; d < tree.dimensions; ++d)
        child = child + (bit(place[d], level) << d);
      if (level < h_.fine) {
        IntOf<T> viewed = child - (child & IntOf<T>(3));
        Choice choice(base_, tree.means + tree.first() + viewed);
        T factor = T(4) * choice.of(bit(place[0], level), bit(place[1], level));
        density = select(tree.at_leaf(), density, density * factor);
      }
      tree.descend(base_, child);
    }
    return {by_pass(h_.colors, from_back, through) + (IntOf<T>(-1) - tree.node) * IntOf<T>(3),
            density};
  }

  /// A number inside one of two parts of the unit interval, of which `first` is the share of the
  /// lower one, as a number of its own.
  static FACETA_INLINE MaskOf<T> choose(T& u, const T& first, const MaskOf<T>& stay) {
    auto upper = u >= first;
    T inside = select(upper, (u - first) / (T(1) - first), u / first);
    u = select(stay, u, clamp01(inside));
    return upper;
  }
  /// From a square of the table down the tree to a point of the unit square.
  FACETA_INLINE Vec2<T> refined(const IntOf<T>& column, const IntOf<T>& row, Vec2<T> u,
                                const Vec3<T>& wo, const MaskOf<T>& through) const {
    Vec2<T> o = concentric_square(wo.x, wo.y);
    IntOf<T> x = column << h_.fine, y = row << h_.fine, vx = place_of(o.x), vy = place_of(o.y);
    Descent tree(*this, (wo.z < T(0)) ^ through, through);
    T size(float(1 << h_.fine));
    for (int level = h_.depth - 1; level >= 0 && !all(tree.at_leaf()); --level) {
      IntOf<T> viewed = (bit(vx, level) << 2) + (bit(vy, level) << 3);
      if (level < h_.fine) {
        Choice choice(base_, tree.means + tree.first() + viewed);
        auto stay = tree.at_leaf();
        T left = choice.p[0] + choice.p[2], all_four = left + (choice.p[1] + choice.p[3]);
        auto right = choose(u.x, left / all_four, stay);
        T low = select(right, choice.p[1], choice.p[0]),
          high = select(right, choice.p[3], choice.p[2]);
        auto upper = choose(u.y, low / (low + high), stay);
        IntOf<T> step(1 << level), none(0);
        x = x + select(stay, none, select(right, step, none));
        y = y + select(stay, none, select(upper, step, none));
        size = select(stay, size, T(0.5) * size);
      }
      tree.descend(base_, viewed + bit(x, level) + (bit(y, level) << 1));
    }
    T inverse(1.0f / float(1 << h_.depth));
    return {fma(u.x, size, to_number(x)) * inverse, fma(u.y, size, to_number(y)) * inverse};
  }

  // --- Cells of viewers and of light ---

  struct Light {
    IntOf<T> cell;
    T inverse_area; ///< one over its projected solid angle
  };

  FACETA_INLINE IntOf<T> ring_of(const MeasuredCellsHeader::Basis& b, const Vec3<T>& w) const {
    T z = abs(w.z);
    IntOf<T> ring(0);
    for (int k = 0; k + 1 < b.rings; ++k)
      ring = select(z <= T(base_[b.cosines + k]), IntOf<T>(k + 1), ring);
    return ring;
  }
  FACETA_INLINE IntOf<T> klems_cell(const MeasuredCellsHeader::Basis& b, const IntOf<T>& ring,
                                    const Vec3<T>& w) const {
    Neighbours<T> place = gather_pair<T>(base_ + b.places, ring + ring);
    T count = place.second;
    T k = floor(fma(atan2(w.y, w.x) * T(kInvTwoPi), count, T(0.5)));
    k = select(k < T(0), k + count, select(k >= count, k - count, k));
    return to_int(place.first + k);
  }
  static FACETA_INLINE IntOf<T> square_cell(const Vec2<T>& u, int side) {
    auto place = [&](const T& x) FACETA_INLINE_LAMBDA {
      return min(to_int(x * T(float(side))), IntOf<T>(side - 1));
    };
    return place(u.y) * IntOf<T>(side) + place(u.x);
  }

  /// The number of the viewer's cell, those behind the surface after those in front.
  FACETA_INLINE IntOf<T> viewer_row(const Vec3<T>& wo) const {
    IntOf<T> cell(0);
    switch (h_.kind) {
    case CellsKind::klems:
      cell = klems_cell(h_.outgoing, ring_of(h_.outgoing, wo), wo);
      break;
    case CellsKind::tree3:
      cell = min(to_int(sine(wo) * T(float(h_.viewers))), IntOf<T>(h_.viewers - 1));
      break;
    case CellsKind::tree4:
      cell = square_cell(concentric_square(wo.x, wo.y), h_.side);
      break;
    }
    return cell + select(wo.z < T(0), IntOf<T>(h_.viewers), IntOf<T>(0));
  }
  FACETA_INLINE Light light_of(const Vec3<T>& wo, const Vec3<T>& wi) const {
    if (h_.kind == CellsKind::klems) {
      IntOf<T> ring = ring_of(h_.incident, wi);
      T share = gather<T>(base_ + h_.incident.areas, ring + ring + IntOf<T>(1));
      return {klems_cell(h_.incident, ring, wi), T(kInvPi) / share};
    }
    Vec3<T> w = wi;
    if (h_.kind == CellsKind::tree3) {
      Vec2<T> a = azimuth(wo);
      w = turned(wi, {a.x, -a.y});
    }
    return {square_cell(concentric_square(w.x, w.y), h_.side), T(float(kInvPi * h_.lights))};
  }

  // --- Sampling ---

  FACETA_INLINE IntOf<T> first_sum(const IntOf<T>& viewer) const {
    return viewer * IntOf<T>(2 * h_.lights + 1);
  }
  /// The last cell before which the probabilities do not exceed x; one that has any.
  FACETA_INLINE IntOf<T> search(const IntOf<T>& first, const T& x) const {
    const int n = 2 * h_.lights;
    int step = 1;
    while (2 * step <= n - 1)
      step *= 2;
    IntOf<T> index(0);
    for (; step > 0; step /= 2) {
      IntOf<T> candidate = min(index + IntOf<T>(step), IntOf<T>(n - 1));
      index = select(gather<T>(base_ + h_.sums, first + candidate) <= x, candidate, index);
    }
    return index;
  }
  static FACETA_INLINE T upward(const T& sine_squared) {
    return sqrt(max(T(1) - sine_squared, T(1e-12)));
  }
  FACETA_INLINE Vec3<T> inside_ring(const IntOf<T>& cell, const Vec2<T>& u) const {
    const MeasuredCellsHeader::Basis& b = h_.incident;
    IntOf<T> ring = to_int(gather<T>(base_ + b.numbers, cell));
    Neighbours<T> place = gather_pair<T>(base_ + b.places, ring + ring);
    Neighbours<T> area = gather_pair<T>(base_ + b.areas, ring + ring);
    T k = to_number(cell) - place.first;
    T square = fma(u.x * area.second, place.second, area.first);
    T r = sqrt(square);
    SinCos<T> phi = sincos((k + (u.y - T(0.5))) / place.second * T(2 * kPi));
    return {r * phi.cos, r * phi.sin, upward(square)};
  }
  FACETA_INLINE Vec3<T> inside_square(const IntOf<T>& cell, const Vec2<T>& u, const Vec3<T>& wo,
                                      const MaskOf<T>& through) const {
    T inverse(1.0f / float(h_.side));
    T row = floor((to_number(cell) + T(0.5)) * inverse);
    T column = fma(row, T(-float(h_.side)), to_number(cell));
    Vec2<T> square{(column + u.x) * inverse, (row + u.y) * inverse};
    if (h_.fine > 0)
      square = refined(to_int(column), to_int(row), u, wo, through);
    Vec2<T> disk = concentric_disk(square);
    Vec3<T> w{disk.x, disk.y, upward(fma(disk.x, disk.x, disk.y * disk.y))};
    return h_.kind == CellsKind::tree3 ? turned(w, azimuth(wo)) : w;
  }

  const float* base_;
  MeasuredCellsHeader h_;
};

} // namespace faceta
