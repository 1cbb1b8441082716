#pragma once

/// The registry: every model, its description, its double and Jet reference, and its kernels.

#include "base/error.h"
#include "bsdf/describe.h"
#include "bsdf/file_tables.h"
#include "bsdf/kernel.h"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>

namespace faceta {

/// The instruction sets that kernels exist for.
enum class Isa { scalar, v3, v4 };
inline constexpr int kIsaCount = 3;
inline constexpr const char* kIsaNames[] = {"scalar", "v3", "v4"};

/// Whether this CPU can run it.
bool isa_supported(Isa isa);
/// The widest this CPU can run.
Isa best_isa();
/// "scalar", "v3" or "v4"; anything else is an Error.
Isa parse_isa(const std::string& name);

/// A prepared parameter set: what kernels and the reference read. slots/choices as the descriptor
/// lays them out; table slots point into `tables`.
struct Record {
  std::vector<float> slots;
  std::vector<int32_t> choices;
  std::vector<float> tables;
  std::shared_ptr<const FileTables> file{}; ///< of models with a file; `tables` is empty then

  /// Arguments for kernels running this one record.
  MaterialArgs args(TransportMode mode = TransportMode::radiance) const;
};

/// One pair of directions for the reference functions, double precision.
struct ReferenceQuery {
  Vec3<double> wo, wi;
  TransportMode mode = TransportMode::radiance;
  Vec2<double> uv{0.5, 0.5};
};

/// Two directions in the local frame.
struct DirectionPair {
  Vec3<double> wo, wi;
};

/// value[3], pdf and their derivatives with respect to up to 8 slots.
struct ReferenceJet {
  double value[4];
  double derivative[4][8];
};

/// Value or weight, and density, over colours of six channels.
struct ReferenceWide {
  double color[6];
  double pdf;
};

struct Model {
  Descriptor descriptor;
  /// Record from the values of all declared slots (doubles, derived slots ignored) and choices, and
  /// the names of the parameters that textures give: runs prepare_once.
  Record (*make_record)(const std::vector<double>& slots, const std::vector<int32_t>& choices,
                        const std::vector<std::string>& textured);
  Eval<double> (*eval)(const Record&, const ReferenceQuery&);
  Sample<double> (*sample)(const Record&, const Vec3<double>& wo, const Random<double>&,
                           TransportMode, Vec2<double> uv);
  /// eval at slots + offset (offset may be empty: the record as it is), for central differences.
  Eval<double> (*eval_at)(const Record&, const std::vector<double>& slots, const ReferenceQuery&);
  /// Derivatives with respect to the slots listed in `active` (at most 8; table slots not allowed).
  ReferenceJet (*eval_jet)(const Record&, const std::vector<double>& slots,
                           const std::vector<int>& active, const ReferenceQuery&);
  /// Values for many pairs of directions above the surface at slots (all of a record, in double
  /// precision): values[3 i + c], and d value / d slot active[k] of n as
  /// derivatives[(3 i + c) n + k] unless that is null. Tables stay as the record has them.
  void (*eval_rows)(const Record&, const std::vector<double>& slots, const std::vector<int>& active,
                    std::span<const DirectionPair> rows, double* values, double* derivatives);
  /// eval with colours of six channels, which hold the record's three twice: how the model fares
  /// with another width.
  ReferenceWide (*eval_wide)(const Record&, const ReferenceQuery&);
  /// The weight and density of sample(), all 0 where that fails.
  ReferenceWide (*sample_wide)(const Record&, const Vec3<double>& wo, const Random<double>&);
  std::array<const MaterialKernel*, kIsaCount> kernels{}; ///< null where the CPU cannot run it

  const std::string& name() const { return descriptor.name; }
};

/// All models known to a program.
class Registry {
public:
  /// The built-in models with the kernels of every instruction set this CPU runs. Loaded once.
  /// (Defined in the room materials/.)
  static Registry& global();

  /// Adds models and their kernels from <directory>/<module>_<isa>.so. A name twice is an Error.
  void add(std::vector<Model> models, const std::string& directory, const std::string& module);

  const std::vector<std::unique_ptr<Model>>& models() const { return models_; }
  /// Null if unknown.
  const Model* find(const std::string& name) const;
  /// Throws an Error with a suggestion if unknown.
  const Model& get(const std::string& name) const;
  std::vector<std::string> names() const;
  /// The renderer's kernels of an instruction set (from the built-in module).
  const RenderKernels* render_kernels(Isa isa) const { return render_[static_cast<int>(isa)]; }

private:
  std::vector<std::unique_ptr<Model>> models_;
  std::array<const RenderKernels*, kIsaCount> render_{};
};

/// The folder that holds the modules of the built-in library: $FACETA_MODULE_PATH, else lib/faceta
/// or faceta beside the running library or program.
std::string module_directory();

/// What becomes of a number above a parameter's hard range: an Error, or it is kept as it is. The
/// scene contract keeps a number given for a colour or a texture (a float reflectance of 1.5).
enum class AboveRange { refuse, keep };

/// A model with values for its parameters, by name: what scene files, the command line and tests
/// build, before textures and tables. Errors carry the place given by the caller.
class Parameters {
public:
  explicit Parameters(const Model& model);

  const Model& model() const { return *model_; }
  const Descriptor& descriptor() const { return model_->descriptor; }

  /// Sets one from text as on the command line: a number, "r,g,b", a name (metal, ior, choice,
  /// flag).
  void set(const std::string& name, const std::string& text, const SourcePosition& where = {});
  void set_number(const std::string& name, double value, const SourcePosition& where = {},
                  AboveRange above = AboveRange::refuse);
  void set_color(const std::string& name, const std::array<double, 3>& rgb,
                 const SourcePosition& where = {}, AboveRange above = AboveRange::refuse);
  /// Marks a parameter as given by a texture whose mean is `mean_rgb` (scalars: its mean channel).
  void set_texture(const std::string& name, const std::array<double, 3>& mean_rgb,
                   const SourcePosition& where = {});
  /// Loads the file of a model that has one, unless that was done: an Error here, at its place in
  /// the scene, instead of in record().
  void load_file(const SourcePosition& where = {});
  /// The name of the file; empty if the model has none or it was not given.
  std::string file_name() const;
  /// Exclusive groups ("alpha" beside "alpha_u"; eta without k): an Error naming both.
  void check(const SourcePosition& where = {}) const;

  bool was_set(const std::string& name) const { return set_.count(name) != 0; }
  const std::vector<double>& slots() const { return slots_; }
  const std::vector<int32_t>& choices() const { return choices_; }
  /// Those that were set, with their texts: set() of each makes the same parameters again.
  Settings given() const;
  /// The name a parameter was given by ("Au", "bk7"), empty if by number.
  std::string given_name(const std::string& param) const;
  /// The value as text that set() reads back to the same numbers.
  std::string text(const std::string& param) const;
  /// Error if the file of a model that has one cannot be loaded.
  Record record() const;

private:
  const ParamInfo& info(const std::string& name, const SourcePosition& where) const;
  void check_range(const ParamInfo& p, double value, const SourcePosition& where,
                   AboveRange above = AboveRange::refuse) const;
  void assign(const ParamInfo& p, const std::vector<double>& values);

  const Model* model_;
  std::vector<double> slots_;
  std::vector<int32_t> choices_;
  std::vector<std::string> textured_;
  std::shared_ptr<const FileTables> file_;
  std::map<std::string, std::string> set_; ///< parameters given, with the name they were given by
};

/// A built-in model by name with "key=value" settings. (Defined in the room materials/.)
Parameters make_parameters(const std::string& model, const Settings& settings);

} // namespace faceta
