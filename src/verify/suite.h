#pragma once

/// The verification suite: every property of every subject, run in parallel. `faceta verify` runs
/// it; the contract tests take its levels and verdicts.

#include "verify/properties.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace faceta {

/// The chance that anything in a whole suite fails although all is right.
inline constexpr double kFamilyLevel = 1e-4;

/// Level of one statistical test in a suite of so many subjects, so that all of them together err
/// with probability `family` (Sidak). Never fewer tests are counted than are made.
double suite_level(size_t subjects, Effort effort, double family = kFamilyLevel);

/// Of subjects and of models.
std::vector<std::string> property_names();

/// What became of one property of one subject.
enum class Verdict {
  passed,
  failed,
  excused,       ///< does not hold, as the model's traits say, with the reason
  not_applicable ///< there is nothing to prove; the text says why
};
inline constexpr int kVerdictCount = 4;
/// "passed", "failed", "excused", "not applicable".
const char* name_of(Verdict verdict);

/// The verdict on an outcome: a failure of what the model excuses is excused.
Verdict judge(const Outcome& outcome, const Descriptor& descriptor, const std::string& property);

struct PropertyResult {
  std::string property;
  Verdict verdict = Verdict::passed;
  double figure = 0; ///< the property's own measure (see properties.h); 0 if it has none
  std::string text;  ///< what failed and where, what was measured, why there is nothing to prove
  std::string reason, reference; ///< of an excuse
  double seconds = 0;            ///< of one thread
};

/// Where a subject comes from.
enum class Origin { exemplar, settings, scene };
/// "exemplar", "settings", "scene".
const char* name_of(Origin origin);

/// A model with parameters, and how reports call it.
struct SuiteSubject {
  std::string name; ///< "roughconductor/gold", "roughconductor alpha=0.2", the id in a scene
  Origin origin = Origin::settings;
  Subject subject;
  std::string exemplar;     ///< its name, if it is one
  std::string where;        ///< file:line:column, if it comes from a scene
  std::vector<Excuse> idle; ///< properties that cannot be asked of it, with the reason
};

/// Exemplars of a model as subjects.
std::vector<SuiteSubject> exemplar_subjects(const Model& model);
/// A tree with a node of scene files at the root.
SuiteSubject tree_subject(const SceneNode& node, const std::string& exemplar,
                          const MaterialNode& root);
/// A model with parameters given by name, named by them: "phong exponent=20".
SuiteSubject settings_subject(const Model& model, const Settings& settings);

/// How far a running suite is.
struct SuiteProgress {
  size_t done = 0, total = 0; ///< checks
  double seconds = 0;
  std::string name; ///< the check that ended last: "roughconductor/gold chi2"
};

struct SuiteOptions {
  Effort effort = Effort::quick;
  double family_level = kFamilyLevel;
  uint64_t seed = 0;
  std::vector<std::string> only; ///< names of properties; empty: all
  /// Called after each check, by one thread at a time; may be empty.
  std::function<void(const SuiteProgress&)> progress;
};

struct SubjectReport {
  SuiteSubject subject;
  std::vector<PropertyResult> results; ///< as in SuiteReport::properties
};

struct ModelReport {
  const Model* model;
  std::vector<PropertyResult> results; ///< as in SuiteReport::model_properties
};

struct SuiteReport {
  Effort effort = Effort::quick;
  double family_level = 0, test_level = 0;
  uint64_t seed = 0;
  double seconds = 0; ///< wall clock
  std::vector<const Property*> properties;
  std::vector<const ModelProperty*> model_properties;
  std::vector<ModelReport> models;
  std::vector<SubjectReport> subjects;
  std::vector<std::string> notes; ///< what could not be verified, or not as it is; a line each

  /// How many results of models and subjects have a verdict.
  size_t count(Verdict verdict) const;
  bool passed() const { return count(Verdict::failed) == 0; }
};

/// Asks every property of every subject, and the models' own properties of `models`. The results
/// are the same whatever the number of threads. A property that ends in an exception has failed.
/// @throws Error if `only` names what is no property, or if there is nothing to ask.
SuiteReport run_suite(const std::vector<SuiteSubject>& subjects,
                      const std::vector<const Model*>& models, const SuiteOptions& options);

} // namespace faceta
