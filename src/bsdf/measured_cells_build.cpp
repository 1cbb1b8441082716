#include "base/error.h"
#include "bsdf/kernel.h"
#include "bsdf/measured_build.h"
#include "bsdf/measured_cells.h"
#include "spectrum/cie.h"

#include <algorithm>
#include <numeric>
#include <tbb/parallel_for.h>

namespace faceta {

namespace {

constexpr size_t kMostNumbers = size_t(1) << 28; ///< of a block: 1 GiB
constexpr int kDeepest = 16;                     ///< so that a float has every digit of a place
constexpr int kExact = 1 << 24;                  ///< whole numbers up to here are floats

constexpr MeasuredPass kPasses[2][2] = {{kFrontReflection, kBackTransmission},
                                        {kBackReflection, kFrontTransmission}};

void check(bool good, const char* what) {
  if (!good)
    throw Error(std::string("a measured table is inconsistent: ") + what);
}

double brightness(const float* rgb) {
  return luminance({rgb[0], rgb[1], rgb[2]});
}

/// The block while it grows; the header is written at the end.
class Block {
public:
  MeasuredCellsHeader header{};

  Block() : values_(sizeof(MeasuredCellsHeader) / sizeof(float)) {}

  int32_t add(size_t count) {
    size_t at = values_.size();
    if (count > kMostNumbers || at + count > kMostNumbers)
      throw Error("a measured table that would take more than 1 GiB of memory");
    values_.resize(at + count);
    return static_cast<int32_t>(at);
  }
  void push(double value) { values_.push_back(static_cast<float>(value)); }
  int32_t size() const { return static_cast<int32_t>(values_.size()); }
  float* at(int32_t offset) { return values_.data() + offset; }
  const float* data() {
    std::memcpy(values_.data(), &header, sizeof header);
    return values_.data();
  }
  HugeVector<float> finish() {
    add(kLanePadding);
    data();
    return std::move(values_);
  }

private:
  HugeVector<float> values_;
};

/// Room for the sums of all viewers.
void add_sums(Block& block) {
  const MeasuredCellsHeader& h = block.header;
  int32_t at = block.add(size_t(2) * size_t(h.viewers) * (2 * size_t(h.lights) + 1));
  block.header.sums = at;
}

/// Sums of probabilities in whole steps of 2^-24, so that their differences are exact; the last
/// is 1, or 0 if nothing has a weight.
void fill_sums(float* sums, const std::vector<double>& weights) {
  double total = std::accumulate(weights.begin(), weights.end(), 0.0), before = 0;
  sums[0] = 0;
  for (size_t k = 0; k < weights.size(); ++k) {
    before += weights[k];
    double share = total > 0 ? std::min(before / total, 1.0) : 0;
    sums[k + 1] = static_cast<float>(std::nearbyint(share * kExact) / kExact);
  }
}

// --- Klems matrices ---

MeasuredCellsHeader::Basis add_basis(Block& block, const KlemsBasis& basis) {
  const size_t rings = basis.cells.size();
  check(rings >= 1 && basis.theta.size() == rings + 1, "a basis has not one edge more than rings");
  check(basis.theta.front() == 0 && std::abs(basis.theta.back() - 0.5 * kPi) < 1e-6,
        "a basis does not span the hemisphere");
  MeasuredCellsHeader::Basis b{};
  b.rings = static_cast<int32_t>(rings);
  b.cosines = block.size();
  for (size_t k = 1; k <= rings; ++k) {
    check(basis.theta[k] > basis.theta[k - 1] && basis.cells[k - 1] >= 1,
          "the rings of a basis do not follow one another");
    block.push(k == rings ? 0 : std::cos(basis.theta[k]));
  }
  b.places = block.size();
  int64_t first = 0;
  for (int cells : basis.cells) {
    block.push(double(first));
    block.push(cells);
    first += cells;
    check(first <= kExact, "a basis has too many cells");
  }
  // Areas by the cosines as they were rounded: those are the edges.
  b.areas = block.size();
  double inner = 0;
  for (size_t k = 0; k < rings; ++k) {
    double outer = 1 - sqr<double>(*block.at(b.cosines + static_cast<int32_t>(k)));
    check(outer > inner, "a ring of a basis is too narrow");
    block.push(inner);
    block.push((outer - inner) / basis.cells[k]);
    inner = outer;
  }
  b.numbers = block.size();
  for (size_t k = 0; k < rings; ++k)
    for (int j = 0; j < basis.cells[k]; ++j)
      block.push(double(k));
  return b;
}

/// Probabilities in proportion to brightness times projected solid angle, but of cells that give
/// any light at least 2^-20, so that none of them rounds to never.
void fill_klems_sums(Block& block) {
  const MeasuredCellsHeader& h = block.header;
  const size_t lights = size_t(h.lights), rows = 2 * size_t(h.viewers);
  std::vector<double> area;
  for (size_t k = 0; k < lights; ++k)
    area.push_back(
        *block.at(h.incident.areas + 1 + 2 * int32_t(*block.at(h.incident.numbers + int32_t(k)))));
  tbb::parallel_for(size_t(0), rows, [&](size_t row) {
    const float* rgb = block.at(h.values) + row * 2 * lights * 3;
    std::vector<double> weights(2 * lights);
    for (size_t k = 0; k < weights.size(); ++k)
      weights[k] = brightness(rgb + 3 * k) * area[k % lights];
    double least = 0x1p-20 * std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& w : weights)
      w = w > 0 ? std::max(w, least) : 0;
    fill_sums(block.at(h.sums) + row * (2 * lights + 1), weights);
  });
}

// --- Tensor trees ---

/// Copies a tree into the block, its children in blocks.
class TreeCopy {
public:
  TreeCopy(Block& block, const MeasuredTree& tree, MeasuredPass pass)
      : block_(block), from_(tree.nodes[pass]), colors_(tree.rgb[pass].size() / 3),
        children_(1 << tree.dimensions) {
    root_ = block.add(1);
    depth_ = copy(0, root_, 0);
    count_ = block.size() - root_;
  }
  int32_t root() const { return root_; }
  int32_t count() const { return count_; }
  int depth() const { return depth_; }

private:
  /// Writes a node to a place in the block; how deep it goes.
  int copy(size_t node, int32_t place, int depth) {
    check(node < from_.size(), "a tree names a node that it has not");
    if (from_[node] < 0) {
      size_t color = static_cast<size_t>(-1 - int64_t(from_[node]));
      check(color < colors_, "a tree names a value that it has not");
      if (color >= size_t(kExact))
        throw Error("a tensor tree of more than 2^24 values");
      *block_.at(place) = -1 - static_cast<float>(color);
      return 0;
    }
    if (depth >= kDeepest)
      throw Error("a tensor tree of more than 16 levels");
    int32_t first = block_.add(size_t(children_)), number = (first - root_ - 1) / children_;
    if (number >= kExact)
      throw Error("a tensor tree of more than 2^24 branches");
    *block_.at(place) = static_cast<float>(number);
    int deepest = 0;
    for (int k = 0; k < children_; ++k)
      deepest = std::max(deepest, copy(size_t(from_[node]) + size_t(k), first + k, depth + 1));
    return deepest + 1;
  }

