#include "formats/xml_parser.h"
#include "formats/xml_values.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace faceta::xml {

bool Parser::read_value(Frame& frame, const Element& element) {
  auto wrong = [&](const char* what) {
    return Error(fmt::format("'{}' is not {}", element.value("value"), what),
                 element.value_where("value"));
  };
  auto store = [&](Type type, Value value) {
    add(frame, element.name(), type, std::move(value), element.where);
  };
  const std::string& tag = element.tag;
  if (tag == "float" || tag == "integer" || tag == "boolean" || tag == "string") {
    check_attributes(element, {"name", "value"}, {});
    const std::string& text = element.value("value");
    if (tag == "string") {
      store(Type::string, text);
    } else if (tag == "float") {
      std::optional<double> value = parse_number(text);
      if (!value)
        throw wrong("a number");
      store(Type::float_, *value);
    } else if (tag == "integer") {
      std::optional<int64_t> value = parse_integer(text);
      if (!value)
        throw wrong("an integer");
      store(Type::integer, *value);
    } else {
      std::optional<bool> value = parse_boolean(text);
      if (!value)
        throw wrong("a boolean: write true or false");
      store(Type::boolean, *value);
    }
  } else if (tag == "vector" || tag == "point") {
    read_point(frame, element, tag == "vector" ? Type::vector : Type::point);
  } else if (tag == "rgb") {
    read_rgb(frame, element);
  } else if (tag == "spectrum") {
    read_spectrum(frame, element);
  } else {
    return false;
  }
  return true;
}

Numbers3 read_three(const Element& element, double fallback) {
  Numbers3 numbers = {fallback, fallback, fallback};
  const Element::Attribute* list = element.find("value");
  const std::array<const char*, 3> names = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const Element::Attribute* one = element.find(names[i]);
    if (one && list)
      throw Error(fmt::format("<{}> has both 'value' and '{}'", element.tag, names[i]),
                  one->name_where, "write value=\"x, y, z\", or x, y and z");
    if (!one)
      continue;
    std::optional<double> number = parse_number(one->value);
    if (!number)
      throw Error(fmt::format("'{}' is not a number", one->value), one->value_where);
    numbers[i] = *number;
  }
  if (!list)
    return numbers;
  std::vector<double> read = parse_numbers(list->value, list->value_where);
  if (read.size() == 1)
    return {read[0], read[0], read[0]};
  if (read.size() != 3)
    throw Error(fmt::format("<{}> needs 1 or 3 numbers, not {}", element.tag, read.size()),
                list->value_where);
  return {read[0], read[1], read[2]};
}

void Parser::read_point(Frame& frame, const Element& element, Type type) {
  if (element.find("value"))
    check_attributes(element, {"name", "value"}, {"x", "y", "z"});
  else
    check_attributes(element, {"name", "x", "y", "z"}, {"value"});
  add(frame, element.name(), type, read_three(element, 0), element.where);
}

void Parser::read_rgb(Frame& frame, const Element& element) {
  check_attributes(element, {"name", "value"}, {});
  const std::string& text = element.value("value");
  if (text.starts_with('#'))
    throw Error(fmt::format("'{}': hexadecimal colours are not read", text),
                element.value_where("value"), "write three linear sRGB numbers");
  add(frame, element.name(), Type::rgb, read_three(element, 0), element.where);
}

void Parser::read_spectrum(Frame& frame, const Element& element) {
  check_attributes(element, {"name"}, {"value", "filename"});
  const Element::Attribute *value = element.find("value"), *filename = element.find("filename");
  bool has_value = value && !value->value.empty();
  bool has_filename = filename && !filename->value.empty();
  if (has_value == has_filename)
    throw Error("<spectrum> needs either 'value' or 'filename'", element.where,
                "with 'type' it is an object, for example <spectrum type=\"blackbody\">");
  SpectrumValue spectrum;
  if (has_value)
    spectrum = parse_spectrum(value->value, value->value_where);
  else
    spectrum = read_spectrum_file(resolve(*frame.file, filename->value, filename->value_where),
                                  filename->value_where, options_.warn);
  add(frame, element.name(), Type::spectrum, std::move(spectrum), element.where);
}

void Parser::read_transform(Frame& frame, const Element& element) {
  check_attributes(element, {"name"}, {});
  Matrix4 transform = kIdentity;
  for (pugi::xml_node child : element.node.children()) {
    if (child.type() != pugi::node_element) {
      warn_about_text(*frame.file, child);
      continue;
    }
    Element operation = read_element(*frame.file, child);
    const std::string& tag = operation.tag;
    if (tag == "translate" || tag == "scale")
      check_attributes(operation, {}, {"value", "x", "y", "z"});
    else if (tag == "rotate")
      check_attributes(operation, {"angle"}, {"value", "x", "y", "z"});
    else if (tag == "lookat")
      check_attributes(operation, {"origin", "target"}, {"up"});
    else if (tag == "matrix")
      check_attributes(operation, {"value"}, {});
    else
      throw Error(fmt::format("<{}> cannot stand inside <transform>", tag), operation.where,
                  suggestion(tag, {"lookat", "matrix", "rotate", "scale", "translate"}));
    check_childless(operation, *frame.file);
    transform = multiply(read_transform_operation(operation, options_.warn), transform);
  }
  add(frame, element.name(), Type::transform, transform, element.where);
}

