#include "cli/commands.h"
#include "image/io.h"
#include "image/metrics.h"

#include <cmath>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace faceta::cli {

namespace {

using Json = nlohmann::ordered_json;

/// --spp, or what the picture's metadata say.
double samples_per_pixel(const DiffOptions& options, const Image& image) {
  if (options.spp)
    return *options.spp;
  for (const char* name : {"samplesPerPixel", "spp"}) {
    auto found = image.metadata.find(name);
    if (found == image.metadata.end())
      continue;
    if (const int* n = std::get_if<int>(&found->second))
      return *n;
    if (const double* n = std::get_if<double>(&found->second))
      return *n;
  }
  throw Error("its metadata name no spp, which the test needs", {options.image}, "give --spp N");
}

Json difference_json(const Difference& d) {
  return {{"mse", d.mse},
          {"rmse", d.rmse},
          {"rel_mse", d.rel_mse},
          {"psnr", d.psnr},
          {"max_abs", d.max_abs},
          {"max_at", {{"x", d.x}, {"y", d.y}, {"channel", d.channel}}},
          {"mean", d.mean_a},
          {"reference_mean", d.mean_b},
          {"non_finite", d.non_finite}};
}

Json test_json(const ZTest& t) {
  return {{"pass", t.pass},
          {"pass_share", t.pass_share},
          {"required_share", t.required_share},
          {"z_threshold", t.z_threshold},
          {"largest_z", t.largest_z},
          {"largest_at", {{"x", t.x}, {"y", t.y}, {"channel", std::string(1, t.channel)}}},
          {"mean_z", {t.mean_z[0], t.mean_z[1], t.mean_z[2]}},
          {"non_finite", t.non_finite}};
}

// What the two-sample test asks for.
constexpr double kMeanTolerance = 0.01, kBlockTolerance = 0.01;

/// Whether two noisy pictures agree: means within 1 % and at most 1 % of the blocks beyond the
/// limit, and of the pixels not finite. A black reference agrees with a black picture.
bool agree(const TwoSampleTest& t, size_t pixels) {
  bool good = t.block_share <= kBlockTolerance &&
              double(t.non_finite) <= kBlockTolerance * double(pixels * t.channels.size());
  for (size_t i = 0; i < t.channels.size(); ++i)
    good = good && (std::abs(t.mean_ratio[i] - 1) <= kMeanTolerance || t.mean_z[i] == 0);
  return good;
}

Json two_sample_json(const TwoSampleTest& t, bool pass) {
  return {{"pass", pass},
          {"limit", t.limit},
          {"block_share", t.block_share},
          {"pixel_share", t.pixel_share},
          {"largest_z", t.largest_z},
          {"largest_at", {{"x", t.x}, {"y", t.y}, {"channel", t.channel}}},
          {"largest_block_z", t.largest_block_z},
          {"largest_block_at", {{"x", t.block_x}, {"y", t.block_y}}},
          {"channels", t.channels},
          {"mean_ratio", t.mean_ratio},
          {"mean_z", t.mean_z},
          {"non_finite", t.non_finite}};
}

std::string two_sample_text(const TwoSampleTest& t, bool pass) {
  std::string text = fmt::format(
      "two-sample test: {}: {:.3f} % of 8 x 8 blocks beyond |z| = {:g} (allowed: {:g} %), {:.3f} % "
      "of pixels\n",
      pass ? "pass" : "FAIL", 100 * t.block_share, t.limit, 100 * kBlockTolerance,
      100 * t.pixel_share);
  text += "mean over the reference's (allowed: within 1 %):";
  for (size_t i = 0; i < t.channels.size(); ++i)
    text += fmt::format(" {} {:.5f} (z {:.2f})", t.channels[i], t.mean_ratio[i], t.mean_z[i]);
  text += fmt::format("\nlargest z {:.2f} at x {}, y {}, channel {}; of a block {:.2f} at x {}, y "
                      "{}\n",
                      t.largest_z, t.x, t.y, t.channel, t.largest_block_z, t.block_x, t.block_y);
  if (t.non_finite)
    text += fmt::format("left out: {} values that are not finite\n", t.non_finite);
  return text;
}

std::string row(const std::string& name, const Difference& d) {
  return fmt::format(
      "{:<10} {:>12.6g} {:>12.6g} {:>12.6g} {:>9.4g} {:>12.6g} {:>12.6g} {:>12.6g}\n", name, d.mse,
      d.rmse, d.rel_mse, d.psnr, d.max_abs, d.mean_a, d.mean_b);
}

std::string comparison_text(const Comparison& c) {
  std::string text =
      fmt::format("{:<10} {:>12} {:>12} {:>12} {:>9} {:>12} {:>12} {:>12}\n", "channel", "MSE",
                  "RMSE", "relMSE", "PSNR/dB", "max |a-b|", "mean a", "mean b");
  for (size_t i = 0; i < c.channels.size(); ++i)
    text += row(c.channels[i], c.per_channel[i]);
  text += row("all", c.all);
  text += fmt::format("largest difference at x {}, y {}, channel {}\n", c.all.x, c.all.y,
                      c.all.channel);
  if (c.all.non_finite)
    text += fmt::format("left out: {} values that are not finite\n", c.all.non_finite);
  return text;
}

std::string test_text(const ZTest& t) {
  std::string text = fmt::format(
      "z-test: {}: {:.4f} % of pixel channels below |z| = {:.3f} (needed: {:.2f} %)\n",
      t.pass ? "pass" : "FAIL", 100 * t.pass_share, t.z_threshold, 100 * t.required_share);
  text +=
      fmt::format("largest z {:.2f} at x {}, y {}, channel {}; z of the mean X {:.2f}, Y {:.2f}, "
                  "Z {:.2f}\n",
                  t.largest_z, t.x, t.y, t.channel, t.mean_z[0], t.mean_z[1], t.mean_z[2]);
  if (t.non_finite)
    text += fmt::format("not finite: {} values, which fail\n", t.non_finite);
  return text;
}

} // namespace

int run_diff(const DiffOptions& options) {
  Image image = read_image(options.image), reference = read_image(options.reference);
  Comparison comparison = compare(image, reference);
  std::optional<ZTest> test;
  if (!options.variance.empty())
    test = z_test(image.rgb(), reference.rgb(), read_image(options.variance).rgb(),
                  samples_per_pixel(options, image), options.reference_spp.value_or(0));
  std::optional<TwoSampleTest> two;
  if (!options.image_variance.empty())
    two = two_sample_test(image.rgb(), read_image(options.image_variance).rgb(), reference.rgb(),
                          read_image(options.reference_variance).rgb(), 4, 8, options.quantisation);
  bool agreed = !two || agree(*two, image.pixel_count());
  std::string text;
  if (options.json) {
    Json json = difference_json(comparison.all);
    for (size_t i = 0; i < comparison.channels.size(); ++i)
      json["channels"][comparison.channels[i]] = difference_json(comparison.per_channel[i]);
    if (test)
      json["z_test"] = test_json(*test);
    if (two)
      json["two_sample_test"] = two_sample_json(*two, agreed);
    text = json.dump(2) + "\n";
  } else {
    text = comparison_text(comparison);
    if (test)
      text += test_text(*test);
    if (two)
      text += two_sample_text(*two, agreed);
  }
  std::fputs(text.c_str(), stdout);
  bool failed = (test && !test->pass) || !agreed;
  return failed ? kCheckFailed : kOk;
}

} // namespace faceta::cli