  Block& block_;
  const std::vector<int32_t>& from_;
  size_t colors_;
  int32_t children_, root_ = 0, count_ = 0;
  int depth_ = 0;
};

/// The mean brightness below each node: children come after their parents.
void add_means(Block& block, MeasuredPass pass, int32_t count) {
  const int32_t means = block.header.means[pass] = block.add(size_t(count));
  const float* nodes = block.at(block.header.nodes[pass]);
  float* mean = block.at(means);
  for (int32_t k = count - 1; k >= 0; --k) {
    auto word = static_cast<int32_t>(nodes[k]);
    double sum = 0;
    for (int child = 0; child < 16 && word >= 0; ++child)
      sum += mean[16 * word + 1 + child] / 16.0;
    mean[k] = static_cast<float>(
        word >= 0 ? sum : brightness(block.at(block.header.colors[pass] + 3 * (-1 - word))));
  }
}

void add_tree(Block& block, const MeasuredTree& tree) {
  MeasuredCellsHeader& h = block.header;
  const int32_t black = block.add(3), nothing = block.add(1);
  *block.at(nothing) = -1;
  for (int p = 0; p < 4; ++p) {
    auto pass = static_cast<MeasuredPass>(p);
    h.nodes[p] = nothing;
    h.colors[p] = black;
    if (tree.nodes[pass].empty())
      continue;
    TreeCopy copy(block, tree, pass);
    h.nodes[p] = copy.root();
    h.depth = std::max(h.depth, copy.depth());
    h.colors[p] = block.add(tree.rgb[pass].size());
    std::copy(tree.rgb[pass].begin(), tree.rgb[pass].end(), block.at(h.colors[p]));
    for (float v : tree.rgb[pass])
      check(v >= 0 && std::isfinite(v), "a value is out of range");
    if (tree.dimensions == 4)
      add_means(block, pass, copy.count());
  }
}

/// The mean brightness of a tree of rank 4 over the pairs of cells of the table.
class PairMeans {
public:
  PairMeans(const MeasuredTree& tree, MeasuredPass pass, int side)
      : tree_(tree), pass_(pass), side_(side),
        values_(size_t(side) * size_t(side) * size_t(side) * size_t(side)) {
    add(0, {0, 0, 0, 0}, side, 1);
  }
  /// [light][viewer]
  double at(size_t light, size_t viewer) const {
    return values_[light * size_t(side_) * size_t(side_) + viewer];
  }

private:
  /// A node that covers `size` cells of the table in each dimension from `corner`; once that is
  /// one, a share of it.
  void add(size_t node, const std::array<int, 4>& corner, int size, double share) {
    int32_t word = tree_.nodes[pass_][node];
    if (word < 0) {
      double value = brightness(&tree_.rgb[pass_][3 * static_cast<size_t>(-1 - int64_t(word))]);
      return fill(corner, size, static_cast<float>(share * value));
    }
    for (int child = 0; child < 16; ++child) {
      std::array<int, 4> at = corner;
      for (int d = 0; d < 4 && size > 1; ++d)
        at[size_t(d)] += (child >> d & 1) * (size / 2);
      add(size_t(word) + size_t(child), at, std::max(1, size / 2), size > 1 ? share : share / 16);
    }
  }
  void fill(const std::array<int, 4>& corner, int size, float value) {
    for (int ly = corner[1]; ly < corner[1] + size; ++ly)
      for (int lx = corner[0]; lx < corner[0] + size; ++lx)
        for (int vy = corner[3]; vy < corner[3] + size; ++vy) {
          float* row = &values_[size_t(((ly * side_ + lx) * side_ + vy) * side_)];
          for (int vx = corner[2]; vx < corner[2] + size; ++vx)
            row[vx] += value;
        }
  }

