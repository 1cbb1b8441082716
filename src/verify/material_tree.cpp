#include "verify/material_tree.h"

#include "spectrum/cie.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace faceta {

namespace {

using Kind = MaterialNode::Kind;
constexpr int kFront = 1, kBack = 2;

Vec3<double> mirrored(const Vec3<double>& w) {
  return {w.x, w.y, -w.z};
}

/// The share of child k of a blend or mask; a mask has a second child, the hole.
double share_of(Kind kind, double weight, size_t k) {
  bool complement = (kind == Kind::blend) == (k == 0);
  return complement ? 1 - weight : weight;
}

Sample<double> straight_on(const Vec3<double>& wo) {
  Sample<double> s;
  s.wi = -wo;
  s.pdf = 1;
  s.weight = Color<double>(1);
  s.eta = 1;
  s.lobe = kNullLobe;
  s.delta = s.valid = true;
  return s;
}

using Copies = std::map<const MaterialNode*, std::shared_ptr<MaterialNode>>;

std::shared_ptr<MaterialNode> copy_without_textures(const MaterialNode& node, const Scene& scene,
                                                    Copies& copies) {
  std::shared_ptr<MaterialNode>& copy = copies[&node];
  if (copy) // a node that occurs twice stays one: trees of shared nodes can have 2^depth ends
    return copy;
  auto fresh = std::make_shared<MaterialNode>(node);
  fresh->textures.clear(); // the parameters hold the means already
  if (node.weight.texture >= 0)
    fresh->weight = {scene.texture_mean(node.weight.texture), -1};
  for (auto& child : fresh->children)
    child = copy_without_textures(*child, scene, copies);
  copies[&node] = fresh;
  return fresh;
}

} // namespace

std::shared_ptr<MaterialNode> without_textures(const MaterialNode& root, const Scene& scene) {
  Copies copies;
  return copy_without_textures(root, scene, copies);
}

MaterialTree::MaterialTree(const MaterialNode& drawn, const MaterialNode& defined)
    : definition_(std::make_shared<MaterialNode>(defined)), kernels_(kIsaCount) {
  auto root = std::make_shared<MaterialNode>(drawn);
  for (int isa = 0; isa < kIsaCount; ++isa) {
    if (!isa_supported(static_cast<Isa>(isa)))
      continue;
    auto scene = std::make_unique<Scene>();
    int material = scene->add_material(root);
    kernels_[isa] =
        std::make_unique<SceneMaterial>(std::move(scene), material, static_cast<Isa>(isa));
  }
  root_ = make_part(defined); // the scene has checked it: so deep, so many ends
  describe();
}

// --- The kernels ---

void MaterialTree::eval(EvalArrays arrays, int n, Isa isa, TransportMode mode) const {
  std::vector<float> middle(n + kLanePadding, 0.5f);
  arrays.uv[0] = arrays.uv[1] = middle.data();
  kernels_[static_cast<int>(isa)]->eval(arrays, n, mode);
}

void MaterialTree::sample(SampleArrays arrays, int n, Isa isa, TransportMode mode) const {
  std::vector<float> middle(n + kLanePadding, 0.5f);
  arrays.uv[0] = arrays.uv[1] = middle.data();
  kernels_[static_cast<int>(isa)]->sample(arrays, n, mode);
}

// --- The definition ---

MaterialTree::Part MaterialTree::make_part(const MaterialNode& node) {
  Part part{node.kind, node.parameters, {}, 0, {}};
  if (node.kind == Kind::model)
    part.record = node.parameters->record();
  if (node.kind == Kind::blend || node.kind == Kind::mask)
    part.weight = static_cast<float>(std::clamp(luminance(node.weight.value), 0.0, 1.0));
  for (size_t k = 0; k < node.children.size(); ++k) {
    bool counts = node.kind == Kind::twosided || share_of(node.kind, part.weight, k) > 0;
    part.children.push_back(counts ? make_part(*node.children[k])
                                   : Part{Kind::null, {}, {}, 0, {}});
  }
  if (node.kind == Kind::mask)
    part.children.push_back({Kind::null, {}, {}, 0, {}});
  return part;
}

Eval<double> MaterialTree::eval_part(const Part& part, const ReferenceQuery& query,
                                     const std::vector<double>& numbers, size_t& next) {
  switch (part.kind) {
  case Kind::null:
    return {};
  case Kind::model: {
    if (numbers.empty())
      return part.parameters->model().eval(part.record, query);
    std::vector<double> slots(numbers.begin() + next,
                              numbers.begin() + next + part.record.slots.size());
    next += slots.size();
    return part.parameters->model().eval_at(part.record, slots, query);
  }
  case Kind::twosided: {
    ReferenceQuery turned = query;
    bool back = query.wo.z < 0;
    if (back)
      turned.wo = mirrored(query.wo), turned.wi = mirrored(query.wi);
    Eval<double> e[2];
    for (size_t k = 0; k < part.children.size(); ++k) // all of them, for the place in the numbers
      e[k] = eval_part(part.children[k], turned, numbers, next);
    return e[back && part.children.size() == 2];
  }
  case Kind::blend:
  case Kind::mask:
    break;
  }
  double weight = part.weight;
  if (!numbers.empty())
    weight = std::clamp(numbers[next++], 0.0, 1.0);
  Eval<double> sum;
  for (size_t k = 0; k < part.children.size(); ++k) {
    Eval<double> e = eval_part(part.children[k], query, numbers, next);
    double share = share_of(part.kind, weight, k);
    sum.value += e.value * share;
    sum.pdf += e.pdf * share;
  }
  return sum;
}

Eval<double> MaterialTree::reference(const ReferenceQuery& query,
                                     const std::vector<double>& numbers) const {
  size_t next = 0;
  return eval_part(root_, query, numbers, next);
}

