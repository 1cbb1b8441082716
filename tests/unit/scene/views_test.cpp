#include "base/error.h"
#include "base/half.h"
#include "image/io.h"
#include "mitsuba_views.h"
#include "scene/camera.h"
#include "scene/environment.h"
#include "test_models.h"

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <numbers>

using namespace faceta;
using namespace faceta::double3;

namespace {

constexpr double kPi = std::numbers::pi;

Double3 rotate(const float (&m)[9], const Double3& v) {
  return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
          m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

/// Radiance along a direction, from the cells.
Double3 look_up(const EnvironmentView& e, const Double3& direction) {
  Double3 v = rotate(e.to_local, direction);
  double u = std::atan2(v[0], -v[2]) / (2 * kPi);
  double x = (u - std::floor(u)) * e.columns;
  double y = std::acos(std::clamp(v[1], -1.0, 1.0)) / kPi * e.rows;
  int cx = std::min(int(x), e.columns - 1), cy = std::min(int(y), e.rows - 1);
  const EnvironmentCell& cell = e.cells[cy * e.columns + cx];
  Double3 r;
  for (int c = 0; c < 3; ++c) {
    auto value = [&](int k) { return double(half_value(cell.texel[k][c])) * cell.scale; };
    double top = std::lerp(value(0), value(1), x - cx);
    double bottom = std::lerp(value(2), value(3), x - cx);
    r[c] = e.radiance[c] * std::lerp(top, bottom, y - cy);
  }
  return r;
}

EnvironmentDesc small_environment() {
  Image image(7, 5);
  image.data = mitsuba::environment_pixels;
  EnvironmentDesc desc;
  desc.radiance = {1.5, 1.5, 1.5};
  desc.image = std::make_shared<Image>(image);
  return desc;
}

TEST(Environment, KeepsElevenBitsOfAnyTexel) {
  Image image(64, 33);
  image.data.clear();
  for (size_t i = 0; i < size_t(64) * 33 * 3; ++i) // from 1e-3 to 1e5, one channel beside the other
    image.data.push_back(static_cast<float>(std::pow(10.0, std::fmod(double(i) * 0.7312, 8) - 3)));
  EnvironmentDesc desc;
  desc.image = std::make_shared<Image>(image);
  EnvironmentTables tables(desc);
  EnvironmentView e = tables.view();
  for (int y = 0; y < e.rows; ++y)
    for (int x = 0; x < e.columns; ++x)
      for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c) {
          const EnvironmentCell& cell = e.cells[y * e.columns + x];
          double kept = double(half_value(cell.texel[k][c])) * cell.scale;
          double given = image.data[image.offset((x + (k & 1)) % 64, y + (k >> 1)) + c];
          ASSERT_NEAR(kept, given, 0x1p-11 * given);
        }
}

TEST(Environment, ShinesAsInMitsuba) {
  EnvironmentDesc desc = small_environment();
  for (const mitsuba::EnvironmentValue& value : mitsuba::environment_values) {
    SCOPED_TRACE(value.label);
    desc.to_world = value.to_world;
    EnvironmentTables tables(desc);
    Double3 radiance = look_up(tables.view(), value.direction);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(radiance[c], value.radiance[c], 2e-5);
  }
}

TEST(Environment, MuseumShinesAsInMitsuba) {
  std::filesystem::path path =
      std::string(FACETA_SHARED_DATA) + "/mitsuba-data/common/textures/museum.exr";
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "no " << path;
  EnvironmentDesc desc;
  desc.image = std::make_shared<Image>(read_image(path));
  EnvironmentTables tables(desc);
  for (const mitsuba::EnvironmentValue& value : mitsuba::museum_values) {
    Double3 radiance = look_up(tables.view(), value.direction);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(radiance[c], value.radiance[c], 1e-4 * (1 + value.radiance[c]));
  }
}

/// The probabilities that an alias table gives its entries.
std::vector<double> probabilities(const float* threshold, const int32_t* alias, int n) {
  std::vector<double> p(n);
  for (int i = 0; i < n; ++i) {
    p[i] += threshold[i] / double(n);
    p[alias[i]] += (1 - threshold[i]) / double(n);
  }
  return p;
}

TEST(Environment, CellsAreChosenByTheirLight) {
  EnvironmentTables tables(small_environment());
  EnvironmentView e = tables.view();
  ASSERT_EQ(e.columns, 7);
  ASSERT_EQ(e.rows, 4);
  // Mean luminance of the corners times the sine at the centre, straight from the picture.
  std::vector<double> expected;
  double sum = 0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 7; ++x) {
      double light = 0;
      for (int k = 0; k < 4; ++k) {
        const float* p = &mitsuba::environment_pixels[3 * (7 * (y + k / 2) + (x + k % 2) % 7)];
        light += 0.212671 * p[0] + 0.715160 * p[1] + 0.072169 * p[2];
      }
      expected.push_back(light * std::sin(kPi * (y + 0.5) / 4));
      sum += expected.back();
    }
  // Every rectangle is chosen with its share of the light, uniformly inside; the densities in the
  // cells say the same.
  std::vector<float> threshold;
  std::vector<int32_t> alias;
  for (int i = 0; i < e.leaf_count; ++i) {
    threshold.push_back(e.leaves[i].threshold);
    alias.push_back(e.leaves[i].alias);
  }
  std::vector<double> chosen = probabilities(threshold.data(), alias.data(), e.leaf_count);
  int covered = 0;
  for (int i = 0; i < e.leaf_count; ++i) {
    int x0 = e.leaves[i].origin[0] & 0xffff, y0 = e.leaves[i].origin[0] >> 16;
    int width = e.leaves[i].size[0] & 0xffff, height = e.leaves[i].size[0] >> 16;
    double share = 0;
    for (int y = y0; y < y0 + height; ++y)
      for (int x = x0; x < x0 + width; ++x, ++covered) {
        share += expected[7 * y + x] / sum;
        EXPECT_NEAR(e.cells[7 * y + x].pdf, chosen[i] * 28 / (width * height), 1e-5);
      }
    EXPECT_NEAR(chosen[i], share, 1e-6);
  }
  EXPECT_EQ(covered, 28);
}

