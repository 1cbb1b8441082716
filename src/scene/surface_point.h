#pragma once

#include "scene/double3.h"

namespace faceta {

/// All that a hit on a surface is made of, in world space and double precision. This is the slow,
/// exact counterpart of the renderer's own interaction stage, and its oracle in tests.
///
/// The conventions are those of Mitsuba 3.9.1, checked against it:
///  - n is the geometric normal, sh_n the shading normal; both are unit, and both are negated by
///    flip_normals. They may face opposite sides (a mirrored mesh with normals from its file).
///  - dp_du and dp_dv are not touched by flip_normals.
///  - s = normalize(dp_du - sh_n (sh_n . dp_du)), t = sh_n x s. Where dp_du is exactly zero,
///    s is the first vector of orthonormal_basis(sh_n).
struct SurfacePoint {
  Double3 p{};
  Double3 n{}, sh_n{};
  double u = 0, v = 0;
  Double3 dp_du{}, dp_dv{};
  Double3 s{}, t{};
};

struct Basis {
  Double3 s{}, t{};
};

/// Two unit vectors that make a right-handed frame (s, t, n) with the unit vector n. Branch-free
/// construction after Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017;
/// the sign of a zero z counts.
Basis orthonormal_basis(const Double3& n);

/// Fills s and t from sh_n and dp_du, by the rule above. Where dp_du is parallel to sh_n (Mitsuba
/// gives NaN there), s is taken from orthonormal_basis as well.
void complete_frame(SurfacePoint& point);

} // namespace faceta
