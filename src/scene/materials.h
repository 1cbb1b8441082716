#pragma once

/// Material trees, flattened into programs, records, leaves, weights, roots and classes.

#include "scene/textures.h"

#include <map>
#include <tuple>

namespace faceta {

class MaterialStore {
public:
  /// Flattens a tree and returns its number. Throws Error if it is malformed.
  int add(const MaterialNode& root, const TextureStore& textures);
  int count() const { return static_cast<int>(roots_.size()); }

  /// Numbers the roots so that those of a class are adjacent, and points the programs at the
  /// kernels of an instruction set; Error if this CPU has none.
  void build(Isa isa);
  /// The number of a root after build().
  int final_root(int root) const { return order_[root]; }

  const std::vector<ProgramView>& programs() const { return program_views_; }
  const std::vector<WeightView>& weights() const { return weights_; }
  const std::vector<LeafView>& leaves() const { return leaves_; }
  const std::vector<RootView>& roots() const { return final_roots_; }
  const std::vector<ClassView>& classes() const { return classes_; }
  size_t bytes() const;

private:
  /// A model with its choices, file and textured slots; a row per parameter set.
  struct Program {
    const Model* model = nullptr;
    std::vector<int32_t> choices;
    std::vector<TextureSlot> slots;
    uint64_t textured = 0;
    int stride = 0, rows = 0;
    std::vector<float> records;
    std::shared_ptr<const FileTables> file;
    std::vector<int32_t> textures;
  };
  using ProgramKey =
      std::tuple<const Model*, std::vector<int32_t>, std::vector<std::pair<int, int>>,
                 const FileTables*>;

  /// Where in a tree flatten() is.
  struct Place {
    bool twosided = false; ///< below a twosided node
    int32_t sides = kFrontSide | kBackSide;
    bool mirrored = false;
    std::vector<WeightView> weights;
    int depth = 0;
    int32_t first_leaf = 0; ///< of the tree
    SourcePosition where;   ///< of the root
  };

  void flatten(const MaterialNode& node, const TextureStore& textures, const Place& place);
  void flatten_twosided(const MaterialNode& node, const TextureStore& textures, const Place& place);
  /// One child with its share of a blend or mask; null: the null leaf. Shares of exactly 0 vanish.
  void flatten_share(const MaterialNode* child, const TexturedValue& weight, bool complement,
                     const TextureStore& textures, const Place& place);
  void add_leaf(int program, int row, const Place& place);
  std::pair<int, int> add_record(const MaterialNode& node, const TextureStore& textures);
  int find_program(const Model& model, const Record& record,
                   const std::vector<std::pair<int, int>>& slots, const SourcePosition& where);
  void number_roots();

  std::vector<Program> programs_;
  std::map<ProgramKey, int> program_index_;
  std::vector<float> tables_;
  std::vector<WeightView> weights_;
  std::vector<LeafView> leaves_;
  std::vector<RootView> roots_; ///< in the order of add()
  std::vector<int> order_;
  std::vector<ProgramView> program_views_;
  std::vector<RootView> final_roots_;
  std::vector<ClassView> classes_;
};

} // namespace faceta
