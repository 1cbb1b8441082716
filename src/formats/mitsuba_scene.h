#pragma once

#include "formats/xml_tree.h"
#include "scene/scene.h"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace faceta {

/// How a scene file is read.
struct ReadOptions {
  /// -Dname=value: wins over the file's <default>s.
  std::vector<std::pair<std::string, std::string>> defines;
  /// Properties that nobody knows, unused defines and doubled names are warnings, not errors.
  bool permissive = false;
  /// Gets "file:line:column: warning: ..."; may be empty.
  xml::Warn warn;
  /// Folders to look for files in, after those the scene names.
  std::vector<std::filesystem::path> search_paths;
};

/// Reads a Mitsuba 3 scene, meant for its RGB variants, with all the files it names. Defaults,
/// types and colour rules are those of Mitsuba 3.9.1; every parameter of a supported plugin is
/// read or refused, never dropped. Supported are
///  - shapes obj, ply, sphere, rectangle, disk, cylinder, cube;
///  - bsdfs: every registered model, twosided, mask, blendbsdf, null;
///  - textures bitmap, checkerboard; spectra uniform, srgb, d65, regular, irregular, rawconstant;
///  - emitters area, constant, envmap, point;
///  - sensor perspective, film hdrfilm, filters box, tent, gaussian;
///  - samplers independent and sobol (ours, which a sensor without a sampler gets: 4 samples);
///  - integrators path, direct, and one of them inside moment.
///
/// What differs from Mitsuba 3.9.1 on purpose: negative or non-finite colours, empty films and
/// filters and emitters that have no effect are errors (the last a warning); regular and irregular
/// spectra become RGB as pairs do, where Mitsuba fails as soon as it renders.
///
/// The result is not yet built (see Scene::build). Its sensors stand in the order of the file;
/// named_materials holds every bsdf with an id, nested ones included.
/// @throws Error at file, line and column: malformed input, unknown properties, missing sensor or
/// integrator, and plugins that are unknown or not supported yet, by name.
std::unique_ptr<Scene> read_mitsuba_scene(const std::filesystem::path& path,
                                          const ReadOptions& options = {});

/// The same for text in memory; `name` stands for the file in messages.
std::unique_ptr<Scene> read_mitsuba_scene_string(std::string_view text,
                                                 const std::string& name = "<string>",
                                                 const ReadOptions& options = {});

/// The same for a tree that was parsed, and perhaps changed, before.
std::unique_ptr<Scene> build_mitsuba_scene(const xml::Node& root, const ReadOptions& options = {});

/// The material of an id in a scene that was read. Error, with a suggestion, if there is none.
std::shared_ptr<MaterialNode> find_material(const Scene& scene, const std::string& id);

/// One material of a scene file, by the id of its bsdf. Nothing else of the file is read beyond its
/// syntax; textures of the material are added to `scene`.
/// @throws Error as above; also if no bsdf has that id, with the ids there are.
std::shared_ptr<MaterialNode> read_mitsuba_material(const std::filesystem::path& path,
                                                    const std::string& id, Scene& scene,
                                                    const ReadOptions& options = {});

/// Every bsdf of a scene file with its id (empty if it has none), in the order of the file, what is
/// nested behind what holds it; a bsdf that several places refer to comes once. The file may also
/// hold one <bsdf> instead of a <scene>. Nothing else of it is read, as above.
/// @throws Error as above; also if there is no bsdf.
NamedMaterials read_mitsuba_materials(const std::filesystem::path& path, Scene& scene,
                                      const ReadOptions& options = {});

} // namespace faceta
