#include "materials/measured_demo.h"

#include "bsdf/measured_build.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <tbb/parallel_for.h>

namespace faceta {

namespace {

constexpr const char* kPrefix = "demo:";

MeasuredAxis even(int n, double degrees, double period = 0) {
  MeasuredAxis axis;
  axis.period = period * kPi / 180;
  for (int k = 0; k < n; ++k)
    axis.nodes.push_back(degrees * k / (period > 0 ? n : n - 1) * kPi / 180);
  return axis;
}

/// Inclinations, denser towards the normal; the square root of the angle is even.
MeasuredAxis rooted(int n) {
  MeasuredAxis axis;
  axis.square_root = true;
  for (int k = 0; k < n; ++k)
    axis.nodes.push_back(std::pow(double(k) / (n - 1), 2) * 0.5 * kPi);
  return axis;
}

struct Demo {
  const char* name;
  const char* model;
  Settings settings;
  MeasuredGrid grid;
};

const std::vector<Demo>& demos() {
  using C = MeasuredCoordinates;
  static const std::vector<Demo> list = {
      {"plastic",
       "roughplastic",
       {{"diffuse_reflectance", "0.1,0.27,0.6"}, {"alpha", "0.15"}},
       {C::half_difference, {rooted(64), even(31, 90), even(36, 180, 180)}, {}}},
      {"metal",
       "roughconductor",
       {{"material", "Cu"}, {"alpha", "0.3"}},
       {C::relative, {even(31, 90), even(46, 90), even(37, 180)}, {}}},
      {"brushed",
       "roughconductor",
       {{"material", "Al"}, {"alpha_u", "0.5"}, {"alpha_v", "0.25"}},
       {C::absolute, {even(13, 90), even(24, 360, 360), even(19, 90), even(36, 360, 360)}, {}}},
      {"gloss",
       "roughplastic",
       {{"diffuse_reflectance", "0.5,0.1,0.05"}, {"alpha", "0.3"}},
       {C::specular, {even(16, 90), rooted(40), even(25, 180)}, {}}},
  };
  return list;
}

const std::vector<std::string>& cell_demos() {
  static const std::vector<std::string> names = {"demo:shade", "demo:tree3", "demo:tree4"};
  return names;
}

MeasuredFile cell_demo(const std::string& name) {
  MeasuredFile file;
  file.info.format = "demo";
  file.info.title = "a window made by Faceta itself";
  if (name == "demo:shade") {
    MeasuredPatches patches = demo_patches();
    file.info.cells = 4 * int64_t(patches.incident.size()) * patches.outgoing.size();
    file.data = std::move(patches);
    return file;
  }
  MeasuredTree tree = demo_tree(name == "demo:tree3" ? 3 : 4);
  for (const std::vector<float>& rgb : tree.rgb)
    file.info.cells += int64_t(rgb.size() / 3);
  file.data = std::move(tree);
  return file;
}

Vec3<double> from_angles(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// v turned by `angle` about z.
Vec3<double> about_z(const Vec3<double>& v, double angle) {
  double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}
Vec3<double> about_y(const Vec3<double>& v, double angle) {
  double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

/// One table a demonstration, made when it is first asked for.
std::shared_ptr<const FileTables> demo_tables(const std::string& name, const std::string& model) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const FileTables>> made;
  std::lock_guard lock(mutex);
  std::weak_ptr<const FileTables>& known = made[model + ' ' + name];
  if (auto tables = known.lock())
    return tables;
  auto tables = std::make_shared<FileTables>();
  tables->name = name;
  MeasuredFile file = measured_demo(name);
  check_model(file, name, model);
  tables->values = measured_block(file);
  known = tables;
  return tables;
}

} // namespace

std::shared_ptr<const FileTables> load_demo(const Parameters& parameters,
                                            const SourcePosition& where) {
  const std::string name = parameters.file_name();
  if (!is_demo(name))
    throw Error("this program reads no files of measured values", where,
                "call faceta::load_measured_files() first");
  for (const ParamInfo& p : parameters.descriptor().params)
    if (p.reads_file && parameters.text(p.name) != Parameters(parameters.model()).text(p.name))
      throw Error("'" + p.name + "' says how a file is read, and '" + name + "' is none", where,
                  "leave it out");
  return demo_tables(name, parameters.model().name());
}

const char* model_of(const MeasuredFile& file) {
  bool cells = std::holds_alternative<MeasuredPatches>(file.data) ||
               std::holds_alternative<MeasuredTree>(file.data);
  return cells ? "measuredwindow" : "measured";
}

void check_model(const MeasuredFile& file, const std::string& name, const std::string& model) {
  if (model != model_of(file))
    throw Error(model == "measured" ? "the file holds values of cells, reflected and transmitted"
                                    : "the file holds reflectance only, not values of cells",
                {name}, std::string("use the model '") + model_of(file) + "'");
}

bool is_demo(const std::string& name) {
  return name.rfind(kPrefix, 0) == 0;
}

std::vector<std::string> demo_names() {
  std::vector<std::string> names;
  for (const Demo& demo : demos())
    names.push_back(std::string(kPrefix) + demo.name);
  names.insert(names.end(), cell_demos().begin(), cell_demos().end());
  return names;
}

bool is_cell_demo(const std::string& name) {
  const std::vector<std::string>& names = cell_demos();
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool directions_of(MeasuredCoordinates coordinates, const double* a, Vec3<double>& wo,
                   Vec3<double>& wi) {
  using C = MeasuredCoordinates;
  switch (coordinates) {
  case C::half_difference: {
    Vec3<double> h = from_angles(a[0], 0);
    wi = about_y(from_angles(a[1], a[2]), a[0]);
    wo = reflect(wi, h);
    break;
  }
  case C::relative:
    wi = from_angles(a[0], 0);
    wo = from_angles(a[1], a[2]);
    break;
  case C::relative_rotated:
    wi = from_angles(a[0], a[1]);
    wo = from_angles(a[2], a[1] + a[3]);
    break;
  case C::absolute:
    wi = from_angles(a[0], a[1]);
    wo = from_angles(a[2], a[3]);
    break;
  case C::specular:
  case C::specular_rotated: {
    bool rotated = coordinates == C::specular_rotated;
    double phi = rotated ? a[1] : 0, radial = a[rotated ? 2 : 1], azimuth = a[rotated ? 3 : 2];
    wi = from_angles(a[0], phi);
    wo = about_z(about_y(from_angles(radial, azimuth), a[0]), phi + kPi);
    break;
  }
  }
  return wi.z > 1e-9 && wo.z > 1e-9;
}

void tabulate(const Reflectance& f, MeasuredGrid& grid) {
  size_t count[4] = {1, 1, 1, 1};
  for (size_t k = 0; k < grid.axes.size(); ++k)
    count[k] = grid.axes[k].nodes.size();
  grid.rgb.resize(3 * count[0] * count[1] * count[2] * count[3]);
  tbb::parallel_for(size_t(0), count[0] * count[1], [&](size_t row) {
    double angles[4] = {};
    float* out = &grid.rgb[3 * row * count[2] * count[3]];
    for (size_t rest = 0; rest < count[2] * count[3]; ++rest, out += 3) {
      size_t index[4] = {row / count[1], row % count[1], rest / count[3], rest % count[3]};
      for (size_t k = 0; k < grid.axes.size(); ++k)
        angles[k] = grid.axes[k].nodes[index[k]];
      Vec3<double> wo, wi;
      if (!directions_of(grid.coordinates, angles, wo, wi)) {
        out[0] = out[1] = out[2] = std::numeric_limits<float>::quiet_NaN();
        continue;
      }
      Color<double> value = f(wo, wi);
      for (int c = 0; c < 3; ++c)
        out[c] = static_cast<float>(value[c] / wi.z);
    }
  });
}

MeasuredFile measured_demo(const std::string& name) {
  const Demo* demo = nullptr;
  for (const Demo& d : demos())
    if (kPrefix + std::string(d.name) == name)
      demo = &d;
  if (!demo && !is_cell_demo(name))
    throw Error("there is no demonstration of that name", {name}, suggestion(name, demo_names()));
  if (!demo)
    return cell_demo(name);
  MeasuredFile file;
  MeasuredGrid grid = demo->grid;
  const Parameters material = make_parameters(demo->model, demo->settings);
  const Record record = material.record();
  tabulate([&](const Vec3<double>& wo,
               const Vec3<double>& wi) { return material.model().eval(record, {wo, wi}).value; },
           grid);
  file.info.format = "demo";
  file.info.title = "a table of Faceta's own model " + std::string(demo->model);
  file.info.cells = int64_t(grid.rgb.size() / 3);
  file.data = std::move(grid);
  return file;
}

} // namespace faceta
