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

/// What makes two loads the same: the file as it is now, and how it is read.
std::string key_of(const std::string& name, const MeasuredOptions& o) {
  std::error_code ignored;
  auto size = fs::file_size(name, ignored);
  auto time = fs::last_write_time(name, ignored).time_since_epoch().count();
  std::string path = fs::weakly_canonical(name, ignored).string();
  return fmt::format("{}\n{} {}\n{} {} {} {} {}", path.empty() ? name : path, size, time, o.format,
                     o.merl_nodes, o.utia_color, o.index, o.wavelength);
}

std::shared_ptr<const FileTables> load(const Parameters& parameters, const SourcePosition& where) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const FileTables>> loaded;
  const std::string name = parameters.file_name();
  if (is_demo(name))
    return load_demo(parameters, where);
  const MeasuredOptions options = measured_options(parameters);
  // Held while reading, so that two threads do not read the same file.
  std::lock_guard lock(mutex);
  std::weak_ptr<const FileTables>& known = loaded[key_of(name, options)];
  if (auto tables = known.lock())
    return tables;
  try {
    auto tables = std::make_shared<FileTables>();
    tables->name = name;
    tables->values = measured_block(read_measured(name, options), name);
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
    return std::visit(
        [&](const auto& data) -> HugeVector<float> {
          if constexpr (requires { measured_block(data); })
            return measured_block(data);
          else
            throw Error("its values transmit light or are constant over patches: not supported "
                        "yet");
        },
        file.data);
  } catch (const Error& error) {
    throw Error(error.message(), {name}, error.hint());
  }
}

void load_measured_files() {
  set_file_loader(load);
}

MeasuredOptions measured_options(const Parameters& parameters) {
  MeasuredOptions options;
  options.format = parameters.text("format");
  options.merl_nodes = parameters.text("merl_nodes");
  options.utia_color = parameters.text("utia_color");
  const Descriptor& d = parameters.descriptor();
  options.index = static_cast<int>(parameters.slots()[size_t(d.find("index")->slot)]);
  options.wavelength = parameters.slots()[size_t(d.find("wavelength")->slot)];
  return options;
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
