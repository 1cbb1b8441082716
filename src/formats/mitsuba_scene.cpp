#include "formats/mitsuba_scene.h"

#include "formats/mitsuba_reader.h"

#include <fmt/format.h>
#include <functional>

namespace faceta {

namespace mitsuba {

namespace {

/// Properties of a scene that only steer the peer's search for intersections.
const std::vector<std::string> kTracingOptions = {"embree_use_robust_intersections",
                                                  "allow_thread_reordering",
                                                  "kd_intersection_cost",
                                                  "kd_traversal_cost",
                                                  "kd_empty_space_bonus",
                                                  "kd_stop_prims",
                                                  "kd_max_depth",
                                                  "kd_min_max_bins",
                                                  "kd_clip",
                                                  "kd_retract_bad_splits",
                                                  "kd_exact_primitive_threshold"};

} // namespace

void Reader::read_scene(const xml::Node& root) {
  if (root.tag != "scene")
    throw root.error(fmt::format("a scene file must hold a <scene>, not a <{}>", root.tag));
  for (const xml::Property& property : root.properties)
    if (xml::NodePtr child = property.object()) {
      property.queried = true;
      read_child(child);
    }
  for (const std::string& name : kTracingOptions)
    if (root.has(name)) {
      root.mark(name);
      warn(root.find(name)->where, fmt::format("'{}' has no effect here", name));
    }
  finish(root, kTracingOptions);
  if (!integrator_)
    throw root.error("the scene has no integrator", "<integrator type=\"path\"/>");
  if (scene_->sensors.empty())
    throw root.error("the scene has no sensor", "<sensor type=\"perspective\">");
  for (const xml::NodePtr& emitter : free_area_emitters_)
    if (!attached_emitters_.count(emitter.get()))
      warn(emitter->where, emitter->describe() + " belongs to no shape and does not emit");
  load_pending_shapes();
}

void Reader::read_child(const xml::NodePtr& child) {
  const std::string& tag = child->tag;
  if (tag == "shape")
    read_shape(child);
  else if (tag == "bsdf")
    read_material(child);
  else if (tag == "emitter")
    read_top_emitter(child);
  else if (tag == "sensor")
    read_sensor(*child);
  else if (tag == "texture" || tag == "spectrum")
    read_texture(child, {SpectrumUse::unbounded, false});
  else if (tag == "film")
    read_film(*child);
  else if (tag == "rfilter")
    read_filter(*child);
  else if (tag == "sampler")
    read_sampler(*child);
  else if (tag == "integrator") {
    if (integrator_)
      throw child->error("the scene has more than one integrator");
    integrator_ = child.get();
    scene_->integrator = read_integrator(*child);
  } else {
    throw unsupported_plugin(*child, {});
  }
}

void Reader::read_top_emitter(const xml::NodePtr& node) {
  if (node->type == "area") {
    read_area_emitter(*node);
    free_area_emitters_.push_back(node);
  } else if (node->type == "point") {
    read_point_light(*node);
  } else if (node->type == "constant") {
    read_constant_environment(*node);
  } else if (node->type == "envmap") {
    read_envmap(*node);
  } else {
    throw unsupported_plugin(*node, {"area", "constant", "envmap", "point"});
  }
}

namespace {

xml::ParseOptions parse_options(const ReadOptions& options) {
  xml::ParseOptions parse;
  parse.defines = options.defines;
  parse.permissive = options.permissive;
  parse.search_paths = options.search_paths;
  parse.warn = options.warn;
  return parse;
}

std::unique_ptr<Scene> read(const xml::Node& root, const ReadOptions& options) {
  auto scene = std::make_unique<Scene>();
  Reader(scene.get(), options).read_scene(root);
  return scene;
}

/// The bsdf of an id, wherever it stands; collects all ids on the way.
xml::NodePtr find_bsdf(const xml::NodePtr& node, const std::string& id,
                       std::unordered_set<const xml::Node*>& seen, std::vector<std::string>& ids) {
  if (!seen.insert(node.get()).second)
    return nullptr;
  if (node->tag == "bsdf" && !node->id.empty()) {
    if (node->id == id)
      return node;
    ids.push_back(node->id);
  }
  for (const xml::Property& property : node->properties)
    if (xml::NodePtr child = property.object())
      if (xml::NodePtr found = find_bsdf(child, id, seen, ids))
        return found;
  return nullptr;
}

/// All bsdfs, each before those nested in it.
void collect_bsdfs(const xml::NodePtr& node, std::unordered_set<const xml::Node*>& seen,
                   std::vector<xml::NodePtr>& bsdfs) {
  if (!seen.insert(node.get()).second)
    return;
  if (node->tag == "bsdf")
    bsdfs.push_back(node);
  for (const xml::Property& property : node->properties)
    if (xml::NodePtr child = property.object())
      collect_bsdfs(child, seen, bsdfs);
}

Error no_material(const std::string& id, const std::vector<std::string>& ids,
                  const SourcePosition& where) {
  return Error(fmt::format("the scene has no bsdf with the id '{}'", id), where,
               ids.empty() ? "no bsdf of the scene has an id" : suggestion(id, ids));
}

} // namespace
} // namespace mitsuba

std::unique_ptr<Scene> read_mitsuba_scene(const std::filesystem::path& path,
                                          const ReadOptions& options) {
  return mitsuba::read(*xml::parse_scene_file(path, mitsuba::parse_options(options)), options);
}

std::unique_ptr<Scene> read_mitsuba_scene_string(std::string_view text, const std::string& name,
                                                 const ReadOptions& options) {
  return mitsuba::read(*xml::parse_scene_string(text, name, mitsuba::parse_options(options)),
                       options);
}

std::unique_ptr<Scene> build_mitsuba_scene(const xml::Node& root, const ReadOptions& options) {
  return mitsuba::read(root, options);
}

std::shared_ptr<MaterialNode> find_material(const Scene& scene, const std::string& id) {
  std::vector<std::string> ids;
  for (const auto& [name, material] : scene.named_materials) {
    if (name == id)
      return material;
    ids.push_back(name);
  }
  throw mitsuba::no_material(id, ids, {});
}

std::shared_ptr<MaterialNode> read_mitsuba_material(const std::filesystem::path& path,
                                                    const std::string& id, Scene& scene,
                                                    const ReadOptions& options) {
  xml::NodePtr root = xml::parse_scene_file(path, mitsuba::parse_options(options));
  std::unordered_set<const xml::Node*> seen;
  std::vector<std::string> ids;
  xml::NodePtr node = mitsuba::find_bsdf(root, id, seen, ids);
  if (!node)
    throw mitsuba::no_material(id, ids, root->where);
  return mitsuba::Reader(&scene, options).read_material(node);
}

NamedMaterials read_mitsuba_materials(const std::filesystem::path& path, Scene& scene,
                                      const ReadOptions& options) {
  xml::NodePtr root = xml::parse_scene_file(path, mitsuba::parse_options(options));
  std::unordered_set<const xml::Node*> seen;
  std::vector<xml::NodePtr> bsdfs;
  mitsuba::collect_bsdfs(root, seen, bsdfs);
  if (bsdfs.empty())
    throw Error("the scene has no bsdf", root->where);
  mitsuba::Reader reader(&scene, options);
  NamedMaterials materials;
  for (const xml::NodePtr& bsdf : bsdfs)
    materials.emplace_back(bsdf->id, reader.read_material(bsdf));
  return materials;
}

} // namespace faceta
