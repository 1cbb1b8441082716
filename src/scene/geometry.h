#pragma once

/// Triangles and quadrics of a scene as the kernels and Embree read them.

#include "base/huge_vector.h"
#include "scene/mesh.h"
#include "scene/primitives.h"
#include "scene/view.h"

#include <limits>

namespace faceta {

/// An axis-aligned box.
struct Box {
  Double3 low, high;
};

/// What the intersection of a quadric needs, in double precision.
struct QuadricShape {
  QuadricType type;
  double to_local[12]; ///< rows of a 3x4 affine map
  Box box;             ///< in the world
};

/// The nearest distance along o + t d in [t_min, t_max], or a negative number.
double intersect(const QuadricShape& quadric, const Double3& o, const Double3& d, double t_min,
                 double t_max);

struct SceneGeometry {
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  HugeVector<TriangleRecord> triangles;
  std::vector<QuadricRecord> quadrics;
  std::vector<QuadricShape> quadric_shapes;
  std::vector<float> positions; ///< of the triangles' vertices, for Embree
  std::vector<uint32_t> indices;
  Box box{{kNone, kNone, kNone}, {-kNone, -kNone, -kNone}};

  /// Appends all triangles of a mesh; flip_normals reverses their winding. Returns the first index.
  /// Material and light are left 0 and -1.
  int add(const Mesh& mesh, int shape);
  int add(const Sphere& sphere, int shape);
  int add(const Disk& disk, int shape);
  int add(const Cylinder& cylinder, int shape);
  size_t bytes() const;

private:
  int add_quadric(QuadricType type, const ToWorld& to_world, bool inward, double area, int shape);
};

} // namespace faceta
