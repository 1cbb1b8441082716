#include "formats/measured_loader.h"

#include "bsdf/measured_build.h"
#include "bsdf/registry.h"
#include "formats/measured_demo.h"
#include "formats/measured_reader.h"

#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <mutex>

namespace faceta {

namespace {

namespace fs = std::filesystem;

constexpr const char* kReflectanceModel = "measured";
constexpr const char* kWindowModel = "measuredwindow";

/// The model that renders a file's data.
const char* model_of(const MeasuredFile& file) {
  bool cells = std::holds_alternative<MeasuredPatches>(file.data) ||
               std::holds_alternative<MeasuredTree>(file.data);
  return cells ? kWindowModel : kReflectanceModel;
}

HugeVector<float> block_of(const MeasuredFile& file, const std::string& name,
                           const std::string& model) {
  if (model != model_of(file))
    throw Error(model == kReflectanceModel
                    ? "the file holds values of cells, reflected and transmitted"
                    : "the file holds reflectance only, not values of cells",
                {name}, fmt::format("use the model '{}'", model_of(file)));
  try {
    return std::visit([](const auto& data) { return measured_block(data); }, file.data);
  } catch (const Error& error) {
    throw Error(error.message(), {name}, error.hint());
  }
}

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
    tables->values = block_of(read_measured_or_demo(name, options), name, model);
    known = tables;
    return tables;
  } catch (const Error& error) {
    if (where.file.empty())
      throw;
    throw Error(error.what(), where);
  }
}

} // namespace

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
    return is_cell_demo(name) ? kWindowModel : kReflectanceModel;
  std::string format = format_of_measured(name);
  return format == "klems" || format == "tensortree" ? kWindowModel : kReflectanceModel;
}

MeasuredFile read_measured_or_demo(const std::string& name, const MeasuredOptions& options) {
  return is_demo(name) ? measured_demo(name, options) : read_measured(name, options);
}

} // namespace faceta
