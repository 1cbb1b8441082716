#include "formats/xml_tree.h"

#include <charconv>
#include <fmt/format.h>
#include <set>
#include <unordered_map>
#include <unordered_set>

namespace faceta::xml {

namespace {

/// Shortest decimal that reads back to the same double.
std::string number(double value) {
  char buffer[64];
  auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, end);
}

template <class Range> std::string list(const Range& numbers) {
  std::string text;
  for (double value : numbers)
    text += (text.empty() ? "" : ", ") + number(value);
  return text;
}

/// An attribute's value; dollars are escaped against substitution.
std::string escape(std::string_view text) {
  std::string out;
  for (char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '$')
      out += "\\$";
    else if (static_cast<unsigned char>(c) < 32)
      out += fmt::format("&#{};", static_cast<int>(c));
    else
      out += c;
  }
  return out;
}

class Writer {
public:
  std::string write(const Node& root) {
    on_path_.insert(&root);
    count(root, 0);
    choose_ids();
    out_ = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\n";
    write_object(root, {}, 0, true);
    return std::move(out_);
  }

private:
  void count(const Node& node, int depth) {
    if (depth >= kMaxDepth)
      throw node.error(
          fmt::format("cannot write objects nested deeper than {}, or in a circle", kMaxDepth));
    if (++uses_[&node] > 1)
      return;
    order_.push_back(&node);
    for (const Property& property : node.properties) {
      if (property.type != Type::object)
        continue;
      NodePtr child = property.object();
      if (!child)
        throw node.error(
            fmt::format("property '{}' of {} holds no object", property.name, node.describe()));
      if (on_path_.count(child.get()))
        throw node.error("cannot write a tree with a circle");
      on_path_.insert(child.get());
      count(*child, depth + 1);
      on_path_.erase(child.get());
    }
  }

  void choose_ids() {
    std::set<std::string> taken;
    std::vector<const Node*> without;
    for (const Node* node : order_) {
      if (!node->id.empty() && taken.insert(node->id).second)
        ids_[node] = node->id;
      else if (uses_[node] > 1)
        without.push_back(node);
    }
    size_t next = 1;
    for (const Node* node : without) {
      std::string id;
      do
        id = fmt::format("{}_{}", node->tag, next++);
      while (!taken.insert(id).second);
      ids_[node] = id;
    }
  }

  void attribute(std::string_view name, std::string_view value) {
    out_ += fmt::format(" {}=\"{}\"", name, escape(value));
  }

  void write_object(const Node& node, std::string_view name, int depth, bool is_root) {
    std::string indent(static_cast<size_t>(depth) * 4, ' ');
    out_ += indent;
    if (!written_.insert(&node).second) {
      out_ += "<ref";
      attribute("id", ids_.at(&node));
      if (!is_automatic_name(name))
        attribute("name", name);
      out_ += "/>\n";
      return;
    }
    out_ += "<" + node.tag;
    if (is_root)
      attribute("version", "3.0.0");
    if (!(is_root && node.tag == "scene" && node.type == "scene"))
      attribute("type", node.type);
    if (auto id = ids_.find(&node); id != ids_.end())
      attribute("id", id->second);
    if (!is_root && !is_automatic_name(name))
      attribute("name", name);
    if (node.properties.empty()) {
      out_ += "/>\n";
      return;
    }
    out_ += ">\n";
    for (const Property& property : node.properties)
      write_property(node, property, depth + 1);
    out_ += indent + "</" + node.tag + ">\n";
  }

  void write_property(const Node& node, const Property& property, int depth) {
    if (NodePtr child = property.object(); child && property.type == Type::object) {
      write_object(*child, property.name, depth, false);
      return;
    }
    out_ += std::string(static_cast<size_t>(depth) * 4, ' ') + "<" + type_name(property.type);
    attribute("name", property.name);
    if (property.type == Type::transform) {
      write_transform(get<Matrix4>(node, property), depth);
      return;
    }
    attribute("value", value_text(node, property));
    out_ += "/>\n";
  }

  void write_transform(const Matrix4& m, int depth) {
    if (m == kIdentity) {
      out_ += "/>\n";
      return;
    }
    std::string indent(static_cast<size_t>(depth) * 4, ' ');
    out_ += ">\n" + indent + "    <matrix";
    attribute("value", list(m));
    out_ += "/>\n" + indent + "</transform>\n";
  }

  template <class T> static const T& get(const Node& node, const Property& property) {
    const T* value = std::get_if<T>(&property.value);
    if (!value)
      throw node.error(fmt::format("property '{}' of {} says {} but holds something else",
                                   property.name, node.describe(), type_name(property.type)));
    return *value;
  }

  static std::string value_text(const Node& node, const Property& property) {
    switch (property.type) {
    case Type::boolean:
      return get<bool>(node, property) ? "true" : "false";
    case Type::integer:
      return fmt::format("{}", get<int64_t>(node, property));
    case Type::float_:
      return number(get<double>(node, property));
    case Type::string:
      return get<std::string>(node, property);
    case Type::spectrum:
      return spectrum_text(node, get<SpectrumValue>(node, property));
    case Type::vector:
    case Type::point:
    case Type::rgb:
      return list(get<Numbers3>(node, property));
    case Type::transform:
    case Type::object:
      break;
    }
    throw node.error(
        fmt::format("property '{}' of {} holds no object", property.name, node.describe()));
  }

  static std::string spectrum_text(const Node& node, const SpectrumValue& spectrum) {
    if (spectrum.is_uniform() && spectrum.values.size() == 1)
      return number(spectrum.values[0]);
    if (spectrum.values.size() != spectrum.wavelengths.size() || spectrum.values.size() < 2)
      throw node.error("a spectrum to write needs as many values as wavelengths, or one value");
    std::string text;
    for (size_t i = 0; i < spectrum.values.size(); ++i)
      text += (i ? ", " : "") + number(spectrum.wavelengths[i]) + ":" + number(spectrum.values[i]);
    return text;
  }

  std::string out_;
  std::unordered_map<const Node*, size_t> uses_;
  std::unordered_set<const Node*> on_path_, written_;
  std::vector<const Node*> order_; // as they will be written
  std::unordered_map<const Node*, std::string> ids_;
};

} // namespace

std::string write_xml(const Node& root) {
  return Writer().write(root);
}

} // namespace faceta::xml
