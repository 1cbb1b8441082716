#include "formats/material_docs.h"

#include "spectrum/ior.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace faceta {

namespace {

using Json = nlohmann::ordered_json;

std::string number(double value) {
  if (std::isinf(value))
    return value > 0 ? "inf" : "-inf";
  // Defaults are meant as written in the source: a float's digits are enough.
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, static_cast<float>(value)).ptr};
}

bool is_color(const ParamInfo& p) {
  return p.kind == ParamKind::reflectance || p.kind == ParamKind::spectrum;
}

std::string join(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : between) + word;
  return text;
}

bool excludes(const ParamInfo& p, const std::string& name) {
  std::string list = "," + p.excludes + ",";
  return list.find("," + name + ",") != std::string::npos;
}

/// The parameter that `p` can be given instead of: alpha for alpha_u, material for eta.
const ParamInfo* instead_of(const Descriptor& d, const ParamInfo& p) {
  for (const ParamInfo& q : d.params)
    if ((q.kind == ParamKind::metal || q.kind == ParamKind::roughness) && excludes(q, p.name))
      return &q;
  return nullptr;
}

/// Without any default.
bool is_required(const ParamInfo& p) {
  return p.defaults.empty() && p.default_name.empty();
}

std::string numbers(const std::vector<double>& values, const char* between) {
  std::vector<std::string> texts;
  for (double v : values)
    texts.push_back(number(v));
  if (std::all_of(texts.begin(), texts.end(), [&](auto& t) { return t == texts[0]; }))
    texts.resize(1);
  return join(texts, between);
}

std::string default_text(const Descriptor& d, const ParamInfo& p) {
  if (is_required(p))
    return "required";
  if (p.choice >= 0)
    return p.choices[static_cast<size_t>(p.defaults[0])];
  if (!p.default_name.empty() && !p.defaults.empty())
    return p.default_name + " (" + number(p.defaults[0]) + ")";
  if (!p.default_name.empty())
    return p.default_name;
  if (const ParamInfo* q = instead_of(d, p))
    return q->kind == ParamKind::metal ? "of " + q->default_name : numbers(p.defaults, ",");
  return numbers(p.defaults, ",");
}

std::string range_text(const ParamInfo& p) {
  if (p.kind == ParamKind::metal)
    return fmt::format("a name of {}", conductor_names().size());
  if (p.kind == ParamKind::file)
    return "a file";
  if (p.choice >= 0)
    return join(p.choices, " | ");
  std::string low = std::isinf(p.hard.low) ? "(-inf" : "[" + number(p.hard.low);
  std::string high = std::isinf(p.hard.high) ? "inf)" : number(p.hard.high) + "]";
  std::string text = low + ", " + high;
  // Taken as the contract says, but tests and sliders stay in what makes sense.
  bool open = std::isinf(p.hard.high) && std::isfinite(p.soft.high) && p.soft.high > p.soft.low;
  if (open && p.kind != ParamKind::ior)
    text += fmt::format(", usual {} to {}", number(p.soft.low), number(p.soft.high));
  return p.kind == ParamKind::ior ? text + " or a name" : text;
}

const char* kind_text(const ParamInfo& p) {
  switch (p.kind) {
  case ParamKind::reflectance:
  case ParamKind::spectrum:
    return "colour";
  case ParamKind::scalar:
  case ParamKind::number:
  case ParamKind::roughness:
    return "number";
  case ParamKind::ior:
    return "index of refraction";
  case ParamKind::choice:
    return "word";
  case ParamKind::flag:
    return "flag";
  case ParamKind::metal:
    return "metal";
  case ParamKind::file:
    return "file";
  }
  return "";
}

std::string settings_text(const Settings& settings) {
  std::vector<std::string> words;
  for (const auto& [key, value] : settings)
    words.push_back(key + "=" + value);
  return words.empty() ? "defaults" : join(words, " ");
}

std::string lobes_text(const Traits& t) {
  std::vector<std::string> words;
  if (t.lobes & kReflection)
    words.push_back("reflection");
  if (t.lobes & kTransmission)
    words.push_back("transmission");
  if (t.lobes & kNullLobe)
    words.push_back("null");
  std::string text = join(words, ", ");
  if (t.delta)
    text += ", all delta";
  else if (t.has_delta)
    text += ", some delta";
  return text;
}

std::string xml_escape(const std::string& text) {
  std::string out;
  for (char c : text)
    switch (c) {
    case '&':
      out += "&amp;";
      break;
    case '<':
      out += "&lt;";
      break;
    case '"':
      out += "&quot;";
      break;
    default:
      out += c;
    }
  return out;
}

