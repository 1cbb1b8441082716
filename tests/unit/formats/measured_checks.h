#pragma once

/// What the tests of readers of measured reflectance share: an evaluation of grids and trees
/// written from the words of measured_data.h, an analytic surface, and errors with their places.

#include "formats/measured_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <numbers>
#include <sstream>
#include <string>

namespace faceta::test {

inline constexpr double kPi = std::numbers::pi, kDegree = kPi / 180;

struct Dir {
  double x = 0, y = 0, z = 0;
};

inline Dir spherical(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
inline double dot(const Dir& a, const Dir& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Dir cross(const Dir& a, const Dir& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Dir unit(const Dir& a) {
  double l = std::sqrt(dot(a, a));
  return {a.x / l, a.y / l, a.z / l};
}
inline double polar(const Dir& a) {
  return std::atan2(std::hypot(a.x, a.y), a.z);
}
inline double azimuth(const Dir& a) {
  return std::atan2(a.y, a.x);
}

/// The angles of a pair of directions in the order of the axes.
inline std::vector<double> grid_angles(MeasuredCoordinates coordinates, const Dir& wi,
                                       const Dir& wo) {
  using enum MeasuredCoordinates;
  double dphi = azimuth(wo) - azimuth(wi);
  if (coordinates == relative)
    return {polar(wi), polar(wo), dphi};
  if (coordinates == relative_rotated)
    return {polar(wi), azimuth(wi), polar(wo), dphi};
  if (coordinates == absolute)
    return {polar(wi), azimuth(wi), polar(wo), azimuth(wo)};
  if (coordinates == half_difference) {
    Dir h = unit({wi.x + wo.x, wi.y + wo.y, wi.z + wo.z});
    double t = polar(h), p = azimuth(h);
    Dir a = {wi.x * std::cos(p) + wi.y * std::sin(p), -wi.x * std::sin(p) + wi.y * std::cos(p),
             wi.z};
    Dir d = {a.x * std::cos(t) - a.z * std::sin(t), a.y, a.x * std::sin(t) + a.z * std::cos(t)};
    return {t, polar(d), azimuth(d)};
  }
  Dir r = {-wi.x, -wi.y, wi.z};
  // the tangent of the circle of growing polar angle through r, in the plane of incidence
  double pr = azimuth(r);
  Dir grows = spherical(polar(r) + kPi / 2, pr);
  Dir side = cross(r, grows);
  double radial = std::atan2(std::hypot(dot(wo, grows), dot(wo, side)), dot(wo, r));
  double turn = std::atan2(dot(wo, side), dot(wo, grows));
  if (coordinates == specular)
    return {polar(wi), radial, turn};
  return {polar(wi), azimuth(wi), radial, turn};
}

/// Linear in every axis, holes left out.
inline std::array<double, 3> grid_value(const MeasuredGrid& grid, std::vector<double> angles) {
  size_t axes = grid.axes.size();
  std::vector<std::array<size_t, 2>> node(axes);
  std::vector<double> share(axes);
  for (size_t k = 0; k < axes; ++k) {
    const MeasuredAxis& axis = grid.axes[k];
    double a = angles[k];
    if (axis.period > 0) {
      a = std::fmod(a - axis.nodes[0], axis.period);
      a += axis.nodes[0] + (a < 0 ? axis.period : 0);
    } else if (k + 1 == axes) {
      a = std::abs(std::remainder(a, 2 * kPi));
    }
    size_t next = static_cast<size_t>(std::upper_bound(axis.nodes.begin(), axis.nodes.end(), a) -
                                      axis.nodes.begin());
    auto bend = [&](double x) { return axis.square_root ? std::sqrt(std::max(0.0, x)) : x; };
    if (next == axis.nodes.size() && axis.period > 0) {
      node[k] = {next - 1, 0};
      share[k] = (a - axis.nodes.back()) / (axis.nodes[0] + axis.period - axis.nodes.back());
    } else if (next == 0 || next == axis.nodes.size()) {
      node[k] = {next == 0 ? 0 : next - 1, next == 0 ? 0 : next - 1};
      share[k] = 0;
    } else {
      node[k] = {next - 1, next};
      share[k] = (bend(a) - bend(axis.nodes[next - 1])) /
                 (bend(axis.nodes[next]) - bend(axis.nodes[next - 1]));
    }
  }
  std::array<double, 3> sum = {0, 0, 0};
  double weights = 0;
  for (size_t corner = 0; corner < size_t(1) << axes; ++corner) {
    size_t index = 0;
    double weight = 1;
    for (size_t k = 0; k < axes; ++k) {
      size_t upper = corner >> k & 1;
      index = index * grid.axes[k].nodes.size() + node[k][upper];
      weight *= upper == 1 ? share[k] : 1 - share[k];
    }
    if (weight == 0 || std::isnan(grid.rgb[3 * index]))
      continue;
    weights += weight;
    for (int c = 0; c < 3; ++c)
      sum[c] += weight * grid.rgb[3 * index + static_cast<size_t>(c)];
  }
  for (double& v : sum)
    v /= weights;
  return sum;
}

inline std::array<double, 3> grid_value(const MeasuredFile& file, const Dir& wi, const Dir& wo) {
  const auto& grid = std::get<MeasuredGrid>(file.data);
  return grid_value(grid, grid_angles(grid.coordinates, wi, wo));
}

/// A surface that is smooth, reciprocal and not simple: a broad lobe about the mirror direction, of
/// another width along x than along y if `anisotropy` is not 0, on a diffuse ground.
inline double model(const Dir& wi, const Dir& wo, double anisotropy = 0) {
  Dir h = unit({wi.x + wo.x, wi.y + wo.y, wi.z + wo.z});
  double s = (h.x * h.x * (1 + anisotropy) + h.y * h.y) / (0.3 * 0.3);
  return 0.1 + 0.5 * std::exp(-s) * (1 + 0.5 * std::pow(1 - std::max(0.0, dot(wi, h)), 3));
}

/// Checks the structure that measured_data.h promises of a grid.
inline void expect_valid(const MeasuredGrid& grid) {
  size_t cells = 1;
  for (const MeasuredAxis& axis : grid.axes) {
    ASSERT_FALSE(axis.nodes.empty());
    for (size_t i = 1; i < axis.nodes.size(); ++i)
      EXPECT_LT(axis.nodes[i - 1], axis.nodes[i]);
    if (axis.period > 0) {
      EXPECT_LT(axis.nodes.back(), axis.nodes.front() + axis.period);
    }
    cells *= axis.nodes.size();
  }
  ASSERT_EQ(grid.rgb.size(), 3 * cells);
  size_t wrong = 0;
  for (size_t i = 0; i < cells; ++i)
    if (!std::isnan(grid.rgb[3 * i]))
      for (size_t c = 0; c < 3; ++c)
        wrong += !(grid.rgb[3 * i + c] >= 0 && std::isfinite(grid.rgb[3 * i + c]));
  EXPECT_EQ(wrong, 0U);
}

/// Expects the text to be refused at a line and column, with a message that contains `part`.
inline void expect_error(const std::string& text, int line, int column, const std::string& part,
                         const MeasuredOptions& options = {}) {
  try {
    parse_measured(text, "bad", options);
    FAIL() << "no error: " << text.substr(0, 200);
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    EXPECT_EQ(e.where().line, line) << e.what();
    EXPECT_EQ(e.where().column, column) << e.what();
    EXPECT_EQ(e.where().file, "bad") << e.what();
  }
}

/// A file of the folder of real measurements; empty if it is not there.
inline std::string real_file(const std::string& name) {
#ifdef FACETA_SHARED_DATA
  std::string path = std::string(FACETA_SHARED_DATA) + "/measured/" + name;
  if (std::filesystem::is_regular_file(path))
    return path;
#endif
  return {};
}

} // namespace faceta::test
