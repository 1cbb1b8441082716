#pragma once

#include "base/vec.h"

#include <cmath>

namespace faceta {

/// Point k of a sequence that fills the unit cube evenly: multiples of powers of the real root of
/// x^4 = x + 1 (Roberts' generalised golden ratio). The first two numbers are the pair that is
/// spread best.
inline Vec3<double> even_point(int k) {
  auto part = [&](double step) {
    double x = 0.5 + step * (k + 1);
    return x - std::floor(x);
  };
  return {part(0.6710436067037893), part(0.5497004779019703), part(0.8191725133961645)};
}

} // namespace faceta
