#include "base/error.h"
#include "bsdf/measured_build.h"
#include "bsdf/measured_cells.h"

#include <gtest/gtest.h>
#include <random>

namespace faceta {
namespace {

const KlemsBasis kQuarter = {{0, 9, 27, 46, 66, 90}, {1, 8, 12, 12, 8}};
const KlemsBasis kHalf = {{0, 6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90}, {1, 8, 12, 16, 20, 12, 4}};

KlemsBasis in_radians(KlemsBasis basis) {
  for (double& theta : basis.theta)
    theta *= kPi / 180;
  return basis;
}

struct Numbers {
  std::mt19937_64 generator{5};
  double next() { return std::uniform_real_distribution<double>(0, 1)(generator); }
  Vec3<double> direction() {
    double z = 2 * next() - 1, phi = 2 * kPi * next(), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
};

/// The cell of a direction by angles, as the definition of the basis has it.
int cell_of(const KlemsBasis& basis, const Vec3<double>& w) {
  double theta = std::acos(std::abs(w.z)), phi = std::atan2(w.y, w.x);
  int first = 0;
  for (size_t ring = 0;; first += basis.cells[ring++]) {
    if (theta >= basis.theta[ring + 1])
      continue;
    for (int j = 0; j < basis.cells[ring]; ++j) {
      double width = 2 * kPi / basis.cells[ring];
      if (std::abs(std::remainder(phi - j * width, 2 * kPi)) <= 0.5 * width)
        return first + j;
    }
  }
}

double projected_solid_angle(const KlemsBasis& basis, int cell) {
  size_t ring = 0;
  while (cell >= basis.cells[ring])
    cell -= basis.cells[ring++];
  return kPi * (sqr(std::sin(basis.theta[ring + 1])) - sqr(std::sin(basis.theta[ring]))) /
         basis.cells[ring];
}

MeasuredPass pass_of(const Vec3<double>& wo, const Vec3<double>& wi) {
  if (wi.z > 0)
    return wo.z > 0 ? kFrontReflection : kFrontTransmission;
  return wo.z < 0 ? kBackReflection : kBackTransmission;
}

MeasuredPatches random_patches(bool grey, double share_of_zeros) {
  MeasuredPatches p{in_radians(kHalf), in_radians(kQuarter), {}};
  Numbers numbers;
  for (std::vector<float>& rgb : p.rgb) {
    rgb.resize(size_t(3 * p.incident.size() * p.outgoing.size()));
    for (size_t k = 0; k < rgb.size(); ++k)
      rgb[k] = grey && k % 3 ? rgb[k - 1] : float(std::pow(numbers.next(), 3));
    for (size_t k = 0; k < rgb.size(); k += 3)
      if (numbers.next() < share_of_zeros)
        rgb[k] = rgb[k + 1] = rgb[k + 2] = 0;
  }
  return p;
}

double value_of(const MeasuredPatches& p, const Vec3<double>& wo, const Vec3<double>& wi, int c) {
  const std::vector<float>& rgb = p.rgb[size_t(pass_of(wo, wi))];
  size_t pair = size_t(cell_of(p.incident, wi) * p.outgoing.size() + cell_of(p.outgoing, wo));
  return rgb.empty() ? 0.0 : double(rgb[3 * pair + size_t(c)]);
}

/// What comes to a viewer from everywhere: values times projected solid angles.
double seen(const MeasuredPatches& p, const Vec3<double>& wo) {
  double sum = 0;
  for (MeasuredPass pass : {wo.z > 0 ? kFrontReflection : kBackReflection,
                            wo.z > 0 ? kBackTransmission : kFrontTransmission})
    for (int i = 0; i < p.incident.size() && !p.rgb[pass].empty(); ++i)
      sum += projected_solid_angle(p.incident, i) *
             p.rgb[pass][size_t(3 * (i * p.outgoing.size() + cell_of(p.outgoing, wo)))];
  return sum;
}

TEST(MeasuredCells, KlemsValuesAreThoseOfTheCells) {
  MeasuredPatches patches = random_patches(false, 0.1);
  HugeVector<float> block = measured_block(patches);
  MeasuredCells<double> cells(block.data());
  MeasuredCells<float> single(block.data());
  Numbers numbers;
  for (int k = 0; k < 20000; ++k) {
    Vec3<double> wo = numbers.direction(), wi = numbers.direction();
    Eval<double> e = cells.eval(wo, wi);
    Eval<float> f = single.eval({float(wo.x), float(wo.y), float(wo.z)},
                                {float(wi.x), float(wi.y), float(wi.z)});
    for (int c = 0; c < 3; ++c) {
      double expected = value_of(patches, wo, wi, c) * std::abs(wi.z);
      ASSERT_NEAR(e.value[c], expected, 1e-12) << k;
      ASSERT_NEAR(f.value[c], expected, 1e-6) << k;
    }
  }
}

// The last cell of a ring reaches across azimuth 0, and one cell fills the first ring.
TEST(MeasuredCells, KlemsCellsAreCentredOnTheirAzimuths) {
  MeasuredPatches patches{in_radians(kHalf), in_radians(kQuarter), {}};
  for (int i = 0; i < 73; ++i)
    for (int o = 0; o < 41; ++o)
      for (int c = 0; c < 3; ++c)
        patches.rgb[kFrontReflection].push_back(float(1000 * o + i));
  HugeVector<float> block = measured_block(patches);
  MeasuredCells<double> cells(block.data());
  auto at = [](double theta, double phi) {
    theta *= kPi / 180;
    phi *= kPi / 180;
    return Vec3<double>{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                        std::cos(theta)};
  };
  auto value = [&](const Vec3<double>& wi, const Vec3<double>& wo) {
    return cells.eval(wo, wi).value[0] / wi.z;
  };
  EXPECT_NEAR(value(at(0, 0), at(0, 0)), 0, 1e-9);
  EXPECT_NEAR(value(at(6.4, 190), at(8.9, 80)), 0, 1e-9);
  EXPECT_NEAR(value(at(6.6, 0), at(9.1, 0)), 1001, 1e-9);
  EXPECT_NEAR(value(at(19.4, 22.4), at(26.9, -22.4)), 1001, 1e-9);
  EXPECT_NEAR(value(at(19.4, 22.6), at(26.9, -22.6)), 8002, 1e-9);
  EXPECT_NEAR(value(at(10, 180), at(20, 179)), 5005, 1e-9);
  EXPECT_NEAR(value(at(10, -180), at(20, -179)), 5005, 1e-9);
  EXPECT_NEAR(value(at(89.9, 269), at(89.9, 336)), 40072, 1e-9); // the last rings begin at 69, 33
}

TEST(MeasuredCells, KlemsSamplesWeighWhatIsSeen) {
  for (double zeros : {0.0, 0.7}) {
    MeasuredPatches patches = random_patches(true, zeros);
    HugeVector<float> block = measured_block(patches);
    MeasuredCells<double> cells(block.data());
    Numbers numbers;
    for (int k = 0; k < 20000; ++k) {
      Vec3<double> wo = numbers.direction();
      Eval<double> e;
      Vec3<double> wi = cells.sample(wo, {{numbers.next(), numbers.next()}, numbers.next()}, e);
      double expected = seen(patches, wo);
      ASSERT_GT(e.pdf, 0);
      // Each probability is a whole number of 2^-24.
      double steps = e.pdf / std::abs(wi.z) * 0x1p24 *
                     projected_solid_angle(patches.incident, cell_of(patches.incident, wi));
      ASSERT_NEAR(e.value[0] / e.pdf, expected, expected * (1 / steps + 1e-4)) << k;
      ASSERT_NEAR(dot(wi, wi), 1, 1e-9);
    }
  }
}

TEST(MeasuredCells, KlemsDensityIntegratesToOne) {
  MeasuredPatches patches = random_patches(false, 0.5);
  patches.rgb[kBackTransmission].clear();
  HugeVector<float> block = measured_block(patches);
  MeasuredCells<double> cells(block.data());
  Numbers numbers;
  for (int k = 0; k < 200; ++k) {
    Vec3<double> wo = numbers.direction();
    double sum = 0;
    int number = 0;
    for (size_t ring = 0; ring < patches.incident.cells.size(); ++ring)
      for (int j = 0; j < patches.incident.cells[ring]; ++j, ++number)
        for (double side : {1.0, -1.0}) {
          double theta = 0.5 * (patches.incident.theta[ring] + patches.incident.theta[ring + 1]);
          double phi = 2 * kPi * j / patches.incident.cells[ring];
          Vec3<double> wi{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                          side * std::cos(theta)};
          Eval<double> e = cells.eval(wo, wi);
          sum += e.pdf / std::abs(wi.z) * projected_solid_angle(patches.incident, number);
          EXPECT_EQ(e.pdf > 0, e.value[0] + e.value[1] + e.value[2] > 0);
        }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

TEST(MeasuredCells, NothingIsSampledWhereNothingIsSeen) {
  MeasuredPatches patches = random_patches(true, 0);
  patches.rgb[kBackReflection].clear();
  patches.rgb[kFrontTransmission].clear();
  HugeVector<float> block = measured_block(patches);
  MeasuredCells<double> cells(block.data());
  Numbers numbers;
  for (int k = 0; k < 1000; ++k) {
    Vec3<double> wo = numbers.direction();
    wo.z = -std::abs(wo.z);
    Eval<double> e;
    cells.sample(wo, {{numbers.next(), numbers.next()}, numbers.next()}, e);
    EXPECT_EQ(e.pdf, 0);
    EXPECT_EQ(e.value[0], 0);
    e = cells.eval(wo, numbers.direction());
    EXPECT_EQ(e.pdf, 0);
    EXPECT_EQ(e.value[0], 0);
  }
}

// --- Trees ---

/// From the disk to the square by the four sectors of Shirley and Chiu 1997.
std::array<double, 2> sectors(double x, double y) {
  double r = std::hypot(x, y), phi = std::atan2(y, x), a = 0, b = 0;
  phi += phi < -kPi / 4 ? 2 * kPi : 0;
  int sector = int((phi + kPi / 4) / (kPi / 2));
  double along = (phi - sector * kPi / 2) * r / (kPi / 4);
  switch (sector) {
  case 0:
    a = r, b = along;
    break;
  case 1:
    a = -along, b = r;
    break;
  case 2:
    a = -r, b = -along;
    break;
  default:
    a = along, b = -r;
    break;
  }
  return {0.5 * (a + 1), 0.5 * (b + 1)};
}

TEST(MeasuredCells, TheSquareIsTheInverseOfTheConcentricDisk) {
  Numbers numbers;
  for (int k = 0; k < 1000; ++k) {
    Vec2<double> u{numbers.next(), numbers.next()};
    Vec2<double> disk = concentric_disk(u), back = concentric_square(disk.x, disk.y);
    EXPECT_NEAR(back.x, u.x, 1e-12);
    EXPECT_NEAR(back.y, u.y, 1e-12);
    std::array<double, 2> s = sectors(disk.x, disk.y);
    EXPECT_NEAR(back.x, s[0], 1e-12);
    EXPECT_NEAR(back.y, s[1], 1e-12);
  }
  EXPECT_EQ(concentric_square(0.0, 0.0).x, 0.5);
  EXPECT_EQ(concentric_square(0.0, 0.0).y, 0.5);
}

/// Branches at random down to a depth; grey leaves.
void grow(std::vector<int32_t>& nodes, std::vector<float>& rgb, size_t node, int dimensions,
          int depth, Numbers& numbers) {
  if (depth == 0 || numbers.next() < 0.3) {
    nodes[node] = -1 - int32_t(rgb.size() / 3);
    float v = numbers.next() < 0.2 ? 0.0f : float(std::pow(numbers.next(), 4));
    rgb.insert(rgb.end(), {v, v, v});
    return;
  }
  size_t first = nodes.size();
  nodes.resize(first + (size_t(1) << dimensions));
  nodes[node] = int32_t(first);
  for (size_t k = 0; k < size_t(1) << dimensions; ++k)
    grow(nodes, rgb, first + k, dimensions, depth - 1, numbers);
}

MeasuredTree random_tree(int dimensions, int depth) {
  MeasuredTree tree;
  tree.dimensions = dimensions;
  tree.depth = depth;
  Numbers numbers;
  for (size_t pass = 0; pass < 4; ++pass) {
    tree.nodes[pass].assign(1, 0);
    grow(tree.nodes[pass], tree.rgb[pass], 0, dimensions, depth, numbers);
  }
  return tree;
}

double value_of(const MeasuredTree& tree, const Vec3<double>& wo, const Vec3<double>& wi) {
  std::vector<double> x;
  if (tree.dimensions == 3) {
    double turn = -std::atan2(-wi.y, -wi.x), r = std::hypot(wo.x, wo.y),
           phi = std::atan2(wo.y, wo.x) + turn;
    std::array<double, 2> o = sectors(r * std::cos(phi), r * std::sin(phi));
    x = {0.5 - 0.5 * std::hypot(wi.x, wi.y), o[0], o[1]};
  } else {
    std::array<double, 2> i = sectors(wi.x, wi.y), o = sectors(wo.x, wo.y);
    x = {i[0], i[1], o[0], o[1]};
  }
  const std::vector<int32_t>& nodes = tree.nodes[size_t(pass_of(wo, wi))];
  int32_t node = nodes.empty() ? -1 : nodes[0];
  while (node >= 0) {
    size_t child = 0;
    for (size_t d = 0; d < x.size(); ++d) {
      bool upper = x[d] >= 0.5;
      child += size_t(upper) << d;
      x[d] = 2 * x[d] - upper;
    }
    node = nodes[size_t(node) + child];
  }
  return nodes.empty() ? 0 : tree.rgb[size_t(pass_of(wo, wi))][size_t(3 * (-1 - node))];
}

TEST(MeasuredCells, TreesAreLookedUpLikeAnythingThatWalksThem) {
  for (int dimensions : {3, 4})
    for (int depth : {0, 1, 4}) {
      MeasuredTree tree = random_tree(dimensions, depth);
      if (depth == 4)
        tree.nodes[kFrontTransmission].clear();
      HugeVector<float> block = measured_block(tree);
      MeasuredCells<double> cells(block.data());
      MeasuredCells<float> single(block.data());
      Numbers numbers;
      int differ = 0;
      for (int k = 0; k < 20000; ++k) {
        Vec3<double> wo = numbers.direction(), wi = numbers.direction();
        double expected = value_of(tree, wo, wi) * std::abs(wi.z);
        ASSERT_NEAR(cells.eval(wo, wi).value[0], expected, 1e-12) << dimensions << " " << k;
        float f = single
                      .eval({float(wo.x), float(wo.y), float(wo.z)},
                            {float(wi.x), float(wi.y), float(wi.z)})
                      .value[0];
        differ += std::abs(f - expected) > 1e-6;
      }
      EXPECT_LE(differ, 2); // at the edges of cells
    }
}

/// The integral of the density and of the value over the squares of both sides, and the largest
/// and the mean square of the weights.
struct Totals {
  double density = 0, value = 0, square = 0, largest = 0;
};
Totals totals(const MeasuredCells<double>& cells, const Vec3<double>& wo, int side) {
  Totals t;
  for (int k = 0; k < side * side; ++k)
    for (double up : {1.0, -1.0}) {
      Vec2<double> d =
          concentric_disk(Vec2<double>{(k % side + 0.5) / side, (double(k / side) + 0.5) / side});
      Vec3<double> wi{d.x, d.y, up * std::sqrt(1 - d.x * d.x - d.y * d.y)};
      Eval<double> e = cells.eval(wo, wi);
      double area = kPi / (double(side) * side * std::abs(wi.z));
      t.density += e.pdf * area;
      t.value += e.value[0] * area;
      if (e.pdf > 0)
        t.square += sqr(e.value[0]) / e.pdf * area;
      EXPECT_TRUE(e.pdf > 0 || e.value[0] == 0);
    }
  return t;
}

TEST(MeasuredCells, TreesAreSampledByTheirBrightness) {
  for (int dimensions : {3, 4}) {
    MeasuredTree tree = random_tree(dimensions, 4);
    HugeVector<float> block = measured_block(tree);
    MeasuredCells<double> cells(block.data());
    Numbers numbers;
    for (int k = 0; k < 30; ++k) {
      Vec3<double> wo = numbers.direction();
      if (dimensions == 3)
        wo = {std::hypot(wo.x, wo.y), 0, wo.z}; // the table turns with the viewer
      Totals t = totals(cells, wo, dimensions == 4 ? 16 : 64);
      EXPECT_NEAR(t.density, 1, 1e-6);
      double cv = std::sqrt(t.square / sqr(t.value) - 1);
      // Cells of rank 4 are the tree's own; only the uniform share is amiss.
      EXPECT_LE(cv, dimensions == 4 ? 0.3 : 0.9);
      double mean = 0;
      const int n = 4000;
      for (int j = 0; j < n; ++j) {
        Eval<double> e;
        Vec3<double> wi =
            cells.sample(wo, {{numbers.next(), numbers.next()}, (j + numbers.next()) / n}, e);
        ASSERT_NEAR(dot(wi, wi), 1, 1e-9);
        mean += e.value[0] / e.pdf / n;
      }
      EXPECT_NEAR(mean, t.value, 5 * t.value * cv / std::sqrt(n) + 1e-6);
    }
  }
}

// Below the table samples go down the tree, here past the five levels of the table.
TEST(MeasuredCells, ATreeDeeperThanTheTable) {
  MeasuredTree tree = random_tree(4, 3);
  for (int pass : {kFrontReflection, kBackReflection, kFrontTransmission}) {
    tree.nodes[size_t(pass)].clear();
    tree.rgb[size_t(pass)].clear();
  }
  // Light straight on: along the diagonal of the squares down to 2^7 cells.
  std::vector<int32_t>& nodes = tree.nodes[kBackTransmission];
  std::vector<float>& rgb = tree.rgb[kBackTransmission];
  nodes = {1};
  rgb = {0.1f, 0.1f, 0.1f};
  std::vector<size_t> last = {0};
  for (int level = 0; level < 7; ++level) {
    std::vector<size_t> next;
    for (size_t node : last) {
      nodes[node] = int32_t(nodes.size());
      for (int32_t child = 0; child < 16; ++child) {
        if ((child & 3) == child >> 2 && (level < 2 || node % 3))
          next.push_back(nodes.size());
        nodes.push_back(-1);
      }
    }
    last = next;
  }
  for (size_t node : last) {
    nodes[node] = -1 - int32_t(rgb.size() / 3);
    rgb.insert(rgb.end(), 3, float(1000 + node % 7));
  }
  HugeVector<float> block = measured_block(tree);
  MeasuredCells<double> cells(block.data());
  Numbers numbers;
  for (int k = 0; k < 6; ++k) {
    Vec3<double> wo = numbers.direction();
    wo.z = std::abs(wo.z);
    Totals t = totals(cells, wo, 128);
    EXPECT_NEAR(t.density, 1, 1e-5);
    double cv = std::sqrt(t.square / sqr(t.value) - 1);
    EXPECT_LE(cv, 0.5);
    double mean = 0;
    const int n = 4000;
    for (int j = 0; j < n; ++j) {
      Eval<double> e;
      cells.sample(wo, {{numbers.next(), numbers.next()}, (j + numbers.next()) / n}, e);
      mean += e.value[0] / e.pdf / n;
    }
    EXPECT_NEAR(mean, t.value, 5 * t.value * cv / std::sqrt(n) + 1e-6);
  }
}

void expect_error(const MeasuredTree& tree, const std::string& text) {
  try {
    measured_block(tree);
    ADD_FAILURE() << "accepted: " << text;
  } catch (const Error& error) {
    EXPECT_NE(error.message().find(text), std::string::npos) << error.message();
  }
}

TEST(MeasuredCells, TreesThatCannotBeAreRefused) {
  MeasuredTree tree = random_tree(3, 2);
  std::vector<int32_t>& nodes = tree.nodes[kFrontReflection];
  nodes.assign(9, -1);
  nodes[0] = 1;
  nodes[3] = 1; // a branch of itself
  expect_error(tree, "more than 16 levels");
  nodes[3] = 7;
  expect_error(tree, "a node that it has not");
  nodes[3] = -1000000;
  expect_error(tree, "a value that it has not");
  nodes[3] = -1;
  EXPECT_NO_THROW(measured_block(tree));
  tree.rgb[kFrontReflection][0] = -1;
  expect_error(tree, "out of range");
  tree.dimensions = 5;
  expect_error(tree, "rank");
}

TEST(MeasuredCells, MatricesThatCannotBeAreRefused) {
  MeasuredPatches good = random_patches(true, 0), patches = good;
  patches.rgb[kBackReflection].pop_back();
  EXPECT_THROW(measured_block(patches), Error);
  patches = good;
  std::swap(patches.incident.theta[2], patches.incident.theta[3]);
  EXPECT_THROW(measured_block(patches), Error);
  patches = good;
  patches.outgoing.theta.pop_back();
  EXPECT_THROW(measured_block(patches), Error);
  patches = good;
  patches.rgb[0][5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(measured_block(patches), Error);
}

} // namespace
} // namespace faceta
