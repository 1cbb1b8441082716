#pragma once

#include "scene/double3.h"

namespace faceta {

/// Throws Error unless all entries are finite and the last row is (0, 0, 0, 1).
void check_affine(const ToWorld& m);

/// Determinant of the linear part.
double determinant(const ToWorld& m);

/// The determinant over the product of the column lengths, in [-1, 1]: 0 when singular, whatever
/// the scale; 0 also if a column is zero.
double relative_determinant(const ToWorld& m);

/// Inverse of an affine matrix. Throws Error with a message about `what` if it is singular.
ToWorld inverse(const ToWorld& m, const char* what);

/// a * b.
ToWorld multiply(const ToWorld& a, const ToWorld& b);

/// Maps normals by the inverse transpose and normalizes them. Computed as the signed cofactors, the
/// same direction, which stay finite when a matrix flattens the object; a normal without direction
/// comes out as zero.
class NormalMap {
public:
  explicit NormalMap(const ToWorld& m);
  Double3 operator()(const Double3& n) const;

private:
  Double3 columns_[3];
};

} // namespace faceta
