#include "verify/report_parts.h"

#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>

namespace faceta::report {

using html::element;
using html::escape;

namespace {

const char* class_of(Verdict verdict) {
  const char* names[kVerdictCount] = {"ok", "bad", "exc", "none"};
  return names[static_cast<int>(verdict)];
}

const char* word_of(Verdict verdict) {
  const char* words[kVerdictCount] = {"ok", "FAIL", "excused", "–"};
  return words[static_cast<int>(verdict)];
}

const char* sign_of(Verdict verdict) {
  const char* signs[kVerdictCount] = {"✓", "✗", "e", "–"};
  return signs[static_cast<int>(verdict)];
}

int count_of(const std::vector<PropertyResult>& results, Verdict verdict) {
  int n = 0;
  for (const PropertyResult& r : results)
    n += r.verdict == verdict;
  return n;
}

std::string figure_text(double figure) {
  return std::isfinite(figure) ? fmt::format("{:.4g}", figure) : "not finite";
}

/// A cell of a matrix: a sign, and for those who do not see it, words.
std::string matrix_cell(const std::vector<PropertyResult>& results, const std::string& target) {
  if (results.empty())
    return "<td></td>";
  Verdict verdict = worst(results);
  std::string words = results.size() == 1 ? name_of(verdict) : counts_text(results);
  return fmt::format("<td class=\"{0}\"><a href=\"{1}\" title=\"{2}: {3}\" aria-label=\"{2}: "
                     "{3}\">{4}</a></td>",
                     class_of(verdict), escape(target), escape(results[0].property), escape(words),
                     sign_of(verdict));
}

std::string matrix_head(const std::string& corner, const std::vector<std::string>& names) {
  std::string head = "<thead><tr>" + element("th", corner);
  for (const std::string& name : names)
    head += element("th", name);
  return head + "</tr></thead>\n";
}

} // namespace

std::string verdict_word(Verdict verdict) {
  return element("span", word_of(verdict), class_of(verdict));
}

std::string counts_text(const std::vector<PropertyResult>& results) {
  std::string text;
  for (Verdict v : {Verdict::failed, Verdict::passed, Verdict::excused, Verdict::not_applicable})
    if (int n = count_of(results, v))
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n,
                          v == Verdict::not_applicable ? "not applicable"
                          : v == Verdict::failed       ? "failed"
                                                       : word_of(v));
  return text;
}

Verdict worst(const std::vector<PropertyResult>& results) {
  for (Verdict v : {Verdict::failed, Verdict::excused, Verdict::passed})
    if (count_of(results, v) > 0)
      return v;
  return Verdict::not_applicable;
}

std::vector<ModelGroup> group_by_model(const SuiteReport& report) {
  std::vector<ModelGroup> groups;
  auto group_of = [&](const Descriptor& descriptor) -> ModelGroup& {
    for (ModelGroup& g : groups)
      if (g.descriptor->name == descriptor.name)
        return g;
    return groups.emplace_back(ModelGroup{&descriptor, nullptr, {}});
  };
  for (const ModelReport& m : report.models)
    group_of(m.model->descriptor).report = &m;
  for (size_t i = 0; i < report.subjects.size(); ++i)
    group_of(report.subjects[i].subject.subject.descriptor()).subjects.push_back(i);
  return groups;
}

std::vector<std::string> subject_ids(const SuiteReport& report) {
  std::vector<std::string> ids;
  std::set<std::string> used;
  for (const SubjectReport& s : report.subjects) {
    std::string id = "s-" + html::slug(s.subject.name), unique = id;
    for (int n = 2; !used.insert(unique).second; ++n)
      unique = fmt::format("{}-{}", id, n);
    ids.push_back(unique);
  }
  return ids;
}

std::string model_matrix(const SuiteReport& report, const std::vector<ModelGroup>& groups,
                         const std::function<std::string(const ModelGroup&)>& target) {
  std::vector<std::string> names;
  for (const Property* p : report.properties)
    names.emplace_back(p->name);
  size_t own = report.models.empty() ? 0 : report.model_properties.size();
  for (size_t p = 0; p < own; ++p)
    names.emplace_back(report.model_properties[p]->name);
  std::string table = "<table class=\"matrix\">" + matrix_head("model", names) + "<tbody>\n";
  for (const ModelGroup& g : groups) {
    std::string to = target(g);
    table += "<tr><th scope=\"row\">" + html::link(to, g.descriptor->name) +
             fmt::format(" <small>{}</small></th>", g.subjects.size());
    for (size_t p = 0; p < report.properties.size(); ++p) {
      std::vector<PropertyResult> results;
      for (size_t i : g.subjects)
        results.push_back(report.subjects[i].results[p]);
      table += matrix_cell(results, to);
    }
    for (size_t p = 0; p < own; ++p)
      table += matrix_cell(
          g.report ? std::vector{g.report->results[p]} : std::vector<PropertyResult>{}, to);
    table += "</tr>\n";
  }
  return html::scrolling(table + "</tbody></table>");
}

