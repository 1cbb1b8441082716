#pragma once

/// The sub-commands: each takes its parsed arguments, writes data to the standard output and
/// messages to the standard error, and returns an exit code. Bad input is an Error.

#include "bsdf/registry.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace faceta::cli {

/// Exit codes of the program.
enum ExitCode : int {
  kOk = 0,
  kCheckFailed = 1, ///< a comparison or a property says no
  kUsage = 2,       ///< arguments that make no sense
  kInputError = 3   ///< bad input, failed reading or writing
};

struct MaterialsOptions {
  std::string name; ///< empty: all
  bool markdown = false, json = false;
};
int run_materials(const MaterialsOptions& options);

/// `eval` and `sample`.
struct TableOptions {
  bool sample = false;
  std::string material; ///< empty: `id` of `scene`
  Settings settings;    ///< of `material`
  std::string scene, id;
  Settings defines; ///< of `scene`
  std::string input = "-", output = "-";
  TransportMode mode = TransportMode::radiance;
  std::optional<Isa> isa; ///< nothing: the best
};
int run_table(const TableOptions& options);

struct DiffOptions {
  std::string image, reference;
  std::string variance; ///< of one sample, of Mitsuba's kind; empty: no z-test
  std::optional<double> spp, reference_spp;
  std::string image_variance, reference_variance; ///< of the means; empty: no two-sample test
  double quantisation = 1.41e-4;                  ///< relative rounding error of the values
  bool json = false;
};
int run_diff(const DiffOptions& options);

struct InfoOptions {
  std::vector<std::string> files; ///< images, and scenes (.xml)
  Settings defines;               ///< of scenes
  bool cpu = false, json = false;
};
int run_info(const InfoOptions& options);

/// A material with settings, or a scene file.
struct VerifyTarget {
  std::string name;
  bool scene = false;
  Settings settings;
};
struct VerifyOptions {
  std::vector<VerifyTarget> targets; ///< empty: every registered model
  Settings defines;                  ///< of scenes
  bool full = false;
  uint64_t seed = 0;
  std::vector<std::string> only; ///< properties; empty: all
  std::string json, html;        ///< files, or - for the standard output; empty: none
  bool list = false, quiet = false;
};
int run_verify(const VerifyOptions& options);

struct EfficiencyOptions {
  std::vector<VerifyTarget> targets; ///< no scenes; empty: every registered model
  int samples = 1 << 17;
  uint64_t seed = 0;
  std::string json; ///< file, or - for the standard output; empty: none
};
int run_efficiency(const EfficiencyOptions& options);

struct DocsOptions {
  std::string folder;
  bool check = false; ///< compare what is there instead of writing
  bool quiet = false;
};
int run_docs(const DocsOptions& options);

} // namespace faceta::cli
