#include "cli/commands.h"
#include "cli/exemplars.h"
#include "cli/suite_progress.h"
#include "formats/measured_loader.h"
#include "formats/mitsuba_scene.h"
#include "formats/output_file.h"
#include "verify/report_html.h"
#include "verify/suite_report.h"
#include "verify/suite_scene.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <unistd.h>

namespace faceta::cli {

namespace {

struct Subjects {
  std::vector<SuiteSubject> subjects;
  std::vector<const Model*> models; ///< asked as a whole
  std::vector<const SceneNode*> nodes;
  std::vector<std::string> notes;

  void add_node(const SceneNode& node) {
    if (std::find(nodes.begin(), nodes.end(), &node) != nodes.end())
      return;
    nodes.push_back(&node);
    for (SuiteSubject& s : node_subjects(node))
      subjects.push_back(std::move(s));
  }
  void add_model(const Model& model) {
    if (std::find(models.begin(), models.end(), &model) != models.end())
      return;
    models.push_back(&model);
    for (SuiteSubject& s : exemplar_subjects(model))
      subjects.push_back(std::move(s));
  }
};

void add_target(const VerifyTarget& target, const Settings& defines, Subjects& all) {
  if (target.scene) {
    ReadOptions options;
    options.defines = defines;
    options.warn = [&](const std::string& text) { all.notes.push_back(text); };
    Scene scene;
    add_scene_subjects(read_mitsuba_materials(target.name, scene, options), scene, all.subjects,
                       all.notes);
    return;
  }
  if (const SceneNode* node = find_scene_node(target.name)) {
    if (!target.settings.empty())
      throw Error("'" + target.name + "' puts materials of a scene file together", {},
                  "verify the scene file, or '" + target.name + "' without settings");
    all.add_node(*node);
    return;
  }
  NamedModel named = model_or_file(target.name, target.settings);
  if (named.settings.empty())
    all.add_model(*named.model);
  else
    all.subjects.push_back(settings_subject(*named.model, named.settings));
}

Subjects choose_subjects(const VerifyOptions& options) {
  Subjects all;
  for (const VerifyTarget& target : options.targets)
    add_target(target, options.defines, all);
  if (!options.targets.empty())
    return all;
  for (const auto& model : Registry::global().models())
    all.add_model(*model);
  for (const SceneNode& node : scene_nodes())
    all.add_node(node);
  return all;
}

std::vector<SubjectPlots> draw_plots(const SuiteReport& report, bool quiet) {
  if (report.properties.empty())
    return {};
  SuiteProgressLine line(quiet, "plots");
  return draw_subject_plots(report.subjects, [&](const SuiteProgress& p) { line.update(p); });
}

} // namespace

int run_verify(const VerifyOptions& options) {
  if (options.list) {
    std::fputs(list_properties().c_str(), stdout);
    return kOk;
  }
  add_round_trips();
  Subjects all = choose_subjects(options);
  SuiteOptions suite;
  suite.effort = options.full ? Effort::full : Effort::quick;
  suite.seed = options.seed;
  suite.only = options.only;
  std::optional<OutputFile> json, page; // opened before the work: a bad name shows at once
  if (!options.json.empty())
    json.emplace(options.json);
  if (!options.html.empty())
    page.emplace(options.html);
  SuiteReport report;
  {
    SuiteProgressLine line(options.quiet);
    suite.progress = [&](const SuiteProgress& p) { line.update(p); };
    report = run_suite(all.subjects, all.models, suite);
  }
  report.notes = all.notes;
  if (json) {
    json->write(suite_json(report, FACETA_VERSION));
    json->commit();
  }
  if (page) {
    page->write(suite_html(report, draw_plots(report, options.quiet), {FACETA_VERSION}));
    page->commit();
  }
  if (options.json != "-" && options.html != "-") {
    bool colour = isatty(STDOUT_FILENO) && !std::getenv("NO_COLOR");
    std::fputs(suite_text(report, colour).c_str(), stdout);
  }
  return report.passed() ? kOk : kCheckFailed;
}

} // namespace faceta::cli
