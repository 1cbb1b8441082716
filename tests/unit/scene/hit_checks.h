#pragma once

#include "mitsuba_hits.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

// Mitsuba computed in single precision: agreement to some 1e-5 of the size of the vector.
inline void expect_near3(const faceta::Double3& ours, const faceta::Double3& theirs,
                         const char* what) {
  double size = std::max({1.0, std::abs(theirs[0]), std::abs(theirs[1]), std::abs(theirs[2])});
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(ours[k], theirs[k], 3e-5 * size) << what << " component " << k;
}

inline void expect_same_hit(const faceta::SurfacePoint& ours, const mitsuba::Hit& theirs) {
  expect_near3(ours.p, theirs.p, "p");
  expect_near3(ours.n, theirs.n, "n");
  expect_near3(ours.sh_n, theirs.sh_n, "sh_n");
  EXPECT_NEAR(ours.u, theirs.uv[0], 1e-5);
  EXPECT_NEAR(ours.v, theirs.uv[1], 1e-5);
  expect_near3(ours.dp_du, theirs.dp_du, "dp_du");
  expect_near3(ours.dp_dv, theirs.dp_dv, "dp_dv");
  expect_near3(ours.s, theirs.s, "s");
  expect_near3(ours.t, theirs.t_axis, "t");
}
