#include "verify/suite_scene.h"

#include "spectrum/cie.h"

#include <fmt/format.h>
#include <map>
#include <set>
#include <tuple>

namespace faceta {

namespace {

using Kind = MaterialNode::Kind;

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string place_text(const SourcePosition& where) {
  return fmt::format("{}:{}:{}", where.file, where.line, where.column);
}

// A number that only scene files can give; empty if there is none.
std::string beyond_range(const Parameters& p) {
  for (const ParamInfo& info : p.descriptor().params)
    for (int k = 0; info.slot >= 0 && k < info.slots; ++k) {
      double value = p.slots()[info.slot + k];
      if (!(value >= info.hard.low && value <= info.hard.high))
        return fmt::format("{} = {} is above its range, which only scene files can give", info.name,
                           p.text(info.name));
    }
  return {};
}

class Collector {
public:
  Collector(const NamedMaterials& materials, const Scene& scene,
            std::vector<SuiteSubject>& subjects, std::vector<std::string>& notes)
      : scene_(scene), subjects_(subjects), notes_(notes) {
    for (const auto& [id, node] : materials)
      ids_[node.get()] = id;
    for (const SuiteSubject& s : subjects)
      names_.insert(s.name);
  }

  void add(const MaterialNode& node, const std::string& holder) {
    if (!seen_.insert(&node).second)
      return;
    auto found = ids_.find(&node);
    std::string id = found == ids_.end() ? "" : found->second;
    if (node.kind == Kind::model) {
      add_model(node, id, holder);
      return;
    }
    add_tree(node, id, holder);
    for (const auto& child : node.children)
      add(*child, id.empty() ? holder : id);
  }

  void tell() {
    for (const auto& [first, others] : equal_)
      notes_.push_back(fmt::format("{} stands for equal parameters: {}", first, join(others)));
  }

private:
  std::string name_of(const MaterialNode& node, const std::string& id, const std::string& holder) {
    const std::string& type = node.kind == Kind::model ? node.parameters->model().name()
                                                       : scene_node(node.kind).descriptor.name;
    std::string name = !id.empty() ? id : !holder.empty() ? holder + "/" + type : type;
    if (id.empty() && (holder.empty() || names_.count(name)))
      name += fmt::format(":{}", node.where.line);
    for (int n = 2; !names_.insert(name).second; ++n)
      name = fmt::format("{} ({})", name, n);
    return name;
  }

  void add_model(const MaterialNode& node, const std::string& id, const std::string& holder) {
    const Parameters& p = *node.parameters;
    std::string name = name_of(node, id, holder);
    auto key = std::make_tuple(&p.model(), p.slots(), p.choices(), p.file_name());
    auto [known, is_new] = by_parameters_.try_emplace(key, name);
    for (const auto& [parameter, texture] : node.textures)
      notes_.push_back(fmt::format("{}: {} is a texture; verified with its mean, {}", name,
                                   parameter, p.text(parameter)));
    if (!is_new) {
      equal_[known->second].push_back(name);
      return;
    }
    SuiteSubject s{name, Origin::scene, Subject(p.model(), p), {}, place_text(node.where), {}};
    std::string beyond = beyond_range(p);
    if (!beyond.empty())
      s.idle.push_back({"round_trip", beyond});
    subjects_.push_back(std::move(s));
  }

  void add_tree(const MaterialNode& node, const std::string& id, const std::string& holder) {
    std::string name = name_of(node, id, holder);
    if (node.weight.texture >= 0)
      notes_.push_back(fmt::format("{}: {} is a texture; verified with its mean, {:.6g}", name,
                                   node.kind == Kind::mask ? "opacity" : "weight",
                                   luminance(scene_.texture_mean(node.weight.texture))));
    auto plain = without_textures(node, scene_);
    auto tree = std::make_shared<MaterialTree>(*plain);
    auto [known, is_new] = by_text_.try_emplace(tree->text(), name);
    if (!is_new) {
      equal_[known->second].push_back(name);
      return;
    }
    SuiteSubject s{name, Origin::scene, Subject(tree), {}, place_text(node.where), {}};
    for (const Parameters* p : tree->models())
      if (std::string beyond = beyond_range(*p); !beyond.empty())
        s.idle.push_back({"round_trip", beyond});
    subjects_.push_back(std::move(s));
  }

  const Scene& scene_;
  std::vector<SuiteSubject>& subjects_;
  std::vector<std::string>& notes_;
  std::map<const MaterialNode*, std::string> ids_;
  std::set<const MaterialNode*> seen_;
  std::set<std::string> names_;
  std::map<std::tuple<const Model*, std::vector<double>, std::vector<int32_t>, std::string>,
           std::string>
      by_parameters_;
  std::map<std::string, std::vector<std::string>> equal_;
  std::map<std::string, std::string> by_text_; ///< of trees
};

} // namespace

void add_scene_subjects(const NamedMaterials& materials, const Scene& scene,
                        std::vector<SuiteSubject>& subjects, std::vector<std::string>& notes) {
  Collector collector(materials, scene, subjects, notes);
  for (const auto& material : materials)
    collector.add(*material.second, {});
  collector.tell();
}

} // namespace faceta
