#pragma once

#include "formats/measured_reader.h"
#include "measured_checks.h"
#include "mesh_checks.h"

#include <algorithm>
#include <cstring>
#include <numbers>

namespace faceta {

template <class T> void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

inline MeasuredFile parse(const std::string& bytes, const MeasuredOptions& options = {}) {
  MeasuredFile file = parse_measured(bytes, "test.file", options);
  EXPECT_EQ(unsound(file), "");
  return file;
}

inline MeasuredGrid parse_grid(const std::string& bytes, const MeasuredOptions& options = {}) {
  return std::get<MeasuredGrid>(parse(bytes, options).data);
}

inline std::string refusal(const std::string& bytes, const MeasuredOptions& options = {}) {
  return error_of([&] { parse_measured(bytes, "test.file", options); });
}

inline std::string shared_file(const std::string& name) {
  return std::string(FACETA_SHARED_DATA) + "/measured/" + name;
}

// Where a value of a grid lies, for the indices along its axes.
inline const float* cell(const MeasuredGrid& grid, const std::vector<size_t>& indices) {
  size_t offset = 0;
  for (size_t axis = 0; axis < grid.axes.size(); ++axis)
    offset = offset * grid.axes[axis].nodes.size() + indices[axis];
  return &grid.rgb[3 * offset];
}

// The node nearest to an angle, in the measure in which the axis is linear.
inline size_t nearest(const MeasuredAxis& axis, double angle) {
  auto distance = [&](double node) {
    if (axis.square_root)
      return std::abs(std::sqrt(node) - std::sqrt(angle));
    if (axis.period > 0)
      return std::abs(std::remainder(node - angle, axis.period));
    return std::abs(node - angle);
  };
  size_t best = 0;
  for (size_t i = 1; i < axis.nodes.size(); ++i)
    if (distance(axis.nodes[i]) < distance(axis.nodes[best]))
      best = i;
  return best;
}

struct Direction {
  double x, y, z;
};

// Uniform over the upper hemisphere.
inline Direction random_direction(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  double z = unit(random), phi = 2 * std::numbers::pi * unit(random), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// Files of many lengths, then thousands of damaged ones: each reads soundly or ends in an Error.
inline void damage(const std::string& bytes, size_t attempts) {
  int read = 0, refused = 0;
  auto attempt = [&](const std::string& damaged) {
    try {
      MeasuredFile file = parse_measured(damaged, "test.file");
      ASSERT_EQ(unsound(file), "");
      ++read;
    } catch (const Error& error) {
      EXPECT_FALSE(error.message().empty());
      EXPECT_EQ(error.where().file, "test.file");
      ++refused;
    }
  };
  std::mt19937 random(7);
  for (size_t n = 0; n < bytes.size(); n += 1 + (n > 600) * random() % (bytes.size() / 50 + 1)) {
    int before = refused;
    attempt(bytes.substr(0, n));
    EXPECT_EQ(refused, before + 1) << "cut to " << n << " bytes";
  }
  attempt(bytes + "x");
  for (size_t i = 0; i < attempts; ++i) {
    std::string damaged = bytes;
    for (unsigned k = random() % 3 + 1; k > 0; --k) {
      // Half of the damage goes to the header.
      size_t at =
          random() % (random() % 2 ? damaged.size() : std::min<size_t>(700, damaged.size()));
      damaged[at] = static_cast<char>(random() % 3 ? random() : random() % 2 ? 0xff : 0x7f);
    }
    attempt(damaged);
  }
  EXPECT_GT(read, 0);
}

} // namespace faceta
