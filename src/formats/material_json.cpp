#include "formats/material_json.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

namespace faceta {

namespace {

using Json = nlohmann::ordered_json;

bool is_color(const ParamInfo& p) {
  return p.kind == ParamKind::reflectance || p.kind == ParamKind::spectrum;
}

Json value_of(const ParamInfo& p, const Parameters& values) {
  if (p.kind == ParamKind::flag)
    return values.choices()[static_cast<size_t>(p.choice)] != 0;
  if (p.choice >= 0 || !values.given_name(p.name).empty())
    return values.text(p.name);
  const double* slots = &values.slots()[static_cast<size_t>(p.slot)];
  if (is_color(p))
    return {slots[0], slots[1], slots[2]};
  return slots[0];
}

// nlohmann counts bytes, people lines and columns.
SourcePosition position_of(std::string_view text, size_t byte, const std::string& name) {
  std::string_view before = text.substr(0, std::min(byte > 0 ? byte - 1 : 0, text.size()));
  size_t line_start = before.rfind('\n') + 1; // npos + 1 = 0
  return {name, int(std::count(before.begin(), before.end(), '\n')) + 1,
          int(before.size() - line_start) + 1};
}

// A key twice in one object would silently lose the first value.
class DoubledKeys {
public:
  explicit DoubledKeys(const std::string& name) : name_(name) {}
  bool operator()(int, Json::parse_event_t event, const Json& parsed) {
    if (event == Json::parse_event_t::object_start)
      keys_.emplace_back();
    else if (event == Json::parse_event_t::object_end)
      keys_.pop_back();
    else if (event == Json::parse_event_t::key &&
             !keys_.back().insert(parsed.get<std::string>()).second)
      throw Error("'" + parsed.get<std::string>() + "' is given twice", {name_, 0, 0});
    return true;
  }

private:
  const std::string& name_;
  std::vector<std::set<std::string>> keys_;
};

Json parse(std::string_view text, const std::string& name) {
  try {
    return Json::parse(text.begin(), text.end(), DoubledKeys(name));
  } catch (const Json::parse_error& e) {
    std::string what = e.what(); // "[json.exception.parse_error.101] parse error at ...: reason"
    size_t reason = what.find(": ");
    throw Error("not JSON: " + (reason == std::string::npos ? what : what.substr(reason + 2)),
                position_of(text, e.byte, name));
  } catch (const Json::exception& e) { // a number beyond the range of double
    throw Error(std::string("not JSON: ") + e.what(), {name, 0, 0});
  }
}

double number_of(const Json& value, const std::string& key, const SourcePosition& where) {
  if (!value.is_number())
    throw Error(fmt::format("'{}' is {}", key, value.dump()), where,
                "a number, or a name where the parameter has names");
  return value.get<double>();
}

void set_value(Parameters& p, const std::string& key, const Json& value,
               const SourcePosition& where) {
  if (value.is_string())
    return p.set(key, value.get<std::string>(), where);
  const ParamInfo* info = p.descriptor().find(key);
  if (value.is_boolean() || (info && info->kind == ParamKind::flag)) {
    if (!value.is_boolean() || (info && info->kind != ParamKind::flag))
      throw Error(fmt::format("'{}' is {}", key, value.dump()), where,
                  value.is_boolean() ? "it is no flag" : "true or false");
    return p.set(key, value.get<bool>() ? "true" : "false", where);
  }
  AboveRange above = info && is_color(*info) ? AboveRange::keep : AboveRange::refuse;
  if (!value.is_array())
    return p.set_number(key, number_of(value, key, where), where, above);
  if (value.size() != 3)
    throw Error(fmt::format("'{}' has {} numbers", key, value.size()), where, "one or three");
  p.set_color(key,
              {number_of(value[0], key, where), number_of(value[1], key, where),
               number_of(value[2], key, where)},
              where, above);
}

} // namespace

std::string write_material_json(const Parameters& parameters) {
  Json json = {{"model", parameters.model().name()}, {"parameters", Json::object()}};
  for (const ParamInfo& p : parameters.descriptor().params)
    if (parameters.was_set(p.name))
      json["parameters"][p.name] = value_of(p, parameters);
  return json.dump(2) + "\n";
}

Parameters parse_material_json(std::string_view text, const std::string& name) {
  Json json = parse(text, name);
  SourcePosition where{name, 0, 0};
  const char* form = R"(the form is {"model": "diffuse", "parameters": {"reflectance": 0.5}})";
  if (!json.is_object() || !json.contains("model") || !json["model"].is_string())
    throw Error("no material", where, form);
  for (const auto& [key, value] : json.items())
    if (key != "model" && key != "parameters")
      throw Error("unknown key '" + key + "'", where, form);
  Parameters p(Registry::global().get(json["model"].get<std::string>()));
  if (json.contains("parameters")) {
    if (!json["parameters"].is_object())
      throw Error("'parameters' is no object", where, form);
    for (const auto& [key, value] : json["parameters"].items())
      set_value(p, key, value, where);
  }
  p.check(where);
  return p;
}

Parameters through_json(const Parameters& parameters) {
  return parse_material_json(write_material_json(parameters));
}

} // namespace faceta
