#include "light_kernels.h"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

using namespace faceta;
using namespace faceta::double3;
using test::Queries;

namespace {

/// Directions, radiances and densities, by all modules alike.
struct Sky {
  std::vector<Double3> direction, radiance;
  std::vector<double> pdf;

  /// Samples by q, or, of given directions, what arrives from there.
  Sky(const EnvironmentView& e, const Queries& q, const std::vector<Double3>* given = nullptr) {
    size_t n = q.count;
    std::vector<float> floats(7 * n), first;
    auto array = [&](int k) { return &floats[k * n]; };
    light_module::EnvironmentAnswers a{
        {array(0), array(1), array(2)}, {array(3), array(4), array(5)}, array(6)};
    for (const light_module::LightTable* table : test::light_tables()) {
      if (given) {
        for (size_t i = 0; i < n; ++i)
          for (int k = 0; k < 3; ++k)
            array(k)[i] = static_cast<float>((*given)[i][k]);
        table->environment(e, a, q.count);
      } else {
        table->sample_environment(e, q.view(), a, q.count);
      }
      if (first.empty())
        first = floats;
      EXPECT_EQ(std::memcmp(first.data(), floats.data(), 4 * floats.size()), 0) << table->width;
    }
    for (size_t i = 0; i < n; ++i) {
      direction.push_back({first[i], first[n + i], first[2 * n + i]});
      radiance.push_back({first[3 * n + i], first[4 * n + i], first[5 * n + i]});
      pdf.push_back(first[6 * n + i]);
    }
  }
};

/// A dim sky with a bright spot at a seam, a black stretch, and rows of different light. Its
/// numbers have 10 bits, fewer than the half floats that they are kept as.
Image sky_image(int width, int height) {
  Image image;
  image.width = width;
  image.height = height;
  image.channels = {"R", "G", "B"};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      bool black = x > width / 3 && x < width / 2 && y > height / 4;
      double v = black ? 0 : 0.2 + 0.1 * y + std::abs(std::sin(x * 1.7 + y));
      v = std::round(v * 128) / 128; // below 8
      if (x == 0 && y == height / 3)
        v = 60;
      for (double tint : {1.0, 0.5, 0.25})
        image.data.push_back(static_cast<float>(v * tint));
    }
  return image;
}

/// The image at u, v in [0, 1] as EnvironmentTables describes it, red only.
double image_at(const Image& image, double u, double v) {
  double x = u * image.width - 0.5, y = v * (image.height - 1);
  int x0 = int(std::floor(x)), y0 = std::min(int(y), image.height - 2);
  auto texel = [&](int i, int j) {
    return double(image.data[image.offset((i + image.width) % image.width, j)]);
  };
  double fx = x - x0, fy = y - y0;
  return (1 - fy) * ((1 - fx) * texel(x0, y0) + fx * texel(x0 + 1, y0)) +
         fy * ((1 - fx) * texel(x0, y0 + 1) + fx * texel(x0 + 1, y0 + 1));
}

/// The world direction of u, v: +Y up, u from -Z towards +X.
Double3 direction_at(const ToWorld& to_world, double u, double v) {
  double phi = 2 * kPi * u, theta = kPi * v;
  return normalize(map_vector(to_world, {std::sin(theta) * std::sin(phi), std::cos(theta),
                                         -std::sin(theta) * std::cos(phi)}));
}

const ToWorld kTurned = {0.36, 0.48, -0.8, 0, -0.8, 0.6, 0, 0, 0.48, 0.64, 0.6, 0, 0, 0, 0, 1};

class EnvironmentImage : public testing::Test {
protected:
  EnvironmentImage() : image_(sky_image(24, 13)) {
    EnvironmentDesc desc;
    desc.image = std::make_shared<Image>(image_);
    desc.to_world = kTurned;
    desc.radiance = {2, 2, 2};
    scene_.set_environment(desc);
    scene_.build(best_isa());
  }
  const EnvironmentView& view() const { return scene_.view().environment; }

  Image image_;
  Scene scene_;
};

} // namespace

TEST_F(EnvironmentImage, RadianceIsTheBilinearImage) {
  Queries q(4096);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> number(0, 1);
  std::vector<Double3> directions;
  std::vector<double> wanted;
  for (int i = 0; i < q.count; ++i) {
    double u = number(generator), v = 0.01 + 0.98 * number(generator);
    directions.push_back(direction_at(kTurned, u, v));
    wanted.push_back(2 * image_at(image_, u, v));
  }
  Sky sky(view(), q, &directions);
  for (int i = 0; i < q.count; ++i) {
    ASSERT_NEAR(sky.radiance[i][0], wanted[i], 1e-5 * 120) << i;
    ASSERT_NEAR(sky.radiance[i][2], 0.25 * sky.radiance[i][0], 1e-6);
  }
}

