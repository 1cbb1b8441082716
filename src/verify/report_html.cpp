#include "verify/report_html.h"

#include "verify/report_parts.h"

#include <fmt/format.h>

namespace faceta {

namespace {

using html::element;
using html::escape;
using namespace report;

/// So few subjects stand open.
constexpr size_t kFew = 2;

std::string target_of(const ModelGroup& group) {
  return "#model-" + html::slug(group.descriptor->name);
}

std::string headline(const SuiteReport& report) {
  size_t total = 0;
  for (int v = 0; v < kVerdictCount; ++v)
    total += report.count(static_cast<Verdict>(v));
  auto count = [&](Verdict v) { return report.count(v); };
  std::string verdict =
      report.passed()
          ? element("b", "Nothing failed.", "ok")
          : element("b", fmt::format("{} of {} checks failed.", count(Verdict::failed), total),
                    "bad");
  return "<p class=\"lead\">" + verdict +
         fmt::format(" {} subject{}, {} checks: {} passed, {} failed, {} excused, {} not "
                     "applicable.</p>\n",
                     report.subjects.size(), report.subjects.size() == 1 ? "" : "s", total,
                     count(Verdict::passed), count(Verdict::failed), count(Verdict::excused),
                     count(Verdict::not_applicable));
}

std::string facts(const SuiteReport& report, const PageOptions& options) {
  std::string list = "<dl class=\"facts\">\n";
  auto add = [&](const char* name, const std::string& value) {
    list += element("dt", name) + element("dd", value) + "\n";
  };
  add("version", "faceta " + options.version);
  add("effort", report.effort == Effort::full ? "full" : "fast");
  add("seed", std::to_string(report.seed));
  if (options.of_this_run)
    add("instruction set", kIsaNames[static_cast<int>(best_isa())]);
  add("chance of a false alarm", false_alarm_text(report));
  if (options.of_this_run)
    add("time", fmt::format("{:.1f} s", report.seconds));
  return list + "</dl>\n";
}

std::string remarks(const SuiteReport& report, const std::vector<std::string>& ids) {
  std::string text, failures = failure_list(report, ids), excuses = excuse_table(report);
  if (!failures.empty())
    text += "<h2>What failed</h2>\n" + failures;
  if (!excuses.empty())
    text += "<h2>What is excused</h2>\n<p>The model itself names the property that it breaks, the "
            "reason and who says so. Figures stand behind the subjects.</p>\n" +
            excuses;
  if (!report.notes.empty()) {
    text += "<h2>Notes</h2>\n<ul>\n";
    for (const std::string& note : report.notes)
      text += element("li", note) + "\n";
    text += "</ul>\n";
  }
  return text;
}

std::string model_section(const SuiteReport& report, const ModelGroup& group,
                          const std::vector<std::string>& ids,
                          const std::vector<SubjectPlots>& plots) {
  const Descriptor& d = *group.descriptor;
  std::string text = "<section class=\"model\">\n<h2 id=\"" + target_of(group).substr(1) + "\">" +
                     escape(d.name) + ": " + escape(d.title) + "</h2>\n" +
                     element("pre", d.equation) + "\n";
  for (const std::string& reference : d.references)
    text += "<p><small>" + escape(reference) + "</small></p>\n";
  if (group.report && !report.model_properties.empty())
    text += property_table(report.model_properties, group.report->results);
  if (report.properties.empty())
    return text + "</section>\n";
  if (group.subjects.size() > 1)
    text += subject_matrix(report, group, ids);
  for (size_t i : group.subjects) {
    bool open =
        report.subjects.size() <= kFew || worst(report.subjects[i].results) == Verdict::failed;
    text += subject_card(report, i, ids[i], plots.empty() ? nullptr : &plots[i], open);
  }
  return text + "</section>\n";
}

} // namespace

std::string suite_html(const SuiteReport& report, const std::vector<SubjectPlots>& plots,
                       const PageOptions& options) {
  std::vector<ModelGroup> groups = group_by_model(report);
  std::vector<std::string> ids = subject_ids(report);
  std::string body =
      "<h1>Faceta: report card</h1>\n" + headline(report) + facts(report, options) + options.remark;
  body += "<h2>Models and properties</h2>\n" + model_matrix(report, groups, target_of) +
          matrix_legend() + remarks(report, ids);
  body += "<h2>How to read this</h2>\n<details>\n<summary>The properties</summary>\n"
          "<div class=\"inside\">\n" +
          property_list(report) + "</div>\n</details>\n";
  if (!plots.empty())
    body += "<details>\n<summary>The plots</summary>\n<div class=\"inside\">\n" + plot_help_list() +
            "</div>\n</details>\n";
  if (report.subjects.size() > kFew)
    body += "<p class=\"screen\"><button hidden data-open=\"1\">Open all</button><button hidden "
            "data-open=\"0\">Close all</button></p>\n";
  for (const ModelGroup& group : groups)
    body += model_section(report, group, ids, plots);
  return html::page("Faceta: report card", body);
}

} // namespace faceta
