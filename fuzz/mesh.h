#pragma once

#include "formats/mesh_input.h"
#include "fuzz.h"
#include "scene/mesh.h"
#include "scene/scene.h"

#include <cmath>

namespace faceta::fuzz {

inline void check(const Mesh& mesh) {
  require(mesh.indices.size() % 3 == 0 && mesh.positions.size() % 3 == 0, "a mesh has triangles");
  require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size(),
          "one normal a vertex");
  require(mesh.uvs.empty() || mesh.uvs.size() / 2 == mesh.vertex_count(), "one uv a vertex");
  for (uint32_t index : mesh.indices)
    require(index < mesh.vertex_count(), "indices are in range");
  for (const auto* numbers : {&mesh.positions, &mesh.normals, &mesh.uvs})
    for (float number : *numbers)
      require(std::isfinite(number), "numbers are finite");
}

/// Reads a mesh file, places it and makes the records of its triangles, some as lights.
inline int read_mesh(const uint8_t* data, size_t size,
                     Mesh (*parse)(std::string_view, const std::string&, const MeshOptions&)) {
  MeshOptions options;
  options.flip_tex_coords = size % 2 != 0;
  options.face_normals = size % 4 >= 2;
  options.flip_normals = size % 8 >= 4;
  Mesh mesh;
  if (!accepts([&] { mesh = parse(text_of(data, size), "mesh", options); }))
    return 0;
  check(mesh);
  try {
    ToWorld to_world = kIdentityToWorld;
    to_world[0] = -2, to_world[1] = 1;
    place(mesh, to_world);
    check(mesh);
    Scene scene;
    auto material = std::make_shared<MaterialNode>();
    material->kind = MaterialNode::Kind::null;
    ShapeDesc shape;
    shape.name = "mesh";
    shape.material = scene.add_material(material);
    if (size % 16 >= 8)
      shape.emitter = std::make_shared<AreaEmitter>();
    scene.add_mesh(mesh, shape, mesh.triangle_count() == 2);
  } catch (const Error& error) {
    require(!error.message().empty(), "an error has a message"); // places are the scene reader's
  }
  return 0;
}

} // namespace faceta::fuzz
