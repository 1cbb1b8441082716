#pragma once

// Models for scene tests: enough of a material to be flattened, never run.

#include "scene/scene.h"

namespace test {

/// Reflects; has a colour, a roughness, a number, a choice and a table.
const faceta::Model& glossy();
/// Lets light through.
const faceta::Model& glass();
/// Reflects as a delta.
const faceta::Model& mirror();

using Node = std::shared_ptr<faceta::MaterialNode>;

Node leaf(const faceta::Model& model);
Node tree(faceta::MaterialNode::Kind kind, std::vector<Node> children, double weight = 0.5);

/// A shape of a new grey material.
faceta::ShapeDesc grey_shape(faceta::Scene& scene);
std::shared_ptr<faceta::AreaEmitter> emitter(double radiance, double sampling_weight = 1);

} // namespace test
