#include "formats/measured_loader.h"

#include "bsdf/measured_build.h"
#include "bsdf/registry.h"
#include "formats/measured_reader.h"
#include "materials/measured_demo.h"

#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <mutex>

namespace faceta {

namespace {

namespace fs = std::filesystem;

/// What makes two loads the same: the file as it is now, how it is read, and for which model.
std::string key_of(const std::string& name, const std::string& model, const MeasuredOptions& o) {
  std::error_code ignored;
  auto size = fs::file_size(name, ignored);
  auto time = fs::last_write_time(name, ignored).time_since_epoch().count();
  std::string path = fs::weakly_canonical(name, ignored).string();
  return fmt::format("{}\n{} {}\n{}\n{} {} {} {} {}", path.empty() ? name : path, size, time, model,
                     o.format, o.merl_nodes, o.utia_color, o.index, o.wavelength);
}

std::shared_ptr<const FileTables> load(const Parameters& parameters, const SourcePosition& where) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const FileTables>> loaded;
  const std::string name = parameters.file_name();
  if (is_demo(name))
    return load_demo(parameters, where);
  const std::string& model = parameters.model().name();
  const MeasuredOptions options = measured_options(parameters);
  // Held while reading, so that two threads do not read the same file.
  std::lock_guard lock(mutex);
  std::weak_ptr<const FileTables>& known = loaded[key_of(name, model, options)];
  if (auto tables = known.lock())
    return tables;
  try {
    auto tables = std::make_shared<FileTables>();
    tables->name = name;
    MeasuredFile file = read_measured(name, options);
    check_model(file, name, model);
    tables->values = measured_block(file, name);
    known = tables;
    return tables;
  } catch (const Error& error) {
    if (where.file.empty())
      throw;
    throw Error(error.what(), where);
  }
}

} // namespace

HugeVector<float> measured_block(const MeasuredFile& file, const std::string& name) {
  try {
    return measured_block(file);
  } catch (const Error& error) {
    throw Error(error.message(), {name}, error.hint());
  }
}

void load_measured_files() {
  set_file_loader(load);
}

MeasuredOptions measured_options(const Parameters& parameters) {
  MeasuredOptions options;
  const Descriptor& d = parameters.descriptor();
  auto read = [&](const char* name, auto& option, auto value) {
    if (const ParamInfo* p = d.find(name))
      option = value(*p);
  };
  auto text = [&](const ParamInfo& p) { return parameters.text(p.name); };
  auto number = [&](const ParamInfo& p) { return parameters.slots()[size_t(p.slot)]; };
  read("format", options.format, text);
  read("merl_nodes", options.merl_nodes, text);
  read("utia_color", options.utia_color, text);
  read("index", options.index, [&](const ParamInfo& p) { return static_cast<int>(number(p)); });
  read("wavelength", options.wavelength, number);
  return options;
}

const char* model_of_measured(const std::string& name) {
  if (is_demo(name))
    return model_of(measured_demo(name));
  std::string format = format_of_measured(name);
  return format == "klems" || format == "tensortree" ? "measuredwindow" : "measured";
}

NamedModel model_or_file(const std::string& name, const Settings& settings) {
  const Registry& registry = Registry::global();
  if (registry.find(name) || !(is_demo(name) || !format_of_measured(name).empty()))
    return {&registry.get(name), settings};
  NamedModel named{&registry.get(model_of_measured(name)), settings};
  named.settings.insert(named.settings.begin(), {named.model->descriptor.file()->name, name});
  return named;
}

Parameters parameters_of(const NamedModel& named) {
  return make_parameters(named.model->name(), named.settings);
}

MeasuredFile read_measured_or_demo(const std::string& name, const MeasuredOptions& options) {
  if (!is_demo(name))
    return read_measured(name, options);
  if (options != MeasuredOptions{})
    throw Error("a demonstration is read in one way only", {name},
                "leave out what says how files are read");
  return measured_demo(name);
}

} // namespace faceta
