#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace faceta {

/// Nearest neighbours among points of `D` dimensions: a balanced tree (Bentley 1975) in the order
/// of an array, built in n log^2 n, with no pointers.
template <int D> class KdTree {
public:
  using Point = std::array<double, D>;
  struct Neighbour {
    double distance2;
    int32_t index;
    bool operator<(const Neighbour& other) const {
      return distance2 != other.distance2 ? distance2 < other.distance2 : index < other.index;
    }
  };

  explicit KdTree(std::vector<Point> points) : points_(std::move(points)) {
    order_.resize(points_.size());
    for (size_t i = 0; i < order_.size(); ++i)
      order_[i] = static_cast<int32_t>(i);
    build(0, order_.size(), 0);
    for (size_t i = 0; i < points_.size(); ++i)
      for (int k = 0; k < D; ++k) {
        least_[k] = i == 0 ? points_[i][k] : std::min(least_[k], points_[i][k]);
        most_[k] = i == 0 ? points_[i][k] : std::max(most_[k], points_[i][k]);
      }
  }

  const std::vector<Point>& points() const { return points_; }

  /// Fills `nearest` with the closest points to `at`, nearest first; the part of it that could be
  /// filled. `leave_out` is the index of a point that does not count.
  std::span<Neighbour> nearest(const Point& at, std::span<Neighbour> nearest,
                               int32_t leave_out = -1) const {
    Query query{at, nearest, 0, leave_out};
    Point offsets{};
    double distance2 = 0;
    for (int k = 0; k < D; ++k) {
      offsets[k] = at[k] - std::clamp(at[k], least_[k], most_[k]);
      distance2 += offsets[k] * offsets[k];
    }
    if (!nearest.empty())
      visit(query, 0, order_.size(), 0, offsets, distance2);
    std::sort_heap(nearest.begin(), nearest.begin() + static_cast<ptrdiff_t>(query.found));
    return nearest.first(query.found);
  }

private:
  struct Query {
    Point at;
    std::span<Neighbour> heap;
    size_t found;
    int32_t leave_out;
  };

  void build(size_t first, size_t last, int axis) {
    if (last - first < 2)
      return;
    size_t middle = first + (last - first) / 2;
    auto at = [&](size_t i) { return order_.begin() + static_cast<ptrdiff_t>(i); };
    std::nth_element(at(first), at(middle), at(last), [&](int32_t a, int32_t b) {
      double x = points_[a][axis], y = points_[b][axis];
      return x != y ? x < y : a < b;
    });
    int next = (axis + 1) % D;
    build(first, middle, next);
    build(middle + 1, last, next);
  }

  /// `offsets` lead from the box of the points of the range to the query, `distance2` is their
  /// square (Arya and Mount 1993): far from all points, single axes would exclude next to nothing.
  void visit(Query& query, size_t first, size_t last, int axis, const Point& offsets,
             double distance2) const {
    if (first >= last)
      return;
    size_t middle = first + (last - first) / 2;
    offer(query, order_[middle]);
    double offset = query.at[axis] - points_[order_[middle]][axis];
    int next = (axis + 1) % D;
    auto descend = [&](bool left, const Point& to, double d2) {
      left ? visit(query, first, middle, next, to, d2)
           : visit(query, middle + 1, last, next, to, d2);
    };
    descend(offset < 0, offsets, distance2);
    Point beyond = offsets;
    beyond[axis] = std::abs(offset) > std::abs(offsets[axis]) ? offset : offsets[axis];
    double further = distance2 - offsets[axis] * offsets[axis] + beyond[axis] * beyond[axis];
    // rounding of the difference must not exclude a neighbour
    if (query.found < query.heap.size() || further * (1 - 1e-12) <= query.heap.front().distance2)
      descend(!(offset < 0), beyond, further);
  }

  void offer(Query& query, int32_t index) const {
    if (index == query.leave_out)
      return;
    Neighbour candidate{0, index};
    for (int k = 0; k < D; ++k) {
      double d = points_[index][k] - query.at[k];
      candidate.distance2 += d * d;
    }
    auto begin = query.heap.begin();
    auto end = [&] { return begin + static_cast<ptrdiff_t>(query.found); };
    if (query.found < query.heap.size()) {
      query.heap[query.found++] = candidate;
      std::push_heap(begin, end());
    } else if (candidate < query.heap.front()) {
      std::pop_heap(begin, end());
      query.heap.back() = candidate;
      std::push_heap(begin, end());
    }
  }

  std::vector<Point> points_;
  std::vector<int32_t> order_;
  Point least_{}, most_{};
};

} // namespace faceta
