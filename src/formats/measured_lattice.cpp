#include "formats/measured_lattice.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace faceta {

namespace {

constexpr double kPi = std::numbers::pi, kSame = 1e-5;
constexpr size_t kMostNodes = 4096;

/// What an axis of a grid holds. A dphi may be folded by the mirror symmetry, a phi may not.
enum class AxisKind { theta, radial, phi, dphi, phi_d };

std::vector<AxisKind> axis_kinds(MeasuredCoordinates coordinates) {
  using enum AxisKind;
  switch (coordinates) {
  case MeasuredCoordinates::half_difference:
    return {theta, theta, phi_d};
  case MeasuredCoordinates::relative:
    return {theta, theta, dphi};
  case MeasuredCoordinates::relative_rotated:
    return {theta, phi, theta, phi};
  case MeasuredCoordinates::absolute:
    return {theta, phi, theta, phi};
  case MeasuredCoordinates::specular:
    return {theta, radial, dphi};
  case MeasuredCoordinates::specular_rotated:
    return {theta, phi, radial, phi};
  }
  return {};
}

std::vector<const char*> axis_names(MeasuredCoordinates coordinates) {
  switch (coordinates) {
  case MeasuredCoordinates::half_difference:
    return {"theta_h", "theta_d", "phi_d"};
  case MeasuredCoordinates::relative:
    return {"theta_i", "theta_o", "dphi"};
  case MeasuredCoordinates::relative_rotated:
    return {"theta_i", "phi_i", "theta_o", "dphi"};
  case MeasuredCoordinates::absolute:
    return {"theta_i", "phi_i", "theta_o", "phi_o"};
  case MeasuredCoordinates::specular:
    return {"theta_i", "radial", "azimuth"};
  case MeasuredCoordinates::specular_rotated:
    return {"theta_i", "phi_i", "radial", "azimuth"};
  }
  return {};
}

/// Brings the azimuths of column `k` into one period and says which: 0 for [0, pi], folded.
double normalise_azimuths(std::vector<LatticeRow>& rows, int k, AxisKind kind) {
  bool first_half = false, second_half = false;
  for (LatticeRow& row : rows) {
    double& a = row.angles[k];
    a = std::remainder(a, 2 * kPi);
    if (std::abs(a) < kSame)
      a = 0;
    if (a > kPi - kSame || a < -kPi + kSame)
      a = kPi;
    first_half |= a > 0 && a < kPi;
    second_half |= a < 0;
  }
  bool foldable = kind == AxisKind::dphi || kind == AxisKind::phi_d;
  if (foldable && !(first_half && second_half)) {
    bool has_pi = false;
    for (LatticeRow& row : rows) {
      row.angles[k] = std::abs(row.angles[k]);
      has_pi |= row.angles[k] > kPi - kSame;
    }
    // reciprocity alone: phi_d and phi_d + pi are the same pair of directions
    return kind == AxisKind::phi_d && !has_pi ? kPi : 0;
  }
  for (LatticeRow& row : rows)
    if (row.angles[k] < 0)
      row.angles[k] += 2 * kPi;
  return 2 * kPi;
}

std::vector<double> distinct(const std::vector<LatticeRow>& rows, int k) {
  std::vector<double> values;
  for (const LatticeRow& row : rows)
    values.push_back(row.angles[k]);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end(),
                           [](double kept, double next) { return next - kept < kSame; }),
               values.end());
  return values;
}

size_t nearest_node(const std::vector<double>& nodes, double angle) {
  size_t i = static_cast<size_t>(std::lower_bound(nodes.begin(), nodes.end(), angle - kSame) -
                                 nodes.begin());
  return std::min(i, nodes.size() - 1);
}

size_t least_nodes(AxisKind kind, bool declared) {
  if (declared)
    return 1;
  return kind == AxisKind::theta || kind == AxisKind::radial ? 2 : 3;
}

/// At the normal an azimuth means nothing: the value of one stands for all.
void fill_poles(MeasuredLattice& lattice, int polar, int azimuth) {
  MeasuredGrid& grid = lattice.grid;
  if (grid.axes[polar].nodes.front() > kSame)
    return;
  std::vector<size_t> stride(grid.axes.size(), 1);
  for (size_t k = grid.axes.size(); k-- > 1;)
    stride[k - 1] = stride[k] * grid.axes[k].nodes.size();
  size_t count = grid.axes[azimuth].nodes.size(), step = stride[azimuth];
  for (size_t i = 0; i < grid.rgb.size() / 3; ++i) {
    size_t at_polar = i / stride[polar] % grid.axes[polar].nodes.size();
    size_t at_azimuth = i / step % count;
    if (at_polar != 0 || !std::isnan(grid.rgb[3 * i]))
      continue;
    for (size_t j = 0; j < count; ++j) {
      size_t other = i - at_azimuth * step + j * step;
      if (std::isnan(grid.rgb[3 * other]))
        continue;
      std::copy_n(&grid.rgb[3 * other], 3, &grid.rgb[3 * i]);
      break;
    }
  }
}

} // namespace

