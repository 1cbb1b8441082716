#pragma once

/// Pieces of HTML that report and documentation are put together from. All texts are escaped.

#include "verify/html.h"
#include "verify/subject_plots.h"
#include "verify/suite.h"

namespace faceta::report {

/// "ok", "FAIL", "excused", "–" in their colours.
std::string verdict_word(Verdict verdict);
/// "12 ok, 1 excused".
std::string counts_text(const std::vector<PropertyResult>& results);
/// The verdict that speaks for all: failed, else excused, else passed, else not applicable.
Verdict worst(const std::vector<PropertyResult>& results);

/// Indices of the subjects of each model or node, in the order in which those first come.
struct ModelGroup {
  const Descriptor* descriptor;
  const ModelReport* report = nullptr; ///< if it was asked as a whole
  std::vector<size_t> subjects;
};
std::vector<ModelGroup> group_by_model(const SuiteReport& report);

/// Ids of the subjects in a page, each unlike the others: "s-roughconductor-gold".
std::vector<std::string> subject_ids(const SuiteReport& report);

/// Models by properties; rows and cells lead where `target` says.
std::string model_matrix(const SuiteReport& report, const std::vector<ModelGroup>& groups,
                         const std::function<std::string(const ModelGroup&)>& target);
/// Subjects of a model by properties. `page` stands before "#id" in the links: empty within one
/// page.
std::string subject_matrix(const SuiteReport& report, const ModelGroup& group,
                           const std::vector<std::string>& ids, const std::string& page = {});
/// What the signs of a matrix mean.
std::string matrix_legend();

/// Property, claim, verdict, figure, and in words what failed or why there is nothing to prove.
std::string property_table(const std::vector<const Property*>& properties,
                           const std::vector<PropertyResult>& results);
std::string property_table(const std::vector<const ModelProperty*>& properties,
                           const std::vector<PropertyResult>& results);

/// A folded part with everything about a subject. `plots` may be null.
std::string subject_card(const SuiteReport& report, size_t subject, const std::string& id,
                         const SubjectPlots* plots, bool open);

/// How to read the plots: a list.
std::string plot_help_list();
/// Every property asked, its claim and what its figure is.
std::string property_list(const SuiteReport& report);
/// Model, property, subjects with figures, reason and reference; empty if nothing is excused.
std::string excuse_table(const SuiteReport& report);
/// What failed, where, with links to the subjects; empty if nothing did.
std::string failure_list(const SuiteReport& report, const std::vector<std::string>& ids);
/// "in 83 subjects and 13 models, ..., the chance that a sound suite fails is ...": a sentence.
std::string false_alarm_text(const SuiteReport& report);

} // namespace faceta::report
