#include "base/happens_before.h"
#include "formats/mesh_obj.h"
#include "formats/mesh_ply.h"
#include "formats/mitsuba_reader.h"
#include "scene/affine.h"

#include <algorithm>
#include <exception>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace faceta::mitsuba {

namespace {

/// Mesh files in memory at once.
constexpr size_t kMeshesAtOnce = 8;

std::vector<std::string> known_names(std::initializer_list<const char*> own) {
  std::vector<std::string> names(own.begin(), own.end());
  names.insert(names.end(), {"to_world", "flip_normals", "silhouette_sampling_weight"});
  return names;
}

ToWorld read_to_world(const xml::Node& node) {
  ToWorld m = node.get_transform("to_world", xml::kIdentity);
  located(node.error_at("to_world", "").where(), [&] { check_affine(m); });
  return m;
}

} // namespace

/// The material of a shape that names none: black if it emits.
const xml::NodePtr& Reader::default_material(bool emits, const SourcePosition& where) {
  xml::NodePtr& node = default_materials_[emits ? 1 : 0];
  if (!node) {
    node = std::make_shared<xml::Node>();
    node->tag = "bsdf";
    node->type = "diffuse";
    node->where = where;
    node->set("reflectance", xml::Type::float_, emits ? 0.0 : 0.5);
  }
  return node;
}

void Reader::read_shape_children(const xml::Node& node, ShapeDesc& shape) {
  xml::NodePtr bsdf, emitter;
  for (const xml::Property& property : node.properties) {
    xml::NodePtr child = property.object();
    if (!child)
      continue;
    auto refuse = [&](const std::string& message) { throw Error(message, property.where); };
    if (child->tag == "bsdf") {
      if (bsdf)
        refuse(node.describe() + " has more than one bsdf");
      bsdf = child;
    } else if (child->tag == "emitter") {
      if (emitter)
        refuse(node.describe() + " has more than one emitter");
      emitter = child;
    } else if (child->tag == "medium") {
      refuse(fmt::format("medium '{}' in a shape is not supported yet", child->type));
    } else if (child->tag == "sensor") {
      refuse(fmt::format("sensor '{}' in a shape is not supported yet", child->type));
    } else if (child->tag == "texture" || child->tag == "spectrum") {
      refuse(fmt::format("{} '{}' as an attribute of a shape is not supported yet", child->tag,
                         child->type));
    } else {
      continue;
    }
    property.queried = true;
  }
  if (emitter) {
    if (emitter->type != "area")
      throw emitter->type == "constant" || emitter->type == "envmap" || emitter->type == "point"
          ? emitter->error(fmt::format("an emitter '{}' cannot belong to a shape", emitter->type),
                           "<emitter type=\"area\">")
          : unsupported_plugin(*emitter, {"area"});
    if (!attached_emitters_.insert(emitter.get()).second)
      throw node.error(emitter->describe() + " belongs to more than one shape");
    shape.emitter = read_area_emitter(*emitter);
  }
  if (!bsdf)
    bsdf = default_material(emitter != nullptr, node.where);
  shape.material = material_index(read_material(bsdf), bsdf->where);
}

void Reader::read_shape(const xml::NodePtr& pointer) {
  const xml::Node& node = *pointer;
  const std::string& type = node.type;
  static const std::vector<std::string> supported = {"obj",  "ply",      "sphere", "rectangle",
                                                     "disk", "cylinder", "cube"};
  if (std::find(supported.begin(), supported.end(), type) == supported.end())
    throw unsupported_plugin(node, supported);
  PendingShape shape;
  shape.where = node.where;
  shape.desc.name = node.id;
  ToWorld to_world = read_to_world(node);
  non_negative(node, "silhouette_sampling_weight", 1); // of use to differentiable renderers only
  bool flip = node.get_boolean("flip_normals", false);
  std::vector<std::string> known;
  if (type == "obj" || type == "ply") {
    MeshOptions options;
    options.flip_tex_coords = node.get_boolean("flip_tex_coords", type == "obj");
    options.face_normals = node.get_boolean("face_normals", false);
    options.flip_normals = flip;
    std::string file = node.get_file("filename").string();
    if (shape.desc.name.empty())
      shape.desc.name = std::filesystem::path(file).filename().string();
    auto read = type == "obj" ? read_obj : read_ply;
    shape.load = [=] {
      Mesh mesh = read(file, options);
      place(mesh, to_world);
      return mesh;
    };
    known = known_names({"filename", "face_normals", "flip_tex_coords"});
  } else if (type == "rectangle" || type == "cube") {
    bool face_normals = node.get_boolean("face_normals", false);
    bool rectangle = type == "rectangle";
    shape.rectangle = rectangle;
    shape.load = [=] {
      Mesh mesh = rectangle ? make_rectangle() : make_cube();
      mesh.face_normals = face_normals;
      mesh.flip_normals = flip;
      place(mesh, to_world);
      return mesh;
    };
    known = known_names({"face_normals"});
  } else {
    known = read_quadric(node, to_world, flip, shape);
  }
  if (shape.desc.name.empty())
    shape.desc.name = type;
  read_shape_children(node, shape.desc);
  finish(node, known);
  shapes_.push_back(std::move(shape));
}

std::vector<std::string> Reader::read_quadric(const xml::Node& node, const ToWorld& to_world,
                                              bool flip, PendingShape& shape) {
  return located(node.where, [&]() -> std::vector<std::string> {
    if (node.type == "sphere") {
      Sphere sphere = make_sphere(node.get_point("center", {0, 0, 0}), node.get_float("radius", 1),
                                  flip, to_world);
      if (!sphere.warning.empty())
        warn(node.where, sphere.warning);
      shape.add = [=](Scene& s, const ShapeDesc& desc) { s.add_sphere(sphere, desc); };
      return known_names({"center", "radius"});
    }
    if (node.type == "disk") {
      Disk disk = make_disk(flip, to_world);
      shape.add = [=](Scene& s, const ShapeDesc& desc) { s.add_disk(disk, desc); };
      return known_names({});
    }
    Cylinder cylinder =
        make_cylinder(node.get_point("p0", {0, 0, 0}), node.get_point("p1", {0, 0, 1}),
                      node.get_float("radius", 1), flip, to_world);
    if (!cylinder.warning.empty())
      warn(node.where, cylinder.warning);
    shape.add = [=](Scene& s, const ShapeDesc& desc) { s.add_cylinder(cylinder, desc); };
    return known_names({"p0", "p1", "radius"});
  });
}

void Reader::load_pending_shapes() {
  for (size_t begin = 0; begin < shapes_.size(); begin += kMeshesAtOnce) {
    size_t count = std::min(kMeshesAtOnce, shapes_.size() - begin);
    std::vector<Mesh> meshes(count);
    std::vector<std::exception_ptr> errors(count);
    tbb::parallel_for(size_t{0}, count, [&](size_t i) {
      try {
        if (shapes_[begin + i].load)
          meshes[i] = shapes_[begin + i].load();
      } catch (...) {
        errors[i] = std::current_exception();
      }
      happens_before::publish(&meshes);
    });
    happens_before::receive(&meshes);
    for (size_t i = 0; i < count; ++i) {
      PendingShape& shape = shapes_[begin + i];
      located(shape.where, [&] {
        if (errors[i])
          std::rethrow_exception(errors[i]);
        if (shape.load)
          scene_->add_mesh(meshes[i], shape.desc, shape.rectangle);
        else
          shape.add(*scene_, shape.desc);
      });
    }
  }
  shapes_.clear();
}

} // namespace faceta::mitsuba
