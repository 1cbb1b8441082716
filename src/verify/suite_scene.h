#pragma once

/// The materials of a scene as subjects of the suite.

#include "scene/scene.h"
#include "verify/suite.h"

namespace faceta {

/// Adds every model among the materials (pairs of an id, perhaps empty, and a node; what is nested
/// in them too) with the parameters it has there. It is named by its id, else by the id of what
/// holds it and its model, else by its model and line. Once for several with equal parameters; with
/// the mean of each texture. What stands for something else, and what is not verified (the nodes
/// that only the renderer puts together), goes to `notes`, a line each.
void add_scene_subjects(
    const std::vector<std::pair<std::string, std::shared_ptr<MaterialNode>>>& materials,
    std::vector<SuiteSubject>& subjects, std::vector<std::string>& notes);

} // namespace faceta
