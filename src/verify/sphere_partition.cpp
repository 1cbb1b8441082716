#include "verify/sphere_partition.h"

#include "verify/random_stream.h"

#include <algorithm>
#include <cmath>

namespace faceta {

namespace {

constexpr int kSpread = 4096;     // points spread evenly over the sphere
constexpr int kAroundHint = 384;  // points around each hint, log-uniform in distance
constexpr double kNearest = 1e-5; // radians

Vec3<double> uniform_direction(double u, double v) {
  double z = 1 - 2 * u, r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * kPi * v;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

} // namespace

SpherePartition::SpherePartition(const std::vector<Vec3<double>>& directions,
                                 const std::vector<Vec3<double>>& hints, const Vec3<double>& axis,
                                 int leaf) {
  double r = std::hypot(axis.x, axis.y);
  if (r > 0) {
    cos_axis_ = axis.x / r;
    sin_axis_ = axis.y / r;
  }
  std::vector<Point> points;
  points.reserve(directions.size() + kSpread + hints.size() * kAroundHint);
  for (const Vec3<double>& d : directions)
    points.push_back(place(d));
  RandomStream random(7);
  for (int i = 0; i < kSpread; ++i)
    points.push_back(place(uniform_direction(random.next(), random.next())));
  for (const Vec3<double>& hint : hints)
    for (int i = 0; i < kAroundHint; ++i) {
      double distance = kNearest * std::pow(kPi / kNearest, random.next());
      double turn = 2 * kPi * random.next();
      Frame<double> frame = frame_from_normal(hint);
      points.push_back(
          place(frame.to_world({std::sin(distance) * std::cos(turn),
                                std::sin(distance) * std::sin(turn), std::cos(distance)})));
    }
  // The horizon is always a border: densities jump there.
  nodes_.resize(3);
  nodes_[0] = {0, 1.0, 1};
  size_t above =
      std::partition(points.begin(), points.end(), [](const Point& p) { return p.c[0] < 1; }) -
      points.begin();
  split(1, points, 0, above, {0, 1, -2, 2}, 0, leaf);
  split(2, points, above, points.size(), {1, 2, -2, 2}, 0, leaf);
}

SpherePartition::Point SpherePartition::place(const Vec3<double>& d) const {
  double square = d.x * d.x + d.y * d.y;
  double x = d.x * cos_axis_ + d.y * sin_axis_, y = d.y * cos_axis_ - d.x * sin_axis_;
  double sum = std::abs(x) + std::abs(y);
  // 1 - |cos| = sin^2 / (1 + |cos|) keeps the digits that a float z has lost near the poles.
  double near = square / (1 + std::abs(d.z));
  double pseudo = sum > 0 ? std::copysign(1 - x / sum, y) : 0;
  return {{d.z > 0 ? std::min(near, 1.0) : 2 - std::min(near, 1.0), pseudo}};
}

void SpherePartition::split(int node, std::vector<Point>& points, size_t begin, size_t end,
                            Rectangle area, int axis, int leaf) {
  for (int attempt = 0; attempt < 2 && end - begin > size_t(leaf); ++attempt, axis = 1 - axis) {
    size_t middle = begin + (end - begin) / 2;
    auto less = [axis](const Point& a, const Point& b) { return a.c[axis] < b.c[axis]; };
    std::nth_element(points.begin() + begin, points.begin() + middle, points.begin() + end, less);
    double upper = points[middle].c[axis];
    double lower = std::max_element(points.begin() + begin, points.begin() + middle, less)->c[axis];
    double border = 0.5 * (lower + upper);
    double low = axis == 0 ? area.x0 : area.y0, high = axis == 0 ? area.x1 : area.y1;
    // Equal coordinates cannot be told apart; slivers would be thinner than float directions are.
    if (!(upper - lower > 0) || border - low < 1e-11 || high - border < 1e-11)
      continue;
    int first = static_cast<int>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[node] = {axis, border, first};
    Rectangle below = area, above = area;
    (axis == 0 ? below.x1 : below.y1) = border;
    (axis == 0 ? above.x0 : above.y0) = border;
    split(first, points, begin, middle, below, 1 - axis, leaf);
    split(first + 1, points, middle, end, above, 1 - axis, leaf);
    return;
  }
  nodes_[node] = {-1, 0, static_cast<int>(cells_.size())};
  cells_.push_back({area.x0, area.x1, angle_of(area.y0), angle_of(area.y1)});
}

double SpherePartition::angle_of(double pseudo) {
  double x = 1 - std::abs(pseudo), y = std::copysign(1 - std::abs(x), pseudo);
  if (std::abs(pseudo) >= 2)
    return std::copysign(kPi, pseudo);
  return std::atan2(y, x);
}

int SpherePartition::locate(const Vec3<double>& direction) const {
  Point p = place(direction);
  int node = 0;
  while (nodes_[node].axis >= 0)
    node = nodes_[node].first + (p.c[nodes_[node].axis] < nodes_[node].split ? 0 : 1);
  return nodes_[node].first;
}

SpherePoint SpherePartition::coordinates(const Vec3<double>& direction) const {
  Point p = place(direction);
  return {p.c[0], angle_of(p.c[1])};
}

Vec3<double> SpherePartition::direction(double t, double phi) const {
  double r = std::sqrt(std::max(0.0, t * (2 - t)));
  double x = r * std::cos(phi), y = r * std::sin(phi);
  return {x * cos_axis_ - y * sin_axis_, y * cos_axis_ + x * sin_axis_, 1 - t};
}

} // namespace faceta
