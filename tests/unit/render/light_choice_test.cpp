#include "light_kernels.h"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

using namespace faceta;
using namespace faceta::double3;
using test::Queries;

namespace {

class Numbers {
public:
  explicit Numbers(int seed) : generator_(seed) {}
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  Double3 point(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  Double3 direction() {
    Double3 d = point(1);
    return length(d) > 1 || length(d) < 0.1 ? direction() : normalize(d);
  }
  std::mt19937& generator() { return generator_; }

private:
  std::mt19937 generator_;
};

/// Lights of every kind and of powers over six decades in a cube of side 10; one is never chosen.
void fill(Scene& scene, int rounds, Numbers& numbers) {
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(Registry::global().get("diffuse"));
  ShapeDesc shape;
  shape.material = scene.add_material(node);
  for (int i = 0; i < rounds; ++i) {
    auto shine = [&] {
      shape.emitter = std::make_shared<AreaEmitter>();
      double radiance = std::exp(numbers.in(-7, 7));
      shape.emitter->radiance.value = {radiance, radiance, radiance};
      shape.emitter->sampling_weight = i == 0 ? 0 : 1;
    };
    auto placed = [&] {
      Double3 n = numbers.direction(), c = numbers.point(5);
      Basis b = orthonormal_basis(n);
      double s = numbers.in(0.02, 1.5), t = numbers.in(0.02, 1.5);
      ToWorld m = kIdentityToWorld;
      for (int k = 0; k < 3; ++k) {
        m[4 * k] = s * b.s[k];
        m[4 * k + 1] = t * b.t[k];
        m[4 * k + 2] = n[k];
        m[4 * k + 3] = c[k];
      }
      return m;
    };
    shine();
    Mesh rectangle = make_rectangle();
    place(rectangle, placed());
    scene.add_mesh(rectangle, shape, i % 2); // half of them as two triangles
    shine();
    scene.add_sphere(make_sphere(numbers.point(5), numbers.in(0.05, 0.5), false, kIdentityToWorld),
                     shape);
    shine();
    scene.add_disk(make_disk(false, placed()), shape);
    shine();
    Double3 p = numbers.point(5);
    scene.add_cylinder(make_cylinder(p, add(p, numbers.direction()), 0.1, false, kIdentityToWorld),
                       shape);
    scene.add_point_light({numbers.point(5), {1, 1, 1}, 1});
  }
  scene.build(best_isa());
}

std::vector<double> probabilities(const SceneView& scene, const Queries& q) {
  std::vector<float> p(q.count), first;
  for (const light_module::LightTable* table : test::light_tables()) {
    table->probability(scene, q.view(), p.data(), q.count);
    if (first.empty())
      first = p;
    EXPECT_EQ(std::memcmp(first.data(), p.data(), 4 * p.size()), 0) << table->width;
  }
  return {first.begin(), first.end()};
}

struct Choices {
  std::vector<int32_t> light;
  std::vector<float> probability;
};
Choices choose(const SceneView& scene, const Queries& q) {
  Choices c{std::vector<int32_t>(q.count), std::vector<float>(q.count)}, first;
  for (const light_module::LightTable* table : test::light_tables()) {
    table->choose(scene, q.view(), c.light.data(), c.probability.data(), q.count);
    if (first.light.empty())
      first = c;
    EXPECT_TRUE(first.light == c.light && first.probability == c.probability) << table->width;
  }
  return first;
}

/// Queries for every light from one point; the rest repeats the last.
Queries all_lights(const SceneView& scene, const Double3& p, const Double3& n) {
  Queries q((scene.light_count + 15) / 16 * 16);
  q.put_all(p, n, scene.light_count - 1);
  for (int i = 0; i < scene.light_count; ++i)
    q.light[i] = i;
  return q;
}

class LightChoices : public testing::Test {
protected:
  LightChoices() { fill(scene_, 12, numbers_); }
  Numbers numbers_{1};
  Scene scene_;
};

} // namespace

TEST_F(LightChoices, ProbabilitiesSumToOne) {
  const SceneView& scene = scene_.view();
  for (int i = 0; i < 300; ++i) {
    Double3 p = numbers_.point(i % 3 ? 5 : 50), n = numbers_.direction();
    Queries q = all_lights(scene, p, n);
    std::vector<double> probability = probabilities(scene, q);
    double sum = 0;
    for (int k = 0; k < scene.light_count; ++k) {
      if (scene.lights[k].depth >= 0)
        sum += probability[k];
      ASSERT_GE(probability[k], 0);
    }
    // Choices may end above lights that all face away, never where point lights shine.
    ASSERT_LE(sum, 1 + 1e-5);
    ASSERT_GE(sum, 0.5);
    // What shines here can be chosen.
    q.random(numbers_.generator());
    test::Samples s = test::sample_lights(scene, q);
    for (int k = 0; k < scene.light_count; ++k)
      if (s.valid[k] && scene.lights[k].depth >= 0) {
        ASSERT_GT(probability[k], 0) << "light " << k << " of type " << scene.lights[k].type;
      }
  }
}

TEST_F(LightChoices, AreMadeWithTheirProbabilities) {
  const SceneView& scene = scene_.view();
  for (int i = 0; i < 20; ++i) {
    Double3 p = numbers_.point(i % 4 ? 5 : 30), n = numbers_.direction();
    std::vector<double> probability = probabilities(scene, all_lights(scene, p, n));
    Queries q(16384);
    q.put_all(p, n, 0);
    q.random(numbers_.generator());
    Choices c = choose(scene, q);
    std::vector<double> expected(scene.light_count + 1), observed(scene.light_count + 1);
    double rest = 1;
    for (int k = 0; k < scene.light_count; ++k)
      if (scene.lights[k].depth >= 0) {
        expected[k] = probability[k] * q.count;
        rest -= probability[k];
      }
    expected.back() = std::max(0.0, rest) * q.count;
    for (int k = 0; k < q.count; ++k) {
      if (c.probability[k] > 0) {
        ASSERT_NEAR(c.probability[k], probability[c.light[k]], 1e-5 * c.probability[k]);
        observed[c.light[k]] += 1;
      } else {
        observed.back() += 1;
      }
    }
    EXPECT_LT(test::chi_square_score(expected, observed), 4.5) << "point " << i;
  }
}

TEST(LightChoice, OneLightIsCertain) {
  for (const test::LoneLight& light : {test::sphere_light({0, 0, 3}, 1, false),
                                       test::rectangle_light({0, 0, 0}, {1, 0, 0}, {0, 1, 0})}) {
    Queries q(16);
    q.put_all({0.2, 0.3, 1}, {0, 0, 1}, 0);
    Choices c = choose(light.scene->view(), q);
    EXPECT_EQ(c.light[0], 0);
    EXPECT_EQ(c.probability[0], 1);
    EXPECT_EQ(probabilities(light.scene->view(), q)[0], 1);
  }
}

TEST(LightChoice, NoneWhereAllFaceAway) {
  Scene scene;
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(Registry::global().get("diffuse"));
  ShapeDesc shape;
  shape.material = scene.add_material(node);
  shape.emitter = std::make_shared<AreaEmitter>();
  shape.emitter->radiance.value = {1, 1, 1};
  for (double x : {-3.0, 3.0}) {
    Mesh mesh = make_rectangle();
    place(mesh, {1, 0, 0, x, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    scene.add_mesh(mesh, shape, true);
  }
  scene.build(best_isa());
  Queries q(16);
  q.put_all({0, 0, -5}, {0, 0, 1}, 0);
  EXPECT_EQ(choose(scene.view(), q).probability[0], 0);
  EXPECT_EQ(probabilities(scene.view(), q)[0], 0);
  q.put_all({0, 0, 5}, {0, 0, -1}, 0);
  EXPECT_FLOAT_EQ(choose(scene.view(), q).probability[0], 0.5f);
}
