#include "image/metrics.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace faceta {
namespace {

void check_same_size(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    throw Error(fmt::format("the images differ in size: {} x {} and {} x {}", a.width, a.height,
                            b.width, b.height));
}

std::vector<std::string> common_channels(const Image& a, const Image& b) {
  std::vector<std::string> rgb{"R", "G", "B"};
  const auto in_both = [&](const std::string& c) { return a.find_channel(c) && b.find_channel(c); };
  if (std::all_of(rgb.begin(), rgb.end(), in_both))
    return rgb;
  std::vector<std::string> out;
  std::copy_if(a.channels.begin(), a.channels.end(), std::back_inserter(out), in_both);
  if (out.empty())
    throw Error("the images have no channel in common");
  return out;
}

/// Sums over many pixels of one channel.
struct Sums {
  double squares = 0, relative = 0, a = 0, b = 0;
  std::int64_t count = 0;
};

void finish(const Sums& sums, Difference& out) {
  const double n = static_cast<double>(std::max<std::int64_t>(sums.count, 1));
  out.mse = sums.squares / n;
  out.rmse = std::sqrt(out.mse);
  out.rel_mse = sums.relative / n;
  out.psnr = -10 * std::log10(out.mse);
  out.mean_a = sums.a / n, out.mean_b = sums.b / n;
}

Difference compare_channel(const Image& a, const Image& b, std::size_t c, Sums& sums) {
  Difference out;
  out.channel = a.channels[c];
  const std::size_t count = a.channels.size();
  for (std::size_t p = 0; p < a.pixel_count(); ++p) {
    const double va = a.data[p * count + c], vb = b.data[p * count + c], d = va - vb;
    if (!std::isfinite(va) || !std::isfinite(vb)) {
      ++out.non_finite;
      continue;
    }
    sums.squares += d * d;
    sums.relative += d * d / (vb * vb + kRelMseEpsilon);
    sums.a += va, sums.b += vb;
    ++sums.count;
    if (std::abs(d) > out.max_abs) {
      out.max_abs = std::abs(d);
      out.x = static_cast<int>(p % std::size_t(a.width));
      out.y = static_cast<int>(p / std::size_t(a.width));
    }
  }
  finish(sums, out);
  return out;
}

using Triple = std::array<double, 3>;

Triple xyz_at(const Image& rgb, std::size_t pixel) {
  const float* v = rgb.data.data() + 3 * pixel;
  return rgb_to_xyz({v[0], v[1], v[2]});
}

/// Sum of differences over a region and the variance of that sum.
struct Region {
  double difference = 0, variance = 0;
  double z() const {
    if (difference == 0)
      return 0;
    return variance > 0 ? difference / std::sqrt(variance)
                        : std::copysign(std::numeric_limits<double>::infinity(), difference);
  }
};

/// Differences this far below the reference's mean are none.
constexpr double kBlack = 1e-6;

/// Makes both pictures and both variances one channel list, so that they can be walked in step.
struct Pair {
  Image a, var_a, b, var_b;
  Pair(const Image& a_in, const Image& va, const Image& b_in, const Image& vb) {
    check_same_size(a_in, b_in);
    check_same_size(a_in, va);
    check_same_size(b_in, vb);
    const auto channels = common_channels(a_in, b_in);
    a = a_in.select(channels), var_a = va.select(channels);
    b = b_in.select(channels), var_b = vb.select(channels);
    set_black_variance();
  }
  bool finite(std::size_t i) const {
    return std::isfinite(a.data[i]) && std::isfinite(b.data[i]) && std::isfinite(var_a.data[i]) &&
           std::isfinite(var_b.data[i]);
  }
  Region at(std::size_t i, double quantisation) const {
    const double va = a.data[i], vb = b.data[i], q = quantisation * quantisation;
    return {va - vb, std::max(0.0f, var_a.data[i]) + std::max(0.0f, var_b.data[i]) +
                         q * (va * va + vb * vb) + black_variance_[i % a.channels.size()]};
  }

private:
  /// Tails of highlights reach 1e-30, where a variance underflows: they are no difference.
  void set_black_variance() {
    const std::size_t n = b.channels.size();
    std::vector<double> sums(n, 0.0);
    for (std::size_t i = 0; i < b.data.size(); ++i)
      sums[i % n] += std::isfinite(b.data[i]) ? std::abs(double(b.data[i])) : 0.0;
    for (double sum : sums) {
      const double black = kBlack * sum / static_cast<double>(b.pixel_count());
      black_variance_.push_back(black * black);
    }
  }
  std::vector<double> black_variance_; ///< per channel
};

/// Sums one block of one channel and counts its pixels into the result.
Region sum_block(const Pair& in, int x0, int y0, int block, int c, double quantisation,
                 TwoSampleTest& out, std::int64_t& beyond) {
  Region sum;
  for (int y = y0; y < std::min(y0 + block, in.a.height); ++y)
    for (int x = x0; x < std::min(x0 + block, in.a.width); ++x) {
      const std::size_t i = in.a.offset(x, y) + std::size_t(c);
      if (!in.finite(i)) {
        ++out.non_finite;
        continue;
      }
      const Region pixel = in.at(i, quantisation);
      sum.difference += pixel.difference, sum.variance += pixel.variance;
      const double z = pixel.z();
      beyond += std::abs(z) > out.limit;
      if (std::abs(z) > std::abs(out.largest_z)) {
        out.largest_z = z, out.x = x, out.y = y;
        out.channel = in.a.channels[std::size_t(c)];
      }
    }
  return sum;
}

double finite_mean_ratio(const Pair& in, std::size_t c) {
  double a = 0, b = 0;
  for (std::size_t i = c; i < in.a.data.size(); i += in.a.channels.size())
    if (in.finite(i))
      a += in.a.data[i], b += in.b.data[i];
  return b != 0 ? a / b : std::numeric_limits<double>::quiet_NaN();
}

} // namespace

