#include "scene/materials.h"

#include <algorithm>
#include <set>

namespace faceta {

namespace {

template <class E> void pad(std::vector<E>& array, size_t used) {
  array.resize(used + kLanePadding);
}

} // namespace

void MaterialStore::build(Isa isa) {
  program_views_.clear();
  for (Program& p : programs_) {
    ProgramView view{};
    view.kernel = p.model->kernels[static_cast<int>(isa)];
    if (!view.kernel)
      throw Error("material '" + p.model->name() + "' has no kernel for the instruction set '" +
                  kIsaNames[static_cast<int>(isa)] + "'");
    pad(p.records, size_t(p.rows) * p.stride);
    pad(p.textures, size_t(p.rows) * p.slots.size());
    pad(p.choices, size_t(p.model->descriptor.choices));
    view.records = p.records.data();
    view.stride = p.stride;
    view.choices = p.choices.data();
    view.textured = p.textured;
    view.delta_only = p.model->descriptor.traits.delta;
    view.texture_slots = static_cast<int32_t>(p.slots.size());
    std::copy(p.slots.begin(), p.slots.end(), view.slots);
    view.textures = p.textures.data();
    program_views_.push_back(view);
  }
  if (classes_.empty()) {
    tables_.resize(tables_.size() + kLanePadding);
    number_roots();
  }
  for (size_t k = 0; k < programs_.size(); ++k)
    program_views_[k].tables =
        programs_[k].file ? programs_[k].file->values.data() : tables_.data();
}

void MaterialStore::number_roots() {
  // Roots of one class get equal keys; a tree is a class of its own.
  using Key = std::tuple<int, int, int, int>;
  std::vector<std::pair<Key, int>> keyed;
  for (int i = 0; i < count(); ++i) {
    const RootView& root = roots_[i];
    const LeafView& leaf = leaves_[root.first_leaf];
    bool single = root.leaves == 1 && leaf.weights == 0;
    keyed.push_back({single ? Key{leaf.program, leaf.sides, leaf.mirrored, -1}
                            : Key{static_cast<int>(programs_.size()), 0, 0, i},
                     i});
  }
  std::sort(keyed.begin(), keyed.end());
  order_.resize(roots_.size());
  for (size_t k = 0; k < keyed.size(); ++k) {
    RootView root = roots_[keyed[k].second];
    bool single = std::get<3>(keyed[k].first) < 0;
    if (k == 0 || keyed[k].first != keyed[k - 1].first) {
      ClassView c{};
      c.first_root = static_cast<int32_t>(k);
      c.single = single;
      c.leaf = leaves_[root.first_leaf];
      classes_.push_back(c);
    }
    ++classes_.back().roots;
    root.class_index = static_cast<int32_t>(classes_.size()) - 1;
    root.row = single ? leaves_[root.first_leaf].row : 0;
    order_[keyed[k].second] = static_cast<int>(k);
    final_roots_.push_back(root);
  }
}

size_t MaterialStore::bytes() const {
  size_t total = tables_.size() * 4 + weights_.size() * sizeof(WeightView) +
                 leaves_.size() * sizeof(LeafView) + roots_.size() * sizeof(RootView);
  std::set<const FileTables*> files;
  for (const Program& p : programs_) {
    if (p.file && files.insert(p.file.get()).second)
      total += p.file->values.size() * 4;
    total += (p.records.size() + p.textures.size()) * 4;
  }
  return total;
}

} // namespace faceta
