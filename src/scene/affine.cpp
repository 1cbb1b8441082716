#include "scene/affine.h"

#include "base/error.h"

#include <algorithm>
#include <string>

namespace faceta {

using namespace double3;

namespace {

// Relative determinants below this are singular: rounding alone reaches some 1e-16.
constexpr double kSingular = 1e-14;

} // namespace

void check_affine(const ToWorld& m) {
  for (double x : m)
    if (!std::isfinite(x))
      throw Error("to_world holds a number that is not finite");
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    throw Error("to_world is not affine", {}, "its last row must be 0 0 0 1");
}

double determinant(const ToWorld& m) {
  return dot(column(m, 0), cross(column(m, 1), column(m, 2)));
}

double relative_determinant(const ToWorld& m) {
  Double3 c[3] = {normalize(column(m, 0)), normalize(column(m, 1)), normalize(column(m, 2))};
  return dot(c[0], cross(c[1], c[2]));
}

ToWorld inverse(const ToWorld& m, const char* what) {
  if (std::abs(relative_determinant(m)) < kSingular)
    throw Error(std::string("to_world of the ") + what + " cannot be inverted", {},
                "it flattens the shape: scale by something other than 0");
  Double3 c0 = column(m, 0), c1 = column(m, 1), c2 = column(m, 2);
  // Columns are scaled to unit length first: neither tiny nor huge scales then overflow.
  double l0 = length(c0), l1 = length(c1), l2 = length(c2);
  c0 = scale(c0, 1 / l0);
  c1 = scale(c1, 1 / l1);
  c2 = scale(c2, 1 / l2);
  double det = dot(c0, cross(c1, c2));
  Double3 r[3] = {scale(cross(c1, c2), 1 / (det * l0)), scale(cross(c2, c0), 1 / (det * l1)),
                  scale(cross(c0, c1), 1 / (det * l2))};
  ToWorld inv = kIdentityToWorld;
  Double3 origin = column(m, 3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      inv[4 * i + j] = r[i][j];
    inv[4 * i + 3] = -dot(r[i], origin);
  }
  for (double x : inv)
    if (!std::isfinite(x))
      throw Error(std::string("to_world of the ") + what + " is out of the range of numbers");
  return inv;
}

ToWorld multiply(const ToWorld& a, const ToWorld& b) {
  ToWorld c{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k)
        c[4 * i + j] += a[4 * i + k] * b[4 * k + j];
  return c;
}

NormalMap::NormalMap(const ToWorld& m) {
  Double3 c[3] = {column(m, 0), column(m, 1), column(m, 2)};
  double largest = 0;
  for (const Double3& v : c)
    for (double x : v)
      largest = std::max(largest, std::abs(x));
  for (Double3& v : c)
    v = largest > 0 ? scale(v, 1 / largest) : v;
  double sign = dot(c[0], cross(c[1], c[2])) < 0 ? -1.0 : 1.0;
  columns_[0] = scale(cross(c[1], c[2]), sign);
  columns_[1] = scale(cross(c[2], c[0]), sign);
  columns_[2] = scale(cross(c[0], c[1]), sign);
}

Double3 NormalMap::operator()(const Double3& n) const {
  Double3 mapped =
      add(add(scale(columns_[0], n[0]), scale(columns_[1], n[1])), scale(columns_[2], n[2]));
  // What rounding leaves of a flattened direction is noise, not a normal.
  return length(mapped) > kSingular ? normalize(mapped) : Double3{0, 0, 0};
}

} // namespace faceta