std::optional<MeasuredLattice> lattice_from_rows(MeasuredCoordinates coordinates,
                                                 std::vector<LatticeRow> rows, bool declared) {
  std::vector<AxisKind> kinds = axis_kinds(coordinates);
  MeasuredLattice lattice;
  lattice.grid.coordinates = coordinates;
  size_t cells = 1;
  for (size_t k = 0; k < kinds.size(); ++k) {
    MeasuredAxis axis;
    if (kinds[k] != AxisKind::theta && kinds[k] != AxisKind::radial)
      axis.period = normalise_azimuths(rows, static_cast<int>(k), kinds[k]);
    axis.nodes = distinct(rows, static_cast<int>(k));
    if (axis.nodes.size() > kMostNodes || axis.nodes.size() < least_nodes(kinds[k], declared))
      return std::nullopt;
    if (axis.nodes.size() == 1)
      axis.period = 0;
    cells *= axis.nodes.size();
    lattice.grid.axes.push_back(std::move(axis));
    // a pole may be measured once for all azimuths, hence the slack until that is known
    if (cells / 4 > rows.size())
      return std::nullopt;
  }

  std::vector<double> sum(3 * cells, 0.0);
  std::vector<int> count(cells, 0);
  for (const LatticeRow& row : rows) {
    size_t i = 0;
    for (size_t k = 0; k < kinds.size(); ++k)
      i = i * lattice.grid.axes[k].nodes.size() +
          nearest_node(lattice.grid.axes[k].nodes, row.angles[k]);
    lattice.repeated += count[i] > 0;
    ++count[i];
    for (int c = 0; c < 3; ++c)
      sum[3 * i + c] += row.rgb[c];
  }
  lattice.grid.rgb.assign(3 * cells, std::numeric_limits<float>::quiet_NaN());
  for (size_t i = 0; i < 3 * cells; ++i)
    if (count[i / 3] > 0)
      lattice.grid.rgb[i] = static_cast<float>(sum[i] / count[i / 3]);

  if (coordinates == MeasuredCoordinates::relative) {
    fill_poles(lattice, 1, 2);
    fill_poles(lattice, 0, 2);
  } else if (coordinates == MeasuredCoordinates::absolute ||
             coordinates == MeasuredCoordinates::relative_rotated) {
    fill_poles(lattice, 2, 3);
  } else if (coordinates == MeasuredCoordinates::half_difference) {
    fill_poles(lattice, 1, 2);
  }
  for (size_t i = 0; i < cells; ++i)
    lattice.holes += std::isnan(lattice.grid.rgb[3 * i]);
  if (static_cast<size_t>(lattice.holes) > cells / 4)
    return std::nullopt;
  return lattice;
}

std::optional<MeasuredLattice> lattice_from_samples(std::span<const MeasuredSample> samples,
                                                    bool isotropic) {
  auto rows = [&](MeasuredCoordinates coordinates) {
    std::vector<LatticeRow> out;
    out.reserve(samples.size());
    for (const MeasuredSample& s : samples) {
      double dphi = s.phi_o - s.phi_i;
      if (coordinates == MeasuredCoordinates::relative)
        out.push_back({{s.theta_i, s.theta_o, dphi, 0}, s.rgb});
      else if (coordinates == MeasuredCoordinates::relative_rotated)
        out.push_back({{s.theta_i, s.phi_i, s.theta_o, dphi}, s.rgb});
      else
        out.push_back({{s.theta_i, s.phi_i, s.theta_o, s.phi_o}, s.rgb});
    }
    return out;
  };
  using enum MeasuredCoordinates;
  if (isotropic)
    return lattice_from_rows(relative, rows(relative));
  std::optional<MeasuredLattice> found =
      lattice_from_rows(relative_rotated, rows(relative_rotated));
  return found ? std::move(found) : lattice_from_rows(absolute, rows(absolute));
}

std::string describe_lattice(const MeasuredGrid& grid) {
  std::string sizes, names;
  std::vector<const char*> all = axis_names(grid.coordinates);
  for (size_t k = 0; k < grid.axes.size(); ++k) {
    sizes += fmt::format("{}{}", k == 0 ? "" : " x ", grid.axes[k].nodes.size());
    names += fmt::format("{}{}", k == 0 ? "" : ", ", all[k]);
  }
  return sizes + " (" + names + ")";
}

} // namespace faceta