std::string xml_element(const ParamInfo& p) {
  std::string tag = "float", value;
  if (p.kind == ParamKind::flag || p.kind == ParamKind::choice) {
    tag = p.kind == ParamKind::flag ? "boolean" : "string";
    value = p.choices[static_cast<size_t>(p.defaults[0])];
  } else if (!p.default_name.empty()) {
    tag = "string";
    value = p.default_name;
  } else if (is_color(p)) {
    tag = "rgb";
    value = numbers(p.defaults, ", ");
  } else {
    value = number(p.defaults[0]);
  }
  return fmt::format("<{} name=\"{}\" value=\"{}\"/>", tag, p.name, xml_escape(value));
}

/// The file that the first exemplar has.
std::string shown_file(const Descriptor& d, const ParamInfo& p) {
  for (const Exemplar& e : d.exemplars)
    for (const auto& [key, value] : e.settings)
      if (key == p.name)
        return xml_escape(value);
  return "FILE";
}

/// A cell of a Markdown table.
std::string cell(std::string text) {
  for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
    text.insert(at, "\\");
  return text;
}

/// Columns padded to their widest cell, indented by two spaces; the last one is not padded.
std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> widths;
  for (const auto& row : rows)
    for (size_t i = 0; i < row.size(); ++i) {
      widths.resize(std::max(widths.size(), i + 1));
      widths[i] = std::max(widths[i], row[i].size());
    }
  std::string text;
  for (const auto& row : rows) {
    std::string line = " ";
    for (size_t i = 0; i < row.size(); ++i)
      line += " " + (i + 1 < row.size() ? fmt::format("{:<{}} ", row[i], widths[i]) : row[i]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

/// Lines after the first moved to the right by two spaces.
std::string indented(std::string text) {
  for (size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 3)
    text.insert(at + 1, "  ");
  return text;
}

std::string list_section(const char* title, const std::vector<std::string>& lines,
                         const char* bullet) {
  if (lines.empty())
    return {};
  std::string text = fmt::format("\n{}\n", title);
  for (const std::string& line : lines)
    text += bullet + line + "\n";
  return text;
}

std::vector<std::string> exceptions(const Descriptor& d) {
  std::vector<std::string> lines;
  for (const Excuse& e : d.excuses)
    lines.push_back(e.property + ": " + e.reason + " (" + e.reference + ")");
  return lines;
}

/// The models, and behind them the nodes.
std::vector<const Descriptor*> descriptors(const Registry& registry) {
  std::vector<const Descriptor*> all;
  for (const auto& model : registry.models())
    all.push_back(&model->descriptor);
  for (const SceneNode& node : scene_nodes())
    all.push_back(&node.descriptor);
  return all;
}

Json parameter_json(const Descriptor& d, const ParamInfo& p) {
  const auto bound = [](double value) { return std::isinf(value) ? Json() : Json(value); };
  Json j = {{"name", p.name}, {"kind", kind_text(p)}, {"meaning", p.doc}, {"unit", p.unit}};
  j["default"] = default_text(d, p);
  if (p.choice >= 0)
    j["words"] = p.choices;
  else if (!p.defaults.empty())
    j["numbers"] = p.defaults;
  if (p.slot >= 0) {
    j["range"] = {bound(p.hard.low), bound(p.hard.high)};
    j["usual_range"] = {bound(p.soft.low), bound(p.soft.high)};
  }
  j["texture"] = p.textured;
  if (const ParamInfo* q = instead_of(d, p))
    j["instead_of"] = q->name;
  return j;
}

Json material_json(const Descriptor& d) {
  Json j = {{"name", d.name}, {"title", d.title}, {"equation", d.equation}};
  const SceneNode* node = find_scene_node(d.name);
  j["role"] = node ? "node" : "model";
  j["parameters"] = Json::array();
  for (const ParamInfo& p : d.params)
    j["parameters"].push_back(parameter_json(d, p));
  j["references"] = d.references;
  j["notes"] = d.notes;
  j["exceptions"] = Json::array();
  for (const Excuse& e : d.excuses)
    j["exceptions"].push_back(
        {{"property", e.property}, {"reason", e.reason}, {"reference", e.reference}});
  j["exemplars"] = Json::array();
  for (const Exemplar& e : d.exemplars) {
    Json settings = Json::object();
    for (const auto& [key, value] : e.settings)
      settings[key] = value;
    j["exemplars"].push_back({{"name", e.name}, {"settings", settings}, {"lossless", e.lossless}});
  }
  if (node)
    for (const auto& [name, xml] : node->exemplars)
      j["exemplars"].push_back({{"name", name}, {"xml", xml}});
  j["traits"] = {{"lobes", lobes_text(d.traits)},
                 {"reciprocal", d.traits.reciprocal},
                 {"albedo_bound", d.traits.albedo_bound},
                 {"two_sided", d.traits.two_sided}};
  j["xml"] = material_xml_snippet(d);
  return j;
}

} // namespace

std::vector<std::vector<std::string>> parameter_table(const Descriptor& d) {
  std::vector<std::vector<std::string>> rows = {
      {"name", "kind", "default", "range", "unit", "texture", "meaning"}};
  for (const ParamInfo& p : d.params)
    rows.push_back({p.name, kind_text(p), default_text(d, p), range_text(p), p.unit,
                    p.textured ? "yes" : "", p.doc});
  return rows;
}

std::string lobes_summary(const Descriptor& d) {
  if (!d.traits.lobes)
    return {};
  return lobes_text(d.traits) + (d.traits.reciprocal ? ", reciprocal" : ", not reciprocal");
}

std::string material_xml_snippet(const Descriptor& d) {
  std::string body;
  for (const ParamInfo& p : d.params) {
    if (p.kind == ParamKind::file)
      body += fmt::format("  <string name=\"{}\" value=\"{}\"/>\n", p.name, shown_file(d, p));
    if (instead_of(d, p) || is_required(p))
      continue;
    body += "  " + xml_element(p) + "\n";
    std::vector<std::string> others;
    for (const ParamInfo& q : d.params)
      if (instead_of(d, q) == &p)
        others.push_back(q.name);
    if (!others.empty())
      body += fmt::format("  <!-- instead of {}: {} -->\n", p.name, join(others, " and "));
  }
  if (const SceneNode* node = find_scene_node(d.name))
    body += node->nested;
  if (body.empty())
    return fmt::format("<bsdf type=\"{}\"/>\n", d.name);
  return fmt::format("<bsdf type=\"{}\">\n{}</bsdf>\n", d.name, body);
}

const Descriptor& material_descriptor(const Registry& registry, const std::string& name) {
  if (const SceneNode* node = find_scene_node(name))
    return node->descriptor;
  if (const Model* model = registry.find(name))
    return model->descriptor;
  std::vector<std::string> names = registry.names();
  for (const SceneNode& node : scene_nodes())
    names.push_back(node.descriptor.name);
  throw Error("unknown material '" + name + "'", {}, suggestion(name, names));
}

std::string list_materials(const Registry& registry) {
  std::vector<const Descriptor*> all = descriptors(registry);
  size_t width = 0;
  for (const Descriptor* d : all)
    width = std::max(width, d->name.size());
  std::string text;
  for (const Descriptor* d : all)
    text += fmt::format("{:<{}}  {}\n", d->name, width, d->title);
  return text;
}

std::string list_materials_markdown(const Registry& registry) {
  std::string text = "| name | what it is | parameters |\n|---|---|---|\n";
  for (const Descriptor* d : descriptors(registry)) {
    std::vector<std::string> names;
    for (const std::string& name : d->param_names())
      names.push_back("`" + name + "`");
    text += fmt::format("| `{}` | {} | {} |\n", d->name, cell(d->title), join(names, " "));
  }
  return text;
}

std::string list_materials_json(const Registry& registry) {
  Json all = Json::array();
  for (const Descriptor* d : descriptors(registry))
    all.push_back(material_json(*d));
  return all.dump(2) + "\n";
}

std::string describe_material(const Descriptor& d) {
  std::string text = fmt::format("{}: {}\n\n  {}\n", d.name, d.title, indented(d.equation));
  if (!d.params.empty())
    text += "\nParameters\n" + aligned(parameter_table(d));
  text += list_section("References", d.references, "  ");
  text += list_section("Notes", d.notes, "  ");
  text += list_section("Known exceptions", exceptions(d), "  ");
  std::vector<std::vector<std::string>> sets;
  for (const Exemplar& e : d.exemplars)
    sets.push_back({e.name, settings_text(e.settings)});
  if (!sets.empty())
    text += "\nExamples\n" + aligned(sets);
  if (d.traits.lobes)
    text += fmt::format("\nLobes\n  {}\n", lobes_summary(d));
  return text + "\nIn a scene file\n" + material_xml_snippet(d);
}

std::string describe_material_markdown(const Descriptor& d) {
  std::string text = fmt::format("## `{}`: {}\n\n```text\n{}\n```\n", d.name, d.title, d.equation);
  if (!d.params.empty()) {
    bool head = true;
    text += "\n";
    for (const auto& row : parameter_table(d)) {
      for (size_t i = 0; i < row.size(); ++i)
        text += "| " + (i == 0 && !head ? "`" + row[i] + "`" : cell(row[i])) + " ";
      text += "|\n";
      if (head)
        text += "|---|---|---|---|---|---|---|\n";
      head = false;
    }
  }
  text += list_section("References:\n", d.references, "- ");
  text += list_section("Notes:\n", d.notes, "- ");
  text += list_section("Known exceptions:\n", exceptions(d), "- ");
  std::vector<std::string> sets;
  for (const Exemplar& e : d.exemplars)
    sets.push_back(e.name + ": `" + settings_text(e.settings) + "`");
  text += list_section("Examples:\n", sets, "- ");
  return text + "\n```xml\n" + material_xml_snippet(d) + "```\n";
}

std::string describe_material_json(const Descriptor& d) {
  return material_json(d).dump(2) + "\n";
}

} // namespace faceta
