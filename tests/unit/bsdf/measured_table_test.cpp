// Tables against the definitions in measured_data.h, written here a second time, and the sampler's
// normals against the distribution that a surface was made of.

#include "base/error.h"
#include "bsdf/measured_build.h"
#include "bsdf/measured_table.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace faceta {
namespace {

using C = MeasuredCoordinates;

MeasuredAxis axis(std::vector<double> nodes, double period = 0, bool root = false) {
  return {std::move(nodes), period, root};
}
std::vector<double> nodes(int n, double last) {
  std::vector<double> list;
  for (int k = 0; k < n; ++k)
    list.push_back(last * k / (n - 1));
  return list;
}

/// A grid whose red is linear in the angles (in the root where the axis says so), which linear
/// interpolation gives back exactly.
MeasuredGrid linear_grid(C coordinates, std::vector<MeasuredAxis> axes) {
  MeasuredGrid grid{coordinates, std::move(axes), {}};
  size_t count[4] = {1, 1, 1, 1};
  for (size_t k = 0; k < grid.axes.size(); ++k)
    count[k] = grid.axes[k].nodes.size();
  for (size_t a = 0; a < count[0]; ++a)
    for (size_t b = 0; b < count[1]; ++b)
      for (size_t c = 0; c < count[2]; ++c)
        for (size_t d = 0; d < count[3]; ++d) {
          size_t index[4] = {a, b, c, d};
          double value = 1;
          for (size_t k = 0; k < grid.axes.size(); ++k) {
            double x = grid.axes[k].nodes[index[k]];
            value += double(k + 1) * 0.1 * (grid.axes[k].square_root ? std::sqrt(x) : x);
          }
          grid.rgb.insert(grid.rgb.end(), {float(value), float(2 * value), 0.5f});
        }
  return grid;
}

Vec3<double> spherical(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
double wrapped(double phi, double period) {
  return phi - period * std::floor(phi / period);
}

double red(const HugeVector<float>& block, const Vec3<double>& wo, const Vec3<double>& wi) {
  Color<double> c = MeasuredTable<double>(block.data()).grid_value(wo, wi);
  EXPECT_NEAR(c[1], 2 * c[0], 1e-6);
  EXPECT_NEAR(c[2], 0.5 * wi.z, 1e-6);
  return c[0] / wi.z;
}

struct Angles {
  double theta_i, phi_i, theta_o, phi_o;
};
template <class F> void for_angles(F check) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int k = 0; k < 300; ++k)
    check(Angles{1.5 * uniform(generator), 2 * kPi * uniform(generator), 1.5 * uniform(generator),
                 2 * kPi * uniform(generator)});
}

TEST(MeasuredTable, RelativeAnglesAreInterpolatedAndFolded) {
  HugeVector<float> block = measured_block(linear_grid(
      C::relative, {axis({0, 0.3, 0.7, 1.6}), axis(nodes(6, 1.6)), axis(nodes(5, kPi))}));
  for_angles([&](const Angles& a) {
    double difference = std::abs(std::remainder(a.phi_o - a.phi_i, 2 * kPi));
    double expected = 1 + 0.1 * a.theta_i + 0.2 * a.theta_o + 0.3 * difference;
    EXPECT_NEAR(red(block, spherical(a.theta_o, a.phi_o), spherical(a.theta_i, a.phi_i)), expected,
                2e-6);
  });
}

TEST(MeasuredTable, AbsoluteAnglesGoAroundTheCircle) {
  // Between the last node and the first again the value falls back linearly.
  std::vector<double> around = {0, 0.5 * kPi, kPi, 1.5 * kPi};
  HugeVector<float> block =
      measured_block(linear_grid(C::absolute, {axis(nodes(4, 1.6)), axis(around, 2 * kPi),
                                               axis(nodes(4, 1.6)), axis(around, 2 * kPi)}));
  auto at = [](double phi) { return phi <= 1.5 * kPi ? phi : 3 * (2 * kPi - phi); };
  for_angles([&](const Angles& a) {
    double expected = 1 + 0.1 * a.theta_i + 0.2 * at(a.phi_i) + 0.3 * a.theta_o + 0.4 * at(a.phi_o);
    EXPECT_NEAR(red(block, spherical(a.theta_o, a.phi_o), spherical(a.theta_i, a.phi_i)), expected,
                3e-6);
  });
}

TEST(MeasuredTable, HalfAndDifferenceAngles) {
  HugeVector<float> block = measured_block(
      linear_grid(C::half_difference, {axis({0, 0.2, 0.8, 1.6}, 0, true), axis(nodes(5, 1.6)),
                                       axis({0, 0.25 * kPi, 0.5 * kPi, 0.75 * kPi}, kPi)}));
  for_angles([&](const Angles& a) {
    Vec3<double> wi = spherical(a.theta_i, a.phi_i), wo = spherical(a.theta_o, a.phi_o);
    Vec3<double> h = normalize(wi + wo);
    double theta_h = std::acos(h.z), phi_h = std::atan2(h.y, h.x);
    // Turned by -phi_h about z, then by -theta_h about y.
    double c = std::cos(-phi_h), s = std::sin(-phi_h);
    Vec3<double> r{c * wi.x - s * wi.y, s * wi.x + c * wi.y, wi.z};
    c = std::cos(-theta_h), s = std::sin(-theta_h);
    Vec3<double> d{c * r.x + s * r.z, r.y, c * r.z - s * r.x};
    double phi_d = wrapped(std::atan2(d.y, d.x), kPi);
    double azimuth = phi_d <= 0.75 * kPi ? phi_d : 3 * (kPi - phi_d);
    double expected = 1 + 0.1 * std::sqrt(theta_h) + 0.2 * std::acos(d.z) + 0.3 * azimuth;
    EXPECT_NEAR(red(block, wo, wi), expected, 1e-5);
    EXPECT_NEAR(red(block, wi, wo), expected, 1e-5); // a period of pi: reciprocal
  });
}

