#include "formats/xml_parser.h"

#include <algorithm>
#include <fmt/format.h>

namespace faceta::xml {

void Parser::resolve_references() {
  for (const NodePtr& node : nodes_)
    for (Property& property : node->properties) {
      if (property.type != Type::object || !std::holds_alternative<std::string>(property.value))
        continue;
      const std::string& id = std::get<std::string>(property.value);
      auto target = ids_.find(id);
      if (target == ids_.end()) {
        std::vector<std::string> known;
        for (const auto& [name, object] : ids_)
          known.push_back(name);
        std::sort(known.begin(), known.end());
        throw Error(fmt::format("reference to unknown id '{}' in {}", id, node->describe()),
                    property.where,
                    known.empty() ? "no object of the scene has an id" : suggestion(id, known));
      }
      property.value = target->second;
    }
}

namespace {

struct Visit {
  const Node* node;
  size_t next = 0;
};

[[noreturn]] void throw_cycle(const std::vector<Visit>& path, const Node* again) {
  auto begin = std::find_if(path.begin(), path.end(),
                            [&](const Visit& visit) { return visit.node == again; });
  std::string names;
  size_t shown = 0;
  for (auto visit = begin; visit != path.end() && shown < 10; ++visit, ++shown)
    names +=
        (visit->node->id.empty() ? "<" + visit->node->tag + ">" : "'" + visit->node->id + "'") +
        " -> ";
  names += again->id.empty() ? "<" + again->tag + ">" : "'" + again->id + "'";
  const Visit& last = path.back();
  throw Error("references form a circle: " + names, last.node->properties[last.next - 1].where);
}

} // namespace

void Parser::check_cycles() const {
  // Height of each finished node over the leaves; 0 while it is on the path. An explicit stack:
  // chains of references may be as long as the file.
  std::unordered_map<const Node*, int> height;
  std::vector<Visit> path;
  auto enter = [&](const Node* node) {
    height[node] = 0;
    path.push_back({node});
  };
  size_t next_start = 0;
  while (!path.empty() || next_start < nodes_.size()) {
    if (path.empty()) {
      if (const Node* start = nodes_[next_start++].get(); !height.count(start))
        enter(start);
      continue;
    }
    Visit& visit = path.back();
    if (visit.next == visit.node->properties.size()) {
      int tallest = 0;
      for (const Property& property : visit.node->properties)
        if (const NodePtr* child = std::get_if<NodePtr>(&property.value))
          tallest = std::max(tallest, height.at(child->get()));
      if (tallest >= kMaxDepth)
        throw Error(fmt::format("objects and references are nested deeper than {}", kMaxDepth),
                    visit.node->where);
      height[visit.node] = tallest + 1;
      path.pop_back();
      continue;
    }
    const NodePtr* child = std::get_if<NodePtr>(&visit.node->properties[visit.next++].value);
    if (!child)
      continue;
    auto known = height.find(child->get());
    if (known == height.end())
      enter(child->get());
    else if (known->second == 0)
      throw_cycle(path, child->get());
  }
}

std::filesystem::path find_file(const std::string& name,
                                const std::vector<std::filesystem::path>& folders,
                                const SourcePosition& where) {
  if (name.empty())
    throw Error("the file name is empty", where);
  if (name.find('\0') != name.npos)
    throw Error("the file name has a zero byte", where);
  std::filesystem::path wanted(name);
  std::error_code code;
  std::string looked;
  if (wanted.is_absolute()) {
    if (std::filesystem::exists(wanted, code))
      return wanted;
    throw Error(fmt::format("file '{}' does not exist", name), where);
  }
  std::vector<std::filesystem::path> tried;
  for (const std::filesystem::path& folder : folders) {
    if (std::find(tried.begin(), tried.end(), folder) != tried.end())
      continue;
    if (std::filesystem::exists(folder / wanted, code))
      return folder / wanted;
    tried.push_back(folder);
    looked += "'" + folder.string() + "', ";
  }
  if (std::filesystem::exists(wanted, code))
    return wanted;
  throw Error(fmt::format("file '{}' was not found", name), where,
              "looked in " + looked + "and the working folder");
}

} // namespace faceta::xml
