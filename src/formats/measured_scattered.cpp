#include "formats/measured_scattered.h"

#include "formats/kd_tree.h"

#include <cmath>
#include <numbers>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace faceta {

namespace {

constexpr double kPi = std::numbers::pi;
// Leave-one-out errors on the Cornell paints are lowest about here and flat in both.
constexpr int kNeighbours[2] = {10, 24};
constexpr double kDifferenceScale = 0.5;
constexpr double kSamePoint = 1e-5;

using Color = std::array<double, 3>;

struct Direction {
  double x, y, z;
};

Direction direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// Half vector and difference vector: theta_h, phi_h, theta_d, and the azimuth of wi - wo about h,
/// from the plane through h and z.
struct HalfDifference {
  double theta_h, phi_h, theta_d, phi_d;
};

HalfDifference half_difference(const Direction& i, const Direction& o) {
  double hx = i.x + o.x, hy = i.y + o.y, hz = i.z + o.z;
  double dx = i.x - o.x, dy = i.y - o.y, dz = i.z - o.z;
  double across = std::hypot(hx, hy);
  double length_h = std::hypot(across, hz), length_d = std::sqrt(dx * dx + dy * dy + dz * dz);
  HalfDifference out{};
  out.theta_h = std::atan2(across, hz);
  out.phi_h = across > 0 ? std::atan2(hy, hx) : 0;
  out.theta_d = std::atan2(length_d, length_h);
  double c = std::cos(out.phi_h), s = std::sin(out.phi_h);
  double x = (dx * c + dy * s) * std::cos(out.theta_h) - dz * std::sin(out.theta_h);
  double y = -dx * s + dy * c;
  out.phi_d = length_d > 1e-9 ? std::atan2(y, x) : 0;
  return out;
}

using IsotropicPoint = KdTree<3>::Point;
using RotatedPoint = KdTree<5>::Point;

IsotropicPoint isotropic_point(double theta_h, double theta_d, double phi_d) {
  double g = std::sqrt(std::max(0.0, theta_h) / (kPi / 2));
  return {g, kDifferenceScale * theta_d,
          kDifferenceScale * g * std::sin(theta_d) * std::cos(2 * phi_d)};
}

RotatedPoint rotated_point(const HalfDifference& p) {
  double g = std::sqrt(std::max(0.0, p.theta_h) / (kPi / 2));
  // the azimuth of wi - wo on the surface; twice it, since reciprocity turns it round
  double psi = 2 * (p.phi_h + p.phi_d), s = kDifferenceScale * std::sin(p.theta_d);
  return {g * std::cos(p.phi_h), g * std::sin(p.phi_h), kDifferenceScale * p.theta_d,
          s * std::cos(psi), s * std::sin(psi)};
}

/// Solves the symmetric positive definite system a x = b of N unknowns for three right sides and
/// returns the first unknown of each (Cholesky).
template <int N> Color solve_first(double (&a)[N][N], double (&b)[N][3]) {
  for (int j = 0; j < N; ++j) {
    for (int k = 0; k < j; ++k)
      for (int i = j; i < N; ++i)
        a[i][j] -= a[i][k] * a[j][k];
    double pivot = std::sqrt(std::max(a[j][j], 1e-30));
    for (int i = j; i < N; ++i)
      a[i][j] /= pivot;
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < j; ++k)
        b[j][c] -= a[j][k] * b[k][c];
      b[j][c] /= a[j][j];
    }
  }
  for (int j = N - 1; j >= 0; --j)
    for (int c = 0; c < 3; ++c) {
      for (int k = j + 1; k < N; ++k)
        b[j][c] -= a[k][j] * b[k][c];
      b[j][c] /= a[j][j];
    }
  return {b[0][0], b[0][1], b[0][2]};
}

