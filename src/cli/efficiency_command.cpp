#include "cli/commands.h"
#include "formats/material_docs.h"
#include "formats/measured_loader.h"
#include "formats/output_file.h"
#include "verify/efficiency.h"

#include <cstdio>

namespace faceta::cli {

namespace {

std::vector<SuiteSubject> choose_subjects(const std::vector<VerifyTarget>& targets) {
  std::vector<SuiteSubject> subjects;
  auto add_model = [&](const Model& model) {
    for (SuiteSubject& s : exemplar_subjects(model))
      subjects.push_back(std::move(s));
  };
  for (const VerifyTarget& target : targets) {
    if (target.scene || find_scene_node(target.name))
      throw Error("'" + target.name + "' is no single model", {},
                  "give the models in it, with their parameters");
    NamedModel named = model_or_file(target.name, target.settings);
    if (named.settings.empty())
      add_model(*named.model);
    else
      subjects.push_back(settings_subject(*named.model, named.settings));
  }
  if (targets.empty())
    for (const auto& model : Registry::global().models())
      add_model(*model);
  return subjects;
}

} // namespace

int run_efficiency(const EfficiencyOptions& options) {
  std::optional<OutputFile> file; // opened before the work: a bad name shows at once
  std::vector<SuiteSubject> subjects = choose_subjects(options.targets);
  if (!options.json.empty())
    file.emplace(options.json);
  EfficiencyReport report = study_efficiencies(subjects, options.samples, options.seed);
  if (file) {
    file->write(efficiency_json(report, FACETA_VERSION));
    file->commit();
  }
  if (options.json != "-")
    std::fputs(efficiency_text(report).c_str(), stdout);
  return kOk;
}

} // namespace faceta::cli
