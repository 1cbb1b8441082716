#pragma once

#include "scene/scene.h"

namespace faceta {

/// A bsdf that exists in scene files only: it puts other bsdfs together, or lets light pass.
struct SceneNode {
  MaterialNode::Kind kind;
  Descriptor descriptor; ///< without exemplars; traits.lobes is 0 where the nested bsdfs decide
  std::string nested;    ///< of its XML snippet: what has no default, and the bsdfs, a line each
  /// Trees with this node at the root, for the proof: a name, and the <bsdf> of a scene file.
  std::vector<std::pair<std::string, std::string>> exemplars;
};

/// twosided, mask, blendbsdf, null.
const std::vector<SceneNode>& scene_nodes();
/// The node of a kind; Error for models.
const SceneNode& scene_node(MaterialNode::Kind kind);
/// Null if nothing has this name.
const SceneNode* find_scene_node(const std::string& name);

} // namespace faceta
