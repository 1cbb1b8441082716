#pragma once

/// What every file of measured reflectance promises once it is read; for tests and fuzzing.

#include "bsdf/measured_data.h"

#include <cmath>
#include <cstddef>

namespace faceta {

inline bool is_increasing(const std::vector<double>& values) {
  for (size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) || (i > 0 && !(values[i] > values[i - 1])))
      return false;
  return !values.empty();
}

inline bool all_finite(const std::vector<float>& values) {
  for (float v : values)
    if (!std::isfinite(v))
      return false;
  return true;
}

inline std::string unsound(const MeasuredGrid& grid, const MeasuredInfo& info) {
  size_t cells = 1;
  for (const MeasuredAxis& axis : grid.axes) {
    if (!is_increasing(axis.nodes))
      return "nodes of an axis increase";
    if (axis.period < 0 ||
        (axis.period > 0 && axis.nodes.back() - axis.nodes.front() >= axis.period))
      return "nodes lie within a period";
    if (axis.square_root && axis.nodes.front() < 0)
      return "roots of angles are real";
    cells *= axis.nodes.size();
  }
  if (grid.axes.size() != 3 && grid.axes.size() != 4)
    return "a grid has three or four axes";
  if (grid.rgb.size() != 3 * cells || info.cells != static_cast<int64_t>(cells))
    return "a colour for each cell";
  int64_t holes = 0;
  for (size_t i = 0; i < grid.rgb.size(); i += 3) {
    if (std::isnan(grid.rgb[i])) {
      ++holes;
      continue;
    }
    for (size_t c = 0; c < 3; ++c)
      if (!(grid.rgb[i + c] >= 0) || !std::isfinite(grid.rgb[i + c]))
        return "colours are finite and not negative";
  }
  return holes == info.holes ? "" : "holes are counted";
}

inline std::string unsound(const RglTables& t, const MeasuredInfo&) {
  auto size = [](const int(&s)[2], size_t depth) {
    return s[0] < 2 || s[1] < 2 ? 0 : static_cast<size_t>(s[0]) * static_cast<size_t>(s[1]) * depth;
  };
  auto increasing = [](const std::vector<float>& v) { return is_increasing({v.begin(), v.end()}); };
  const size_t tables = t.phi_i.size() * t.theta_i.size();
  if (!increasing(t.phi_i) || !increasing(t.theta_i))
    return "the angles of the viewer increase";
  if (t.ndf.empty() || t.ndf.size() != size(t.ndf_size, 1) || t.sigma.empty() ||
      t.sigma.size() != size(t.sigma_size, 1) || t.vndf.empty() ||
      t.vndf.size() != size(t.vndf_size, tables) || t.luminance.empty() ||
      t.luminance.size() != size(t.luminance_size, tables) ||
      t.rgb.size() != size(t.luminance_size, 3 * tables))
    return "the sizes of the tables agree";
  for (const std::vector<float>* table : {&t.ndf, &t.sigma, &t.vndf, &t.luminance})
    for (float v : *table)
      if (!(v >= 0) || !std::isfinite(v))
        return "densities are finite and not negative";
  return all_finite(t.rgb) ? "" : "colours are finite";
}

inline std::string unsound(const MeasuredPatches& patches, const MeasuredInfo&) {
  for (const std::vector<float>& rgb : patches.rgb) {
    if (!rgb.empty() && rgb.size() != 3 * static_cast<size_t>(patches.incident.size()) *
                                          static_cast<size_t>(patches.outgoing.size()))
      return "a colour for each pair of patches";
    for (float v : rgb)
      if (!(v >= 0) || !std::isfinite(v))
        return "colours are finite and not negative";
  }
  return {};
}

inline std::string unsound(const MeasuredTree& tree, const MeasuredInfo&) {
  const int64_t children = int64_t(1) << tree.dimensions;
  for (size_t pass = 0; pass < tree.nodes.size(); ++pass) {
    const auto size = static_cast<int64_t>(tree.nodes[pass].size());
    const auto values = static_cast<int64_t>(tree.rgb[pass].size() / 3);
    for (int64_t node : tree.nodes[pass])
      if (node >= 0 ? node == 0 || node + children > size : -1 - node >= values)
        return "children and values of a tree are there";
    for (float v : tree.rgb[pass])
      if (!(v >= 0) || !std::isfinite(v))
        return "colours are finite and not negative";
  }
  return {};
}

/// Empty, or what does not hold.
inline std::string unsound(const MeasuredFile& file) {
  if (file.info.format.empty() || file.info.title.empty() || file.info.interpolation.empty())
    return "a file says what it is";
  if (!(file.info.largest_theta >= 0 && file.info.largest_theta < 1.6))
    return "measured directions lie above the horizon";
  return std::visit([&](const auto& data) { return unsound(data, file.info); }, file.data);
}

} // namespace faceta
