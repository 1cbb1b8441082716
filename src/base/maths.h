#pragma once

/// Elementary functions for every number type. float and Lanes run the same polynomials (own
/// minimax fits; 2 ulp where nothing else is said, see tests/unit/base) and so give the same
/// bits; double takes the C library's; ceres::Jet its own (base/jet.h).

#include "base/number.h"

namespace faceta {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kInvPi = 0.31830988618379067154;
inline constexpr double kInvTwoPi = 0.15915494309189533577;

/// The largest float below 1.
inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;

template <class T> FACETA_INLINE T sqr(const T& a) {
  return a * a;
}
template <class T> FACETA_INLINE T clamp(const T& a, const T& lo, const T& hi) {
  return min(max(a, lo), hi);
}
/// sqrt(max(a, 0)).
template <class T> FACETA_INLINE T safe_sqrt(const T& a) {
  return sqrt(max(a, T(0)));
}
/// a + (b - a) t.
template <class T> FACETA_INLINE T lerp(const T& a, const T& b, const T& t) {
  return fma(t, b - a, a);
}
template <class T> FACETA_INLINE T clamp01(const T& a) {
  return clamp(a, T(0), T(1));
}

template <class T> struct SinCos {
  T sin, cos;
};

/// The types whose elementary functions are the polynomials of this file.
template <class T>
concept SinglePrecision = std::is_same_v<typename NumberTraits<T>::Scalar, float>;

/// c[0] + c[1] x + ... by Horner's rule with fused steps.
template <class T, int N> FACETA_INLINE T polynomial(const T& x, const float (&c)[N]) {
  T sum = T(c[N - 1]);
  for (int i = N - 2; i >= 0; --i)
    sum = fma(sum, x, T(c[i]));
  return sum;
}
/// The same with coefficients of each lane's own: c[k][segment mod Segments] x^k; 16 or 32
/// segments.
template <class T, int N, int Segments>
FACETA_INLINE T polynomial(const T& x, const float (&c)[N][Segments], const IntOf<T>& segment) {
  static_assert(Segments == 16 || Segments == 32);
  auto coefficient = [&](int k) FACETA_INLINE_LAMBDA {
    if constexpr (Segments == 16)
      return entry16<T>(c[k], segment);
    else
      return entry32<T>(c[k], segment);
  };
  T sum = coefficient(N - 1);
  for (int k = N - 2; k >= 0; --k)
    sum = fma(sum, x, coefficient(k));
  return sum;
}

/// 2^n for an integer n in [-126, 127].
template <SinglePrecision T> FACETA_INLINE T power_of_two(const IntOf<T>& n) {
  return bits_float((n + IntOf<T>(127)) << 23);
}

namespace detail {

// exp(x) (1 + tail), the tail being a small correction: shared by exp and pow.
template <SinglePrecision T> FACETA_INLINE T exp_with_tail(const T& argument, const T& tail) {
  T x = clamp(argument, T(-104.0f), T(89.0f));
  T n = floor(fma(x, T(1.44269504f), T(0.5f)));
  T r = fma(n, T(-0.693145752f), x); // ln 2 in two parts: the first product is exact
  r = fma(n, T(-1.42860677e-6f), r) + tail;
  constexpr float c[] = {0.500000001f,  0.166666668f,   0.0416664645f,
                         0.0083332859f, 0.00139337018f, 0.000199076563f};
  T p = fma(polynomial(r, c), r * r, r) + T(1);
  IntOf<T> whole = to_int(n), half = whole >> 1; // two factors, so that 2^n may leave the range
  T y = p * power_of_two<T>(half) * power_of_two<T>(whole - half);
  return select(argument != argument, argument, y);
}

// Splits x > 0 into 2^e m with m in [sqrt(1/2), sqrt(2)); returns m.
template <SinglePrecision T> FACETA_INLINE T split_exponent(const T& x, T& exponent) {
  auto tiny = x < T(0x1p-126f); // denormals, scaled up by 2^24
  T scaled = select(tiny, x * T(0x1p24f), x);
  // Unsigned, as -0 wraps around (log then replaces the result).
  IntOf<T> bits = as_int(as_uint(float_bits(scaled)) - UintOf<T>(0x3f3504f3));
  IntOf<T> e = bits >> 23;
  exponent = to_float(e) - select(tiny, T(24), T(0));
  return bits_float((bits & IntOf<T>(0x007fffff)) + IntOf<T>(0x3f3504f3));
}

inline constexpr float kLogPolynomial[] = {0.666666666f, 0.400001229f, 0.28550723f, 0.233327661f};

// log(x) for x > 0 as an unevaluated sum; about 2^-33 relative.
template <SinglePrecision T> FACETA_INLINE T log_two_parts(const T& x, T& low) {
  T e;
  T f = split_exponent(x, e) - T(1);
  T d = f + T(2), d_low = f - (d - T(2));
  T s = f / d;
  T s_low = (fma(-s, d, f) - s * d_low) / d;
  T t = s * s;
  T series = s * t * polynomial(t, kLogPolynomial);
  T a = e * T(0.693145752f), b = T(2) * s; // exact product: 0.693145752 has few bits
  T high = a + b;
  T rest = b - (high - a);
  // |a| >= |b| whenever e != 0, so that the sum's rounding error is exact (Dekker's fast two-sum).
  low = fma(e, T(1.42860677e-6f), rest + fma(T(2), s_low, series));
  return high;
}

} // namespace detail

template <SinglePrecision T> FACETA_INLINE T exp(const T& x) {
  return detail::exp_with_tail(x, T(0));
}

/// Natural logarithm; log(0) = -inf, a NaN below.
template <SinglePrecision T> FACETA_INLINE T log(const T& x) {
  T e;
  T f = detail::split_exponent(x, e) - T(1);
  T s = f / (f + T(2));
  T t = s * s;
  // log(1+f) = f - f^2/2 + s (f^2/2 + t P(t)) keeps f exact (fdlibm's arrangement of the series).
  T half = T(0.5f) * f * f;
  T y = f - (half - s * fma(t, polynomial(t, detail::kLogPolynomial), half));
  y = fma(e, T(0.693145752f), fma(e, T(1.42860677e-6f), y));
  y = select(x == T(0), T(-__builtin_inff()), y);
  y = select(x == T(__builtin_inff()), x, y);
  return select(x < T(0), T(__builtin_nanf("")), select(x != x, x, y));
}

/// x^y for x >= 0 (pow(0, 0) = 1, pow(0, y > 0) = 0).
template <SinglePrecision T> FACETA_INLINE T pow(const T& x, const T& y) {
  T low;
  T high = detail::log_two_parts(x, low);
  T product = y * high;
  T tail = fma(y, high, -product) + y * low;
  auto representable = abs(product) < T(200);
  T result = detail::exp_with_tail(product, select(representable, tail, T(0)));
  result = select(x == T(0), select(y > T(0), T(0), T(__builtin_inff())), result);
  return select(y == T(0), T(1), result);
}

namespace detail {

// x - n pi/2 for the nearest integer n. pi/2 in three parts: the first difference is exact, and so
// is the second where it cancels, since all its terms are multiples of 2^-40.
template <SinglePrecision T> FACETA_INLINE T reduce_quadrant(const T& x, IntOf<T>& quadrant) {
  T n = floor(fma(x, T(0.636619772f), T(0.5f)));
  T r = fma(n, T(-1.57079637f), x);
  r = fma(n, T(4.37112249e-08f), r);
  r = fma(n, T(1.65139956e-13f), r);
  quadrant = to_int(n);
  return r;
}

inline constexpr float kSinePolynomial[] = {-0.166666667f, 0.00833333188f, -0.000198400869f,
                                            2.72499273e-06f};
inline constexpr float kCosinePolynomial[] = {0.0416666647f, -0.00138883033f, 2.45479752e-05f};

} // namespace detail

/// sin and cos together; 2 ulp for |x| <= 1e4.
template <SinglePrecision T> FACETA_INLINE SinCos<T> sincos(const T& x) {
  IntOf<T> quadrant;
  T r = detail::reduce_quadrant(x, quadrant);
  T t = r * r;
  T sine = fma(r * t, polynomial(t, detail::kSinePolynomial), r);
  T cosine = fma(t * t, polynomial(t, detail::kCosinePolynomial), fma(T(-0.5f), t, T(1)));
  auto swap = (quadrant & IntOf<T>(1)) != IntOf<T>(0);
  auto negative_sine = (quadrant & IntOf<T>(2)) != IntOf<T>(0);
  auto negative_cosine = ((quadrant + IntOf<T>(1)) & IntOf<T>(2)) != IntOf<T>(0);
  T a = select(swap, cosine, sine), b = select(swap, sine, cosine);
  return {select(negative_sine, -a, a), select(negative_cosine, -b, b)};
}
template <SinglePrecision T> FACETA_INLINE T sin(const T& x) {
  return sincos(x).sin;
}
template <SinglePrecision T> FACETA_INLINE T cos(const T& x) {
  return sincos(x).cos;
}

/// Tangent; 2.1 ulp for |x| <= 1e4.
template <SinglePrecision T> FACETA_INLINE T tan(const T& x) {
  IntOf<T> quadrant;
  T r = detail::reduce_quadrant(x, quadrant);
  T t = r * r;
  // Numerator and denominator as sums of two floats each: the quotient's residual then takes back
  // what rounding them took.
  T sine_tail = r * t * polynomial(t, detail::kSinePolynomial);
  T cosine_tail = fma(t * t, polynomial(t, detail::kCosinePolynomial), T(-0.5f) * t);
  T sine = r + sine_tail, cosine = T(1) + cosine_tail;
  sine_tail = sine_tail - (sine - r);
  cosine_tail = cosine_tail - (cosine - T(1));
  auto swap = (quadrant & IntOf<T>(1)) != IntOf<T>(0);
  T p = select(swap, -cosine, sine), p_tail = select(swap, -cosine_tail, sine_tail);
  T q = select(swap, sine, cosine), q_tail = select(swap, sine_tail, cosine_tail);
  T y = p / q;
  T correction = (fma(-y, q, p) + fma(-y, q_tail, p_tail)) / q;
  return select(is_finite(correction), y + correction, y);
}

/// The angle of (x, y) in [-pi, pi], 2.5 ulp; atan2(0, 0) = 0.
template <SinglePrecision T> FACETA_INLINE T atan2(const T& y, const T& x) {
  T ax = abs(x), ay = abs(y);
  T small = min(ax, ay), large = max(ax, ay);
  // Above tan(pi/8) rotate by pi/4: (a - b) / (a + b).
  auto rotate = small > T(0.414213562f) * large, steep = ay > ax, left = x < T(0);
  T p = select(rotate, small - large, small), q = select(rotate, small + large, large);
  T z = select(large == T(0), T(0), p / select(q == T(0), T(1), q));
  // The angle is octants pi/4 + sign atan(z), with pi/4 in two parts.
  T octants = select(rotate, T(1), T(0));
  octants = select(steep, T(2) - octants, octants);
  octants = select(left, T(4) - octants, octants);
  z = select(steep, -z, z);
  z = select(left, -z, z);
  T t = z * z;
  constexpr float c[] = {-0.333333319f, 0.199995594f, -0.142645045f, 0.107488304f, -0.0646674338f};
  T low = fma(z * t, polynomial(t, c), fma(octants, T(-2.18556941e-8f), z));
  return copysign(fma(octants, T(0.785398185f), low), y);
}

namespace detail {

// What asin and acos share: asin(a) = r + tail for a <= 1/2, pi/2 - 2 (r + tail) above (r then is
// sqrt((1 - a) / 2)), a = min(|x|, 1).
template <SinglePrecision T> FACETA_INLINE MaskOf<T> asin_parts(const T& x, T& r, T& tail) {
  T a = min(abs(x), T(1));
  auto steep = a > T(0.5f);
  T t = select(steep, T(0.5f) * (T(1) - a), a * a);
  r = select(steep, sqrt(t), a);
  constexpr float c[] = {0.166666663f,  0.0750010316f, 0.044596626f,
                         0.0311319097f, 0.017005832f,  0.0339210077f};
  tail = r * t * polynomial(t, c);
  return steep;
}

} // namespace detail

/// Arc sine for |x| <= 1 (clamped), 2 ulp.
template <SinglePrecision T> FACETA_INLINE T asin(const T& x) {
  T r, tail;
  auto steep = detail::asin_parts(x, r, tail);
  // pi/2 = 1.57079637 - 4.37e-8
  T high = fma(T(-2), tail + T(2.18556941e-8f), fma(T(-2), r, T(1.57079637f)));
  return copysign(select(steep, high, r + tail), x);
}

/// Arc cosine for |x| <= 1 (clamped), 2 ulp.
template <SinglePrecision T> FACETA_INLINE T acos(const T& x) {
  T r, tail;
  auto steep = detail::asin_parts(x, r, tail);
  T y = r + tail;
  T mild = T(1.57079637f) - (copysign(y, x) + T(4.37113883e-8f));
  T near = select(x < T(0), fma(T(-2), y, T(3.14159274f)) - T(8.74227766e-8f), y + y);
  return select(steep, near, mild);
}

/// The error function.
template <SinglePrecision T> FACETA_INLINE T erf(const T& x) {
  T a = min(abs(x), T(4));
  constexpr float s[] = {0.128379167f,   -0.376126385f,    0.112837827f,    -0.0268654458f,
                         0.00522107488f, -0.000848471148f, 0.000112705447f, -9.68013691e-06f};
  constexpr float l[] = {-0.000188467809f, 1.12958031f,    0.633216395f,     0.108422103f,
                         -0.0252103424f,   0.00420528593f, -0.000441472923f, 2.16976395e-05f};
  T small = fma(a, polynomial(a * a, s), a);
  T large = T(1) - exp(-polynomial(a, l));
  return copysign(select(a < T(1), small, large), x);
}

/// The inverse of erf on (-1, 1), 4 ulp (the form of Giles 2010, "Approximating the erfinv
/// function").
template <SinglePrecision T> FACETA_INLINE T erfinv(const T& x) {
  T w = -log((T(1) - x) * (T(1) + x));
  constexpr float central[] = {1.50140941f,     0.246640727f,    -0.00417768164f,
                               -0.00125372503f, 0.00021858087f,  -4.39150654e-06f,
                               -3.5233877e-06f, 3.43273939e-07f, 2.81022636e-08f};
  constexpr float tail[] = {2.83297682f,    1.00167406f,     0.00943887047f,
                            -0.0076224613f, 0.00573950773f,  -0.00367342844f,
                            0.00134934322f, 0.000100950558f, -0.000200214257f};
  T p = polynomial(w - T(2.5f), central);
  T q = polynomial(sqrt(max(w, T(0))) - T(3), tail);
  return x * select(w < T(5), p, q);
}

// double: the C library.
FACETA_INLINE double exp(double x) {
  return std::exp(x);
}
FACETA_INLINE double log(double x) {
  return std::log(x);
}
FACETA_INLINE double pow(double x, double y) {
  return std::pow(x, y);
}
FACETA_INLINE SinCos<double> sincos(double x) {
  return {std::sin(x), std::cos(x)};
}
FACETA_INLINE double sin(double x) {
  return std::sin(x);
}
FACETA_INLINE double cos(double x) {
  return std::cos(x);
}
FACETA_INLINE double tan(double x) {
  return std::tan(x);
}
FACETA_INLINE double atan2(double y, double x) {
  return std::atan2(y, x);
}
FACETA_INLINE double asin(double x) {
  return std::asin(x < -1 ? -1 : x > 1 ? 1 : x);
}
FACETA_INLINE double acos(double x) {
  return std::acos(x < -1 ? -1 : x > 1 ? 1 : x);
}
FACETA_INLINE double erf(double x) {
  return std::erf(x);
}
inline double erfinv(double x) {
  double y = erfinv(static_cast<float>(x < -0.9999999  ? -0.9999999
                                       : x > 0.9999999 ? 0.9999999
                                                       : x));
  for (int i = 0; i < 3; ++i) // Newton on erf(y) = x
    y -= (std::erf(y) - x) * 0.88622692545275801365 * std::exp(y * y);
  return y;
}

} // namespace faceta