namespace {

void warn_operation(const Element& element, const Warn& warn, const char* message) {
  if (warn)
    warn(fmt::format("{}:{}:{}: warning: {}", element.where.file, element.where.line,
                     element.where.column, message));
}

Matrix4 read_rotate(const Element& element, const Warn& warn) {
  Numbers3 axis = read_three(element, 0);
  if (axis == Numbers3{0, 0, 0})
    throw Error("the axis of <rotate> is zero", element.where, "for example x=\"1\"");
  std::optional<double> angle = parse_number(element.value("angle"));
  if (!angle)
    throw Error(fmt::format("'{}' is not a number", element.value("angle")),
                element.value_where("angle"));
  double length = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
  if (std::abs(length - 1) > 1e-3)
    warn_operation(element, warn,
                   "the axis of <rotate> has not length 1, so that this is no pure rotation");
  return rotation(axis, *angle);
}

Matrix4 read_look_at(const Element& element) {
  auto three = [&](const char* name) {
    std::vector<double> numbers = parse_numbers(element.value(name), element.value_where(name));
    if (numbers.size() != 3)
      throw Error(fmt::format("'{}' of <lookat> needs 3 numbers, not {}", name, numbers.size()),
                  element.value_where(name));
    return Numbers3{numbers[0], numbers[1], numbers[2]};
  };
  const Element::Attribute* up = element.find("up");
  std::optional<Matrix4> matrix = look_at(
      three("origin"), three("target"), up && !up->value.empty() ? three("up") : Numbers3{0, 0, 0});
  if (!matrix)
    throw Error("<lookat> gives no frame: target equals origin, or up is parallel to the view",
                element.where);
  return *matrix;
}

Matrix4 read_matrix(const Element& element, const Warn& warn) {
  std::vector<double> numbers = parse_numbers(element.value("value"), element.value_where("value"));
  if (numbers.size() != 16 && numbers.size() != 9)
    throw Error(fmt::format("<matrix> needs 9 or 16 numbers, not {}", numbers.size()),
                element.value_where("value"));
  Matrix4 matrix = kIdentity;
  size_t columns = numbers.size() == 16 ? 4 : 3;
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = 0; column < columns; ++column)
      matrix[4 * row + column] = numbers[columns * row + column];
  if (columns == 4 &&
      (numbers[12] != 0 || numbers[13] != 0 || numbers[14] != 0 || numbers[15] != 1))
    warn_operation(element, warn, "the last row of <matrix> is taken as 0 0 0 1");
  return matrix;
}

} // namespace

Matrix4 read_transform_operation(const Element& element, const Warn& warn) {
  if (element.tag == "translate")
    return translation(read_three(element, 0));
  if (element.tag == "scale")
    return scaling(read_three(element, 1));
  if (element.tag == "rotate")
    return read_rotate(element, warn);
  return element.tag == "lookat" ? read_look_at(element) : read_matrix(element, warn);
}

std::string snake_case(std::string_view name) {
  auto upper = [](char c) { return c >= 'A' && c <= 'Z'; };
  auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
  std::string out;
  bool in_capitals = false; // of a run that began after a small letter
  for (size_t i = 0; i < name.size(); ++i) {
    char c = name[i];
    bool begins = i > 0 && lower(name[i - 1]) && upper(c);
    in_capitals = upper(c) && (begins || in_capitals);
    if (begins)
      out += '_';
    out += in_capitals ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return out;
}

void Parser::upgrade_names(Frame& frame) {
  Node& node = *frame.node;
  auto rename = [&](Property& property, std::string name) {
    if (name == property.name)
      return;
    if (!frame.names.insert(name).second)
      throw Error(fmt::format("property '{}' of {} is set twice, once as '{}'", name,
                              node.describe(), property.name),
                  property.where, "names of version 1 are read as snake_case");
    frame.names.erase(property.name);
    property.name = std::move(name);
  };
  for (Property& property : node.properties)
    rename(property, snake_case(property.name));
  if (node.type == "diffuse")
    for (Property& property : node.properties)
      if (property.name == "diffuse_reflectance")
        rename(property, "reflectance");
  upgrade_texture_placement(node);
}

void Parser::upgrade_texture_placement(Node& node) {
  Numbers3 offset = {0, 0, 0}, scale = {1, 1, 1};
  const std::array<std::pair<const char*, double*>, 4> parts = {{{"uoffset", &offset[0]},
                                                                 {"voffset", &offset[1]},
                                                                 {"uscale", &scale[0]},
                                                                 {"vscale", &scale[1]}}};
  const Property* first = nullptr;
  for (auto [name, number] : parts)
    if (const Property* property = node.find(name)) {
      *number = node.get_float(name);
      first = first ? first : property;
    }
  if (!first)
    return;
  SourcePosition where = first->where;
  if (const Property* other = node.find("to_uv"))
    throw Error(
        fmt::format("{} has both 'to_uv' and uoffset, voffset, uscale or vscale", node.describe()),
        other->where);
  std::erase_if(node.properties, [&](const Property& property) {
    return std::any_of(parts.begin(), parts.end(),
                       [&](const auto& part) { return property.name == part.first; });
  });
  node.properties.push_back(
      {"to_uv", Type::transform, multiply(scaling(scale), translation(offset)), where});
}

} // namespace faceta::xml