TEST(Environment, RotationsAreInverse) {
  EnvironmentDesc desc = small_environment();
  desc.to_world = {0, 0, -3, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 1}; // mirrors and scales
  EnvironmentView e = EnvironmentTables(desc).view();
  for (const Double3& v : {Double3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    Double3 back = rotate(e.to_world, rotate(e.to_local, v));
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(back[k], v[k], 1e-6);
  }
}

TEST(Environment, IsChosenByItsSharesOfWeight) {
  auto probability = [](double weight, std::vector<double> lights, double radiance = 1) {
    Scene scene;
    EnvironmentDesc desc;
    desc.radiance = {radiance, radiance, radiance};
    desc.sampling_weight = weight;
    scene.set_environment(desc);
    for (double w : lights)
      scene.add_point_light({{0, 0, 0}, {1, 1, 1}, w});
    scene.build(Isa::scalar);
    EXPECT_EQ(scene.view().environment.present, 1);
    return scene.view().environment.probability;
  };
  EXPECT_FLOAT_EQ(probability(1, {}), 1);
  EXPECT_FLOAT_EQ(probability(1, {1}), 0.5f);
  EXPECT_FLOAT_EQ(probability(3, {1, 1}), 0.75f);
  EXPECT_FLOAT_EQ(probability(1, {3, 3}), 0.25f);
  EXPECT_FLOAT_EQ(probability(1, {0}), 1);
  EXPECT_FLOAT_EQ(probability(0, {1}), 0);
  EXPECT_FLOAT_EQ(probability(0, {}), 0);
  EXPECT_FLOAT_EQ(probability(1, {1}, 0), 0); // black
}

TEST(Environment, RefusesWhatIsNone) {
  EnvironmentDesc desc = small_environment();
  desc.to_world = {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  EXPECT_THROW(EnvironmentTables{desc}, Error);
  desc = small_environment();
  desc.image = std::make_shared<Image>(Image(7, 2));
  EXPECT_THROW(EnvironmentTables{desc}, Error);
  Image infinite(7, 5);
  infinite.data[8] = std::numeric_limits<float>::infinity();
  desc.image = std::make_shared<Image>(infinite);
  EXPECT_THROW(EnvironmentTables{desc}, Error);
  Scene scene;
  scene.set_environment({});
  EXPECT_THROW(scene.set_environment({}), Error);
  // A black picture is no error: it is a black constant.
  desc.image = std::make_shared<Image>(Image(7, 5));
  EXPECT_TRUE(EnvironmentTables(desc).black());
  EXPECT_EQ(EnvironmentTables(desc).view().columns, 0);
}

TEST(Camera, ShootsMitsubasRays) {
  for (const mitsuba::CameraRay& ray : mitsuba::camera_rays) {
    SCOPED_TRACE(ray.label);
    CameraDesc camera;
    camera.to_world = ray.to_world;
    camera.x_fov = ray.fov;
    camera.near_clip = ray.near_clip;
    camera.far_clip = ray.far_clip;
    camera.principal_point[0] = ray.principal_point[0];
    camera.principal_point[1] = ray.principal_point[1];
    FilmDesc film;
    film.width = ray.width, film.height = ray.height;
    film.crop_x = ray.crop_x, film.crop_y = ray.crop_y;
    film.crop_width = ray.crop_width, film.crop_height = ray.crop_height;
    CameraView v = make_camera(camera, film);
    // From the crop window to the whole film, to the near plane, to the world.
    double fx = (v.crop_x + ray.x * v.crop_width) / v.film_width;
    double fy = (v.crop_y + ray.y * v.crop_height) / v.film_height;
    const float* m = v.sample_to_camera;
    double p[4];
    for (int r = 0; r < 4; ++r)
      p[r] = m[4 * r] * fx + m[4 * r + 1] * fy + m[4 * r + 3];
    Double3 d = normalize({p[0] / p[3], p[1] / p[3], p[2] / p[3]});
    Double3 world{}, origin{};
    for (int k = 0; k < 3; ++k) {
      const float* w = v.to_world + 4 * k;
      world[k] = w[0] * d[0] + w[1] * d[1] + w[2] * d[2];
      origin[k] = w[3] + world[k] * v.near_clip / d[2];
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(world[k], ray.direction[k], 1e-6);
      EXPECT_NEAR(origin[k], ray.origin[k], 1e-5);
    }
    EXPECT_NEAR((v.far_clip - v.near_clip) / d[2], ray.far, 1e-5 * ray.far);
  }
}

TEST(Camera, RefusesWhatMakesNoPicture) {
  auto refuse = [](auto change) {
    CameraDesc camera;
    FilmDesc film;
    change(camera, film);
    EXPECT_THROW(make_camera(camera, film), Error);
  };
  refuse([](CameraDesc& c, FilmDesc&) { c.x_fov = 0; });
  refuse([](CameraDesc& c, FilmDesc&) { c.x_fov = 180; });
  refuse([](CameraDesc& c, FilmDesc&) { c.near_clip = 0; });
  refuse([](CameraDesc& c, FilmDesc&) { c.far_clip = c.near_clip; });
  refuse([](CameraDesc& c, FilmDesc&) { c.to_world[0] = 2; });
  refuse([](CameraDesc& c, FilmDesc&) { c.principal_point[1] = NAN; });
  refuse([](CameraDesc&, FilmDesc& f) { f.width = 0; });
  refuse([](CameraDesc&, FilmDesc& f) { f.crop_x = f.width; });
  refuse([](CameraDesc&, FilmDesc& f) { f.crop_x = -1; });
  refuse([](CameraDesc&, FilmDesc& f) { f.crop_height = f.height + 1; });
  EXPECT_NO_THROW(make_camera({}, {}));
}

TEST(Filter, CumulatesMitsubasFilters) {
  for (const mitsuba::FilterValue& value : mitsuba::filter_values) {
    FilterDesc desc;
    desc.type = value.tent ? FilterType::tent : FilterType::gaussian;
    desc.radius = desc.stddev = value.parameter;
    FilterTable table(desc);
    FilterView v = table.view();
    ASSERT_EQ(v.cells, kFilterCells);
    EXPECT_EQ(v.share[0], 0);
    EXPECT_EQ(v.share[v.cells], 1);
    EXPECT_FLOAT_EQ(v.radius, static_cast<float>((value.tent ? 1 : 4) * value.parameter));
    // The density of the table's cell against the filter over its integral; Mitsuba's Gaussian is a
    // polynomial good to some 1e-3.
    double integral = value.tent ? value.parameter : value.parameter * std::sqrt(2 * kPi);
    double x = std::abs(value.x) / v.radius * v.cells, width = v.radius / v.cells;
    int i = std::min(int(x), v.cells - 1);
    auto density = [&](int k) { // even in k + 1/2
      k = std::min(k < 0 ? -1 - k : k, v.cells - 1);
      return (v.share[k + 1] - v.share[k]) / (2 * width);
    };
    // Linear between the middles of cells.
    int k = x - i < 0.5 ? i - 1 : i;
    double between = std::lerp(density(k), density(k + 1), x - k - 0.5);
    EXPECT_NEAR(between * integral, value.value, value.x == 0 && value.tent ? 0.02 : 4e-3)
        << value.x;
  }
  EXPECT_EQ(FilterTable(FilterDesc{FilterType::box}).view().cells, 0);
  EXPECT_THROW(FilterTable(FilterDesc{FilterType::tent, 0}), Error);
  EXPECT_THROW(FilterTable(FilterDesc{FilterType::gaussian, 1, -1}), Error);
}

} // namespace
