#include "verify/random_stream.h"
#include "verify/sphere_partition.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace {

using namespace faceta;

// Directions around `axis`, as narrow as `width`.
std::vector<Vec3<double>> lobe(const Vec3<double>& axis, double width, int n, uint64_t seed) {
  RandomStream random(seed);
  Frame<double> frame = frame_from_normal(axis);
  std::vector<Vec3<double>> result;
  for (int i = 0; i < n; ++i) {
    double r = width * std::sqrt(-std::log(1 - random.next())), phi = 2 * kPi * random.next();
    result.push_back(
        frame.to_world({std::sin(r) * std::cos(phi), std::sin(r) * std::sin(phi), std::cos(r)}));
  }
  return result;
}

const Vec3<double> kAxes[] = {{0, 0, 1}, {0.48, 0.6, 0.64}, {-1, 0, 0}, {0, -0.6, -0.8}};

TEST(SpherePartition, CoversTheSphereOnce) {
  for (const Vec3<double>& axis : kAxes) {
    SpherePartition p(lobe(axis, 0.001, 8192, 1), {axis}, axis, 16);
    double area = 0;
    for (const Rectangle& c : p.cells()) {
      ASSERT_LT(c.x0, c.x1);
      ASSERT_LT(c.y0, c.y1);
      area += (c.x1 - c.x0) * (c.y1 - c.y0);
    }
    EXPECT_NEAR(area, 4 * kPi, 1e-9);
  }
}

TEST(SpherePartition, LocatesTheCellThatHoldsADirection) {
  RandomStream random(3);
  for (const Vec3<double>& axis : kAxes) {
    SpherePartition p(lobe(axis, 0.01, 8192, 1), {}, axis, 16);
    for (int i = 0; i < 20000; ++i) {
      double t = 2 * random.next(), phi = kPi * (2 * random.next() - 1);
      Vec3<double> w = p.direction(t, phi);
      EXPECT_NEAR(length(w), 1, 1e-14);
      SpherePoint q = p.coordinates(w);
      ASSERT_NEAR(q.t, t, 1e-12);
      if (t > 1e-3 && t < 2 - 1e-3) {
        ASSERT_NEAR(q.phi, phi, 1e-10);
      }
      const Rectangle& c = p.cells()[p.locate(w)];
      ASSERT_TRUE(t > c.x0 - 1e-12 && t < c.x1 + 1e-12);
      ASSERT_TRUE(phi > c.y0 - 1e-9 && phi < c.y1 + 1e-9);
    }
  }
}

TEST(SpherePartition, CellsShareEvenTheNarrowestLobe) {
  for (const Vec3<double>& axis : kAxes)
    for (double width : {1.0, 0.03, 0.001}) {
      SpherePartition p(lobe(axis, width, 16384, 1), {axis}, axis, 32);
      std::vector<int> counts(p.cells().size());
      const int n = 100000;
      for (const Vec3<double>& w : lobe(axis, width, n, 2))
        ++counts[p.locate(w)];
      EXPECT_LT(*std::max_element(counts.begin(), counts.end()), n / 150) << width;
    }
}

TEST(SpherePartition, TheHorizonIsABorder) {
  SpherePartition p(lobe({0, 0, 1}, 1, 4096, 1), {}, {0, 0, 1}, 32);
  for (const Rectangle& c : p.cells())
    EXPECT_TRUE(c.x1 <= 1 || c.x0 >= 1);
}

TEST(SpherePartition, KeepsDigitsNearThePole) {
  SpherePartition p({}, {}, {0, 0, 1}, 32);
  Vec3<double> w = {3e-5, 4e-5, 1}; // z is what a float keeps: 1 - 1.25e-9 is lost
  EXPECT_NEAR(p.coordinates(w).t, 1.25e-9, 1e-17);
}

} // namespace
