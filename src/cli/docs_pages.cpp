#include "cli/docs_pages.h"

#include "cli/exemplars.h"
#include "formats/material_docs.h"
#include "verify/plot_data.h"
#include "verify/report_html.h"
#include "verify/report_parts.h"

#include <cmath>
#include <fmt/format.h>

namespace faceta::cli {

namespace {

using html::element;
using html::escape;
using html::link;

std::string measured(const std::string& text) {
  return std::string(kMeasuredBegin) + text + kMeasuredEnd + "\n";
}

std::string list(const char* heading, const std::vector<std::string>& lines) {
  if (lines.empty())
    return {};
  std::string text = element("h2", heading) + "\n<ul>\n";
  for (const std::string& line : lines)
    text += element("li", line) + "\n";
  return text + "</ul>\n";
}

std::string picture(const DocsPicture& p, const std::string& folder) {
  return fmt::format("<figure><img src=\"{}pictures/{}\" alt=\"{}\" width=\"176\" height=\"176\">"
                     "<figcaption>{}<br><small>{}</small></figcaption></figure>\n",
                     folder, escape(p.file), escape("An object of " + p.title), escape(p.title),
                     escape(p.label));
}

std::string parameters(const Descriptor& d) {
  if (d.params.empty())
    return {};
  std::string table = "<h2>Parameters</h2>\n", body;
  bool head = true;
  // Where it is narrow, each row becomes a block with the headings in front of its cells.
  const auto rows = parameter_table(d);
  for (const auto& row : rows) {
    std::string cells;
    for (size_t i = 0; i < row.size(); ++i)
      cells += head     ? element("th", row[i])
               : i == 0 ? "<td>" + element("code", row[i]) + "</td>"
               : row[i].empty()
                   ? "<td></td>"
                   : fmt::format("<td data-label=\"{}\">{}</td>", rows[0][i], escape(row[i]));
    body += head ? "<table class=\"stack\"><thead><tr>" + cells + "</tr></thead><tbody>\n"
                 : "<tr>" + cells + "</tr>\n";
    head = false;
  }
  return table + html::scrolling(body + "</tbody></table>");
}

std::string exceptions(const Descriptor& d) {
  std::vector<std::string> lines;
  for (const Excuse& e : d.excuses)
    lines.push_back(e.property + ": " + e.reason + " (" + e.reference + ")");
  return list("Known exceptions", lines);
}

/// A few numbers that tell whether a parameter set still does what was measured.
std::string values(const SuiteSubject& s) {
  std::string text = kValuesBegin + escape(s.name);
  std::vector<double> thetas = {0, 30, 60, 80};
  if (s.subject.traits().two_sided)
    thetas.push_back(150);
  for (double theta : thetas) {
    Vec3<double> wo = plot_viewer(theta, 20);
    WeightStudy study = study_weights(s.subject, wo, PlotChannel::luminance, 4096, 1);
    double sum = 0, densities = 0;
    for (int i = 0; i < 36; ++i) {
      Eval<double> e = s.subject.reference(wo, plane_direction(0.17 * (i - 17.6), 20 + 7 * i));
      sum += (1 + 0.1 * i) * channel_of(e.value, PlotChannel::luminance);
      densities += (1 + 0.1 * i) * e.pdf;
    }
    text += fmt::format(" {:.4g} {:.4g} {:.4g} {:.4g}", study.mean,
                        std::isnan(study.variation) ? 0 : study.variation, sum, densities);
  }
  return text + "-->\n";
}

std::string sets_table(const std::string& second, const std::string& rows) {
  return "<h2>Parameter sets</h2>\n<p>Those that are proved and measured.</p>\n" +
         html::scrolling("<table><thead><tr><th>name</th>" + element("th", second) +
                         "</tr></thead><tbody>\n" + rows + "</tbody></table>");
}

std::string parameter_sets(const SceneNode& node) {
  std::string rows, text;
  for (const auto& [name, xml] : node.exemplars)
    rows += "<tr>" + element("td", name) + "<td>" + element("pre", xml) + "</td></tr>\n";
  for (const SuiteSubject& s : node_subjects(node))
    text += values(s);
  return sets_table("in a scene file", rows) + text;
}

std::string parameter_sets(const Model& model) {
  std::string text, rows;
  for (const Exemplar& e : model.descriptor.exemplars) {
    std::string settings;
    for (const auto& [key, value] : e.settings)
      settings += element("code", key + "=" + value) + " ";
    rows += "<tr>" + element("td", e.name) + "<td class=\"settings\">" +
            (settings.empty() ? "defaults" : settings) +
            (e.lossless ? "<small>loses nothing</small>" : "") + "</td></tr>\n";
  }
  for (const SuiteSubject& s : exemplar_subjects(model))
    text += values(s);
  return sets_table("settings", rows) + text;
}

const char* kReport = "../report.html";

std::string card(const Descriptor& d, const DocsResults& results) {
  const SuiteReport& report = results.report;
  std::vector<std::string> ids = report::subject_ids(report);
  std::string text;
  for (const report::ModelGroup& group : report::group_by_model(report)) {
    if (group.descriptor->name != d.name)
      continue;
    text += report::subject_matrix(report, group, ids, kReport) + report::matrix_legend();
    if (group.report)
      text += report::property_table(report.model_properties, group.report->results);
    size_t first = group.subjects.at(0);
    text += "<h2>In figures</h2>\n<p>The first parameter set; the others are in the " +
            link(std::string(kReport) + "#model-" + html::slug(d.name), "report card") +
            ", which also says how to read the plots.</p>\n" +
            report::subject_card(report, first, ids[first], &results.plots.at(first), true);
  }
  return text;
}

std::string try_it(const Descriptor& d, bool is_model) {
  std::string text = "<h2>In a scene file</h2>\n" + element("pre", material_xml_snippet(d)) + "\n";
  std::string file = d.file() ? " " + d.file()->name + "=FILE" : "";
  std::string plot = is_model ? fmt::format("faceta plot {0}{1} -o {0}.svg\n", d.name, file) : "";
  return text + "<h2>On the command line</h2>\n" +
         element("pre", fmt::format("faceta materials {0}\n{1}faceta verify {0} --html {0}.html\n",
                                    d.name, plot)) +
         "\n";
}

} // namespace

std::vector<std::string> exemplar_names(const DocsMaterial& m) {
  std::vector<std::string> names;
  for (const Exemplar& e : m.descriptor->exemplars)
    names.push_back(m.descriptor->name + "/" + e.name);
  if (m.node)
    for (const auto& [name, xml] : m.node->exemplars)
      names.push_back(m.descriptor->name + "/" + name);
  return names;
}

std::string material_page(const DocsMaterial& material, const DocsResults* results) {
  const Descriptor& d = *material.descriptor;
  std::string body = "<p class=\"screen\">" + link("../index.html", "Faceta: materials") +
                     "</p>\n<h1>" + escape(d.name) + ": " + escape(d.title) + "</h1>\n";
  if (!material.pictures.empty()) {
    body += "<div class=\"balls\">\n";
    for (const DocsPicture& p : material.pictures)
      body += picture(p, "../");
    body += "</div>\n";
  }
  body += "<h2>Equation</h2>\n" + element("pre", d.equation) + "\n";
  if (std::string lobes = lobes_summary(d); !lobes.empty())
    body += "<p>Lobes: " + escape(lobes) + ".</p>\n";
  body +=
      parameters(d) + list("Notes", d.notes) + exceptions(d) + try_it(d, material.model != nullptr);
  body += list("References", d.references);
  body += material.model ? parameter_sets(*material.model) : parameter_sets(*material.node);
  body += "<h2>Report card</h2>\n" + measured(results ? card(d, *results) : "");
  return html::page(d.name + ": " + d.title, body);
}

std::string index_page(const std::vector<DocsMaterial>& materials, const DocsResults* results) {
  std::string body = "<h1>Faceta: materials</h1>\n<p class=\"lead\">Every material with its "
                     "equation, parameters, a look at it, and the proof that it does what it says."
                     "</p>\n<div class=\"cards\">\n";
  for (const DocsMaterial& m : materials) {
    const Descriptor& d = *m.descriptor;
    body += "<a href=\"materials/" + html::slug(d.name) + ".html\">";
    if (!m.pictures.empty())
      body += fmt::format("<img class=\"ball\" src=\"pictures/{}\" alt=\"\" width=\"176\" "
                          "height=\"176\">",
                          escape(m.pictures[0].file));
    body += element("b", d.name) + "<br>" + element("small", d.title) + "</a>\n";
  }
  body +=
      "</div>\n<h2>Report card</h2>\n<p>Every property of every parameter set, with figures and "
      "plots: " +
      link("report.html", "the whole report") + ".</p>\n";
  std::string text;
  if (results) {
    auto target = [](const report::ModelGroup& g) {
      return "report.html#model-" + html::slug(g.descriptor->name);
    };
    text = report::model_matrix(results->report, report::group_by_model(results->report), target) +
           report::matrix_legend();
    text += "<p>Chance of a false alarm: " + escape(report::false_alarm_text(results->report)) +
            ". " + element("small", "faceta " + results->version) + "</p>\n";
  }
  body += measured(text) + "<h2>The properties</h2>\n<dl>\n";
  for (const Property& p : subject_properties())
    body += "<dt>" + element("b", p.name) + "</dt>" + element("dd", p.claim) + "\n";
  for (const ModelProperty& p : model_properties())
    body += "<dt>" + element("b", p.name) + "</dt>" + element("dd", p.claim) + "\n";
  body += "</dl>\n<p><small>Made by <code>make docs</code> from what the materials say of "
          "themselves; do not edit.</small></p>\n";
  return html::page("Faceta: materials", body);
}

std::string report_page(const DocsResults& results) {
  PageOptions options{results.version, false, {}};
  options.remark = "<p class=\"screen\">" + link("index.html", "Faceta: materials") + "</p>\n";
  return suite_html(results.report, results.plots, options);
}

} // namespace faceta::cli