/// Points with the logarithms of their values, and the local fit to them.
template <int D> class LocalFit {
public:
  using Tree = KdTree<D>;
  using Point = typename Tree::Point;

  LocalFit(std::vector<Point> points, const std::vector<Color>& values, double floor,
           int neighbours)
      : floor_(floor), neighbours_(neighbours) {
    merge(points, values);
    tree_.emplace_back(std::move(points));
  }

  /// `hidden`: a point that takes no part, with all that lies on it.
  Color at(const Point& point, const Point* hidden = nullptr) const {
    std::array<typename Tree::Neighbour, 32> buffer;
    int32_t leave_out = -1;
    if (hidden != nullptr) {
      auto nearest = tree().nearest(*hidden, std::span(buffer).first(1));
      if (!nearest.empty() && nearest[0].distance2 < kSamePoint * kSamePoint * D)
        leave_out = nearest[0].index;
    }
    auto found =
        tree().nearest(point, std::span(buffer).first(static_cast<size_t>(neighbours_)), leave_out);
    Color log = {0, 0, 0};
    if (!found.empty())
      log = fit(point, found);
    for (double& c : log)
      c = std::max(0.0, std::exp(c) - floor_);
    return log;
  }

private:
  const Tree& tree() const { return tree_.front(); }

  /// Measurements of one point become one: their mean.
  void merge(std::vector<Point>& points, const std::vector<Color>& values) {
    std::vector<int32_t> order(points.size());
    for (size_t i = 0; i < order.size(); ++i)
      order[i] = static_cast<int32_t>(i);
    auto key = [&](int32_t i) {
      std::array<int64_t, D> cell;
      for (int k = 0; k < D; ++k)
        cell[k] = std::llround(points[i][k] / kSamePoint);
      return cell;
    };
    std::sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
      auto x = key(a), y = key(b);
      return x != y ? x < y : a < b;
    });
    std::vector<Point> merged;
    for (size_t first = 0; first < order.size();) {
      Color sum = {0, 0, 0};
      size_t last = first;
      for (; last < order.size() && key(order[last]) == key(order[first]); ++last)
        for (int c = 0; c < 3; ++c)
          sum[c] += values[order[last]][c];
      for (double& c : sum)
        c = std::log(c / static_cast<double>(last - first) + floor_);
      merged.push_back(points[order[first]]);
      logs_.push_back(sum);
      first = last;
    }
    points = std::move(merged);
  }

  Color fit(const Point& point, std::span<const typename Tree::Neighbour> found) const {
    constexpr int N = D + 1;
    double a[N][N] = {}, b[N][3] = {};
    double radius = std::sqrt(found.back().distance2) * 1.0001 + 1e-12, weights = 0;
    Color least = logs_[found[0].index], most = least;
    for (const auto& n : found) {
      double t2 = n.distance2 / (radius * radius);
      double weight = (1 - t2) * (1 - t2) / (t2 + 0.01) + 1e-9;
      weights += weight;
      double basis[N] = {1};
      for (int k = 0; k < D; ++k)
        basis[k + 1] = (tree().points()[n.index][k] - point[k]) / radius;
      const Color& log = logs_[n.index];
      for (int i = 0; i < N; ++i) {
        for (int j = 0; j <= i; ++j)
          a[i][j] += weight * basis[i] * basis[j];
        for (int c = 0; c < 3; ++c)
          b[i][c] += weight * basis[i] * log[c];
      }
      for (int c = 0; c < 3; ++c) {
        least[c] = std::min(least[c], log[c]);
        most[c] = std::max(most[c], log[c]);
      }
    }
    // a small pull of the slopes to zero: neighbours in a plane leave one of them open
    for (int i = 1; i < N; ++i)
      a[i][i] += 1e-4 * weights;
    Color log = solve_first<N>(a, b);
    const double slack = std::log(1.3);
    for (int c = 0; c < 3; ++c)
      log[c] = std::clamp(log[c], least[c] - slack, most[c] + slack);
    return log;
  }

  std::vector<Tree> tree_; // one, made after the points were merged
  std::vector<Color> logs_;
  double floor_;
  int neighbours_;
};

/// Below a thousandth of the median all values are noise: the logarithm is taken of what exceeds
/// it.
double noise_floor(std::span<const MeasuredSample> samples) {
  std::vector<double> means;
  for (const MeasuredSample& s : samples)
    means.push_back((s.rgb[0] + s.rgb[1] + s.rgb[2]) / 3);
  auto middle = means.begin() + static_cast<ptrdiff_t>(means.size() / 2);
  std::nth_element(means.begin(), middle, means.end());
  return std::max(1e-3 * *middle, 1e-9);
}

} // namespace

struct ScatteredReflectance::Implementation {
  std::unique_ptr<LocalFit<3>> isotropic;
  std::unique_ptr<LocalFit<5>> rotated;

  Color at(const HalfDifference& p, const HalfDifference* hidden = nullptr) const {
    if (isotropic) {
      IsotropicPoint out{};
      if (hidden != nullptr)
        out = isotropic_point(hidden->theta_h, hidden->theta_d, hidden->phi_d);
      return isotropic->at(isotropic_point(p.theta_h, p.theta_d, p.phi_d),
                           hidden != nullptr ? &out : nullptr);
    }
    RotatedPoint out{};
    if (hidden != nullptr)
      out = rotated_point(*hidden);
    return rotated->at(rotated_point(p), hidden != nullptr ? &out : nullptr);
  }
};

