#include "formats/xml_tree.h"

#include "formats/xml_parser.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta::xml {

namespace {

const char* with_article(Type type) {
  switch (type) {
  case Type::boolean:
    return "a boolean";
  case Type::integer:
    return "an integer";
  case Type::float_:
    return "a float";
  case Type::string:
    return "a string";
  case Type::vector:
    return "a vector";
  case Type::point:
    return "a point";
  case Type::rgb:
    return "an rgb colour";
  case Type::spectrum:
    return "a spectrum";
  case Type::transform:
    return "a transform";
  case Type::object:
    break;
  }
  return "a nested object";
}

const Property& require(const Node& node, std::string_view name, Type type) {
  const Property* property = node.find(name);
  if (!property) {
    std::string example =
        type == Type::transform || type == Type::object
            ? std::string()
            : fmt::format("<{} name=\"{}\" value=\"...\"/>", type_name(type), name);
    throw node.error(fmt::format("{} needs {} '{}'", node.describe(), with_article(type), name),
                     example);
  }
  property->queried = true;
  return *property;
}

[[noreturn]] void throw_wrong_type(const Node& node, const Property& property, Type wanted) {
  throw Error(fmt::format("property '{}' of {} must be {}, not {}", property.name, node.describe(),
                          with_article(wanted), with_article(property.type)),
              property.where);
}

template <class T> const T& get(const Node& node, std::string_view name, Type type) {
  const Property& property = require(node, name, type);
  const T* value = std::get_if<T>(&property.value);
  if (!value || property.type != type)
    throw_wrong_type(node, property, type);
  return *value;
}

Numbers3 get_three(const Node& node, std::string_view name, Type wanted,
                   std::initializer_list<Type> accepted) {
  const Property& property = require(node, name, wanted);
  const Numbers3* value = std::get_if<Numbers3>(&property.value);
  if (!value || std::find(accepted.begin(), accepted.end(), property.type) == accepted.end())
    throw_wrong_type(node, property, wanted);
  return *value;
}

bool matches(const Node& node, std::string_view tag) {
  return node.tag == tag || (tag == "texture" && node.tag == "spectrum");
}

} // namespace

bool SpectrumValue::is_regular() const {
  if (wavelengths.size() < 2)
    return false;
  double step = wavelengths[1] - wavelengths[0];
  for (size_t i = 2; i < wavelengths.size(); ++i)
    if (std::abs(wavelengths[i] - wavelengths[i - 1] - step) > 1e-3 * step)
      return false;
  return true;
}

const char* type_name(Type type) {
  constexpr const char* names[] = {"boolean", "integer", "float",    "string",    "vector",
                                   "point",   "rgb",     "spectrum", "transform", "object"};
  return names[static_cast<size_t>(type)];
}

NodePtr Property::object() const {
  const NodePtr* node = std::get_if<NodePtr>(&value);
  return node ? *node : nullptr;
}

const Property* Node::find(std::string_view name) const {
  for (const Property& property : properties)
    if (property.name == name)
      return &property;
  return nullptr;
}

std::optional<Type> Node::type_of(std::string_view name) const {
  const Property* property = find(name);
  return property ? std::optional<Type>(property->type) : std::nullopt;
}

std::vector<std::string> Node::names() const {
  std::vector<std::string> all;
  for (const Property& property : properties)
    all.push_back(property.name);
  return all;
}

void Node::mark(std::string_view name) const {
  if (const Property* property = find(name))
    property->queried = true;
}

void Node::mark_all() const {
  for (const Property& property : properties)
    property.queried = true;
}

bool Node::get_boolean(std::string_view name) const {
  return get<bool>(*this, name, Type::boolean);
}

bool Node::get_boolean(std::string_view name, bool fallback) const {
  return has(name) ? get_boolean(name) : fallback;
}

double Node::get_float(std::string_view name) const {
  const Property& property = require(*this, name, Type::float_);
  if (const double* value = std::get_if<double>(&property.value))
    return *value;
  if (const int64_t* value = std::get_if<int64_t>(&property.value))
    return static_cast<double>(*value);
  throw_wrong_type(*this, property, Type::float_);
}

double Node::get_float(std::string_view name, double fallback) const {
  return has(name) ? get_float(name) : fallback;
}

int Node::get_integer(std::string_view name) const {
  require(*this, name, Type::integer);
  return static_cast<int>(get_integer64(name, 0, INT_MIN, INT_MAX));
}

int Node::get_integer(std::string_view name, int fallback, int low, int high) const {
  return static_cast<int>(get_integer64(name, fallback, low, high));
}

int64_t Node::get_integer64(std::string_view name, int64_t fallback, int64_t low,
                            int64_t high) const {
  if (!has(name))
    return fallback;
  int64_t value = get<int64_t>(*this, name, Type::integer);
  if (value < low || value > high)
    throw error_at(name, fmt::format("'{}' of {} is {}, but must lie between {} and {}", name,
                                     describe(), value, low, high));
  return value;
}

std::string Node::get_string(std::string_view name) const {
  return get<std::string>(*this, name, Type::string);
}

std::string Node::get_string(std::string_view name, std::string_view fallback) const {
  return has(name) ? get_string(name) : std::string(fallback);
}