  const MeasuredTree& tree_;
  MeasuredPass pass_;
  int side_;
  std::vector<float> values_;
};

/// Probabilities of a row, with a share that is uniform over the sides that light goes to at all:
/// it bounds the weights of samples.
void fill_tree_row(Block& block, const MeasuredTree& tree, size_t row,
                   std::vector<double>& weights) {
  constexpr double kUniform = 0.05;
  const MeasuredCellsHeader& h = block.header;
  const size_t lights = size_t(h.lights), viewer_side = row / size_t(h.viewers);
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  bool used[2];
  for (int through = 0; through < 2; ++through)
    used[through] = !tree.nodes[kPasses[viewer_side][through]].empty();
  const double even = 1 / std::max(1.0, double(lights) * (used[0] + used[1]));
  for (size_t k = 0; k < weights.size(); ++k) {
    double uniform = used[k / lights] ? even : 0;
    weights[k] = total > 0 ? lerp(weights[k] / total, uniform, kUniform) : uniform;
  }
  fill_sums(block.at(h.sums) + row * (2 * lights + 1), weights);
}

void fill_tree4_sums(Block& block, const MeasuredTree& tree) {
  const MeasuredCellsHeader& h = block.header;
  const size_t lights = size_t(h.lights), viewers = size_t(h.viewers);
  for (size_t side = 0; side < 2; ++side) {
    std::unique_ptr<PairMeans> means[2];
    for (int through = 0; through < 2; ++through)
      if (MeasuredPass pass = kPasses[side][through]; !tree.nodes[pass].empty())
        means[through] = std::make_unique<PairMeans>(tree, pass, h.side);
    tbb::parallel_for(size_t(0), viewers, [&](size_t viewer) {
      std::vector<double> weights(2 * lights);
      for (size_t k = 0; k < weights.size(); ++k)
        if (means[k / lights])
          weights[k] = means[k / lights]->at(k % lights, viewer);
      fill_tree_row(block, tree, side * viewers + viewer, weights);
    });
  }
}

/// Points in each ring of viewers and square of light: the tree's own cells turn with the light.
/// Roots of mean weights make the variance least.
void fill_tree3_sums(Block& block, const MeasuredTree& tree) {
  constexpr int kRadii = 3, kAcross = 2;
  const MeasuredCells<double> cells(block.data());
  const MeasuredCellsHeader& h = block.header;
  const size_t lights = size_t(h.lights), viewers = size_t(h.viewers);
  tbb::parallel_for(size_t(0), 2 * viewers, [&](size_t row) {
    const double up = row < viewers ? 1 : -1;
    std::vector<double> weights(2 * lights);
    for (size_t k = 0; k < weights.size(); ++k) {
      size_t cell = k % lights, x = cell % size_t(h.side), y = cell / size_t(h.side);
      const bool through = k >= lights;
      for (int point = 0; point < kRadii * kAcross * kAcross; ++point) {
        double r = (double(row % viewers) + (point / (kAcross * kAcross) + 0.5) / kRadii) / viewers;
        Vec3<double> wo{r, 0, up * std::sqrt(1 - r * r)};
        Vec2<double> light = concentric_disk(
            Vec2<double>{(double(x) + (point % kAcross + 0.5) / kAcross) / h.side,
                         (double(y) + (point / kAcross % kAcross + 0.5) / kAcross) / h.side});
        double cosine = safe_sqrt(1 - sqr(light.x) - sqr(light.y));
        MeasuredRgb<double> c =
            cells.tree_color(wo, {light.x, light.y, through ? -up * cosine : up * cosine}, through);
        weights[k] += sqr(luminance({c.r, c.g, c.b}));
      }
      weights[k] = std::sqrt(weights[k]);
    }
    fill_tree_row(block, tree, row, weights);
  });
}

} // namespace

