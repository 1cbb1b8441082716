#pragma once

/// The one-dimensional part of sampling Beckmann's visible normals.

#include "base/maths.h"

namespace faceta {

namespace detail {

/// exp(-a^2) / sqrt(pi) - a erfc(a) for a >= 0: the integral of erfc from a on.
template <class T> FACETA_INLINE T ierfc(const T& a) {
  T b = min(a, T(6));
  return T(0.56418958354775628695) * exp(-(b * b)) - b * (T(1) - erf(b));
}
/// The same to 3e-7 absolute: the eighth power of a polynomial (own minimax fit on [0, 4]).
template <SinglePrecision T> FACETA_INLINE T ierfc(const T& a) {
  constexpr float c[] = {0.930953801f,   -0.206259578f,  -0.0435680263f,   0.00326912059f,
                         0.00390731962f, 3.9289549e-05f, -0.000286633527f, 3.73538351e-05f};
  return sqr(sqr(sqr(polynomial(min(a, T(4)), c))));
}

} // namespace detail

/// Samples x in (-a, inf) with density proportional to (a + x) exp(-x^2): the slope along the
/// direction of view of the visible normals of a Beckmann surface of unit roughness, a = cot theta.
/// u in [0, 1).
template <class T> FACETA_INLINE T beckmann_visible_slope(const T& cot, const T& u) {
  T a = min(cot, T(1e6));
  T total = fma(T(2), a, detail::ierfc(a));
  T target = total * (T(1) - u);
  T x = select(a < T(1), sqrt(-log(T(1) - u)) - a, T(0));
  for (int i = 0; i < 8; ++i) {
    T t = a + x;
    T e = exp(-(x * x)) * T(0.56418958354775628695);
    T step = (fma(a, T(1) - erf(x), e) - target) / (T(2) * t * e);
    x = max(x + clamp(step, T(-1), T(1)), T(1e-6) - a);
  }
  return x;
}

} // namespace faceta
