#include "light_kernels.h"
#include "view_math.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace faceta;
using namespace faceta::double3;
using test::LoneLight;
using test::Queries;
using test::Samples;

namespace {

constexpr int kSamples = 16384;

/// Samples of one light from one point, and what they must agree with.
class View {
public:
  View(const LoneLight& light, const Double3& p)
      : light_(light), p_(test::rounded(p)), scene_(light.scene->view()), queries_(kSamples) {
    queries_.put_all(p_, {0, 0, 1}, 0);
    queries_.random(generator_);
    samples_ = test::sample_lights(scene_, queries_);
    for (int v : samples_.valid)
      valid_ += v != 0;
  }

  double valid_share() const { return double(valid_) / kSamples; }

  /// Rays along the samples meet the light where they were told to, and MIS gives them the density
  /// they were drawn with. An edge may swallow a few.
  void check_hits() {
    Queries at_hits = queries_;
    std::vector<Double3> offsets(kSamples);
    int missed = 0;
    for (int i = 0; i < kSamples; ++i) {
      if (!samples_.valid[i])
        continue;
      const Double3& d = samples_.direction[i];
      ASSERT_NEAR(length(d), 1, 1e-6);
      ASSERT_NEAR(length(samples_.offset[i]), samples_.distance[i], 1e-5 * samples_.distance[i]);
      test::Hit hit = test::trace(scene_, p_, d);
      if (hit.geometry < 0) {
        ++missed;
        continue;
      }
      SurfacePoint s = test::surface(scene_, hit, p_, d);
      offsets[i] = sub(s.p, p_);
      at_hits.put_point(i, p_, s.n);
      double cosine = std::abs(dot(d, s.n));
      ASSERT_NEAR(length(offsets[i]), samples_.distance[i],
                  samples_.distance[i] * (1e-5 + 1e-6 / cosine) + 4e-7 * length(s.p) / cosine);
    }
    EXPECT_LE(missed, kSamples / 1000);
    std::vector<double> pdf = test::light_pdfs(scene_, at_hits, offsets);
    for (int i = 0; i < kSamples; ++i) {
      if (!samples_.valid[i] || length(offsets[i]) == 0)
        continue;
      Double3 n{at_hits.normal[0][i], at_hits.normal[1][i], at_hits.normal[2][i]};
      double cosine = std::abs(dot(samples_.direction[i], n));
      // Rounding moves a hit along the ray by 1 / cosine, and the normal of what is round with it.
      double error = 2e-5 + 2e-5 / cosine + (light_.polygon.empty() ? 5e-6 / (cosine * cosine) : 0);
      ASSERT_NEAR(pdf[i], samples_.pdf[i], samples_.pdf[i] * error) << i;
    }
  }