std::string Node::get_choice(std::string_view name, std::string_view fallback,
                             const std::vector<std::string>& choices) const {
  std::string value = get_string(name, fallback);
  if (has(name) && std::find(choices.begin(), choices.end(), value) == choices.end())
    throw error_at(name, fmt::format("'{}' of {} cannot be '{}'", name, describe(), value),
                   suggestion(value, choices));
  return value;
}

Numbers3 Node::get_point(std::string_view name) const {
  return get_three(*this, name, Type::point, {Type::point, Type::vector});
}

Numbers3 Node::get_point(std::string_view name, const Numbers3& fallback) const {
  return has(name) ? get_point(name) : fallback;
}

Numbers3 Node::get_vector(std::string_view name) const {
  return get_three(*this, name, Type::vector, {Type::point, Type::vector});
}

Numbers3 Node::get_vector(std::string_view name, const Numbers3& fallback) const {
  return has(name) ? get_vector(name) : fallback;
}

Numbers3 Node::get_rgb(std::string_view name) const {
  return get_three(*this, name, Type::rgb, {Type::rgb, Type::vector, Type::point});
}

Numbers3 Node::get_rgb(std::string_view name, const Numbers3& fallback) const {
  return has(name) ? get_rgb(name) : fallback;
}

const SpectrumValue& Node::get_spectrum(std::string_view name) const {
  return get<SpectrumValue>(*this, name, Type::spectrum);
}

Matrix4 Node::get_transform(std::string_view name) const {
  return get<Matrix4>(*this, name, Type::transform);
}

Matrix4 Node::get_transform(std::string_view name, const Matrix4& fallback) const {
  return has(name) ? get_transform(name) : fallback;
}

Matrix3 Node::get_transform_2d(std::string_view name) const {
  Matrix4 m = get_transform(name, kIdentity);
  return {m[0], m[1], m[3], m[4], m[5], m[7], 0, 0, 1};
}

std::filesystem::path Node::get_file(std::string_view name) const {
  std::string filename = get_string(name);
  const Property* property = find(name);
  return find_file(filename, folders ? *folders : std::vector<std::filesystem::path>{},
                   property->where);
}

NodePtr Node::get_object(std::string_view name) const {
  return has(name) ? get<NodePtr>(*this, name, Type::object) : nullptr;
}

std::vector<const Property*> Node::object_properties(std::string_view tag) const {
  std::vector<const Property*> found;
  for (const Property& property : properties) {
    NodePtr child = property.object();
    if (child && matches(*child, tag)) {
      property.queried = true;
      found.push_back(&property);
    }
  }
  return found;
}

std::vector<NodePtr> Node::objects(std::string_view tag) const {
  std::vector<NodePtr> found;
  for (const Property* property : object_properties(tag))
    found.push_back(property->object());
  return found;
}

std::vector<NodePtr> Node::objects() const {
  std::vector<NodePtr> found;
  for (const Property& property : properties)
    if (NodePtr child = property.object()) {
      property.queried = true;
      found.push_back(std::move(child));
    }
  return found;
}

std::filesystem::path Node::resolve(const std::string& filename) const {
  return find_file(filename, folders ? *folders : std::vector<std::filesystem::path>{}, where);
}

std::string Node::describe() const {
  if (tag == "scene" && type == "scene")
    return "the scene";
  std::string text = fmt::format("{} of type '{}'", tag, type);
  return id.empty() ? text : fmt::format("{} (id '{}')", text, id);
}

Error Node::error(const std::string& message, const std::string& hint) const {
  return Error(message, where, hint);
}

Error Node::error_at(std::string_view name, const std::string& message,
                     const std::string& hint) const {
  const Property* property = find(name);
  return Error(message, property ? property->where : where, hint);
}

Property& Node::set(std::string name, Type property_type, Value value) {
  for (Property& property : properties)
    if (property.name == name) {
      property.type = property_type;
      property.value = std::move(value);
      return property;
    }
  properties.push_back({std::move(name), property_type, std::move(value), {}});
  return properties.back();
}

Property& Node::add_object(NodePtr object, std::string name) {
  for (size_t i = 0; name.empty(); ++i)
    if (std::string candidate = fmt::format("_arg_{}", i); !has(candidate))
      name = candidate;
  return set(std::move(name), Type::object, std::move(object));
}

bool is_automatic_name(std::string_view name) {
  return name.starts_with("_arg_");
}

void check_all_queried(const Node& node, bool permissive,
                       const std::vector<std::string>& known_names, const Warn& warn) {
  for (const Property& property : node.properties) {
    if (property.queried)
      continue;
    NodePtr child = property.object();
    bool unnamed = child && is_automatic_name(property.name);
    std::string message =
        unnamed ? fmt::format("unexpected {} in {}", child->describe(), node.describe())
                : fmt::format("unexpected property '{}' in {}", property.name, node.describe());
    std::string hint = unnamed ? std::string() : suggestion(property.name, known_names);
    if (!permissive)
      throw Error(message, property.where, hint);
    if (warn) {
      const SourcePosition& at = property.where;
      warn(fmt::format("{}:{}:{}: warning: {}{}{}{}", at.file, at.line, at.column, message,
                       hint.empty() ? "" : " (", hint, hint.empty() ? "" : ")"));
    }
  }
}

} // namespace faceta::xml
