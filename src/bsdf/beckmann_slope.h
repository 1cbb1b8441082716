#pragma once

/// The slopes of a Beckmann surface's visible normals.
///
/// Stretched to unit roughness the slopes are normal, exp(-x^2 - y^2) / pi. A direction with
/// cot theta = a along x sees them with the weight (a + x)+, so that the slope y across is
/// independent of x and stays normal, while x has density proportional to (a + x)+ exp(-x^2).

#include "base/vec.h"

namespace faceta {

namespace detail {

/// exp(-a^2) / sqrt(pi) - a erfc(a) for a >= 0: the integral of erfc from a on.
template <class T> FACETA_INLINE T ierfc(const T& a) {
  T b = min(a, T(6));
  return T(0.56418958354775628695) * exp(-(b * b)) - b * (T(1) - erf(b));
}
/// erfc(a) for a >= 0.
template <class T> FACETA_INLINE T erfc_positive(const T& a) {
  return T(1) - erf(a);
}

// Both by quartics on segments of length 1/4 about n/4, in t = 4 a - n from -1/2 to 1/2 (own
// minimax fits): sum of c[k][n] t^k.
alignas(64) inline constexpr float kIerfcSegments[5][16] = {
    {0.564189613f, 0.349088669f, 0.199641228f, 0.104832254f, 0.0502545387f, 0.0218857192f,
     0.00862286333f, 0.00306292274f, 0.000978023279f, 0.000280047621f, 7.17623116e-05f,
     1.64284484e-05f, 3.35507571e-06f, 6.10492066e-07f, 9.88724054e-08f, 1.4239629e-08f},
    {-0.25f, -0.180918887f, -0.119875729f, -0.0722116679f, -0.0393250659f, -0.0192749482f,
     -0.00847354438f, -0.00333189941f, -0.00116930238f, -0.000365606189f, -0.000101704958f,
     -2.51429574e-05f, -5.51859739e-06f, -1.07458641e-06f, -1.85511738e-07f, -2.83778849e-08f},
    {0.0352616869f, 0.0331252776f, 0.0274619404f, 0.020091705f, 0.0129722515f, 0.00739137689f,
     0.00371660246f, 0.00164920522f, 0.000645816384f, 0.000223175477f, 6.80587182e-05f,
     1.83154425e-05f, 4.34954063e-06f, 9.11501274e-07f, 1.68559893e-07f, 2.75060899e-08f},
    {2.13011951e-15f, -0.00137250836f, -0.00227735937f, -0.00250227307f, -0.00215779431f,
     -0.00154020183f, -0.000931850343f, -0.000483951269f, -0.000217382927f, -8.48657801e-05f,
     -2.88912943e-05f, -8.59722513e-06f, -2.24009523e-06f, -5.11762664e-07f, -1.02615466e-07f,
     -1.80740045e-08f},
    {-0.000365594955f, -0.000300504442f, -0.00014289924f, 2.52182363e-05f, 0.000133899011f,
     0.000162788361f, 0.000135234193f, 8.81605083e-05f, 4.73248256e-05f, 2.14049269e-05f,
     8.26343421e-06f, 2.74492913e-06f, 7.8881061e-07f, 1.96853705e-07f, 4.27821831e-08f,
     8.11439094e-09f},
};
alignas(64) inline constexpr float kErfcSegments[5][16] = {
    {1.0f, 0.723673642f, 0.479500145f, 0.288844377f, 0.157299206f, 0.0770998672f, 0.0338948481f,
     0.0133283269f, 0.0046777348f, 0.00146271731f, 0.000406952691f, 0.000100622317f,
     2.20906732e-05f, 4.30284308e-06f, 7.43117141e-07f, 1.13731936e-07f},
    {-0.282092661f, -0.265002012f, -0.219695508f, -0.160733774f, -0.103778183f, -0.059131179f,
     -0.0297328569f, -0.013193626f, -0.00516649848f, -0.00178537681f, -0.000544454204f,
     -0.000146516497f, -3.47937166e-05f, -7.29120211e-06f, -1.34826678e-06f, -2.20000999e-07f},
    {4.44413115e-15f, 0.0165622216f, 0.0274613686f, 0.0301370621f, 0.0259442739f, 0.0184784755f,
     0.0111499531f, 0.00577237597f, 0.00258337939f, 0.00100435293f, 0.000340322295f,
     0.000100745827f, 2.61007499e-05f, 5.92572542e-06f, 1.18014896e-06f, 2.06342875e-07f},
    {0.00584268011f, 0.0048064529f, 0.00228629378f, -0.000402426114f, -0.00214098417f,
     -0.00260336953f, -0.00216344441f, -0.00141069456f, -0.000757460599f, -0.000342694897f,
     -0.000132339541f, -4.39752257e-05f, -1.26418445e-05f, -3.15613102e-06f, -6.86216083e-07f,
     -1.30212641e-07f},
    {-1.23284282e-14f, -0.00049171201f, -0.000709927524f, -0.000585757196f, -0.000270734599f,
     2.17976394e-05f, 0.000172156302f, 0.000186942372f, 0.000134498245f, 7.48524981e-05f,
     3.39794897e-05f, 1.29042237e-05f, 4.15880822e-06f, 1.14774002e-06f, 2.72902639e-07f,
     5.61506077e-08f},
};
template <SinglePrecision T>
FACETA_INLINE T quartic_on_segments(const float (&c)[5][16], const T& a) {
  T position = T(4) * min(a, T(3.8f));
  // Rounds to an integer in the low bits of a float.
  T shifted = position + T(12582912.0f), t = position - (shifted - T(12582912.0f));
  return polynomial(t, c, float_bits(shifted));
}
/// The same to 4e-7 absolute.
template <SinglePrecision T> FACETA_INLINE T ierfc(const T& a) {
  return quartic_on_segments(kIerfcSegments, a);
}
template <SinglePrecision T> FACETA_INLINE T erfc_positive(const T& a) {
  return quartic_on_segments(kErfcSegments, a);
}

// 1 / c and log(1 / c) of the middles c of 32 parts of [1, 2).
alignas(64) inline constexpr float kReciprocals[32] = {
    0.984615386f, 0.955223858f, 0.927536249f, 0.901408434f, 0.876712322f, 0.853333354f,
    0.83116883f,  0.810126603f, 0.790123463f, 0.771084309f, 0.752941191f, 0.735632181f,
    0.719101131f, 0.703296721f, 0.688172042f, 0.673684239f, 0.659793794f, 0.646464646f,
    0.633663356f, 0.621359229f, 0.609523833f, 0.598130822f, 0.587155938f, 0.576576591f,
    0.566371679f, 0.556521714f, 0.547008574f, 0.537815154f, 0.528925598f, 0.520325184f,
    0.512000024f, 0.503937006f};
alignas(64) inline constexpr float kLogReciprocals[32] = {
    -0.015504186f, -0.0458095595f, -0.0752234012f, -0.10379681f,  -0.131576359f, -0.158605009f,
    -0.184922338f, -0.210564747f,  -0.235566065f,  -0.259957552f, -0.283768147f, -0.307025045f,
    -0.32975328f,  -0.351976395f,  -0.373716414f,  -0.394993752f, -0.41582793f,  -0.436236769f,
    -0.456237435f, -0.475845903f,  -0.495077223f,  -0.513945758f, -0.532464862f, -0.55064708f,
    -0.568504751f, -0.58604908f,   -0.603290796f,  -0.620240331f, -0.636907518f, -0.653301299f,
    -0.669430614f, -0.685303986f};
/// -log(x) for normal x > 0, from that of the nearest c and a cubic; 2e-7 absolute.
template <SinglePrecision T> FACETA_INLINE T minus_log_normal(const T& x) {
  IntOf<T> bits = float_bits(x) - IntOf<T>(0x3f800000), part = bits >> 18;
  T m = bits_float((bits & IntOf<T>(0x007fffff)) | IntOf<T>(0x3f800000));
  T r = fma(m, entry32<T>(kReciprocals, part), T(-1));
  T nearest = fma(to_float(bits >> 23), T(-0.693147181f), entry32<T>(kLogReciprocals, part));
  return fma(r, fma(r, fma(r, T(-0.333333333f), T(0.5f)), T(-1)), nearest);
}

/// erfinv(1 - v) on the octave of v with the exponent e: the sum of c[k][e mod 32] t^k, t = v / 2^e
/// - 3/2; 4.4e-7 absolute (own minimax fits), 0 for v = 1.
alignas(64) inline constexpr float kErfinvOctaves[7][32] = {
    {0.0f,         0.0f,         0.0f,        0.0f,        0.0f,        0.0f,        3.86871243f,
     3.78092432f,  3.69117737f,  3.59933662f, 3.50525188f, 3.40875387f, 3.30965066f, 3.20772481f,
     3.10272646f,  2.99436784f,  2.88231325f, 2.76616836f, 2.6454649f,  2.51963902f, 2.38800263f,
     2.24970222f,  2.10365725f,  1.94846725f, 1.78226411f, 1.60246432f, 1.40532362f, 1.18506825f,
     0.931974351f, 0.627307236f, 0.22531195f, 0.0f},
    {0.0f,           0.0f,           0.0f,           0.0f,
     0.0f,           0.0f,           -0.0835339502f, -0.0853579417f,
     -0.0873044655f, -0.0893877447f, -0.0916243717f, -0.0940338895f,
     -0.0966394916f, -0.0994689167f, -0.102555692f,  -0.105940737f,
     -0.109674595f,  -0.113820553f,  -0.118459001f,  -0.123693891f,
     -0.12966226f,   -0.136548981f,  -0.144610465f,  -0.154213965f,
     -0.165907189f,  -0.180548847f,  -0.199575081f,  -0.225605682f,
     -0.264046133f,  -0.328391671f,  -0.466194183f,  0.0f},
    {0.0f,          0.0f,          0.0f,          0.0f,          0.0f,          0.0f,
     0.0269985851f, 0.0275508035f, 0.028137546f,  0.0287625063f, 0.0294299461f, 0.0301448125f,
     0.0309128799f, 0.0317409448f, 0.0326370485f, 0.0336107984f, 0.0346737541f, 0.0358399563f,
     0.0371266268f, 0.0385551155f, 0.0401521623f, 0.0419516265f, 0.0439967848f, 0.0463432819f,
     0.0490623713f, 0.0522424541f, 0.0559802167f, 0.0603238605f, 0.0649845377f, 0.067657344f,
     0.0489779562f, 0.0f},
    {0.0f,           0.0f,           0.0f,           0.0f,
     0.0f,           0.0f,           -0.0117634051f, -0.0119971009f,
     -0.0122449696f, -0.012508478f,  -0.0127893146f, -0.0130894259f,
     -0.0134110777f, -0.013756915f,  -0.014130055f,  -0.0145341912f,
     -0.0149737401f, -0.0154540222f, -0.0159815103f, -0.0165641513f,
     -0.0172118172f, -0.0179368854f, -0.0187550746f, -0.0196865425f,
     -0.0207574088f, -0.022001734f,  -0.0234641545f, -0.0252045915f,
     -0.0273229014f, -0.0302422009f, -0.0404713303f, 0.0f},
    {0.0f,           0.0f,           0.0f,           0.0f,
     0.0f,           0.0f,           0.00578815397f, 0.00590102281f,
     0.0060206065f,  0.00614758627f, 0.006282744f,   0.00642697932f,
     0.0065813344f,  0.00674702413f, 0.00692547392f, 0.00711836573f,
     0.00732770236f, 0.00755588617f, 0.00780582428f, 0.00808106922f,
     0.00838600378f, 0.00872609764f, 0.00910824817f, 0.00954125635f,
     0.0100364694f,  0.010608647f,   0.0112770619f,  0.01206668f,
     0.0130076176f,  0.0140944114f,  0.0133279087f,  0.0f},
    {0.0f,
     0.0f,
     0.0f,
     0.0f,
     0.0f,
     0.0f,
     -0.00358214974f,
     -0.00365081267f,
     -0.00372348935f,
     -0.00380058028f,
     -0.00388254318f,
     -0.00396990357f,
     -0.00406326912f,
     -0.00416334579f,
     -0.00427095871f,
     -0.00438707974f,
     -0.00451285997f,
     -0.00464967685f,
     -0.00479918765f,
     -0.00496341102f,
     -0.00514482334f,
     -0.00534649892f,
     -0.00557229482f,
     -0.00582710514f,
     -0.00611721026f,
     -0.00645074993f,
     -0.00683834823f,
     -0.00729388138f,
     -0.00783536024f,
     -0.00849073287f,
     -0.00997592974f,
     0.0f},
    {0.0f,           0.0f,           0.0f,           0.0f,
     0.0f,           0.0f,           0.00208325405f, 0.00212273956f,
     0.00216450682f, 0.00220878096f, 0.00225581834f, 0.00230591395f,
     0.00235940702f, 0.00241669174f, 0.00247822748f, 0.00254455442f,
     0.00261631072f, 0.00269425777f, 0.0027793101f,  0.00287257694f,
     0.00297541544f, 0.00308950501f, 0.00321694417f, 0.00336038694f,
     0.00352322683f, 0.0037098492f,  0.00392596889f, 0.00417906092f,
     0.00447882991f, 0.00483686198f, 0.00503709307f, 0.0f},
};
/// erfinv(1 - v) for v in [2^-24, 1].
template <SinglePrecision T> FACETA_INLINE T erfinv_of_complement(const T& v) {
  IntOf<T> bits = float_bits(v), octave = bits >> 23;
  T t = bits_float((bits & IntOf<T>(0x007fffff)) | IntOf<T>(0x3f800000)) - T(1.5f);
  return polynomial(t, kErfinvOctaves, octave);
}
/// erfinv(x), x in [0, 1), where `body` is set, sqrt(-log(tail)) elsewhere.
template <SinglePrecision T>
FACETA_INLINE T slope_magnitude(const MaskOf<T>& body, const T& x, const T& tail) {
  return select(body, erfinv_of_complement(T(1) - x), sqrt(max(minus_log_normal(tail), T(0))));
}
template <class T>
  requires(!SinglePrecision<T>)
T slope_magnitude(bool body, const T& x, const T& tail) {
  return body ? erfinv(x) : sqrt(max(-log(tail), T(0)));
}
template <SinglePrecision T> FACETA_INLINE T normal_slope(const T& x) {
  return copysign(erfinv_of_complement(T(1) - abs(x)), x);
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
  MaskOf<T> tilted; ///< else the view is from straight above, and any direction is along
  T z, r, inverse_z, inverse_r;
  T twice_area; ///< twice the projected area of the visible normals, 2 z + r ierfc(z / r)
  T along;      ///< the magnitude

  /// u in [0, 1); r2 = r^2.
  FACETA_INLINE BeckmannSlopes(const T& cosine, const T& r2, const T& u)
      : tilted(r2 > T(1e-19)), z(max(cosine, T(1e-18))) {
    T some_r2 = max(r2, T(1e-19)); // the product with z is a normal float
    r = sqrt(some_r2);
    T inverse = T(1) / (some_r2 * z); // both inverses from one division beside the root
    inverse_r = r * z * inverse, inverse_z = some_r2 * inverse;
    T a = z * inverse_r, twice_z = T(2) * z;
    twice_area = fma(r, detail::ierfc(a), twice_z);
    T position = u * twice_area;
    auto body = position < fma(-z, detail::erfc_positive(a), twice_z);
    T share = position * inverse_z;
    T half_normal = min(select(share < T(1), share, share - T(1)), T(kOneMinusEpsilon));
    T tail = twice_area * ((T(1) - u) * (T(1.77245385090551602730) * inverse_r));
    along = detail::slope_magnitude<T>(body, half_normal, tail);
  }

  /// {along, across} from a number for the slope across and one for the sign, which is negative
  /// with probability (z - along r)+ / (2 z).
  FACETA_INLINE Vec2<T> draw(const T& u, const T& sign) const {
    T y = max(fma(T(2), u, T(-1)), T(-kOneMinusEpsilon));
    auto negative = along < z * inverse_r * fma(T(-2), sign, T(1));
    return {select(negative, -along, along), detail::normal_slope<T>(y)};
  }
  /// Both from one number, which is rescaled after it has drawn the sign.
  FACETA_INLINE Vec2<T> draw(const T& u) const {
    T position = T(2) * z * u, negative_part = max(fma(-along, r, z), T(0));
    auto negative = position < negative_part;
    T rescaled = select(negative, position, position - negative_part) /
                 select(negative, negative_part, T(2) * z - negative_part);
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
