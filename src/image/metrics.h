#pragma once

#include "image/image.h"

#include <cstdint>
#include <string>
#include <vector>

namespace faceta {

/// Differences of an image a from a reference b, over the values that are finite in both.
struct Difference {
  double mse = 0;     ///< mean of (a - b)^2
  double rmse = 0;    ///< its root
  double rel_mse = 0; ///< mean of (a - b)^2 / (b^2 + kRelMseEpsilon)
  double psnr = 0;    ///< 10 log10(1 / mse) in dB, for a peak value of 1; infinite if mse = 0
  double max_abs = 0; ///< largest |a - b|, found at (x, y) in `channel`
  int x = 0, y = 0;
  std::string channel;
  double mean_a = 0, mean_b = 0;
  /// Values that are NaN or infinite in one image or both, left out above.
  std::int64_t non_finite = 0;
};

/// The term that keeps dark reference pixels from ruling the relative error.
inline constexpr double kRelMseEpsilon = 1e-2;

struct Comparison {
  Difference all;
  std::vector<std::string> channels;
  std::vector<Difference> per_channel; ///< one for each of `channels`
};

/// Compares over R, G, B if both images have them, otherwise over all channels both have. Error if
/// the sizes differ or no channel is common.
Comparison compare(const Image& image, const Image& reference);

/// Outcome of Mitsuba's acceptance test of a rendered picture.
struct ZTest {
  double pass_share = 0;     ///< of all pixel channels: those with |z| below z_threshold
  double required_share = 0; ///< 0.9975
  double z_threshold = 0;    ///< |z| whose two-sided p-value is alpha
  double alpha = 0;          ///< 1 - (1 - 0.01)^(1 / pixels) (Sidak)
  double largest_z = 0;      ///< largest |z|, with the sign of picture - reference, at (x, y)
  int x = 0, y = 0;
  char channel = 'X'; ///< X, Y or Z
  /// z of the image mean for X, Y, Z: mean difference over the root of its variance. Pixels are
  /// taken as independent and the variance is not floored here.
  double mean_z[3] = {0, 0, 0};
  std::int64_t non_finite = 0; ///< picture values that are not finite; they fail
  bool pass = false;
};

/// Mitsuba 3's test of a picture against a converged reference, by the rule of its own
/// src/render/tests/test_renders.py. All three images have R, G, B; `variance` is the variance of
/// *one sample* (second moment minus squared mean), taken in XYZ and pushed through the XYZ-to-RGB
/// matrix, which is undone first. In XYZ, for each pixel and channel,
///   z = |picture - reference| sqrt(spp / max(variance, 1e-4)),  two-sided p = erfc(z / sqrt 2),
/// which passes if p > alpha; the picture passes if 99.75 % of pixel channels do. The picture's own
/// variance does not enter.
/// \param spp samples per pixel of the picture
/// \param reference_spp those of the reference, which add to the variance of the mean in `mean_z`
///        only; 0: the reference is exact
ZTest z_test(const Image& image, const Image& reference, const Image& variance, double spp,
             double reference_spp = 0);

/// Agreement of two noisy pictures.
struct TwoSampleTest {
  double largest_z = 0; ///< of single pixel channels, with sign
  int x = 0, y = 0;
  std::string channel;
  double pixel_share = 0;     ///< pixel channels with |z| > limit
  double block_share = 0;     ///< 8 x 8 block means (per channel) with |z| > limit
  double largest_block_z = 0; ///< with sign; its block begins at (block_x, block_y)
  int block_x = 0, block_y = 0;
  double limit = 4;
  std::vector<std::string> channels;
  std::vector<double> mean_ratio; ///< mean of a over mean of b, per channel; NaN if b is black
  std::vector<double> mean_z;     ///< z of the difference of the means, per channel
  std::int64_t non_finite = 0;    ///< pixel channels with a value that is not finite; left out
};

/// Compares a with b, both unbiased, by z = (a - b) / sqrt(var_a + var_b) over the common R, G, B
/// (or all common channels): per pixel, per block of `block` x `block` pixels (fewer at the right
/// and bottom edges) and for the whole picture.
/// \param var_a,var_b variances *of the pixel means* (not of a sample), with a's and b's channels
/// \param quantisation relative rounding error of stored values added to both variances: 2^-11 /
/// sqrt
///        12 of a value for 16-bit files is the default; it also keeps noiseless pixels from
///        dividing by zero. A millionth of b's mean is added likewise: what lies below is black
TwoSampleTest two_sample_test(const Image& a, const Image& var_a, const Image& b,
                              const Image& var_b, double limit = 4, int block = 8,
                              double quantisation = 1.41e-4);

/// |z| whose two-sided p-value under the normal distribution is alpha in (0, 1).
double two_sided_z(double alpha);

} // namespace faceta