Sample<double> MaterialTree::choose(const Part& part, const Vec3<double>& wo,
                                    const Random<double>& random, TransportMode mode) {
  if (part.kind == Kind::null)
    return straight_on(wo);
  if (part.kind == Kind::model)
    return part.parameters->model().sample(part.record, wo, random, mode, {0.5, 0.5});
  if (part.kind == Kind::twosided) {
    if (wo.z >= 0)
      return choose(part.children[0], wo, random, mode);
    Sample<double> s = choose(part.children.back(), mirrored(wo), random, mode);
    s.wi = mirrored(s.wi);
    return s;
  }
  double first = share_of(part.kind, part.weight, 0);
  bool second = random.uc >= first;
  double share = second ? 1 - first : first;
  Random<double> rest = random;
  rest.uc = std::clamp((random.uc - (second ? first : 0)) / share, 0.0, 1 - 0x1p-53);
  Sample<double> s = choose(part.children[second], wo, rest, mode);
  s.pdf *= share;
  return s;
}

Sample<double> MaterialTree::reference_sample(const Vec3<double>& wo, const Random<double>& random,
                                              TransportMode mode) const {
  Sample<double> s = choose(root_, wo, random, mode);
  if (s.valid && !s.delta) {
    Eval<double> e = reference({wo, s.wi, mode});
    s.value = e.value;
    s.pdf = e.pdf;
    s.weight = e.value * (1 / e.pdf);
  }
  return s;
}

// --- What is in it ---

template <class Visit> void MaterialTree::for_each(const Part& part, const Visit& visit) {
  visit(part);
  for (const Part& child : part.children)
    for_each(child, visit);
}

std::vector<const Parameters*> MaterialTree::models() const {
  std::vector<const Parameters*> found;
  for_each(root_, [&](const Part& part) {
    if (part.kind == Kind::model)
      found.push_back(part.parameters.get());
  });
  return found;
}

std::vector<double> MaterialTree::numbers() const {
  std::vector<double> all;
  for_each(root_, [&](const Part& part) {
    if (part.kind == Kind::blend || part.kind == Kind::mask)
      all.push_back(part.weight);
    all.insert(all.end(), part.record.slots.begin(), part.record.slots.end());
  });
  return all;
}

std::vector<int> MaterialTree::parameter_numbers() const {
  std::vector<int> indices;
  int first = 0;
  for_each(root_, [&](const Part& part) {
    if (part.kind == Kind::blend || part.kind == Kind::mask)
      indices.push_back(first++);
    if (part.kind != Kind::model)
      return;
    for (int slot : part.parameters->descriptor().parameter_slots())
      indices.push_back(first + slot);
    first += static_cast<int>(part.record.slots.size());
  });
  return indices;
}

int MaterialTree::sides_of(const Part& part) {
  if (part.kind == Kind::model)
    return part.parameters->descriptor().traits.two_sided ? kFront | kBack : kFront;
  if (part.kind == Kind::null || part.kind == Kind::twosided)
    return kFront | kBack;
  int sides = 0;
  for (size_t k = 0; k < part.children.size(); ++k)
    if (share_of(part.kind, part.weight, k) > 0)
      sides |= sides_of(part.children[k]);
  return sides;
}

std::string MaterialTree::text_of(const Part& part) {
  if (part.kind == Kind::model) {
    const Parameters& p = *part.parameters;
    std::string text = p.model().name();
    for (const auto& [name, value] : p.given())
      text += " " + name + "=" + value;
    return text;
  }
  std::string text = scene_node(part.kind).descriptor.name;
  if (part.kind == Kind::null)
    return text;
  std::string inside;
  if (part.kind != Kind::twosided)
    inside = fmt::format("{}={}", part.kind == Kind::mask ? "opacity" : "weight",
                         static_cast<float>(part.weight));
  size_t named = part.children.size() - (part.kind == Kind::mask);
  for (size_t k = 0; k < named; ++k)
    inside += (inside.empty() ? "" : k == 0 ? "; " : ", ") + text_of(part.children[k]);
  return text + "(" + inside + ")";
}

/// Traits and excuses that follow from the models; a part that has no share has no say.
void MaterialTree::gather(const Part& part) {
  Traits& traits = descriptor_.traits;
  if (part.kind == Kind::null) {
    traits.lobes |= kNullLobe;
    traits.has_delta = true;
    traits.albedo_bound = std::max(traits.albedo_bound, 1.0);
    return;
  }
  if (part.kind == Kind::model) {
    const Descriptor& d = part.parameters->descriptor();
    traits.lobes |= d.traits.lobes;
    traits.delta = traits.delta && d.traits.delta;
    traits.tabulated = traits.tabulated || d.traits.tabulated;
    traits.has_delta = traits.has_delta || d.traits.delta || d.traits.has_delta;
    traits.reciprocal = traits.reciprocal && d.traits.reciprocal;
    traits.albedo_bound = std::max(traits.albedo_bound, d.traits.albedo_bound);
    descriptor_.excuses.insert(descriptor_.excuses.end(), d.excuses.begin(), d.excuses.end());
  }
  for (size_t k = 0; k < part.children.size(); ++k)
    if (part.kind == Kind::twosided || share_of(part.kind, part.weight, k) > 0)
      gather(part.children[k]);
}

void MaterialTree::describe() {
  descriptor_ = scene_node(root_.kind).descriptor;
  descriptor_.traits = {.lobes = 0, .delta = true, .albedo_bound = 0};
  gather(root_);
  descriptor_.traits.two_sided = (sides_of(root_) & kBack) != 0;
  text_ = text_of(root_);
}

} // namespace faceta
