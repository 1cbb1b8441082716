#include "scene/surface_point.h"

namespace faceta {

using namespace double3;

Basis orthonormal_basis(const Double3& n) {
  double sign = std::copysign(1.0, n[2]);
  double a = -1 / (sign + n[2]);
  double b = n[0] * n[1] * a;
  return {{1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]}, {b, sign + n[1] * n[1] * a, -n[1]}};
}

void complete_frame(SurfacePoint& point) {
  Double3 s = sub(point.dp_du, scale(point.sh_n, dot(point.sh_n, point.dp_du)));
  bool usable = length(s) > 1e-12 * length(point.dp_du);
  point.s = usable ? normalize(s) : orthonormal_basis(point.sh_n).s;
  point.t = cross(point.sh_n, point.s);
}

} // namespace faceta
