#pragma once

/// The kernels' sampling of lights for tests: the modules of light_module/, scenes of one light,
/// and what a light sends to a point by formulas of others.

#include "light_module/light_table.h"
#include "scene/scene.h"

#include <array>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace test {

using faceta::Double3;

/// The modules that this processor can run, the scalar one first.
const std::vector<const faceta::light_module::LightTable*>& light_tables();

/// Arrays of queries; the number is a multiple of 16.
struct Queries {
  explicit Queries(int n);
  void put_point(int i, const Double3& point, const Double3& n);
  void put_all(const Double3& point, const Double3& n, int light);
  /// Fills u, and the normals too if they serve as random numbers.
  void random(std::mt19937& generator, bool normals = false);
  faceta::light_module::LightQueries view() const;

  int count;
  std::array<std::vector<float>, 3> p, normal;
  std::vector<float> u[2], choice;
  std::vector<int32_t> light;
};

/// One array of floats for each answer of sample().
struct Samples {
  std::vector<Double3> offset, direction;
  std::vector<double> distance, pdf;
  std::vector<int32_t> valid, delta;
};
/// By the scalar module; others must give the same bits.
Samples sample_lights(const faceta::SceneView& scene, const Queries& q);
std::vector<double> light_pdfs(const faceta::SceneView& scene, const Queries& q,
                               const std::vector<Double3>& offsets);

/// A light of radiance 1 in a scene of its own, and its surface by a map of the unit square:
/// position, unit normal of the emitting side, area per area of the square.
struct SurfaceElement {
  Double3 position, normal;
  double area;
};
struct LoneLight {
  std::string name;
  std::shared_ptr<faceta::Scene> scene;
  std::function<SurfaceElement(double s, double t)> element; ///< null: a point
  std::function<std::array<double, 2>(const Double3&)> square;
  std::vector<Double3> polygon; ///< flat lights: their edge, counter-clockwise seen from the front
};
LoneLight rectangle_light(const Double3& corner, const Double3& e1, const Double3& e2);
LoneLight triangle_light(const Double3& a, const Double3& b, const Double3& c);
LoneLight sphere_light(const Double3& center, double radius, bool inward);
/// The disk of the map (x, y, 0) -> center + x a + y b; front: along a x b.
LoneLight disk_light(const Double3& center, const Double3& a, const Double3& b);
LoneLight cylinder_light(const Double3& p0, const Double3& p1, double radius, bool inward);

/// Irradiance from a flat light of radiance 1 (Lambert 1760), cut off at the receiver's horizon.
double polygon_irradiance(std::vector<Double3> polygon, const Double3& p, const Double3& n);
/// Irradiance from an opaque sphere of radius 1 and radiance 1 at distance h > 1, theta between the
/// receiver's normal and the centre (Hamilton and Morgan, NACA TN 2836, 1952).
double sphere_irradiance(double h, double theta);

/// Rounded to what the kernels can hold.
Double3 rounded(const Double3& v);

/// How many standard deviations a chi-square statistic of counts lies above its mean (Wilson and
/// Hilferty 1931); cells that expect fewer than 5 are pooled.
double chi_square_score(const std::vector<double>& expected, const std::vector<double>& observed);

/// Mean, and the standard error of the mean.
struct Estimate {
  double value = 0, error = 0;
};
Estimate estimate(const std::vector<double>& values);

} // namespace test