Comparison compare(const Image& image, const Image& reference) {
  check_same_size(image, reference);
  Comparison out;
  out.channels = common_channels(image, reference);
  const Image a = image.select(out.channels), b = reference.select(out.channels);
  Sums total;
  for (std::size_t c = 0; c < out.channels.size(); ++c) {
    Sums sums;
    const Difference d = compare_channel(a, b, c, sums);
    out.per_channel.push_back(d);
    total.squares += sums.squares, total.relative += sums.relative;
    total.a += sums.a, total.b += sums.b, total.count += sums.count;
    const std::int64_t non_finite = out.all.non_finite + d.non_finite;
    if (c == 0 || d.max_abs > out.all.max_abs)
      out.all = d;
    out.all.non_finite = non_finite;
  }
  finish(total, out.all);
  return out;
}

double two_sided_z(double alpha) {
  // Bisection on the complementary error function: it stays accurate where 1 - erf would cancel.
  double low = 0, high = 40;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (std::erfc(middle / std::sqrt(2.0)) > alpha ? low : high) = middle;
  }
  return (low + high) / 2;
}

ZTest z_test(const Image& image, const Image& reference, const Image& variance, double spp,
             double reference_spp) {
  check_same_size(image, reference);
  check_same_size(image, variance);
  if (!(spp > 0))
    throw Error("the z-test needs the picture's samples per pixel");
  const Image a = image.rgb(), b = reference.rgb(), v = variance.rgb();
  ZTest out;
  const auto pixels = static_cast<double>(a.pixel_count());
  out.required_share = 0.9975;
  out.alpha = -std::expm1(std::log1p(-0.01) / pixels);
  out.z_threshold = two_sided_z(out.alpha);
  const double mean_weight = 1 / spp + (reference_spp > 0 ? 1 / reference_spp : 0);
  std::array<Region, 3> mean;
  std::int64_t passed = 0;
  for (std::size_t p = 0; p < a.pixel_count(); ++p) {
    const Triple xa = xyz_at(a, p), xb = xyz_at(b, p), xv = xyz_at(v, p);
    for (std::size_t c = 0; c < 3; ++c) {
      const double d = xa[c] - xb[c], z = d * std::sqrt(spp / std::max(xv[c], 1e-4));
      if (!std::isfinite(z)) {
        ++out.non_finite;
        continue;
      }
      passed += std::abs(z) < out.z_threshold;
      mean[c].difference += d, mean[c].variance += std::max(xv[c], 0.0) * mean_weight;
      if (std::abs(z) <= std::abs(out.largest_z))
        continue;
      out.largest_z = z, out.channel = "XYZ"[c];
      out.x = static_cast<int>(p % std::size_t(a.width));
      out.y = static_cast<int>(p / std::size_t(a.width));
    }
  }
  for (std::size_t c = 0; c < 3; ++c)
    out.mean_z[c] = mean[c].z();
  out.pass_share = static_cast<double>(passed) / (3 * pixels);
  out.pass = out.pass_share >= out.required_share;
  return out;
}

TwoSampleTest two_sample_test(const Image& a, const Image& var_a, const Image& b,
                              const Image& var_b, double limit, int block, double quantisation) {
  if (block < 1)
    throw Error(fmt::format("blocks of {} pixels", block), {}, "1 or more");
  const Pair in(a, var_a, b, var_b);
  TwoSampleTest out;
  out.limit = limit;
  out.channels = in.a.channels;
  std::int64_t pixels_beyond = 0, blocks_beyond = 0, blocks = 0;
  for (int c = 0; c < in.a.channel_count(); ++c) {
    Region total;
    for (int y = 0; y < in.a.height; y += block)
      for (int x = 0; x < in.a.width; x += block, ++blocks) {
        const Region sum = sum_block(in, x, y, block, c, quantisation, out, pixels_beyond);
        total.difference += sum.difference, total.variance += sum.variance;
        const double z = sum.z();
        blocks_beyond += std::abs(z) > limit;
        if (std::abs(z) > std::abs(out.largest_block_z))
          out.largest_block_z = z, out.block_x = x, out.block_y = y;
      }
    out.mean_z.push_back(total.z());
    out.mean_ratio.push_back(finite_mean_ratio(in, std::size_t(c)));
  }
  const auto values = static_cast<double>(in.a.data.size());
  out.pixel_share = static_cast<double>(pixels_beyond) / values;
  out.block_share = static_cast<double>(blocks_beyond) / static_cast<double>(blocks);
  return out;
}

} // namespace faceta
