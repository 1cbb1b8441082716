#pragma once

/// A tree of materials (twosided, mask, blendbsdf, null, and models at its ends) to be proved: as
/// the renderer puts it together, beside its definition in double.

#include "render/scene_material.h"
#include "scene/nodes.h"
#include "verify/batch.h"

namespace faceta {

class MaterialTree {
public:
  /// \param root not a model by itself; without textures
  explicit MaterialTree(const MaterialNode& root) : MaterialTree(root, root) {}
  /// The kernels run `drawn`, the reference follows `defined`. Two trees are for tests of the
  /// proof.
  MaterialTree(const MaterialNode& drawn, const MaterialNode& defined);

  const MaterialNode& definition() const { return *definition_; }
  /// Of the node at the root, with the traits and excuses that follow from the models.
  const Descriptor& descriptor() const { return descriptor_; }
  /// "blendbsdf(weight=0.3; diffuse, roughconductor alpha=0.2)"; trees with the same are the same.
  const std::string& text() const { return text_; }
  /// The models of the tree, in order.
  std::vector<const Parameters*> models() const;

  void eval(EvalArrays arrays, int n, Isa isa, TransportMode mode) const;
  void sample(SampleArrays arrays, int n, Isa isa, TransportMode mode) const;

  /// Slots of all models and the weights, one after the other.
  std::vector<double> numbers() const;
  /// Which of them are parameters: not derived from others, no offsets of tables.
  std::vector<int> parameter_numbers() const;
  /// By definition, model by model; with other numbers if `numbers` is not empty.
  Eval<double> reference(const ReferenceQuery& query,
                         const std::vector<double>& numbers = {}) const;
  Sample<double> reference_sample(const Vec3<double>& wo, const Random<double>& random,
                                  TransportMode mode) const;

private:
  struct Part {
    MaterialNode::Kind kind;
    std::shared_ptr<const Parameters> parameters; ///< of a model
    Record record;
    double weight = 0; ///< of the second child of a blend, or the opacity of a mask
    std::vector<Part> children;
  };
  static Part make_part(const MaterialNode& node);
  template <class Visit> static void for_each(const Part& part, const Visit& visit);
  static Eval<double> eval_part(const Part& part, const ReferenceQuery& query,
                                const std::vector<double>& numbers, size_t& next);
  static Sample<double> choose(const Part& part, const Vec3<double>& wo,
                               const Random<double>& random, TransportMode mode);
  /// The sides on which a part scatters: bit 0 front, bit 1 back.
  static int sides_of(const Part& part);
  static std::string text_of(const Part& part);
  void gather(const Part& part);
  void describe();

  std::shared_ptr<const MaterialNode> definition_;
  Part root_;
  Descriptor descriptor_;
  std::string text_;
  std::vector<std::unique_ptr<SceneMaterial>> kernels_; ///< by instruction set
};

/// A copy of a tree in which the means stand for the textures.
std::shared_ptr<MaterialNode> without_textures(const MaterialNode& root, const Scene& scene);

} // namespace faceta
