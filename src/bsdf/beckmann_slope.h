#pragma once

/// The slopes of a Beckmann surface's visible normals.
///
/// Stretched to unit roughness the slopes are normal, exp(-x^2 - y^2) / pi. A direction with
/// cot theta = a along x sees them with the weight (a + x)+, so that the slope y across is
/// independent of x and stays normal, while x has density proportional to (a + x)+ exp(-x^2).

#include "base/vec.h"

namespace faceta {

namespace detail {

// c[First] + c[First+1] x + ... over Count coefficients by halves (Estrin's rule): sampling one
// direction is a single long chain of dependences, and Horner's rule would lengthen it. powers[k]
// is x^(2^k).
template <int First, int Count, class T, int N>
FACETA_INLINE T polynomial_by_halves(const T* powers, const float (&c)[N]) {
  if constexpr (Count == 1) {
    return T(c[First]);
  } else {
    constexpr int kLevel = std::bit_width(unsigned(Count - 1)) - 1, kHalf = 1 << kLevel;
    return fma(polynomial_by_halves<First + kHalf, Count - kHalf>(powers, c), powers[kLevel],
               polynomial_by_halves<First, kHalf>(powers, c));
  }
}
template <class T, int N> FACETA_INLINE T polynomial_by_halves(const T& x, const float (&c)[N]) {
  static_assert(N <= 16);
  T x2 = x * x, x4 = x2 * x2;
  const T powers[] = {x, x2, x4, N > 8 ? x4 * x4 : x4};
  return polynomial_by_halves<0, N>(powers, c);
}

/// exp(-a^2) / sqrt(pi) - a erfc(a) for a >= 0: the integral of erfc from a on.
template <class T> FACETA_INLINE T ierfc(const T& a) {
  T b = min(a, T(6));
  return T(0.56418958354775628695) * exp(-(b * b)) - b * (T(1) - erf(b));
}
/// The same to 3e-7 absolute: the eighth power of a polynomial (own minimax fit on [0, 4]).
template <SinglePrecision T> FACETA_INLINE T ierfc(const T& a) {
  constexpr float c[] = {0.930953801f,   -0.206259578f,  -0.0435680263f,   0.00326912059f,
                         0.00390731962f, 3.9289549e-05f, -0.000286633527f, 3.73538351e-05f};
  return sqr(sqr(sqr(polynomial_by_halves(min(a, T(4)), c))));
}

/// erfc(a) for a >= 0.
template <class T> FACETA_INLINE T erfc_positive(const T& a) {
  return T(1) - erf(a);
}
/// The same to 3e-7 absolute, likewise.
template <SinglePrecision T> FACETA_INLINE T erfc_positive(const T& a) {
  constexpr float c[] = {1.0f,
                         -0.141047344f,
                         -0.0696309805f,
                         -0.00208618678f,
                         0.00658315606f,
                         0.000193226311f,
                         -0.000516763539f,
                         9.00188461e-05f,
                         -4.93161133e-06f};
  return sqr(sqr(sqr(polynomial_by_halves(min(a, T(4)), c))));
}

/// -log(x) for normal x > 0 without the special cases of log(); 2e-7 absolute.
template <SinglePrecision T> FACETA_INLINE T minus_log_normal(const T& x) {
  IntOf<T> bits = float_bits(x) - IntOf<T>(0x3f3504f3);
  T e = to_float(bits >> 23);
  T f = bits_float((bits & IntOf<T>(0x007fffff)) + IntOf<T>(0x3f3504f3)) - T(1);
  constexpr float c[] = {0.49999994f,  -0.333336413f, 0.250020593f, -0.199744582f,
                         0.165620282f, -0.147750273f, 0.143522516f, -0.092265211f};
  return fma(e, T(-0.693147181f), fma(f * f, polynomial_by_halves(f, c), -f));
}

/// erfinv(x) / x from w = -log(1 - x^2) in [0, 17]; 3e-6 relative (own minimax fit).
template <SinglePrecision T> FACETA_INLINE T erfinv_over_x(const T& w) {
  T rho = sqrt(w + T(2.5f)) - T(1.58113883f);
  constexpr float c[] = {0.886229455f,  0.733401477f,    0.352790147f,   -0.0371957906f,
                         0.0527308509f, -0.258039594f,   0.269461244f,   -0.136716485f,
                         0.0383660942f, -0.00574824866f, 0.000360751757f};
  return polynomial_by_halves(rho, c);
}
/// erfinv(x) where `body` is set, sqrt(-log(tail)) elsewhere.
template <SinglePrecision T>
FACETA_INLINE T slope_magnitude(const MaskOf<T>& body, const T& x, const T& tail) {
  T w = max(minus_log_normal(select(body, (T(1) - x) * (T(1) + x), tail)), T(0));
  return select(body, x * erfinv_over_x(w), sqrt(w));
}
template <class T>
  requires(!SinglePrecision<T>)
T slope_magnitude(bool body, const T& x, const T& tail) {
  return body ? erfinv(x) : sqrt(max(-log(tail), T(0)));
}
template <SinglePrecision T> FACETA_INLINE T normal_slope(const T& x) {
  T w = minus_log_normal((T(1) - x) * (T(1) + x));
  return x * erfinv_over_x(max(w, T(0)));
}
template <class T>
  requires(!SinglePrecision<T>)
T normal_slope(const T& x) {
  return erfinv(x);
}

} // namespace detail

/// The visible slopes of the unit surface, for z = cos theta > 0 and r = sin theta >= 0 of the
/// stretched direction (of any common length). First the magnitude of the slope along, then its
/// sign.
///
/// No iteration: the two values +-y together weigh a + max(a, y). Half a normal, another one cut
/// off at a, and y exp(-y^2) beyond a make up this density of y, and each has an inverse. The sign
/// is then drawn with the odds (a + y) : (a - y)+.
template <class T> struct BeckmannSlopes {
  T along, twice_z, negative_part; ///< negative with probability negative_part / twice_z

  /// u in [0, 1).
  FACETA_INLINE BeckmannSlopes(const T& z, const T& r, const T& u) {
    T inverse = T(1) / max(r, T(1e-30)), inverse_z = T(1) / z, a = min(z * inverse, T(6));
    twice_z = T(2) * z;
    T total = fma(r, detail::ierfc(a), twice_z), position = u * total;
    auto body = position < fma(-z, detail::erfc_positive(a), twice_z);
    T share = position * inverse_z;
    T half_normal = min(select(share < T(1), share, share - T(1)), T(kOneMinusEpsilon));
    T tail = total * (T(1) - u) * (inverse * T(1.77245385090551602730));
    along = detail::slope_magnitude<T>(body, half_normal, max(min(tail, T(1)), T(1e-30)));
    negative_part = max(fma(-along, r, z), T(0));
  }

  /// {along, across} from a number for the slope across and one for the sign.
  FACETA_INLINE Vec2<T> draw(const T& u, const T& sign) const {
    T y = max(fma(T(2), u, T(-1)), T(-kOneMinusEpsilon));
    auto negative = twice_z * sign < negative_part;
    return {select(negative, -along, along), detail::normal_slope<T>(y)};
  }
  /// Both from one number, which is rescaled after it has drawn the sign.
  FACETA_INLINE Vec2<T> draw(const T& u) const {
    T position = twice_z * u;
    auto negative = position < negative_part;
    T rescaled = select(negative, position, position - negative_part) /
                 select(negative, negative_part, twice_z - negative_part);
    T y = clamp(fma(T(2), rescaled, T(-1)), T(-kOneMinusEpsilon), T(kOneMinusEpsilon));
    return {select(negative, -along, along), detail::normal_slope<T>(y)};
  }
};

/// The slope along for cot theta = a > 0 by inverting its distribution function: continuous in u,
/// for quadrature. (Slow; double only.)
inline double beckmann_visible_slope(double a, double u) {
  a = min(a, 1e6);
  double target = (2 * a + detail::ierfc(a)) * (1 - u), low = -min(a, 7.0), high = 7;
  double x = 0.5 * (low + high);
  for (int i = 0; i < 60; ++i) { // Newton, kept inside a shrinking bracket
    double e = exp(-(x * x)) * 0.56418958354775628695;
    double excess = a * (1 - erf(x)) + e - target;
    (excess > 0 ? low : high) = x;
    double next = x + excess / (2 * (a + x) * e);
    next = next > low && next < high ? next : 0.5 * (low + high);
    if (abs(next - x) < 1e-14)
      break;
    x = next;
  }
  return x;
}

} // namespace faceta
