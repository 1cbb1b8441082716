#include "scene/environment.h"

#include "base/half.h"
#include "bsdf/kernel.h"
#include "scene/affine.h"
#include "scene/environment_leaves.h"
#include "spectrum/cie.h"

#include <algorithm>
#include <cmath>

namespace faceta {

using namespace double3;

namespace {

// Kernels count words of cells in 32 bits.
constexpr int64_t kMaxCells = int64_t(1) << 26;
// 32 bytes each: the table stays in the second-level cache and leaves room there; four times as
// many gave no less noise.
constexpr int kMaxLeaves = 1 << 12;

std::array<double, 3> texel(const Image& image, int x, int y) {
  const float* p = &image.data[image.offset(x % image.width, y)];
  return {p[0], p[1], p[2]};
}

using Corners = std::array<std::array<double, 3>, 4>;

double brightness(const Corners& corners) {
  double sum = 0;
  for (const auto& t : corners)
    sum += luminance({std::abs(t[0]), std::abs(t[1]), std::abs(t[2])});
  return 0.25 * sum;
}

/// Half floats over the power of two that brings the largest close below 2^15: 11 bits each, down
/// to 2^-29 of the largest.
EnvironmentCell pack_cell(const Corners& corners) {
  double largest = 0;
  for (const auto& t : corners)
    for (double v : t)
      largest = std::max(largest, std::abs(v));
  EnvironmentCell cell{};
  int exponent = largest > 0 ? std::max(std::ilogb(largest) - 14, -126) : 0;
  cell.scale = std::ldexp(1.0f, exponent);
  for (int k = 0; k < 4; ++k)
    for (int c = 0; c < 3; ++c)
      cell.texel[k][c] = half_bits(static_cast<float>(std::ldexp(corners[k][c], -exponent)));
  return cell;
}

} // namespace

AliasTable make_alias_table(const std::vector<double>& weights) {
  size_t n = weights.size();
  double sum = 0;
  for (double w : weights)
    sum += w;
  AliasTable table{std::vector<float>(n), std::vector<int32_t>(n)};
  std::vector<double> share(n);
  std::vector<size_t> small, large;
  for (size_t i = 0; i < n; ++i) {
    share[i] = sum > 0 ? weights[i] / sum * double(n) : 1;
    (share[i] < 1 ? small : large).push_back(i);
    table.threshold[i] = 1;
    table.alias[i] = static_cast<int32_t>(i);
  }
  while (!small.empty() && !large.empty()) {
    size_t s = small.back(), l = large.back();
    small.pop_back();
    table.threshold[s] = static_cast<float>(share[s]);
    table.alias[s] = static_cast<int32_t>(l);
    share[l] -= 1 - share[s];
    if (share[l] < 1) {
      large.pop_back();
      small.push_back(l);
    }
  }
  return table;
}

EnvironmentTables::EnvironmentTables(const EnvironmentDesc& desc) {
  view_.present = 1;
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(desc.radiance[c]))
      throw Error("the radiance of the environment is not finite");
    view_.radiance[c] = static_cast<float>(desc.radiance[c]);
    black_ = black_ && !(desc.radiance[c] > 0);
  }
  if (!(desc.sampling_weight >= 0) || !std::isfinite(desc.sampling_weight))
    throw Error("sampling_weight of the environment must be a finite number, 0 or more");
  set_rotations(desc.to_world, desc.image ? desc.image->width : 0);
  if (desc.image)
    add_image(desc.image->rgb(RgbFallback::luminance_or_xyz));
}

void EnvironmentTables::set_rotations(const ToWorld& m, int width) {
  check_affine(m);
  double size = length(column(m, 0));
  bool similar = size > 0;
  for (int i = 0; i < 3; ++i) {
    similar = similar && std::abs(length(column(m, i)) - size) <= 1e-3 * size;
    for (int j = 0; j < i; ++j)
      similar = similar && std::abs(dot(column(m, i), column(m, j))) <= 1e-3 * size * size;
  }
  if (!similar)
    throw Error("to_world of the environment holds a non-uniform scale or a shear", {},
                "rotate or mirror it");
  // Turning about y by half a texel: u of the turned direction is u - 1 / (2 width).
  double turn = width > 0 ? kPi / width : 0;
  double c = std::cos(turn), s = std::sin(turn);
  for (int k = 0; k < 3; ++k) { // the inverse of a rotation is its transpose
    Double3 column_k{m[4 * k] / size, m[4 * k + 1] / size, m[4 * k + 2] / size};
    Double3 turned{c * column_k[0] + s * column_k[2], column_k[1],
                   c * column_k[2] - s * column_k[0]};
    for (int i = 0; i < 3; ++i) {
      view_.to_local[3 * i + k] = static_cast<float>(turned[i]);
      view_.to_world[3 * k + i] = static_cast<float>(turned[i]);
    }
  }
}

