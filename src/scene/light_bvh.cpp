#include "scene/light_bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

namespace faceta {

using namespace double3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kBuckets = 12;
constexpr int kMaxLevels = 32; // bits of a trail

struct Cone {
  Double3 axis;
  double cosine;
};

Cone unite_cones(const LightBounds& a, const LightBounds& b) {
  if (a.cos_spread > b.cos_spread)
    return unite_cones(b, a);
  double wide = std::acos(std::clamp(a.cos_spread, -1.0, 1.0));
  double narrow = std::acos(std::clamp(b.cos_spread, -1.0, 1.0));
  Double3 side = cross(a.axis, b.axis);
  double between = std::atan2(length(side), dot(a.axis, b.axis));
  if (std::min(between + narrow, kPi) <= wide)
    return {a.axis, a.cos_spread};
  double spread = 0.5 * (wide + between + narrow);
  if (spread >= kPi || length(side) < 1e-12)
    return {{0, 0, 1}, -1};
  // Turn the wider axis towards the other, about their common normal.
  double turn = spread - wide;
  Double3 across = cross(normalize(side), a.axis);
  Double3 axis = add(scale(a.axis, std::cos(turn)), scale(across, std::sin(turn)));
  return {normalize(axis), std::cos(spread)};
}

/// Solid angle that emission can reach, weighted by the cosine beyond the normals' cone.
double orientation_measure(const LightBounds& b) {
  double spread = std::acos(std::clamp(b.cos_spread, -1.0, 1.0));
  double emission = std::acos(std::clamp(b.cos_emission, -1.0, 1.0));
  double reach = std::min(spread + emission, kPi);
  double s = std::sin(spread), c = std::cos(spread);
  return 2 * kPi * (1 - c) +
         kPi / 2 * (2 * reach * s - std::cos(spread - 2 * reach) - 2 * spread * s + c);
}

double size_measure(const LightBounds& b) {
  Double3 d = sub(b.high, b.low);
  // A little of the diagonal's square keeps rows of points apart, whose boxes have no area.
  return d[0] * d[1] + d[1] * d[2] + d[2] * d[0] + 1e-3 * dot(d, d);
}

double cost(const LightBounds& b) {
  return b.power * orientation_measure(b) * size_measure(b);
}

LightNode make_node(const LightBounds& b) {
  LightNode node{};
  double radius = 0.5 * length(sub(b.high, b.low));
  for (int k = 0; k < 3; ++k) {
    double center = 0.5 * (b.low[k] + b.high[k]);
    node.center[k] = static_cast<float>(center);
    radius += std::abs(node.center[k] - center);
    node.axis[k] = static_cast<float>(b.axis[k]);
  }
  // Rounding must not narrow the sphere or the cones.
  node.radius2 = static_cast<float>(radius * radius * (1 + 1e-6));
  double cos_spread = std::max(-1.0, b.cos_spread - (b.cos_spread < 1 ? 1e-6 : 0));
  node.cos_spread = static_cast<float>(cos_spread);
  node.sin_spread = static_cast<float>(std::sqrt(1 - cos_spread * cos_spread));
  node.cos_emission = static_cast<float>(b.cos_emission);
  node.power = static_cast<float>(b.power);
  node.child = node.light = -1;
  return node;
}

class Builder {
public:
  explicit Builder(const std::vector<LightBounds>& lights)
      : lights_(lights), order_(lights.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    tree_.trails.resize(lights.size());
    tree_.nodes.reserve(2 * lights.size());
    tree_.nodes.push_back(make_node({}));
    if (!lights.empty())
      build(0, 0, lights.size(), 0, 0);
  }
  LightTree take() { return std::move(tree_); }

private:
  struct Split {
    int axis = 0, bucket = 0;
    double low = 0, scale = 0; ///< bucket = (centre - low) * scale
  };

  double centre(size_t light, int axis) const {
    return 0.5 * (lights_[light].low[axis] + lights_[light].high[axis]);
  }
  static int bucket_of(double x, const Split& s) {
    return std::clamp(static_cast<int>((x - s.low) * s.scale), 0, kBuckets - 1);
  }