TEST_F(EnvironmentImage, SamplesHaveTheDensityOfTheirDirection) {
  Queries q(16384);
  std::mt19937 generator(4);
  q.random(generator, true);
  Sky samples(view(), q), seen(view(), q, &samples.direction);
  int differ = 0;
  for (int i = 0; i < q.count; ++i) {
    ASSERT_NEAR(length(samples.direction[i]), 1, 1e-6);
    ASSERT_GT(samples.pdf[i], 0);
    // A direction on the border of two cells may be taken for the other one's.
    if (std::abs(seen.pdf[i] - samples.pdf[i]) > 1e-3 * samples.pdf[i])
      ++differ;
    ASSERT_NEAR(seen.radiance[i][0], samples.radiance[i][0], 2e-3 + 1e-4 * samples.radiance[i][0]);
  }
  EXPECT_LE(differ, q.count / 2000);
}

TEST_F(EnvironmentImage, DensityIntegratesToOneAndSamplesFollowIt) {
  // Quadrature in the cells of the image, which start half a texel off u = 0.
  int columns = view().columns, rows = view().rows, steps = 16;
  Queries nodes(columns * rows * steps * steps), q(65536);
  std::vector<Double3> directions;
  std::vector<double> weight;
  for (int i = 0; i < nodes.count; ++i) {
    int x = i % (columns * steps), y = i / (columns * steps);
    double u = (x + 0.5) / (columns * steps) + 0.5 / columns, v = (y + 0.5) / (rows * steps);
    directions.push_back(direction_at(kTurned, u, v));
    weight.push_back(2 * kPi * kPi * std::sin(kPi * v) / nodes.count);
  }
  Sky sky(view(), nodes, &directions);
  std::vector<double> expected(columns * rows), observed(columns * rows);
  double integral = 0, flux = 0;
  for (int i = 0; i < nodes.count; ++i) {
    integral += sky.pdf[i] * weight[i];
    flux += sky.radiance[i][0] * weight[i];
    int x = i % (columns * steps), y = i / (columns * steps);
    expected[y / steps * columns + x / steps] += sky.pdf[i] * weight[i] * q.count;
  }
  EXPECT_NEAR(integral, 1, 1e-3);
  std::mt19937 generator(5);
  q.random(generator, true);
  Sky samples(view(), q);
  std::vector<double> values;
  for (int i = 0; i < q.count; ++i) {
    values.push_back(samples.radiance[i][0] / samples.pdf[i]);
    Double3 d; // to_world is a rotation
    for (int k = 0; k < 3; ++k)
      d[k] = dot(column(kTurned, k), samples.direction[i]);
    double u = std::atan2(d[0], -d[2]) / (2 * kPi) - 0.5 / columns;
    u -= std::floor(u);
    int x = std::min(int(u * columns), columns - 1);
    int y = std::min(int(std::acos(std::clamp(d[1], -1.0, 1.0)) / kPi * rows), rows - 1);
    observed[y * columns + x] += 1;
  }
  EXPECT_LT(test::chi_square_score(expected, observed), 4.5);
  test::Estimate e = test::estimate(values);
  EXPECT_NEAR(e.value, flux, 4.5 * e.error + 1e-3 * flux);
  EXPECT_LT(e.error, 0.005 * flux); // uniform directions would give 0.03
}

TEST(EnvironmentConstant, IsSampledUniformly) {
  Scene scene;
  EnvironmentDesc desc;
  desc.radiance = {0.5, 1, 2};
  scene.set_environment(desc);
  scene.build(best_isa());
  const EnvironmentView& view = scene.view().environment;
  Queries q(16384);
  std::mt19937 generator(6);
  q.random(generator, true);
  Sky samples(view, q), seen(view, q, &samples.direction);
  constexpr int kSide = 16;
  std::vector<double> expected(kSide * kSide, double(q.count) / (kSide * kSide)),
      observed(kSide * kSide);
  for (int i = 0; i < q.count; ++i) {
    ASSERT_FLOAT_EQ(samples.pdf[i], 1 / (4 * kPi));
    ASSERT_EQ(samples.pdf[i], seen.pdf[i]);
    ASSERT_EQ(seen.radiance[i], (Double3{0.5, 1, 2}));
    const Double3& d = samples.direction[i];
    ASSERT_NEAR(length(d), 1, 1e-6);
    int x = std::min(int((std::atan2(d[1], d[0]) / (2 * kPi) + 0.5) * kSide), kSide - 1);
    int y = std::clamp(int((d[2] + 1) / 2 * kSide), 0, kSide - 1);
    observed[y * kSide + x] += 1;
  }
  EXPECT_LT(test::chi_square_score(expected, observed), 4.5);
}
