#include "bsdf/bsdf.h"
#include "materials/measured_demo.h"
#include "sampling/warp.h"

#include <algorithm>
#include <cmath>

namespace faceta {

namespace {

/// One of the four ways of light: a diffuse colour, and a lobe about the mirror direction or
/// straight on.
struct Way {
  std::array<double, 3> diffuse;
  double strength, exponent;
};

constexpr Way kWays[4] = {{{0.35, 0.30, 0.22}, 0.25, 20},  // kFrontReflection
                          {{0.20, 0.16, 0.10}, 0.15, 60},  // kFrontTransmission
                          {{0.15, 0.20, 0.30}, 0.10, 8},   // kBackReflection
                          {{0.20, 0.16, 0.10}, 0.15, 60}}; // kBackTransmission

Vec3<double> above(const Vec2<double>& disk) {
  return {disk.x, disk.y, safe_sqrt(1 - sqr(disk.x) - sqr(disk.y))};
}

std::array<double, 3> value_at(MeasuredPass pass, Vec3<double> wi, Vec3<double> wo) {
  bool from_back = pass == kBackReflection || pass == kBackTransmission;
  bool through = pass == kFrontTransmission || pass == kBackTransmission;
  wi.z = from_back ? -wi.z : wi.z;
  wo.z = from_back != through ? -wo.z : wo.z;
  return demo_window(pass, wi, wo);
}

/// The middle of each cell by projected solid angle.
std::vector<Vec3<double>> middles(const KlemsBasis& basis) {
  std::vector<Vec3<double>> list;
  for (size_t k = 0; k < basis.cells.size(); ++k)
    for (int j = 0; j < basis.cells[k]; ++j) {
      double square =
          k == 0 ? 0 : 0.5 * (sqr(std::sin(basis.theta[k])) + sqr(std::sin(basis.theta[k + 1])));
      double r = std::sqrt(square), phi = 2 * kPi * j / basis.cells[k];
      list.push_back({r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - square)});
    }
  return list;
}

/// Builds a tree of the middles of its cells; branches whose cells are alike become one.
class TreeBuilder {
public:
  TreeBuilder(MeasuredTree& tree, MeasuredPass pass)
      : tree_(tree), pass_(pass), nodes_(tree.nodes[pass]), rgb_(tree.rgb[pass]) {
    nodes_.assign(1, 0);
    fill(0, {0, 0, 0, 0}, 1, 0);
  }

private:
  void fill(size_t node, const std::array<double, 4>& corner, double size, int depth) {
    if (depth == tree_.depth || alike(corner, size, depth)) {
      nodes_[node] = -1 - static_cast<int32_t>(rgb_.size() / 3);
      for (double v : middle(corner, size))
        rgb_.push_back(static_cast<float>(v));
      return;
    }
    const size_t children = size_t(1) << tree_.dimensions, first = nodes_.size();
    nodes_.resize(first + children);
    nodes_[node] = static_cast<int32_t>(first);
    for (size_t k = 0; k < children; ++k)
      fill(first + k, child(corner, size, k), 0.5 * size, depth + 1);
  }
  std::array<double, 4> child(std::array<double, 4> corner, double size, size_t k) const {
    for (size_t d = 0; d < size_t(tree_.dimensions); ++d)
      corner[d] += double(k >> d & 1) * 0.5 * size;
    return corner;
  }
  /// Whether the cells of the next level differ little; large cells are always divided.
  bool alike(const std::array<double, 4>& corner, double size, int depth) const {
    if (depth < 2)
      return false;
    double least = 1e9, most = 0;
    for (size_t k = 0; k < size_t(1) << tree_.dimensions; ++k) {
      double value = middle(child(corner, size, k), 0.5 * size)[1];
      least = std::min(least, value);
      most = std::max(most, value);
    }
    return most - least < 0.02;
  }
  std::array<double, 3> middle(const std::array<double, 4>& corner, double size) const {
    double x[4];
    for (size_t d = 0; d < 4; ++d)
      x[d] = corner[d] + 0.5 * size;
    if (tree_.dimensions == 4)
      return value_at(pass_, above(concentric_disk(Vec2<double>{x[0], x[1]})),
                      above(concentric_disk(Vec2<double>{x[2], x[3]})));
    // Light comes from azimuth pi; beyond the middle of the first coordinate there is none.
    double r = 1 - 2 * x[0];
    if (r < 0)
      return {0, 0, 0};
    return value_at(pass_, above({-r, 0}), above(concentric_disk(Vec2<double>{x[1], x[2]})));
  }

  MeasuredTree& tree_;
  MeasuredPass pass_;
  std::vector<int32_t>& nodes_;
  std::vector<float>& rgb_;
};

} // namespace

std::array<double, 3> demo_window(MeasuredPass pass, const Vec3<double>& wi,
                                  const Vec3<double>& wo) {
  const Way& way = kWays[pass];
  Vec3<double> axis = wi.z * wo.z > 0 ? reflect(wi) : -wi;
  double lobe = way.strength * (way.exponent + 1) / (2 * kPi) *
                std::pow(std::max(0.0, dot(axis, wo)), way.exponent);
  std::array<double, 3> value{};
  for (size_t c = 0; c < 3; ++c)
    value[c] = way.diffuse[c] / kPi + lobe;
  return value;
}

MeasuredPatches demo_patches() {
  const KlemsBasis& basis = klems_bases().at("lbnl/klems full");
  MeasuredPatches patches{basis, basis, {}};
  const std::vector<Vec3<double>> directions = middles(patches.incident);
  for (int pass = 0; pass < 4; ++pass)
    for (const Vec3<double>& wi : directions)
      for (const Vec3<double>& wo : directions)
        for (double v : value_at(static_cast<MeasuredPass>(pass), wi, wo))
          patches.rgb[size_t(pass)].push_back(static_cast<float>(v));
  return patches;
}

MeasuredTree demo_tree(int dimensions) {
  MeasuredTree tree;
  tree.dimensions = dimensions;
  tree.depth = dimensions == 3 ? 4 : 3;
  for (int pass = 0; pass < 4; ++pass)
    TreeBuilder(tree, static_cast<MeasuredPass>(pass));
  return tree;
}

} // namespace faceta
