#include "verify/report_parts.h"

#include <fmt/format.h>
#include <map>

namespace faceta::report {

using html::element;
using html::escape;

std::string plot_help_list() {
  std::string text = "<dl>\n";
  for (const PlotHelp& h : plot_help())
    text += "<dt>" + element("b", h.heading) + "</dt>" + element("dd", h.text) + "\n";
  return text + "</dl>\n";
}

std::string property_list(const SuiteReport& report) {
  std::string table =
      "<table><thead><tr><th>property</th><th>claim</th><th>figure</th></tr></thead>"
      "<tbody>\n";
  auto add = [&](const char* name, const char* claim, const char* figure) {
    table += "<tr><td>" + element("b", name) + "</td>" + element("td", claim) +
             element("td", figure) + "</tr>\n";
  };
  for (const Property* p : report.properties)
    add(p->name, p->claim, p->figure);
  for (const ModelProperty* p : report.model_properties)
    if (!report.models.empty())
      add(p->name, p->claim, "");
  return html::scrolling(table + "</tbody></table>");
}

std::string excuse_table(const SuiteReport& report) {
  struct Entry {
    const PropertyResult* first = nullptr;
    std::string subjects;
  };
  std::map<std::pair<std::string, std::string>, Entry> entries;
  auto add = [&](const std::string& name, const Descriptor& descriptor, const PropertyResult& r) {
    if (r.verdict != Verdict::excused)
      return;
    Entry& e = entries[{descriptor.name, r.property}];
    e.first = &r;
    e.subjects += fmt::format("{}{} ({:.4g})", e.subjects.empty() ? "" : ", ", name, r.figure);
  };
  for (const ModelReport& m : report.models)
    for (const PropertyResult& r : m.results)
      add(m.model->name(), m.model->descriptor, r);
  for (const SubjectReport& s : report.subjects)
    for (const PropertyResult& r : s.results)
      add(s.subject.name, s.subject.subject.descriptor(), r);
  if (entries.empty())
    return {};
  std::string table = "<table><thead><tr><th>property</th><th>of</th><th>reason</th>"
                      "<th>reference</th></tr></thead><tbody>\n";
  for (const auto& [key, e] : entries)
    table += "<tr>" + element("td", key.second) + element("td", e.subjects) +
             element("td", e.first->reason) + element("td", e.first->reference) + "</tr>\n";
  return html::scrolling(table + "</tbody></table>");
}

std::string failure_list(const SuiteReport& report, const std::vector<std::string>& ids) {
  std::string text;
  auto add = [&](const std::string& name, const std::string& target, const char* claim,
                 const PropertyResult& r) {
    if (r.verdict == Verdict::failed)
      text += "<div class=\"trouble\"><p>" + html::link(target, name) + " " +
              element("b", r.property, "bad") + " <small>" + escape(claim) + "</small></p>" +
              element("p", r.text) + "</div>\n";
  };
  for (const ModelReport& m : report.models)
    for (size_t i = 0; i < m.results.size(); ++i)
      add(m.model->name(), "#model-" + html::slug(m.model->name()),
          report.model_properties[i]->claim, m.results[i]);
  for (size_t s = 0; s < report.subjects.size(); ++s)
    for (size_t i = 0; i < report.subjects[s].results.size(); ++i)
      add(report.subjects[s].subject.name, "#" + ids[s], report.properties[i]->claim,
          report.subjects[s].results[i]);
  return text;
}

std::string false_alarm_text(const SuiteReport& report) {
  return fmt::format("{:g} in the whole suite, {:.2g} in each of its statistical tests (Šidák): of "
                     "{:.0f} runs of sound materials with seeds of their own, one would fail by "
                     "chance",
                     report.family_level, report.test_level, 1 / report.family_level);
}

} // namespace faceta::report