HugeVector<float> measured_block(const MeasuredPatches& patches) {
  Block block;
  MeasuredCellsHeader& h = block.header;
  h.kind = CellsKind::klems;
  h.incident = add_basis(block, patches.incident);
  h.outgoing = add_basis(block, patches.outgoing);
  h.lights = patches.incident.size();
  h.viewers = patches.outgoing.size();
  const size_t lights = size_t(h.lights), viewers = size_t(h.viewers);
  h.values = block.add(size_t(2) * viewers * 2 * lights * 3);
  float* out = block.at(h.values);
  for (int side = 0; side < 2; ++side)
    for (size_t o = 0; o < viewers; ++o)
      for (int through = 0; through < 2; ++through) {
        const std::vector<float>& rgb = patches.rgb[kPasses[side][through]];
        check(rgb.empty() || rgb.size() == 3 * lights * viewers,
              "a matrix has not one colour for each pair of cells");
        for (size_t i = 0; i < lights; ++i, out += 3)
          for (size_t c = 0; c < 3 && !rgb.empty(); ++c) {
            out[c] = rgb[3 * (i * viewers + o) + c];
            check(out[c] >= 0 && std::isfinite(out[c]), "a value is out of range");
          }
      }
  add_sums(block);
  fill_klems_sums(block);
  return block.finish();
}

HugeVector<float> measured_block(const MeasuredTree& tree) {
  Block block;
  MeasuredCellsHeader& h = block.header;
  check(tree.dimensions == 3 || tree.dimensions == 4, "a tree has neither rank 3 nor 4");
  h.kind = tree.dimensions == 3 ? CellsKind::tree3 : CellsKind::tree4;
  add_tree(block, tree);
  h.side = 1 << std::min(h.depth, tree.dimensions == 3 ? 6 : 5);
  h.fine = tree.dimensions == 4 ? h.depth - std::min(h.depth, 5) : 0;
  h.lights = h.side * h.side;
  h.viewers = tree.dimensions == 3 ? std::max(1, h.side / 2) : h.lights;
  add_sums(block);
  if (tree.dimensions == 3)
    fill_tree3_sums(block, tree);
  else
    fill_tree4_sums(block, tree);
  return block.finish();
}

const std::map<std::string, KlemsBasis>& klems_bases() {
  static const std::map<std::string, KlemsBasis> bases = [] {
    std::map<std::string, KlemsBasis> out = {
        {"lbnl/klems full",
         {{0, 5, 15, 25, 35, 45, 55, 65, 75, 90}, {1, 8, 16, 20, 24, 24, 24, 16, 12}}},
        {"lbnl/klems half",
         {{0, 6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90}, {1, 8, 12, 16, 20, 12, 4}}},
        {"lbnl/klems quarter", {{0, 9, 27, 46, 66, 90}, {1, 8, 12, 12, 8}}},
    };
    for (auto& [name, basis] : out)
      for (double& theta : basis.theta)
        theta *= kPi / 180;
    return out;
  }();
  return bases;
}

} // namespace faceta