/// The table of rectangles, and in each cell the density that choosing by it has.
void EnvironmentTables::add_leaves(const std::vector<double>& weights, double total) {
  std::vector<EnvironmentRectangle> rectangles =
      divide_environment(weights, view_.columns, view_.rows, kMaxLeaves);
  std::vector<double> leaf_weights;
  for (const EnvironmentRectangle& r : rectangles)
    leaf_weights.push_back(r.weight);
  AliasTable table = make_alias_table(leaf_weights);
  double cells = double(view_.columns) * view_.rows;
  auto origin = [&](int32_t i) {
    return uint32_t(rectangles[i].x) | uint32_t(rectangles[i].y) << 16;
  };
  auto size = [&](int32_t i) {
    return uint32_t(rectangles[i].width) | uint32_t(rectangles[i].height) << 16;
  };
  for (int32_t i = 0; i < static_cast<int32_t>(rectangles.size()); ++i) {
    const EnvironmentRectangle& r = rectangles[i];
    int32_t other = table.alias[i];
    leaves_.push_back(
        {table.threshold[i], {origin(i), origin(other)}, {size(i), size(other)}, other, {}});
    double density = r.weight / total * cells / (double(r.width) * r.height);
    for (int y = r.y; y < r.y + r.height; ++y)
      for (int x = r.x; x < r.x + r.width; ++x)
        cells_[size_t(y) * view_.columns + x].pdf = static_cast<float>(density);
  }
}

void EnvironmentTables::add_image(const Image& image) {
  if (image.width < 2 || image.height < 3)
    throw Error("the image of the environment is smaller than 2 x 3 pixels");
  int columns = image.width, rows = image.height - 1;
  if (int64_t(columns) * rows > kMaxCells || columns > 65535)
    throw Error("the image of the environment has more than 2^26 pixels or 65535 columns", {},
                "make it smaller");
  for (float v : image.data)
    if (!std::isfinite(v))
      throw Error("the image of the environment holds a value that is not finite");
  cells_.assign(size_t(columns) * rows + 1, {});
  std::vector<double> weights(size_t(columns) * rows);
  double total = 0;
  for (int y = 0; y < rows; ++y) {
    double sine = std::sin(kPi * (y + 0.5) / rows);
    for (int x = 0; x < columns; ++x) {
      size_t i = size_t(y) * columns + x;
      Corners corners;
      for (int k = 0; k < 4; ++k)
        corners[k] = texel(image, x + (k & 1), y + (k >> 1));
      cells_[i] = pack_cell(corners);
      total += weights[i] = brightness(corners) * sine;
    }
  }
  if (!(total > 0)) {
    // Nothing arrives: as good as a black constant, and nothing to divide by.
    black_ = true;
    std::fill_n(view_.radiance, 3, 0.0f);
    cells_.clear();
    return;
  }
  view_.columns = columns;
  view_.rows = rows;
  add_leaves(weights, total);
}

EnvironmentView EnvironmentTables::view() const {
  EnvironmentView view = view_;
  static const EnvironmentCell kNoCell{};
  view.cells = cells_.empty() ? &kNoCell : cells_.data();
  static const EnvironmentLeaf kNoLeaf{};
  view.leaves = leaves_.empty() ? &kNoLeaf : leaves_.data();
  view.leaf_count = static_cast<int32_t>(leaves_.size());
  return view;
}

size_t EnvironmentTables::bytes() const {
  return cells_.size() * sizeof(EnvironmentCell) + leaves_.size() * sizeof(EnvironmentLeaf);
}

} // namespace faceta