std::string subject_matrix(const SuiteReport& report, const ModelGroup& group,
                           const std::vector<std::string>& ids, const std::string& page) {
  std::vector<std::string> names;
  for (const Property* p : report.properties)
    names.emplace_back(p->name);
  std::string table = "<table class=\"matrix\">" + matrix_head("subject", names) + "<tbody>\n";
  for (size_t i : group.subjects) {
    const SubjectReport& s = report.subjects[i];
    std::string name = s.subject.exemplar.empty() ? s.subject.name : s.subject.exemplar;
    table += "<tr><th scope=\"row\">" + html::link(page + "#" + ids[i], name) + "</th>";
    for (const PropertyResult& r : s.results)
      table += matrix_cell({r}, page + "#" + ids[i]);
    table += "</tr>\n";
  }
  return html::scrolling(table + "</tbody></table>");
}

std::string matrix_legend() {
  std::string text;
  const char* meanings[kVerdictCount] = {"holds", "fails",
                                         "does not hold, and the model says so with its reason",
                                         "there is nothing to prove"};
  for (int v = 0; v < kVerdictCount; ++v)
    text += fmt::format("{}<span class=\"{}\">{}</span> {}", v ? " · " : "",
                        class_of(static_cast<Verdict>(v)), sign_of(static_cast<Verdict>(v)),
                        meanings[v]);
  return "<p><small>" + text + ".</small></p>\n";
}

namespace {

std::string property_row(const char* name, const char* claim, const char* figure,
                         const PropertyResult& r) {
  std::string row = "<tr><td>" + element("b", name) + " <small>" + escape(claim) + "</small>";
  if (r.verdict == Verdict::failed)
    row += "<br>" + element("span", r.text, "bad");
  else if (!r.text.empty())
    row += "<br><small>" + escape(r.text) + "</small>";
  if (r.verdict == Verdict::excused)
    row += "<br><small>Excused: " + escape(r.reason) + " (" + escape(r.reference) + ")</small>";
  row += "</td><td>" + verdict_word(r.verdict) + "</td><td class=\"n\">";
  if (figure[0] != '\0' && r.verdict != Verdict::not_applicable)
    row += escape(figure_text(r.figure));
  return row + "</td></tr>\n";
}

constexpr const char* kPropertyHead = "<table><thead><tr><th>property</th><th>verdict</th>"
                                      "<th class=\"n\">figure</th></tr></thead><tbody>\n";

} // namespace

std::string property_table(const std::vector<const Property*>& properties,
                           const std::vector<PropertyResult>& results) {
  std::string table = kPropertyHead;
  for (size_t i = 0; i < results.size(); ++i)
    table +=
        property_row(properties[i]->name, properties[i]->claim, properties[i]->figure, results[i]);
  return html::scrolling(table + "</tbody></table>");
}

std::string property_table(const std::vector<const ModelProperty*>& properties,
                           const std::vector<PropertyResult>& results) {
  std::string table = kPropertyHead;
  for (size_t i = 0; i < results.size(); ++i)
    table += property_row(properties[i]->name, properties[i]->claim, "", results[i]);
  return html::scrolling(table + "</tbody></table>");
}

namespace {

std::string settings_line(const SuiteSubject& s) {
  std::string text;
  for (const auto& [name, value] : s.subject.given())
    text += element("code", name + "=" + value) + " ";
  if (s.subject.tree)
    text = element("code", s.subject.tree->text()) + " ";
  if (text.empty())
    text = "Default parameters. ";
  if (s.subject.lossless)
    text += "Claims to lose nothing. ";
  if (!s.where.empty())
    text += "From " + element("code", s.where) + ".";
  return "<p class=\"settings\">" + text + "</p>\n";
}

std::string sampling_table(const std::vector<SamplingFigure>& figures) {
  std::string table = "<table><thead><tr><th>viewer</th><th class=\"n\">mean weight</th>"
                      "<th class=\"n\">its variation</th></tr></thead><tbody>\n";
  for (const SamplingFigure& f : figures)
    table += fmt::format("<tr><td>{:.0f}°</td><td class=\"n\">{:.4f}</td><td class=\"n\">{}</td>"
                         "</tr>\n",
                         f.theta, f.mean,
                         std::isnan(f.variation) ? "–" : fmt::format("{:.3f}", f.variation));
  return html::scrolling(table + "</tbody></table>");
}

} // namespace

std::string subject_card(const SuiteReport& report, size_t subject, const std::string& id,
                         const SubjectPlots* plots, bool open) {
  const SubjectReport& s = report.subjects[subject];
  std::string card = fmt::format("<details id=\"{}\"{}>\n<summary>", id, open ? " open" : "") +
                     element("b", s.subject.name) +
                     element("span", counts_text(s.results), class_of(worst(s.results))) +
                     "</summary>\n";
  card += "<div class=\"inside\">\n" + settings_line(s.subject);
  card += "<div class=\"tables\">\n" + property_table(report.properties, s.results);
  if (plots)
    card += sampling_table(plots->sampling);
  card += "</div>\n";
  if (plots) {
    card += "<div class=\"plots\">\n";
    for (size_t i = 0; i < plots->drawings.size(); ++i)
      card += "<figure class=\"plot\">" +
              to_svg(plots->drawings[i], fmt::format("{}_{}", id, i), PlotTheme::page) +
              "</figure>\n";
    card += "</div>\n";
  }
  return card + "</div>\n</details>\n";
}

} // namespace faceta::report
