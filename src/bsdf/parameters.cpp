#include "bsdf/registry.h"
#include "spectrum/ior.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>

namespace faceta {

namespace {

std::optional<double> parse_number(std::string_view text) {
  while (!text.empty() && text.front() == ' ')
    text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ')
    text.remove_suffix(1);
  if (!text.empty() && text.front() == '+')
    text.remove_prefix(1);
  double value = 0;
  auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  size_t begin = 0;
  while (begin <= text.size()) {
    size_t end = text.find(',', begin);
    if (end == std::string_view::npos)
      end = text.size();
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string format_number(double value) {
  char buffer[40];
  auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return {buffer, end};
}

std::atomic<FileLoader> file_loader = nullptr;

std::vector<std::string> split_names(const std::string& list) {
  std::vector<std::string> names;
  for (std::string_view part : split(list))
    if (!part.empty())
      names.emplace_back(part);
  return names;
}

} // namespace

void set_file_loader(FileLoader loader) {
  file_loader = loader;
}

Parameters::Parameters(const Model& model) : model_(&model) {
  const Descriptor& d = model.descriptor;
  slots_.assign(d.slots, 0.0);
  choices_.assign(d.choices, 0);
  for (const ParamInfo& p : d.params) {
    if (p.choice >= 0)
      choices_[p.choice] = static_cast<int32_t>(p.defaults[0]);
    else if (p.slot >= 0)
      std::copy(p.defaults.begin(), p.defaults.end(), slots_.begin() + p.slot);
  }
}

const ParamInfo& Parameters::info(const std::string& name, const SourcePosition& where) const {
  if (const ParamInfo* p = descriptor().find(name))
    return *p;
  throw Error("material '" + descriptor().name + "' has no parameter '" + name + "'", where,
              suggestion(name, descriptor().param_names()));
}

void Parameters::check_range(const ParamInfo& p, double value, const SourcePosition& where,
                             AboveRange above) const {
  if (std::isfinite(value) && value >= p.hard.low &&
      (value <= p.hard.high || above == AboveRange::keep))
    return;
  std::string range = "from " + format_number(p.hard.low);
  range += std::isinf(p.hard.high) ? " up" : " to " + format_number(p.hard.high);
  throw Error("parameter '" + p.name + "' of '" + descriptor().name + "' is " +
                  format_number(value) + ", outside its range",
              where, "allowed: " + range);
}

void Parameters::assign(const ParamInfo& p, const std::vector<double>& values) {
  for (int i = 0; i < p.slots; ++i)
    slots_[p.slot + i] = values[values.size() == 1 ? 0 : i];
  if (p.kind == ParamKind::number) // may be about the file
    file_.reset();
  std::erase(textured_, p.name);
}

void Parameters::set_number(const std::string& name, double value, const SourcePosition& where,
                            AboveRange above) {
  const ParamInfo& p = info(name, where);
  if (p.slot < 0)
    throw Error("parameter '" + name + "' of '" + descriptor().name + "' is not a number", where,
                p.choices.empty() ? "give a name" : suggestion("", p.choices));
  check_range(p, value, where, above);
  assign(p, {value});
  set_[name] = "";
}

void Parameters::set_color(const std::string& name, const std::array<double, 3>& rgb,
                           const SourcePosition& where, AboveRange above) {
  const ParamInfo& p = info(name, where);
  if (p.kind != ParamKind::reflectance && p.kind != ParamKind::spectrum)
    throw Error("parameter '" + name + "' of '" + descriptor().name + "' is not a colour", where);
  for (double v : rgb)
    check_range(p, v, where, above);
  assign(p, {rgb[0], rgb[1], rgb[2]});
  set_[name] = "";
}

void Parameters::set_texture(const std::string& name, const std::array<double, 3>& mean_rgb,
                             const SourcePosition& where) {
  const ParamInfo& p = info(name, where);
  if (!p.textured)
    throw Error("parameter '" + name + "' of '" + descriptor().name + "' takes no texture", where);
  if (p.slots == 3)
    assign(p, {mean_rgb[0], mean_rgb[1], mean_rgb[2]});
  else
    assign(p, {(mean_rgb[0] + mean_rgb[1] + mean_rgb[2]) / 3});
  set_[name] = "";
  textured_.push_back(name);
}

void Parameters::set(const std::string& name, const std::string& text,
                     const SourcePosition& where) {
  const ParamInfo& p = info(name, where);
  if (p.kind == ParamKind::choice || p.kind == ParamKind::flag) {
    auto word = std::find(p.choices.begin(), p.choices.end(), text);
    if (word == p.choices.end())
      throw Error("parameter '" + name + "' of '" + descriptor().name + "' cannot be '" + text +
                      "'",
                  where, suggestion(text, p.choices));
    choices_[p.choice] = static_cast<int32_t>(word - p.choices.begin());
    set_[name] = text;
    file_.reset();
    return;
  }
  if (p.kind == ParamKind::file) {
    file_.reset();
    if (text.empty())
      throw Error("parameter '" + name + "' of '" + descriptor().name + "' names no file", where);
    set_[name] = text;
    return;
  }
  if (p.kind == ParamKind::metal) {
    std::optional<ConductorIor> metal = find_conductor(text);
    if (!metal)
      throw Error("unknown metal '" + text + "'", where, suggestion(text, conductor_names()));
    for (int i = 0; i < 3; ++i) {
      slots_[info("eta", where).slot + i] = metal->eta[i];
      slots_[info("k", where).slot + i] = metal->k[i];
    }
    set_[name] = text;
    return;
  }
  if (p.kind == ParamKind::ior && !parse_number(text)) {
    std::optional<double> ior = find_dielectric(text);
    if (!ior)
      throw Error("unknown dielectric '" + text + "'", where, suggestion(text, dielectric_names()));
    assign(p, {*ior});
    set_[name] = text;
    return;
  }
  std::vector<double> values;
  for (std::string_view part : split(text)) {
    std::optional<double> value = parse_number(part);
    if (!value)
      throw Error("parameter '" + name + "' of '" + descriptor().name + "': '" + text +
                      "' is not a number" + (p.slots == 3 ? " or three (r,g,b)" : ""),
                  where);
    values.push_back(*value);
  }
  bool color = p.kind == ParamKind::reflectance || p.kind == ParamKind::spectrum;
  if (values.size() != 1 && !(color && values.size() == 3))
    throw Error("parameter '" + name + "' of '" + descriptor().name + "' takes " +
                    (color ? "one number or three" : "one number"),
                where);
  for (double v : values)
    check_range(p, v, where);
  assign(p, values);
  set_[name] = "";
}

std::string Parameters::file_name() const {
  const ParamInfo* p = descriptor().file();
  return p ? given_name(p->name) : std::string();
}

void Parameters::load_file(const SourcePosition& where) {
  const ParamInfo* p = descriptor().file();
  if (!p || file_)
    return;
  if (file_name().empty())
    throw Error("'" + descriptor().name + "' needs a '" + p->name + "'", where, p->doc);
  FileLoader loader = file_loader;
  if (!loader)
    throw Error("this program reads no files of measured values", where,
                "call faceta::load_measured_files() first");
  file_ = loader(*this, where);
}

Record Parameters::record() const {
  Parameters loaded = *this;
  loaded.load_file();
  Record record = model_->make_record(slots_, choices_, textured_);
  record.file = loaded.file_;
  return record;
}

void Parameters::check(const SourcePosition& where) const {
  for (const auto& [name, given] : set_) {
    const ParamInfo& p = *descriptor().find(name);
    if (p.kind == ParamKind::metal && given == "none")
      continue;
    for (const std::string& other : split_names(p.excludes))
      if (was_set(other))
        throw Error("'" + name + "' and '" + other + "' of '" + descriptor().name +
                        "' exclude each other",
                    where, "give one of them");
  }
  const char* pairs[][2] = {{"alpha_u", "alpha_v"}, {"eta", "k"}};
  for (auto& pair : pairs)
    if (was_set(pair[0]) != was_set(pair[1])) {
      std::string missing = was_set(pair[0]) ? pair[1] : pair[0];
      throw Error("'" + std::string(pair[0]) + "' and '" + pair[1] + "' of '" + descriptor().name +
                      "' must be given together",
                  where, "missing: " + missing);
    }
}

std::string Parameters::given_name(const std::string& param) const {
  auto found = set_.find(param);
  return found == set_.end() ? std::string() : found->second;
}

Settings Parameters::given() const {
  Settings settings;
  for (const ParamInfo& p : descriptor().params)
    if (was_set(p.name))
      settings.emplace_back(p.name, text(p.name));
  return settings;
}

std::string Parameters::text(const std::string& param) const {
  const ParamInfo& p = info(param, {});
  if (p.choice >= 0)
    return p.choices[choices_[p.choice]];
  std::string given = given_name(param);
  if (!given.empty() || p.kind == ParamKind::metal || p.kind == ParamKind::file)
    return given.empty() ? p.default_name : given;
  if (p.slots == 3) {
    const double* v = &slots_[p.slot];
    return format_number(v[0]) + "," + format_number(v[1]) + "," + format_number(v[2]);
  }
  return format_number(slots_[p.slot]);
}

} // namespace faceta
