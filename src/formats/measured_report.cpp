#include "formats/measured_report.h"

#include "formats/measured_common.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace faceta {

namespace {

using Json = nlohmann::ordered_json;

std::string line(const char* label, const std::string& text) {
  return text.empty() ? "" : fmt::format("  {:<14}{}\n", label, text);
}

std::string wavelengths_text(const std::vector<double>& w) {
  return w.empty() ? "" : fmt::format("{} from {:g} to {:g} nm", w.size(), w.front(), w.back());
}

std::string list(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : "; ") + word;
  return text;
}

} // namespace

std::string measured_text(const std::string& name, const MeasuredInfo& info,
                          const MeasuredAudit& audit) {
  std::string text = fmt::format("{}: {}\n", name, info.title);
  text += line("format", info.format);
  text += line("description", info.description);
  text += line("resolution", info.resolution);
  text += line("wavelengths", wavelengths_text(info.wavelengths));
  text += line("symmetries", list(info.symmetries));
  text += line("interpolation", info.interpolation);
  for (const std::string& note : info.notes)
    text += line("note", note);
  text += line("cells", audit.below > 0 ? fmt::format("{}, {} of them for directions below the "
                                                      "surface",
                                                      audit.cells, audit.below)
                                        : fmt::format("{}", audit.cells));
  if (audit.largest_theta > 0)
    text += line("measured", fmt::format("up to {:.1f} degrees", audit.largest_theta));
  text += line("range", fmt::format("f_r from {:.3g} to {:.3g} /sr (luminance)", audit.smallest,
                                    audit.most));
  text += "  viewer        albedo r, g, b            spread of weights\n";
  for (const MeasuredAudit::Angle& a : audit.angles)
    text += fmt::format("  {:>4} degrees  {:.4f}  {:.4f}  {:.4f}    {:.3f}\n", a.theta, a.albedo[0],
                        a.albedo[1], a.albedo[2], a.variation);
  for (const MeasuredAudit::Finding& f : audit.findings) {
    text += fmt::format("  {} {}\n", f.good ? "good" : "BAD ", f.text);
    if (!f.advice.empty())
      text += fmt::format("       {}\n", f.advice);
  }
  return text;
}

std::string measured_json(const std::string& name, const MeasuredInfo& info,
                          const MeasuredAudit& audit) {
  Json angles = Json::array(), findings = Json::array();
  for (const MeasuredAudit::Angle& a : audit.angles)
    angles.push_back({{"theta", a.theta},
                      {"albedo", a.albedo},
                      {"largest", a.largest},
                      {"variation", a.variation}});
  for (const MeasuredAudit::Finding& f : audit.findings)
    findings.push_back({{"good", f.good}, {"text", f.text}, {"advice", f.advice}});
  Json json = {{"file", name},
               {"format", info.format},
               {"title", info.title},
               {"description", info.description},
               {"resolution", info.resolution},
               {"wavelengths", info.wavelengths},
               {"symmetries", info.symmetries},
               {"interpolation", info.interpolation},
               {"notes", info.notes},
               {"audit",
                {{"cells", audit.cells},
                 {"holes", audit.holes},
                 {"below_surface", audit.below},
                 {"negative", audit.negative},
                 {"out_of_gamut", audit.out_of_gamut},
                 {"largest_theta", audit.largest_theta},
                 {"smallest", audit.smallest},
                 {"largest", audit.most},
                 {"reciprocity",
                  {{"mean", audit.reciprocity.mean},
                   {"largest", audit.reciprocity.largest},
                   {"relative", audit.reciprocity.relative}}},
                 {"angles", angles},
                 {"findings", findings},
                 {"clean", audit.clean()}}}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string conversion_text(const std::string& path, const Conversion& made) {
  std::string text = fmt::format("{}: {}\n", path, made.resolution);
  text += "  viewer        albedo of the source      of the file               error\n";
  for (const Conversion::Row& r : made.rows)
    text += fmt::format("  {:>4} degrees  {:.4f}  {:.4f}  {:.4f}    {:.4f}  {:.4f}  {:.4f}    "
                        "{:.2f} %\n",
                        r.theta, r.source[0], r.source[1], r.source[2], r.result[0], r.result[1],
                        r.result[2], 100 * r.error);
  for (const std::string& note : made.notes)
    text += line("note", note);
  return text;
}

std::string conversion_json(const std::string& path, const Conversion& made) {
  Json rows = Json::array();
  for (const Conversion::Row& r : made.rows)
    rows.push_back(
        {{"theta", r.theta}, {"source", r.source}, {"result", r.result}, {"error", r.error}});
  return Json({{"file", path},
               {"resolution", made.resolution},
               {"error", made.error},
               {"albedos", rows},
               {"notes", made.notes}})
      .dump(2, ' ', false, Json::error_handler_t::replace);
}

} // namespace faceta
