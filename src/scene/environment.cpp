#include "scene/environment.h"

#include "bsdf/kernel.h"
#include "scene/affine.h"
#include "spectrum/cie.h"

#include <algorithm>
#include <cmath>

namespace faceta {

using namespace double3;

namespace {

// Kernels count words of cells in 32 bits.
constexpr int64_t kMaxCells = int64_t(1) << 26;

std::array<double, 3> texel(const Image& image, int x, int y) {
  const float* p = &image.data[image.offset(x % image.width, y)];
  return {p[0], p[1], p[2]};
}

double brightness(const EnvironmentCell& cell) {
  double sum = 0;
  for (const auto& t : cell.texel)
    sum += luminance({std::abs(t[0]), std::abs(t[1]), std::abs(t[2])});
  return 0.25 * sum;
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

/// The alias table of a row in 16 + 16 bits; leaves each cell's density along the row in its pdf.
void EnvironmentTables::add_row(int y, int columns, const std::vector<double>& weights) {
  AliasTable table = make_alias_table(weights);
  size_t first = size_t(y) * columns;
  std::vector<double> share(columns, 0.0);
  for (int x = 0; x < columns; ++x) {
    uint32_t threshold = static_cast<uint32_t>(std::min(65535.0, table.threshold[x] * 65536.0));
    uint32_t alias = table.threshold[x] >= 1 ? uint32_t(x) : uint32_t(table.alias[x]);
    column_aliases_[first + x] = threshold | alias << 16;
    share[x] += threshold / 65536.0;
    share[alias] += 1 - threshold / 65536.0;
  }
  for (int x = 0; x < columns; ++x)
    cells_[first + x].pdf = static_cast<float>(share[x]);
}

void EnvironmentTables::add_image(const Image& image) {
  if (image.width < 2 || image.height < 3)
    throw Error("the image of the environment is smaller than 2 x 3 pixels");
  int columns = image.width, rows = image.height - 1;
  if (int64_t(columns) * rows > kMaxCells || columns > 65536)
    throw Error("the image of the environment has more than 2^26 pixels or 65536 columns", {},
                "make it smaller");
  for (float v : image.data)
    if (!std::isfinite(v))
      throw Error("the image of the environment holds a value that is not finite");
  cells_.assign(size_t(columns) * rows + 1, {});
  column_aliases_.assign(size_t(columns) * rows + 1, {});
  std::vector<double> row_weights(rows);
  double total = 0;
  for (int y = 0; y < rows; ++y) {
    std::vector<double> weights(columns);
    double sine = std::sin(kPi * (y + 0.5) / rows);
    for (int x = 0; x < columns; ++x) {
      EnvironmentCell& cell = cells_[size_t(y) * columns + x];
      for (int k = 0; k < 4; ++k) {
        auto rgb = texel(image, x + (k & 1), y + (k >> 1));
        std::copy(rgb.begin(), rgb.end(), cell.texel[k]);
      }
      weights[x] = brightness(cell) * sine;
      row_weights[y] += weights[x];
    }
    add_row(y, columns, weights);
    total += row_weights[y];
  }
  if (!(total > 0)) {
    // Nothing arrives: as good as a black constant, and nothing to divide by.
    black_ = true;
    std::fill_n(view_.radiance, 3, 0.0f);
    cells_.clear();
    column_aliases_.clear();
    return;
  }
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      EnvironmentCell& cell = cells_[size_t(y) * columns + x];
      cell.pdf = static_cast<float>(double(cell.pdf) * row_weights[y] / total * rows);
    }
  AliasTable table = make_alias_table(row_weights);
  row_threshold_ = std::move(table.threshold);
  row_alias_ = std::move(table.alias);
  row_threshold_.resize(rows + kLanePadding);
  row_alias_.resize(rows + kLanePadding);
  view_.columns = columns;
  view_.rows = rows;
}

EnvironmentView EnvironmentTables::view() const {
  EnvironmentView view = view_;
  static const EnvironmentCell kNoCell{};
  static const EnvironmentAlias kNoColumn = 65535;
  static const float kNoThreshold = 1;
  static const int32_t kNoAlias = 0;
  view.cells = cells_.empty() ? &kNoCell : cells_.data();
  view.column_aliases = column_aliases_.empty() ? &kNoColumn : column_aliases_.data();
  view.row_threshold = row_threshold_.empty() ? &kNoThreshold : row_threshold_.data();
  view.row_alias = row_alias_.empty() ? &kNoAlias : row_alias_.data();
  return view;
}

size_t EnvironmentTables::bytes() const {
  return cells_.size() * (sizeof(EnvironmentCell) + sizeof(EnvironmentAlias)) +
         row_threshold_.size() * 8;
}

} // namespace faceta
