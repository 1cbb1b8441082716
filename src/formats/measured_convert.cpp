#include "formats/measured_convert.h"

#include "formats/measured_common.h"
#include "formats/measured_csv_writer.h"
#include "formats/measured_merl.h"
#include "formats/measured_rgl.h"
#include "formats/reflector.h"
#include "materials/measured_demo.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace faceta {

namespace {

constexpr double kAngles[] = {0, 15, 30, 45, 60, 75, 80, 85};

MeasuredAxis axis(size_t n, double first, double step, double period = 0) {
  MeasuredAxis a;
  a.period = period * kDegree;
  for (size_t k = 0; k < n; ++k)
    a.nodes.push_back((first + step * double(k)) * kDegree);
  return a;
}

/// The cells of MERL, values at their centres.
MeasuredGrid merl_grid() {
  MeasuredGrid grid;
  grid.axes = {{{}, 0, true}, axis(90, 0.5, 1), axis(180, 0.5, 1, 180)};
  for (int k = 0; k < 90; ++k)
    grid.axes[0].nodes.push_back(sqr((k + 0.5) / 90) * 90 * kDegree);
  return grid;
}

/// Inclinations up to the last multiple of the step below the horizon and 89 degrees.
MeasuredAxis inclinations(double step) {
  MeasuredAxis a;
  for (double angle = 0; angle < 88.5; angle += step)
    a.nodes.push_back(angle * kDegree);
  a.nodes.push_back(89 * kDegree);
  return a;
}

MeasuredGrid csv_grid(bool isotropic, std::optional<double> resolution) {
  const double step = resolution.value_or(isotropic ? 5 : 10);
  if (!(step >= (isotropic ? 0.5 : 3) && step <= 45))
    throw Error(fmt::format("a table with angles every {} degrees makes no sense", step), {},
                isotropic ? "0.5 to 45 do" : "3 to 45 do where a surface is not isotropic");
  const MeasuredAxis theta = inclinations(step);
  const size_t turns = size_t(std::max(2.0, std::round(360 / step)));
  MeasuredGrid grid;
  const MeasuredAxis around = axis(turns, 0, 360.0 / double(turns), 360);
  grid.coordinates = isotropic ? MeasuredCoordinates::relative : MeasuredCoordinates::absolute;
  if (isotropic)
    grid.axes = {theta, theta, around};
  else
    grid.axes = {theta, around, theta, around};
  return grid;
}

std::string size_text(const std::vector<size_t>& sizes) {
  std::string text;
  for (size_t n : sizes)
    text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text;
}

MeasuredFile make_rgl(const Reflectance& f, const ConvertOptions& options, Conversion& made) {
  RglResolution resolution;
  if (options.resolution) {
    double side = *options.resolution;
    if (!(side >= 8 && side <= 256 && side == std::floor(side)))
      throw Error(fmt::format("{} texels a side make no sense", side), {}, "8 to 256 do");
    resolution.side = int(side);
  }
  RglTables t = make_rgl_tables(f, resolution);
  made.resolution = fmt::format("{} x {} (phi_i, theta_i) tables of {} x {} texels", t.phi_i.size(),
                                t.theta_i.size(), t.luminance_size[0], t.luminance_size[1]);
  return {{}, std::move(t)};
}

MeasuredFile make_grid(const Reflectance& f, const ConvertOptions& options, Conversion& made) {
  const bool isotropic = is_isotropic(f);
  MeasuredGrid grid;
  if (options.target == MeasuredTarget::csv) {
    grid = csv_grid(isotropic, options.resolution);
    tabulate(f, grid);
  } else {
    if (options.resolution)
      throw Error("a MERL file has 90 x 90 x 180 cells, always", {}, "leave the resolution out");
    if (!isotropic)
      throw Error("the surface is not isotropic, a MERL file cannot hold it", {},
                  "write an RGL file (.bsdf) or a table (.csv)");
    grid = merl_grid();
    tabulate(symmetrised(f), grid);
  }
  std::vector<size_t> sizes;
  for (const MeasuredAxis& a : grid.axes)
    sizes.push_back(a.nodes.size());
  made.resolution =
      size_text(sizes) + (options.target == MeasuredTarget::merl ? " (theta_h, theta_d, phi_d)"
                          : isotropic                            ? " (theta_i, theta_o, phi_o)"
                                      : " (theta_i, phi_i, theta_o, phi_o)");
  return {{}, std::move(grid)};
}

void compare(Conversion& made, const Reflectance& source, const Reflector& result) {
  for (double theta : kAngles) {
    Conversion::Row row;
    row.theta = theta;
    const Vec3<double> wo = direction_of(theta * kDegree, theta > 0 ? 0.3 : 0);
    const int n = 4096;
    for_samples(result, wo, n, [&](const Vec3<double>& wi, double pdf) {
      Color<double> a = source(wo, wi), b = result.value(wo, wi);
      for (int c = 0; c < 3; ++c) {
        row.source[size_t(c)] += a[c] / pdf / n;
        row.result[size_t(c)] += b[c] / pdf / n;
      }
    });
    // A channel that is all but black has no relative error worth the name.
    double least = 0.02 * *std::max_element(row.source.begin(), row.source.end());
    for (size_t c = 0; c < 3; ++c)
      if (double scale = std::max(row.source[c], least); scale > 0)
        row.error = std::max(row.error, std::abs(row.result[c] - row.source[c]) / scale);
    if (theta <= 80)
      made.error = std::max(made.error, row.error);
    made.rows.push_back(row);
  }
}

} // namespace

std::optional<MeasuredTarget> measured_target(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".bsdf")
    return MeasuredTarget::rgl;
  if (ending == ".binary")
    return MeasuredTarget::merl;
  if (ending == ".csv")
    return MeasuredTarget::csv;
  return {};
}

Conversion write_reflectance(const std::string& path, const Reflectance& f,
                             const ConvertOptions& options) {
  Conversion made;
  const bool rgl = options.target == MeasuredTarget::rgl;
  const MeasuredFile file = rgl ? make_rgl(f, options, made) : make_grid(f, options, made);
  if (rgl)
    write_rgl(path, std::get<RglTables>(file.data), options.description);
  else if (options.target == MeasuredTarget::merl)
    write_merl(path, std::get<MeasuredGrid>(file.data));
  else
    write_measured_csv(path, std::get<MeasuredGrid>(file.data));
  compare(made, f, Reflector(file, path));
  if (made.error > 0.01)
    made.notes.push_back(
        fmt::format("albedos are off by up to {:.2g} %: {}", 100 * made.error,
                    rgl ? "more texels may help (--resolution 128)"
                        : "lobes too narrow for this format; an RGL file (.bsdf) is finer"));
  return made;
}

Reflectance symmetrised(Reflectance f) {
  return [f = std::move(f)](const Vec3<double>& wo, const Vec3<double>& wi) {
    Color<double> there = f(wo, wi), back = f(wi, wo);
    for (int c = 0; c < 3; ++c)
      there[c] = 0.5 * (there[c] + back[c] * (wi.z / wo.z));
    return there;
  };
}

} // namespace faceta