TEST(MeasuredTable, AnglesAboutTheMirrorDirection) {
  HugeVector<float> block = measured_block(
      linear_grid(C::specular, {axis(nodes(4, 1.6)), axis(nodes(6, kPi)), axis(nodes(5, kPi))}));
  for_angles([&](const Angles& a) {
    Vec3<double> wi = spherical(a.theta_i, a.phi_i), wo = spherical(a.theta_o, a.phi_o);
    Vec3<double> mirror{-wi.x, -wi.y, wi.z};
    Vec3<double> across = normalize(Vec3<double>{-mirror.y, mirror.x, 0}); // z cross mirror
    Vec3<double> outward{across.y * mirror.z - across.z * mirror.y,
                         across.z * mirror.x - across.x * mirror.z,
                         across.x * mirror.y - across.y * mirror.x};
    double azimuth = std::abs(std::atan2(dot(wo, across), dot(wo, outward)));
    double expected = 1 + 0.1 * a.theta_i + 0.2 * std::acos(dot(wo, mirror)) + 0.3 * azimuth;
    EXPECT_NEAR(red(block, wo, wi), expected, 1e-5);
  });
}

TEST(MeasuredTable, HolesAreLeftOutAndWeightsMadeOne) {
  MeasuredGrid grid{C::relative, {axis({0, 1}), axis({0, 1}), axis({0, 1})}, {}};
  for (float value : {1.0f, 1.0f, 2.0f, 2.0f, 3.0f, 3.0f, 0.0f, 0.0f})
    grid.rgb.insert(grid.rgb.end(), 3, value == 0 ? std::nanf("") : value);
  HugeVector<float> block = measured_block(grid);
  // theta_i = 0.25, theta_o = 0.5: weights 3/8 of 1, 3/8 of 2, 1/8 of 3, 1/8 of the hole.
  Color<double> c =
      MeasuredTable<double>(block.data()).grid_value(spherical(0.5, 0.3), spherical(0.25, 0));
  EXPECT_NEAR(c[0] / std::cos(0.25), (3 + 6 + 3) / 7.0, 1e-5);
  // In the corner of the hole: the mean of its neighbours, not nothing.
  c = MeasuredTable<double>(block.data()).grid_value(spherical(1, 0.3), spherical(1, 0));
  EXPECT_NEAR(c[0] / std::cos(1), 2.5, 1e-3);
}

TEST(MeasuredTable, BadTablesAreRefused) {
  MeasuredGrid grid = linear_grid(C::relative, {axis({0, 1}), axis({0, 1}), axis({0, 1})});
  MeasuredGrid few = grid, falling = grid, negative = grid, flat = grid;
  few.rgb.pop_back();
  falling.axes[1].nodes = {1, 0};
  negative.rgb[3] = -1;
  flat.axes.pop_back();
  for (const MeasuredGrid& bad : {few, falling, negative, flat})
    EXPECT_THROW(measured_block(bad), Error);
  RglTables empty;
  EXPECT_THROW(measured_block(empty), Error);
}

// f(o, o) = D(o) G1(o) / (4 cos^2 o) of a surface in its own hot spot gives back its D
// (Dupuy et al. 2015, section 3).
TEST(MeasuredTable, NormalsFromRetroreflection) {
  for (double alpha : {0.05, 0.2, 0.6}) {
    const int n = 256;
    std::vector<double> retro, truth;
    for (int k = 0; k < n; ++k) {
      double theta = std::pow((k + 0.5) / n, 2) * 0.5 * kPi, c = std::cos(theta);
      double t2 = std::pow(std::tan(theta), 2);
      double d = alpha * alpha / (kPi * std::pow(c * c * (alpha * alpha + t2), 2));
      double g1 = 2 / (1 + std::sqrt(1 + alpha * alpha * t2));
      retro.push_back(d * g1 / (4 * c * c) * c);
      truth.push_back(d);
    }
    std::vector<double> found = normals_of_retroreflection(retro);
    for (int k = 0; k < n; ++k)
      if (truth[size_t(k)] > 1e-3 * truth[0]) {
        EXPECT_NEAR(found[size_t(k)] / found[0], truth[size_t(k)] / truth[0],
                    0.02 * truth[size_t(k)] / truth[0])
            << alpha << ' ' << k;
      }
    // One unit of projected area.
    double area = 0;
    for (int k = 0; k < n; ++k) {
      double u = (k + 0.5) / n, theta = u * u * 0.5 * kPi;
      area += found[size_t(k)] * std::cos(theta) * 2 * kPi * kPi * u * std::sin(theta) / n;
    }
    EXPECT_NEAR(area, 1, 1e-3);
  }
}

} // namespace
} // namespace faceta
