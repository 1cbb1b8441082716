#pragma once

/// Functions on a square with values at nodes, as RGL tables hold them: looked up, drawn from, and
/// fitted to points. Only for make_rgl_tables().

#include "base/vec.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace faceta {

/// Numbers at the nodes of a square, bilinear in between.
struct Square {
  int nx = 0, ny = 0;
  std::vector<double> values{}; ///< [y][x]

  Square(int x, int y) : nx(x), ny(y), values(size_t(x) * size_t(y)) {}
  double& node(int x, int y) { return values[size_t(y) * size_t(nx) + size_t(x)]; }
  double node(int x, int y) const { return values[size_t(y) * size_t(nx) + size_t(x)]; }
  double at(const Vec2<double>& u) const {
    double px = u.x * (nx - 1), py = u.y * (ny - 1);
    int x = std::clamp(int(px), 0, nx - 2), y = std::clamp(int(py), 0, ny - 2);
    return lerp(lerp(node(x, y), node(x + 1, y), px - x),
                lerp(node(x, y + 1), node(x + 1, y + 1), px - x), py - y);
  }
  /// As the file will hold them.
  void round() {
    for (double& v : values)
      v = static_cast<float>(v);
  }
  std::vector<float> floats() const { return {values.begin(), values.end()}; }
};

/// Draws points of a Square by its values, as readers of the file do: rows by y, then along them.
class SquareSampler {
public:
  struct Point {
    Vec2<double> u;
    double density;
  };

  explicit SquareSampler(const Square& square)
      : s_(square), along_(square.values.size()), before_(size_t(square.ny)) {
    for (int y = 0; y < s_.ny; ++y) {
      for (int x = 1; x < s_.nx; ++x)
        along_[index(x, y)] = along_[index(x - 1, y)] + 0.5 * (s_.node(x - 1, y) + s_.node(x, y));
      if (y > 0)
        before_[size_t(y)] = before_[size_t(y) - 1] + 0.5 * (row(y - 1) + row(y));
    }
  }
  double total() const { return before_.back(); }

  Point sample(const Vec2<double>& u) const {
    double rest = u.y * total();
    int y = last_below(s_.ny, rest, [&](int k) { return before_[size_t(k)]; });
    double t = solve(rest - before_[size_t(y)], row(y), row(y + 1));
    auto before = [&](int k) { return lerp(along_[index(k, y)], along_[index(k, y + 1)], t); };
    rest = u.x * lerp(row(y), row(y + 1), t);
    int x = last_below(s_.nx, rest, before);
    double left = lerp(s_.node(x, y), s_.node(x, y + 1), t);
    double right = lerp(s_.node(x + 1, y), s_.node(x + 1, y + 1), t);
    double s = solve(rest - before(x), left, right);
    return {{(x + s) / (s_.nx - 1), (y + t) / (s_.ny - 1)},
            lerp(left, right, s) * (s_.nx - 1) * (s_.ny - 1) / total()};
  }

private:
  size_t index(int x, int y) const { return size_t(y) * size_t(s_.nx) + size_t(x); }
  double row(int y) const { return along_[index(s_.nx - 1, y)]; }
  /// The last of the first n - 1 places whose sum is not above x.
  template <class F> static int last_below(int n, double x, const F& sum) {
    int low = 0, high = n - 1;
    while (high - low > 1) {
      int middle = (low + high) / 2;
      (sum(middle) <= x ? low : high) = middle;
    }
    return low;
  }
  /// Where the integral of lerp(a, b, t) from 0 is y.
  static double solve(double y, double a, double b) {
    double root = std::sqrt(std::max(0.0, a * a + 2 * y * (b - a)));
    return a + root > 0 ? std::clamp(2 * y / (a + root), 0.0, 1.0) : 0.5;
  }

  const Square& s_;
  std::vector<double> along_, before_;
};

/// Values at scattered points of a square, fitted by a bilinear function whose integral over them
/// is that of the values.
class TexelFit {
public:
  TexelFit(int side, int points) : side_(side), points_(points) {
    weights_.assign(size_t(side) * size_t(side), 0);
  }
  void add(int i, int j) {
    places_.push_back({i, j});
    spread(places_.back(), [&](size_t n, double w) { weights_[n] += w; });
  }
  size_t size() const { return places_.size(); }

  /// The nodes, for a value for each point added. Those without points get their neighbours'.
  std::vector<double> solve(const std::vector<double>& values) const {
    std::vector<double> nodes(weights_.size()), rest = values;
    // Each step spreads what is left over; the integral is right from the first one on.
    for (int iteration = 0; iteration < 3; ++iteration) {
      std::vector<double> sums(nodes.size());
      for (size_t p = 0; p < places_.size(); ++p)
        spread(places_[p], [&](size_t n, double w) { sums[n] += w * rest[p]; });
      for (size_t n = 0; n < nodes.size(); ++n)
        nodes[n] += weights_[n] > 0 ? sums[n] / weights_[n] : 0;
      for (size_t p = 0; p < places_.size(); ++p) {
        rest[p] = values[p];
        spread(places_[p], [&](size_t n, double w) { rest[p] -= w * nodes[n]; });
      }
    }
    clamp_to_positive(nodes);
    fill_empty(nodes);
    return nodes;
  }

private:
  struct Place {
    int i, j;
  };
  template <class F> void spread(const Place& place, const F& function) const {
    double x = (place.i + 0.5) / points_ * (side_ - 1), y = (place.j + 0.5) / points_ * (side_ - 1);
    int ix = std::min(int(x), side_ - 2), iy = std::min(int(y), side_ - 2);
    double tx = x - ix, ty = y - iy;
    size_t n = size_t(iy) * size_t(side_) + size_t(ix);
    function(n, (1 - tx) * (1 - ty));
    function(n + 1, tx * (1 - ty));
    function(n + size_t(side_), (1 - tx) * ty);
    function(n + size_t(side_) + 1, tx * ty);
  }
  void clamp_to_positive(std::vector<double>& nodes) const {
    double before = 0, after = 0;
    for (size_t n = 0; n < nodes.size(); ++n) {
      before += weights_[n] * nodes[n];
      nodes[n] = std::max(nodes[n], 0.0);
      after += weights_[n] * nodes[n];
    }
    for (double& v : nodes)
      v *= after > 0 ? before / after : 1;
  }
  /// From the nearest rows and columns inwards; each pass goes one node further.
  void fill_empty(std::vector<double>& nodes) const {
    std::vector<char> known(nodes.size());
    for (size_t n = 0; n < nodes.size(); ++n)
      known[n] = weights_[n] > 0;
    for (int pass = 0; pass < 2 * side_; ++pass) {
      std::vector<char> now = known;
      for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x)
          if (size_t n = size_t(y * side_ + x); !known[n]) {
            double sum = 0;
            int count = 0;
            for (auto [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
              int i = x + dx, j = y + dy;
              if (i < 0 || j < 0 || i >= side_ || j >= side_ || !known[size_t(j * side_ + i)])
                continue;
              sum += nodes[size_t(j * side_ + i)];
              ++count;
            }
            if (count > 0) {
              nodes[n] = sum / count;
              now[n] = 1;
            }
          }
      if (now == known)
        return;
      known = now;
    }
  }

  int side_, points_;
  std::vector<Place> places_;
  std::vector<double> weights_;
};

} // namespace faceta
