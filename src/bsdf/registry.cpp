#include "bsdf/registry.h"

#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>

namespace faceta {

namespace fs = std::filesystem;

bool isa_supported(Isa isa) {
  __builtin_cpu_init();
  switch (isa) {
  case Isa::scalar:
    return true;
  case Isa::v3:
    return __builtin_cpu_supports("x86-64-v3") && __builtin_cpu_supports("aes") &&
           __builtin_cpu_supports("pclmul");
  case Isa::v4:
    return __builtin_cpu_supports("x86-64-v4") && __builtin_cpu_supports("aes") &&
           __builtin_cpu_supports("pclmul");
  }
  return false;
}

Isa best_isa() {
  for (Isa isa : {Isa::v4, Isa::v3})
    if (isa_supported(isa))
      return isa;
  return Isa::scalar;
}

Isa parse_isa(const std::string& name) {
  for (int i = 0; i < kIsaCount; ++i)
    if (name == kIsaNames[i])
      return static_cast<Isa>(i);
  throw Error("unknown instruction set '" + name + "'", {}, "known: scalar, v3, v4");
}

MaterialArgs Record::args(TransportMode mode) const {
  MaterialArgs a;
  a.records = slots.data();
  a.stride = static_cast<int32_t>(slots.size());
  a.choices = choices.data();
  a.tables = file ? file->values.data() : tables.data();
  a.importance = mode == TransportMode::importance;
  return a;
}

std::string module_directory() {
  if (const char* path = std::getenv("FACETA_MODULE_PATH"))
    return path;
  Dl_info info{};
  std::vector<fs::path> bases;
  if (dladdr(reinterpret_cast<void*>(&module_directory), &info) && info.dli_fname)
    bases.push_back(fs::weakly_canonical(fs::path(info.dli_fname)).parent_path());
  std::error_code ignored;
  bases.push_back(fs::read_symlink("/proc/self/exe", ignored).parent_path());
  for (const fs::path& base : bases)
    for (const char* below : {"faceta", "lib/faceta", "../lib/faceta"})
      if (fs::is_directory(base / below, ignored))
        return fs::weakly_canonical(base / below).string();
  throw Error("the folder with the instruction-set modules was not found", {},
              "looked for faceta, lib/faceta and ../lib/faceta beside the library; set "
              "FACETA_MODULE_PATH to where builtin_scalar.so lies");
}

namespace {

const ModuleTable* load_module(const fs::path& path) {
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle)
    throw Error("cannot load module: " + std::string(dlerror()), {path.string()});
  auto table = reinterpret_cast<const ModuleTable* (*)()>(dlsym(handle, "faceta_module_table"));
  if (!table || table()->abi != kModuleAbi)
    throw Error("not a module of this version of the library", {path.string()});
  return table();
}

} // namespace

void Registry::add(std::vector<Model> models, const std::string& directory,
                   const std::string& module) {
  for (int i = 0; i < kIsaCount; ++i) {
    if (!isa_supported(static_cast<Isa>(i)))
      continue;
    fs::path path = fs::path(directory) / (module + "_" + kIsaNames[i] + ".so");
    const ModuleTable* table = load_module(path);
    if (table->kernel_count != static_cast<int32_t>(models.size()))
      throw Error("module and registration list disagree; rebuild both", {path.string()});
    for (size_t k = 0; k < models.size(); ++k)
      models[k].kernels[i] = table->kernels[k];
    if (table->render)
      render_[i] = table->render;
  }
  for (Model& model : models) {
    if (find(model.name()))
      throw Error("a material named '" + model.name() + "' is registered already");
    models_.push_back(std::make_unique<Model>(std::move(model)));
  }
}

const Model* Registry::find(const std::string& name) const {
  for (const auto& model : models_)
    if (model->name() == name)
      return model.get();
  return nullptr;
}

const Model& Registry::get(const std::string& name) const {
  if (const Model* model = find(name))
    return *model;
  throw Error("unknown material '" + name + "'", {}, suggestion(name, names()));
}

std::vector<std::string> Registry::names() const {
  std::vector<std::string> result;
  for (const auto& model : models_)
    result.push_back(model->name());
  return result;
}

} // namespace faceta