  void build(int node, size_t first, size_t last, uint32_t trail, int depth) {
    LightBounds bounds = lights_[order_[first]];
    for (size_t i = first + 1; i < last; ++i)
      bounds = unite(bounds, lights_[order_[i]]);
    tree_.nodes[node] = make_node(bounds);
    if (last - first == 1) {
      tree_.nodes[node].light = static_cast<int32_t>(order_[first]);
      tree_.trails[order_[first]] = {trail, depth};
      return;
    }
    size_t middle = partition(bounds, first, last, depth);
    int child = static_cast<int>(tree_.nodes.size());
    tree_.nodes[node].child = child;
    tree_.nodes.resize(tree_.nodes.size() + 2);
    build(child, first, middle, trail, depth + 1);
    build(child + 1, middle, last, trail | uint32_t(1) << depth, depth + 1);
  }

  size_t partition(const LightBounds& bounds, size_t first, size_t last, int depth) {
    size_t middle = first;
    std::optional<Split> split = find_split(bounds, first, last);
    if (split)
      middle = std::partition(order_.begin() + first, order_.begin() + last,
                              [&](size_t i) {
                                return bucket_of(centre(i, split->axis), *split) <= split->bucket;
                              }) -
               order_.begin();
    // Halves where nothing separates the lights, or where the levels would run out.
    size_t largest = std::max(middle - first, last - middle);
    if (middle == first || middle == last || largest > size_t(1) << (kMaxLevels - 1 - depth))
      middle = first + (last - first) / 2;
    return middle;
  }

  std::optional<Split> find_split(const LightBounds& bounds, size_t first, size_t last) const {
    Double3 low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
    for (size_t i = first; i < last; ++i)
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], centre(order_[i], k));
        high[k] = std::max(high[k], centre(order_[i], k));
      }
    Double3 extent = sub(bounds.high, bounds.low);
    double longest = *std::max_element(extent.begin(), extent.end());
    std::optional<Split> best;
    double best_cost = kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(high[axis] > low[axis]))
        continue;
      Split s{axis, 0, low[axis], kBuckets / (high[axis] - low[axis])};
      if (!std::isfinite(s.scale))
        continue;
      // Thin slices of a long box are poor groups (the regularity factor of the paper).
      double factor = longest / extent[axis];
      scan(s, first, last, [&](int bucket, const LightBounds& left, const LightBounds& right) {
        double c = factor * (cost(left) + cost(right));
        if (c < best_cost) {
          best_cost = c;
          best = s;
          best->bucket = bucket;
        }
      });
    }
    return best;
  }

  /// Calls consider(bucket, left, right) for each way to cut between buckets.
  template <class F> void scan(const Split& s, size_t first, size_t last, F consider) const {
    std::optional<LightBounds> buckets[kBuckets], right[kBuckets];
    auto merge = [](std::optional<LightBounds>& to, const std::optional<LightBounds>& from) {
      if (from)
        to = to ? unite(*to, *from) : *from;
    };
    for (size_t i = first; i < last; ++i)
      merge(buckets[bucket_of(centre(order_[i], s.axis), s)], lights_[order_[i]]);
    for (int k = kBuckets - 1; k > 0; --k) {
      right[k] = buckets[k];
      if (k + 1 < kBuckets)
        merge(right[k], right[k + 1]);
    }
    std::optional<LightBounds> left;
    for (int k = 0; k + 1 < kBuckets; ++k) {
      merge(left, buckets[k]);
      if (left && right[k + 1])
        consider(k, *left, *right[k + 1]);
    }
  }

  const std::vector<LightBounds>& lights_;
  std::vector<size_t> order_;
  LightTree tree_;
};

} // namespace

LightBounds unite(const LightBounds& a, const LightBounds& b) {
  LightBounds r;
  for (int k = 0; k < 3; ++k) {
    r.low[k] = std::min(a.low[k], b.low[k]);
    r.high[k] = std::max(a.high[k], b.high[k]);
  }
  Cone cone = unite_cones(a, b);
  r.axis = cone.axis;
  r.cos_spread = cone.cosine;
  r.cos_emission = std::min(a.cos_emission, b.cos_emission);
  r.power = a.power + b.power;
  return r;
}

LightTree build_light_tree(const std::vector<LightBounds>& lights) {
  return Builder(lights).take();
}

} // namespace faceta
