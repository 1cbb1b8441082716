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

// Both by cubics on segments of length 1/8 about n/8, in t = 8 a - n from -1/2 to 1/2 (own minimax
// fits): sum of c[k][n] t^k.
alignas(64) inline constexpr float kIerfcSegments[4][32] = {
    {0.564189792f,    0.447982341f,    0.349088818f,    0.266720355f,    0.199641302f,
     0.146275342f,    0.104832247f,    0.0734381601f,   0.0502544753f,   0.033573661f,
     0.0218856409f,   0.0139136612f,   0.00862279814f,  0.0052071414f,   0.00306287967f,
     0.00175424013f,  0.000977999647f, 0.000530582154f, 0.000280036824f, 0.000143754107f,
     7.17580842e-05f, 3.48239191e-05f, 1.64270168e-05f, 7.53075801e-06f, 3.35465711e-06f,
     1.45185436e-06f, 6.10385598e-07f, 2.49251201e-07f, 9.8848794e-08f,  3.80679808e-08f,
     1.42350558e-08f, 5.16807752e-09f},
    {-0.125f,          -0.107460484f,    -0.0904592276f,   -0.0744854212f,   -0.0599375516f,
     -0.0470949225f,   -0.0361055732f,   -0.026990639f,    -0.0196624137f,   -0.0139514767f,
     -0.00963748246f,  -0.00647873525f,  -0.00423684809f,  -0.00269452389f,  -0.00166603189f,
     -0.00100123475f,  -0.000584710331f, -0.000331748626f, -0.000182835938f, -9.78647731e-05f,
     -5.08673547e-05f, -2.56709318e-05f, -1.25771176e-05f, -5.98149518e-06f, -2.76111223e-06f,
     -1.2369851e-06f,  -5.37792573e-07f, -2.26882989e-07f, -9.28743162e-08f, -3.68865436e-08f,
     -1.42132501e-08f, -5.31310373e-09f},
    {0.00880972762f,  0.00867332146f,  0.00827664603f,  0.00765542453f,  0.00686325505f,
     0.00596399093f,  0.00502330391f,  0.00410098536f,  0.00324513577f,  0.00248899171f,
     0.00185037579f,  0.00133334449f,  0.000931259419f, 0.000630441704f, 0.000413680536f,
     0.000263106253f, 0.000162197102f, 9.69172179e-05f, 5.61312409e-05f, 3.15104226e-05f,
     1.71454794e-05f, 9.04255012e-06f, 4.62251137e-06f, 2.29039779e-06f, 1.09999235e-06f,
     5.12052111e-07f, 2.3103857e-07f,  1.01041678e-07f, 4.28314095e-08f, 1.75982677e-08f,
     7.0084698e-09f,  2.70534217e-09f},
    {-7.5843023e-16f,  -9.02469983e-05f, -0.00017223804f,  -0.000238963083f, -0.000285643444f,
     -0.000310265546f, -0.000313587749f, -0.00029866994f,  -0.000270093908f, -0.000233046681f,
     -0.000192495325f, -0.000152572698f, -0.000116244788f, -8.5248721e-05f,  -6.02377877e-05f,
     -4.10461907e-05f, -2.69889715e-05f, -1.71334232e-05f, -1.05060817e-05f, -6.2249951e-06f,
     -3.56514079e-06f, -1.97411009e-06f, -1.05712002e-06f, -5.47549064e-07f, -2.74374742e-07f,
     -1.33031548e-07f, -6.24185716e-08f, -2.83448482e-08f, -1.24589752e-08f, -5.30127453e-09f,
     -2.18376317e-09f, -8.70947536e-10f},
};
alignas(64) inline constexpr float kErfcSegments[4][32] = {
    {1.0f,
     0.859683931f,
     0.72367388f,
     0.595883429f,
     0.479500473f,
     0.37675944f,
     0.288844645f,
     0.215925157f,
     0.15729934f,
     0.111611821f,
     0.0770998597f,
     0.0518298708f,
     0.0338947698f,
     0.0215561725f,
     0.0133282375f,
     0.00800986215f,
     0.00467766915f,
     0.002653979f,
     0.00146268017f,
     0.000782913121f,
     0.000406935549f,
     0.000205365388f,
     0.000100615696f,
     4.78512411e-05f,
     2.20884995e-05f,
     9.89566706e-06f,
     4.30223054e-06f,
     1.81500945e-06f,
     7.42968552e-07f,
     2.95080383e-07f,
     1.13700686e-07f,
     4.2502549e-08f},
    {-0.141047329f,    -0.138860554f,    -0.132501692f,    -0.122544058f,    -0.109847814f,
     -0.0954374671f,   -0.0803664327f,   -0.0655931979f,   -0.0518885031f,   -0.0397843048f,
     -0.0295651834f,   -0.0212950017f,   -0.0148662999f,   -0.0100590345f,   -0.00659686839f,
     -0.00419321749f,  -0.00258336077f,  -0.00154259067f,  -0.000892779732f, -0.000500801776f,
     -0.000272279693f, -0.000143480371f, -7.32820263e-05f, -3.62768988e-05f, -1.74056604e-05f,
     -8.09428366e-06f, -3.64832795e-06f, -1.59381079e-06f, -6.74849673e-07f, -2.76952079e-07f,
     -1.10161402e-07f, -4.24699209e-08f},
    {-6.2875928e-16f, 0.00216551195f,  0.00413294043f,  0.00573409954f,  0.00685432646f,
     0.00744528975f,  0.00752515811f,  0.00716739148f,  0.00648183189f,  0.00559295015f,
     0.00461991923f,  0.00366192916f,  0.00279014604f,  0.00204627216f,  0.00144600007f,
     0.000985366292f, 0.000647945446f, 0.000411363086f, 0.000252262515f, 0.00014948014f,
     8.56160987e-05f, 4.7411766e-05f,  2.53908202e-05f, 1.31527013e-05f, 6.59139323e-06f,
     3.19617584e-06f, 1.49980383e-06f, 6.81147355e-07f, 2.99431406e-07f, 1.27422183e-07f,
     5.24954586e-08f, 2.0939261e-08f},
    {0.000733546854f,  0.000699441181f,  0.000602934102f,  0.000458222494f,  0.000285977963f,
     0.000109047032f,  -5.17135704e-05f, -0.000180723233f, -0.000269461452f, -0.000316588848f,
     -0.000326683949f, -0.000308121904f, -0.000270829652f, -0.000224273332f, -0.000176163929f,
     -0.000131851804f, -9.43350897e-05f, -6.46690751e-05f, -4.25526996e-05f, -2.6913096e-05f,
     -1.63788045e-05f, -9.59991939e-06f, -5.42295629e-06f, -2.95427571e-06f, -1.55286659e-06f,
     -7.87905776e-07f, -3.86041137e-07f, -1.82705833e-07f, -8.35513063e-08f, -3.69269593e-08f,
     -1.57767754e-08f, -6.51720855e-09f},
};
template <SinglePrecision T>
FACETA_INLINE T cubic_on_segments(const float (&c)[4][32], const T& a) {
  T position = T(8) * min(a, T(3.9f));
  // Rounds to an integer in the low bits of a float.
  T shifted = position + T(12582912.0f), t = position - (shifted - T(12582912.0f));
  IntOf<T> n = float_bits(shifted);
  T sum = entry32<T>(c[3], n);
  for (int k = 2; k >= 0; --k)
    sum = fma(sum, t, entry32<T>(c[k], n));
  return sum;
}
/// The same to 4e-7 absolute.
template <SinglePrecision T> FACETA_INLINE T ierfc(const T& a) {
  return cubic_on_segments(kIerfcSegments, a);
}
template <SinglePrecision T> FACETA_INLINE T erfc_positive(const T& a) {
  return cubic_on_segments(kErfcSegments, a);
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
  T sum = entry32<T>(kErfinvOctaves[6], octave);
  for (int k = 5; k >= 0; --k)
    sum = fma(sum, t, entry32<T>(kErfinvOctaves[k], octave));
  return sum;
}
/// erfinv(x), x in [0, 1), where `body` is set, sqrt(-log(tail)) elsewhere.
template <SinglePrecision T>
FACETA_INLINE T slope_magnitude(const MaskOf<T>& body, const T& x, const T& tail) {
  return select(body, erfinv_of_complement(T(1) - x), sqrt(max(minus_log_normal(tail), T(0))));
}
template <std::same_as<double> T> T slope_magnitude(bool body, const T& x, const T& tail) {
  return body ? erfinv(x) : sqrt(max(-log(tail), 0.0));
}
template <SinglePrecision T> FACETA_INLINE T normal_slope(const T& x) {
  return copysign(erfinv_of_complement(T(1) - abs(x)), x);
}
template <std::same_as<double> T> T normal_slope(const T& x) {
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
  T z, r, inverse_z, inverse_r;
  T twice_area; ///< twice the projected area of the visible normals, 2 z + r ierfc(z / r)
  T along;      ///< the magnitude

  /// u in [0, 1); r2 = r^2.
  FACETA_INLINE BeckmannSlopes(const T& cosine, const T& r2, const T& u) : z(cosine) {
    T some_r2 = max(r2, T(1e-24)); // straight from above cot theta = inf
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
