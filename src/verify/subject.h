#pragma once

/// What a property is proved of: a model with values for its parameters, or a tree of such
/// materials.

#include "verify/material_tree.h"

#include <optional>
#include <string>
#include <vector>

namespace faceta {

/// How much work a verdict may cost: quick for every build, full for continuous integration.
enum class Effort { quick, full };

/// The verdict on one property.
struct Outcome {
  bool passed = true;
  std::string message;    ///< what failed and where; or what was measured
  double figure = 0;      ///< the property's own measure: smallest p-value, largest error, ...
  bool applicable = true; ///< false: there is nothing to prove, `message` says why

  bool excusable = true; ///< false: a failure worse than the model's excuse admits

  /// Records a failure; only the first one keeps its words.
  void fail(const std::string& text) {
    if (passed)
      message = text;
    passed = false;
  }
  /// The same for one that no excuse covers; its words replace those of others.
  void fail_beyond_excuse(const std::string& text) {
    if (excusable)
      message = text;
    passed = excusable = false;
  }
};

struct Subject {
  const Model* model = nullptr;         ///< null: a tree
  std::optional<Parameters> parameters; ///< of the model
  Record record;                        ///< of the model
  std::shared_ptr<const MaterialTree> tree;
  bool lossless = false;
  uint64_t seed = 0; ///< what all random numbers of the properties come from

  Subject(const Model& m, const Parameters& p, bool loses_nothing = false);
  /// An exemplar of the model's own.
  Subject(const Model& m, const Exemplar& exemplar);
  explicit Subject(std::shared_ptr<const MaterialTree> t) : tree(std::move(t)) {}

  const Descriptor& descriptor() const { return tree ? tree->descriptor() : model->descriptor; }
  const Traits& traits() const { return descriptor().traits; }
  /// Runs the kernel of an instruction set, as a rule the widest here.
  void run(EvalBatch& batch, TransportMode mode, Isa isa = best_isa()) const;
  void run(SampleBatch& batch, TransportMode mode, Isa isa = best_isa()) const;
  /// The parameters that the model was given.
  Settings given() const { return parameters ? parameters->given() : Settings{}; }
  /// A kernel of the model.
  const MaterialKernel& kernel(Isa isa) const { return *model->kernels[static_cast<int>(isa)]; }
  bool transmissive() const { return (traits().lobes & kTransmission) != 0; }

  /// Seed of the random numbers for one purpose.
  uint64_t stream(uint64_t purpose) const { return purpose + seed * 0x9e3779b97f4a7c15ull; }

  Eval<double> reference(const Vec3<double>& wo, const Vec3<double>& wi,
                         TransportMode mode = TransportMode::radiance) const {
    return tree ? tree->reference({wo, wi, mode}) : model->eval(record, {wo, wi, mode});
  }
  Sample<double> reference_sample(const Vec3<double>& wo, const Random<double>& random,
                                  TransportMode mode) const;
  /// All numbers that the reference reads, and which of them are parameters.
  std::vector<double> numbers() const;
  std::vector<int> parameter_numbers() const;
  /// The reference with other numbers.
  Eval<double> reference_at(const std::vector<double>& numbers, const ReferenceQuery& query) const;
};

/// Whether turning both directions about the normal changes a value (beyond rounding).
bool is_anisotropic(const Subject& subject);

/// Directions towards the viewer: 0, 30, 60, 80, 89 degrees; from below as well if the model
/// scatters there; one azimuth, three for anisotropic models (full effort: more of each).
std::vector<Vec3<float>> viewers(const Subject& subject, Effort effort);
/// Never fewer than viewers() returns, whatever the subject; for correcting a level.
int most_viewers(Effort effort);

/// Directions near which a density may have a narrow peak for this viewer.
std::vector<Vec3<double>> peak_hints(const Subject& subject, const Vec3<double>& wo);

/// "(x, y, z)" with enough digits to read the float back.
std::string to_text(const Vec3<float>& v);

/// How far a change of one unit in the last place of any component of wo or wi, or of any
/// parameter, moves the reference: the largest change, for each of the three values and the
/// density.
struct Sensitivity {
  Eval<double> center;
  double change[4] = {0, 0, 0, 0};
};
Sensitivity ulp_sensitivity(const Subject& subject, const Vec3<float>& wo, const Vec3<float>& wi,
                            TransportMode mode);

} // namespace faceta
