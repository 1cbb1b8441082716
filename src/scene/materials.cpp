#include "scene/materials.h"

#include "spectrum/cie.h"

#include <algorithm>
#include <cmath>

namespace faceta {

namespace {

constexpr int kMaxDepth = 32, kMaxLeaves = 64;
// Table offsets are kept in float slots, where whole numbers are exact up to here.
constexpr size_t kMaxTables = size_t(1) << 24;

void expect_children(const MaterialNode& node, const char* what, size_t low, size_t high) {
  size_t n = node.children.size();
  bool complete = std::all_of(node.children.begin(), node.children.end(),
                              [](const auto& child) { return child != nullptr; });
  if (n < low || n > high || !complete)
    throw Error(std::string("a ") + what + " material has " + std::to_string(n) + " children",
                node.where,
                "it takes " + (low == high ? std::to_string(low)
                                           : std::to_string(low) + " or " + std::to_string(high)));
}

/// The slots that a parameter's texture feeds: (slot, count).
std::vector<std::pair<int, int>> texture_slots(const ParamInfo& p) {
  if (p.slots == 3)
    return {{p.slot, 3}};
  std::vector<std::pair<int, int>> slots; // a roughness feeds both directions
  for (int i = 0; i < p.slots; ++i)
    slots.push_back({p.slot + i, 1});
  return slots;
}

} // namespace

int MaterialStore::add(const MaterialNode& root, const TextureStore& textures) {
  RootView view{};
  view.first_leaf = static_cast<int32_t>(leaves_.size());
  Place place;
  place.first_leaf = view.first_leaf;
  place.where = root.where;
  flatten(root, textures, place);
  view.leaves = static_cast<int32_t>(leaves_.size()) - view.first_leaf;
  roots_.push_back(view);
  return count() - 1;
}

void MaterialStore::flatten(const MaterialNode& node, const TextureStore& textures,
                            const Place& place) {
  if (place.depth > kMaxDepth)
    throw Error("materials are nested more than " + std::to_string(kMaxDepth) + " deep",
                node.where);
  Place below = place;
  ++below.depth;
  switch (node.kind) {
  case MaterialNode::Kind::null:
    expect_children(node, "null", 0, 0);
    if (place.twosided)
      throw Error("a twosided material cannot hold a null material", node.where,
                  "only materials that do not transmit light can be made two-sided");
    return add_leaf(-1, 0, place);
  case MaterialNode::Kind::blend:
    expect_children(node, "blend", 2, 2);
    flatten_share(node.children[0].get(), node.weight, true, textures, below);
    return flatten_share(node.children[1].get(), node.weight, false, textures, below);
  case MaterialNode::Kind::mask:
    expect_children(node, "mask", 1, 1);
    if (place.twosided)
      throw Error("a twosided material cannot hold a mask", node.where,
                  "put the twosided material into the mask");
    flatten_share(node.children[0].get(), node.weight, false, textures, below);
    return flatten_share(nullptr, node.weight, true, textures, below);
  case MaterialNode::Kind::twosided:
    return flatten_twosided(node, textures, below);
  case MaterialNode::Kind::model:
    auto [program, row] = add_record(node, textures);
    const Descriptor& d = programs_[program].model->descriptor;
    if (place.twosided && (d.traits.lobes & (kTransmission | kNullLobe)))
      throw Error("a twosided material cannot hold '" + d.name + "', which transmits light",
                  node.where, "use '" + d.name + "' without twosided: it has two sides itself");
    add_leaf(program, row, place);
  }
}

void MaterialStore::flatten_twosided(const MaterialNode& node, const TextureStore& textures,
                                     const Place& place) {
  expect_children(node, "twosided", 1, 2);
  Place below = place;
  below.twosided = true;
  if (place.twosided) // an outer one already shows this one its front
    return flatten(*node.children[0], textures, below);
  if (node.children.size() == 1) {
    below.mirrored = true;
    return flatten(*node.children[0], textures, below);
  }
  below.sides = kFrontSide;
  flatten(*node.children[0], textures, below);
  below.sides = kBackSide;
  below.mirrored = true;
  flatten(*node.children[1], textures, below);
}

void MaterialStore::flatten_share(const MaterialNode* child, const TexturedValue& weight,
                                  bool complement, const TextureStore& textures,
                                  const Place& place) {
  Place below = place;
  if (weight.texture >= 0) {
    textures.check(weight.texture, "weight of a material");
    below.weights.push_back({weight.texture, 0, complement});
  } else {
    double w = std::clamp(luminance(weight.value), 0.0, 1.0);
    if (std::isnan(w))
      throw Error("the weight of a material is not a number",
                  child ? child->where : SourcePosition{});
    double share = complement ? 1 - w : w;
    if (share == 0)
      return;
    if (share < 1)
      below.weights.push_back({-1, static_cast<float>(w), complement});
  }
  if (child)
    flatten(*child, textures, below);
  else
    add_leaf(-1, 0, below);
}

void MaterialStore::add_leaf(int program, int row, const Place& place) {
  // Counted here, as a tree of shared nodes can have 2^depth leaves.
  if (leaves_.size() - size_t(place.first_leaf) == kMaxLeaves)
    throw Error("a material tree has more than " + std::to_string(kMaxLeaves) + " leaves",
                place.where);
  LeafView leaf{};
  leaf.program = program;
  leaf.row = row;
  leaf.sides = place.sides;
  leaf.mirrored = place.mirrored;
  leaf.first_weight = static_cast<int32_t>(weights_.size());
  leaf.weights = static_cast<int32_t>(place.weights.size());
  weights_.insert(weights_.end(), place.weights.begin(), place.weights.end());
  leaves_.push_back(leaf);
}

std::pair<int, int> MaterialStore::add_record(const MaterialNode& node,
                                              const TextureStore& textures) {
  expect_children(node, "simple", 0, 0);
  if (!node.parameters)
    throw Error("a material has no parameters", node.where);
  Parameters parameters = *node.parameters;
  std::map<int, std::pair<int, int>> bound; // slot -> count, texture
  for (const auto& [name, texture] : node.textures) {
    textures.check(texture, "material");
    std::array<double, 3> mean = textures.mean(texture);
    const ParamInfo* p = parameters.descriptor().find(name);
    if (p && p->slots != 3)
      mean.fill(luminance(mean));
    parameters.set_texture(name, mean, node.where);
    for (auto [slot, count] : texture_slots(*parameters.descriptor().find(name)))
      bound[slot] = {count, texture};
  }
  parameters.check(node.where);
  Record record = parameters.record();
  std::vector<std::pair<int, int>> slots;
  for (const auto& [slot, use] : bound)
    slots.push_back({slot, use.first});
  int index = find_program(parameters.model(), record, slots, node.where);

  Program& program = programs_[index];
  if (tables_.size() + record.tables.size() > kMaxTables)
    throw Error("the materials of this scene need tables of more than 2^24 numbers", node.where);
  for (int k : program.model->descriptor.table_slots)
    record.slots[k] += static_cast<float>(tables_.size());
  tables_.insert(tables_.end(), record.tables.begin(), record.tables.end());
  program.records.insert(program.records.end(), record.slots.begin(), record.slots.end());
  for (const auto& [slot, use] : bound)
    program.textures.push_back(use.second);
  return {index, program.rows++};
}

int MaterialStore::find_program(const Model& model, const Record& record,
                                const std::vector<std::pair<int, int>>& slots,
                                const SourcePosition& where) {
  auto [at, fresh] = program_index_.try_emplace({&model, record.choices, slots, record.file.get()},
                                                static_cast<int>(programs_.size()));
  if (!fresh)
    return at->second;
  if (slots.size() > size_t(kMaxTextureSlots) || model.descriptor.slots > kMaxSlots)
    throw Error("material '" + model.name() + "' has more textures than the " +
                    std::to_string(kMaxTextureSlots) + " that one can have",
                where);
  Program program;
  program.model = &model;
  program.choices = record.choices;
  program.file = record.file;
  program.stride = static_cast<int>(record.slots.size());
  for (auto [slot, count] : slots) {
    program.slots.push_back({slot, count});
    program.textured |= ((uint64_t(1) << count) - 1) << slot;
  }
  programs_.push_back(std::move(program));
  return at->second;
}

} // namespace faceta