ScatteredReflectance::ScatteredReflectance(std::span<const MeasuredSample> samples, bool isotropic)
    : implementation_(std::make_unique<Implementation>()) {
  std::vector<IsotropicPoint> points;
  std::vector<RotatedPoint> rotated;
  std::vector<Color> values;
  for (const MeasuredSample& s : samples) {
    HalfDifference p =
        half_difference(direction(s.theta_i, s.phi_i), direction(s.theta_o, s.phi_o));
    values.push_back(s.rgb);
    if (isotropic)
      points.push_back(isotropic_point(p.theta_h, p.theta_d, p.phi_d));
    else
      rotated.push_back(rotated_point(p));
  }
  double floor = noise_floor(samples);
  if (isotropic)
    implementation_->isotropic =
        std::make_unique<LocalFit<3>>(std::move(points), values, floor, kNeighbours[0]);
  else
    implementation_->rotated =
        std::make_unique<LocalFit<5>>(std::move(rotated), values, floor, kNeighbours[1]);
}

ScatteredReflectance::~ScatteredReflectance() = default;

std::array<double, 3> ScatteredReflectance::at(double theta_i, double phi_i, double theta_o,
                                               double phi_o) const {
  return implementation_->at(half_difference(direction(theta_i, phi_i), direction(theta_o, phi_o)));
}

std::array<double, 3> ScatteredReflectance::at_half(double theta_h, double theta_d,
                                                    double phi_d) const {
  return implementation_->at({theta_h, 0, theta_d, phi_d});
}

std::array<double, 3> ScatteredReflectance::without(const MeasuredSample& s) const {
  HalfDifference p = half_difference(direction(s.theta_i, s.phi_i), direction(s.theta_o, s.phi_o));
  return implementation_->at(p, &p);
}

MeasuredGrid grid_from_samples(std::span<const MeasuredSample> samples, bool isotropic) {
  ScatteredReflectance reflectance(samples, isotropic);
  MeasuredGrid grid;
  auto nodes = [](int count, double last, double period, bool square_root) {
    MeasuredAxis axis{{}, period, square_root};
    for (int i = 0; i < count; ++i) {
      double t = static_cast<double>(i) / (period > 0 ? count : count - 1);
      axis.nodes.push_back((square_root ? t * t : t) * last);
    }
    return axis;
  };
  if (isotropic) {
    grid.coordinates = MeasuredCoordinates::half_difference;
    grid.axes = {nodes(90, kPi / 2, 0, true), nodes(46, kPi / 2, 0, false),
                 nodes(48, kPi, kPi, false)};
  } else {
    grid.coordinates = MeasuredCoordinates::relative_rotated;
    grid.axes = {nodes(16, kPi / 2, 0, false), nodes(18, 2 * kPi, 2 * kPi, false),
                 nodes(31, kPi / 2, 0, false), nodes(36, 2 * kPi, 2 * kPi, false)};
  }
  size_t rows = 1, last = grid.axes.back().nodes.size();
  for (size_t k = 0; k + 1 < grid.axes.size(); ++k)
    rows *= grid.axes[k].nodes.size();
  grid.rgb.resize(3 * rows * last);
  auto node = [&](size_t axis, size_t i) { return grid.axes[axis].nodes[i]; };
  auto fill_row = [&](size_t row) {
    for (size_t j = 0; j < last; ++j) {
      float* out = &grid.rgb[3 * (row * last + j)];
      // reciprocity and mirror symmetry make the second half of phi_d a copy
      if (isotropic && j > last / 2) {
        std::copy_n(&grid.rgb[3 * (row * last + last - j)], 3, out);
        continue;
      }
      Color value;
      if (isotropic) {
        size_t n1 = grid.axes[1].nodes.size();
        value = reflectance.at_half(node(0, row / n1), node(1, row % n1), node(2, j));
      } else {
        size_t n1 = grid.axes[1].nodes.size(), n2 = grid.axes[2].nodes.size();
        double phi_i = node(1, row / n2 % n1);
        value =
            reflectance.at(node(0, row / n2 / n1), phi_i, node(2, row % n2), phi_i + node(3, j));
      }
      for (int c = 0; c < 3; ++c)
        out[c] = static_cast<float>(value[c]);
    }
  };
  tbb::parallel_for(tbb::blocked_range<size_t>(0, rows, 64),
                    [&](const tbb::blocked_range<size_t>& range) {
                      for (size_t row = range.begin(); row != range.end(); ++row)
                        fill_row(row);
                    });
  return grid;
}

} // namespace faceta