  /// The samples lie on the light as its density says, which integrates to the share of the valid:
  /// 1 where every point of the light can be seen.
  void check_density(bool all_seen) {
    constexpr int kCells = 12, kSteps = 16, kSide = kCells * kSteps;
    Queries nodes(kSide * kSide);
    nodes.put_all(p_, {0, 0, 1}, 0);
    std::vector<Double3> offsets(nodes.count);
    std::vector<double> factor(nodes.count), expected(kCells * kCells), observed(kCells * kCells);
    for (int i = 0; i < nodes.count; ++i) {
      test::SurfaceElement e = light_.element((i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide);
      offsets[i] = sub(e.position, p_);
      nodes.put_point(i, p_, e.normal);
      double d = length(offsets[i]), cosine = -dot(offsets[i], e.normal) / d;
      factor[i] = std::max(0.0, cosine) / (d * d) * e.area / nodes.count;
    }
    std::vector<double> pdf = test::light_pdfs(scene_, nodes, offsets);
    double integral = 0;
    for (int i = 0; i < nodes.count; ++i) {
      double share = factor[i] > 0 ? pdf[i] * factor[i] : 0;
      expected[i / kSide / kSteps * kCells + i % kSide / kSteps] += share * kSamples;
      integral += share;
    }
    for (int i = 0; i < kSamples; ++i) {
      if (!samples_.valid[i])
        continue;
      auto [s, t] = light_.square(add(p_, samples_.offset[i]));
      int x = std::clamp(int(s * kCells), 0, kCells - 1);
      int y = std::clamp(int(t * kCells), 0, kCells - 1);
      observed[y * kCells + x] += 1;
    }
    double share = valid_share();
    EXPECT_NEAR(integral, share, 3e-3 + 4 * std::sqrt(share * (1 - share) / kSamples));
    if (all_seen) {
      EXPECT_NEAR(integral, 1, 3e-3);
      EXPECT_GE(share, 0.999);
    }
    EXPECT_LT(test::chi_square_score(expected, observed), 4.5);
  }

  /// The same where it is small: only the relative error counts.
  void check_irradiance_within(const Double3& normal, double wanted, double relative) {
    double sum = 0;
    for (int i = 0; i < kSamples; ++i)
      sum += dot(samples_.direction[i], normal) / samples_.pdf[i];
    EXPECT_NEAR(sum / kSamples / wanted, 1, relative);
  }

  /// The mean of cosine over density is the irradiance.
  void check_irradiance(const Double3& normal, double wanted) {
    std::vector<double> values(kSamples);
    for (int i = 0; i < kSamples; ++i)
      if (samples_.valid[i])
        values[i] = std::max(0.0, dot(samples_.direction[i], normal)) / samples_.pdf[i];
    test::Estimate e = test::estimate(values);
    EXPECT_NEAR(e.value, wanted, 4.5 * e.error + 2e-4 * wanted + 1e-7)
        << "normal " << normal[0] << " " << normal[1] << " " << normal[2];
  }

private:
  const LoneLight& light_;
  Double3 p_;
  const SceneView& scene_;
  std::mt19937 generator_{7};
  Queries queries_;
  Samples samples_;
  int valid_ = 0;
};

const Double3 kNormals[] = {{0, 0, 1},      {0, 0, -1},         {1, 0, 0},
                            {-0.6, 0, 0.8}, {0.36, 0.48, -0.8}, {0.8, -0.6, 0}};

/// Everything about a flat light from a point in front of it.
void check_flat(const LoneLight& light, const Double3& p, bool converges = true) {
  SCOPED_TRACE(testing::Message() << light.name << " seen from " << p[0] << " " << p[1] << " "
                                  << p[2]);
  View view(light, p);
  view.check_hits();
  view.check_density(true);
  for (const Double3& n : kNormals)
    if (converges)
      view.check_irradiance(n, test::polygon_irradiance(light.polygon, test::rounded(p), n));
}

} // namespace

TEST(LightSampling, FormulasAgree) {
  // A square of side 2 one above the receiver's normal, by the factor of a rectangle over a corner.
  double x = 1 / std::sqrt(2.0);
  double corner = 0.5 * (x * std::atan(x) + x * std::atan(x));
  std::vector<Double3> square = {{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}};
  EXPECT_NEAR(test::polygon_irradiance(square, {0, 0, 0}, {0, 0, 1}), 4 * corner, 1e-12);
  EXPECT_EQ(test::polygon_irradiance(square, {0, 0, 2}, {0, 0, -1}), 0);
  // A disk parallel to the receiver, off its axis (Hamilton and Morgan 1952).
  LoneLight disk = test::disk_light({0.7, 0, 2}, {0, 1.5, 0}, {1.5, 0, 0});
  double sum = 4 + 0.49 + 2.25;
  double factor = 0.5 * (1 - (sum - 4.5) / std::sqrt(sum * sum - 4 * 0.49 * 2.25));
  EXPECT_NEAR(test::polygon_irradiance(disk.polygon, {0, 0, 0}, {0, 0, 1}), kPi * factor, 1e-6);
}

TEST(LightSampling, RectangleBySolidAngle) {
  LoneLight unit = test::rectangle_light({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  for (const Double3& p : {Double3{0, 0, 1},
                           {0.2, -0.3, 0.1},
                           {0.9, 0.9, 0.4},
                           {1.2, 0.3, 0.2},
                           {-1, -1, 0.5},
                           {1.3, 0.1, 0.05},
                           {0.5, 0.4, 0.03}})
    check_flat(unit, p);
  LoneLight tilted = test::rectangle_light({3, 1, 2}, {0.8, 0, 0.6}, {0, 1.5, 0});
  for (const Double3& p : {Double3{3, 1.5, 2.8}, {3.1, 2.2, 2.4}, {3.9, 1, 2.9}})
    check_flat(tilted, p);
}

// From here the rectangle is all of a hemisphere.
TEST(LightSampling, RectangleVeryNear) {
  LoneLight unit = test::rectangle_light({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  for (double height : {3e-3, 1e-3, 1e-4, 1e-6}) {
    Double3 p{0.5, 0.5, height};
    View view(unit, p);
    view.check_hits();
    for (const Double3& n : kNormals)
      view.check_irradiance(n, test::polygon_irradiance(unit.polygon, test::rounded(p), n));
  }
}

TEST(LightSampling, RectangleByArea) {
  LoneLight unit = test::rectangle_light({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  for (const Double3& p : {Double3{0, 0, 3}, {4, 2, 1}, {-5, 0, 0.3}, {100, 50, 80}, {8, 0, 0.01}})
    check_flat(unit, p);
}

TEST(LightSampling, RectangleBehindAndInItsPlane) {
  LoneLight unit = test::rectangle_light({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  for (const Double3& p : {Double3{0, 0, -1},
                           {0.3, 0.2, -1e-4},
                           {0.1, 5, -2},
                           {0.5, 0.25, 0},
                           {1, 0.5, 0},
                           {1, 1, 0},
                           {1.25, 0, 0},
                           {3, 1, 0}})
    EXPECT_EQ(View(unit, p).valid_share(), 0) << p[0] << " " << p[1] << " " << p[2];
}

// Beside a rectangle and little above its plane the sum of four angles that is its solid angle has
// lost its digits and may come out below 0.
TEST(LightSampling, RectanglesSeenEdgeOn) {
  struct Case {
    Double3 e1, e2;
  };
  for (const Case& c :
       {Case{{2, 0, 0}, {0, 2, 0}}, {{4, 0, 0}, {0, 0.25, 0}}, {{0.03, 0, 0}, {0, 7, 0}}}) {
    Double3 corner = scale(add(c.e1, c.e2), -0.5);
    LoneLight light = test::rectangle_light(corner, c.e1, c.e2);
    const SceneView& scene = light.scene->view();
    std::mt19937 generator(11);
    Queries q(1024);
    for (double height = 1e-7; height < 0.3; height *= 3)
      for (double s : {0.501, 0.55, 0.6, 0.75, 1.0})
        for (int k = 0; k < 8; ++k) { // beside each edge, at each corner, in bands around them
          double along = (k & 1) ? s : 0.37, across = (k & 1) ? 0.21 : s;
          double sx = (k & 2) ? 1 : -1, sy = (k & 4) ? 1 : -1;
          Double3 p = add(scale(c.e1, along * sx), scale(c.e2, across * sy));
          if (s == 0.55)
            p = add(scale(c.e1, s * sx), scale(c.e2, s * sy));
          p[2] = height;
          p = test::rounded(p);
          q.put_all(p, {0, 0, 1}, 0);
          q.random(generator);
          Samples samples = test::sample_lights(scene, q);
          for (const Double3& n : {Double3{0, 0, -1}, normalize(sub({0, 0, 0}, p))}) {
            std::vector<double> values(q.count);
            for (int i = 0; i < q.count; ++i)
              if (samples.valid[i]) {
                ASSERT_TRUE(std::isfinite(samples.pdf[i]) && samples.pdf[i] > 0);
                values[i] = std::max(0.0, dot(samples.direction[i], n)) / samples.pdf[i];
              }
            test::Estimate e = test::estimate(values);
            double wanted = test::polygon_irradiance(light.polygon, p, n);
            // Sampled by area, what is near is rare and bright: allow for it not being met.
            bool apart = std::abs(p[0]) - 0.5 * c.e1[0] > 0.1 * length(corner) ||
                         std::abs(p[1]) - 0.5 * c.e2[1] > 0.1 * length(corner);
            ASSERT_LE(e.value, wanted + 6 * e.error + 1e-3 * wanted + 1e-7)
                << p[0] << " " << p[1] << " " << p[2];
            if (apart) {
              ASSERT_GE(e.value, wanted - 6 * e.error - 1e-3 * wanted - 1e-7)
                  << p[0] << " " << p[1] << " " << p[2];
            }
          }
        }
  }
}

TEST(LightSampling, Triangle) {
  LoneLight light = test::triangle_light({0, 0, 0}, {2, 0.5, 0}, {0.3, 1.5, 0.2});
  for (const Double3& p : {Double3{0.6, 0.6, 1}, {3, -1, 2}, {-2, 1, 0.5}, {40, 30, 20}})
    check_flat(light, p);
  // Near by, area sampling meets the bright part too seldom to be measured.
  check_flat(light, {0.7, 0.6, 0.2}, false);
  EXPECT_EQ(View(light, {0.6, 0.6, -1}).valid_share(), 0);
}

TEST(LightSampling, SphereFromOutside) {
  for (double radius : {0.5, 20.0}) {
    LoneLight light = test::sphere_light({1, -2, 0.5}, radius, false);
    for (double h : {1.001, 1.05, 1.5, 4.0, 50.0}) {
      SCOPED_TRACE(testing::Message() << "radius " << radius << ", distance " << h);
      Double3 way = normalize({1, 2, -1});
      Double3 p = test::rounded(add({1, -2, 0.5}, scale(way, -h * radius)));
      Double3 to_center = sub({1, -2, 0.5}, p);
      double true_h = length(to_center) / radius;
      View view(light, p);
      view.check_hits();
      if (h > 1.01 && h < 40) // else too small for the cells
        view.check_density(true);
      EXPECT_GE(view.valid_share(), 0.999);
      for (const Double3& n : kNormals) {
        double theta = std::acos(dot(normalize(to_center), n));
        view.check_irradiance(n, test::sphere_irradiance(true_h, theta));
      }
    }
  }
}

// Rays miss a sphere of 1e-5 of its distance by rounding alone; samples of it are right still.
TEST(LightSampling, TinySphere) {
  for (double radius : {1e-3, 1e-4, 1e-5, 1e-7}) {
    LoneLight light = test::sphere_light({0.1, -0.2, 0.05}, radius, false);
    for (double distance : {0.1, 1.0, 30.0}) {
      SCOPED_TRACE(testing::Message() << "radius " << radius << ", distance " << distance);
      Double3 way = normalize({1, 2, -1});
      Double3 p = test::rounded(add({0.1, -0.2, 0.05}, scale(way, -distance)));
      Double3 to_center = sub({0.1, -0.2, 0.05}, p);
      View view(light, p);
      if (radius >= 1e-4 * distance)
        view.check_hits();
      EXPECT_EQ(view.valid_share(), 1);
      double solid_angle = kPi * radius * radius / dot(to_center, to_center);
      view.check_irradiance_within(normalize(to_center), solid_angle, 1e-5);
    }
  }
}

TEST(LightSampling, SphereVeryNearAndInside) {
  LoneLight outward = test::sphere_light({0, 0, 0}, 1, false);
  LoneLight inward = test::sphere_light({0, 0, 0}, 1, true);
  // So near that the area is sampled: what can be seen is a small cap.
  View near(outward, {0, 0, 1 + 4e-6});
  EXPECT_LE(near.valid_share(), 1e-4);
  EXPECT_EQ(View(outward, {0.3, 0.2, 0.5}).valid_share(), 0);
  EXPECT_EQ(View(inward, {0, 0, 2}).valid_share(), 0);
  for (const Double3& p : {Double3{0, 0, 0}, {0.3, 0.2, 0.5}, {0, 0.8, -0.1}}) {
    View view(inward, p);
    view.check_hits();
    view.check_density(true);
    for (const Double3& n : kNormals)
      view.check_irradiance(n, kPi); // a hemisphere full of light
  }
}

TEST(LightSampling, Disk) {
  LoneLight round = test::disk_light({1, 1, 1}, {0.5, 0, 0}, {0, 0.5, 0});
  for (const Double3& p : {Double3{1, 1, 2}, {2, 0.5, 1.6}, {1.2, 1.1, 1.3}, {9, -5, 3}})
    check_flat(round, p);
  EXPECT_EQ(View(round, {1, 1, 0}).valid_share(), 0);
  EXPECT_EQ(View(round, {3, 1, 1}).valid_share(), 0);
  LoneLight ellipse = test::disk_light({0, 0, 0}, {0, 2, 0}, {0.5, 1, 1});
  for (const Double3& p : {Double3{2, 0, 1}, {4, 3, -2}})
    check_flat(ellipse, p);
}

TEST(LightSampling, CylinderFromInside) {
  double r = 0.75, h = 2;
  LoneLight light = test::cylinder_light({0, 0, 0}, {0, 0, h}, r, true);
  for (double a : {0.25, 1.0, 5.0}) { // below the opening, on the axis
    Double3 p{0, 0, -a};
    View view(light, p);
    view.check_hits();
    view.check_density(true);
    auto disk = [&](double d) { return kPi * r * r / (r * r + d * d); };
    view.check_irradiance({0, 0, 1}, disk(a) - disk(a + h));
    view.check_irradiance({0, 0, -1}, 0);
  }
}

TEST(LightSampling, CylinderFromOutside) {
  LoneLight light = test::cylinder_light({-1, 0, 2}, {2, 1, 2.5}, 0.5, false);
  for (const Double3& p : {Double3{0, 0, 0}, {3, -2, 2}, {-20, 5, 9}}) {
    View view(light, p);
    view.check_hits();
    view.check_density(false);
    for (const Double3& n : kNormals) {
      double wanted = 0;
      constexpr int kSide = 512;
      for (int i = 0; i < kSide * kSide; ++i) {
        test::SurfaceElement e =
            light.element((i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide);
        Double3 d = sub(e.position, p);
        double d2 = dot(d, d);
        wanted += std::max(0.0, dot(d, n)) * std::max(0.0, -dot(d, e.normal)) / (d2 * d2) * e.area /
                  (kSide * kSide);
      }
      view.check_irradiance(n, wanted);
    }
  }
}

TEST(LightSampling, Point) {
  Scene scene;
  scene.add_point_light({{1, 2, 3}, {4, 5, 6}, 1});
  scene.build(best_isa());
  Queries q(16);
  q.put_all({1, 0, 3}, {0, 0, 1}, 0);
  Samples s = test::sample_lights(scene.view(), q);
  EXPECT_TRUE(s.valid[0] && s.delta[0]);
  EXPECT_EQ(s.direction[0], (Double3{0, 1, 0}));
  EXPECT_EQ(s.distance[0], 2);
  EXPECT_EQ(s.pdf[0], 1); // of the intensity over the squared distance
  q.put_all({1, 2, 3}, {0, 0, 1}, 0);
  EXPECT_FALSE(test::sample_lights(scene.view(), q).valid[0]);
}
