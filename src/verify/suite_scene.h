#pragma once

/// The materials of a scene as subjects of the suite.

#include "scene/scene.h"
#include "verify/suite.h"

namespace faceta {

/// Adds every model and every tree (twosided, mask, blendbsdf, null) among the materials, what is
/// nested in them too, with the parameters it has there. It is named by its id, else by the id of
/// what holds it and its type, else by its type and line. Once for several with equal parameters;
/// with the mean of each texture. What stands for something else goes to `notes`, a line each.
/// \param scene that holds the textures
/// @throws Error for a tree that the renderer would refuse.
void add_scene_subjects(const NamedMaterials& materials, const Scene& scene,
                        std::vector<SuiteSubject>& subjects, std::vector<std::string>& notes);

} // namespace faceta
