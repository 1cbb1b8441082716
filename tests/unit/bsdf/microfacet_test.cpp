#include "bsdf/microfacet.h"

#include <gtest/gtest.h>
#include <random>

namespace faceta {
namespace {

using Direction = Vec3<double>;

Direction direction(double cosine, double azimuth) {
  double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

struct Surface {
  int distribution;
  double alpha_u, alpha_v;
  template <class T = double> Microfacet<T> make(MicrofacetOptions o = {}) const {
    o.distribution = distribution;
    return {o, T(alpha_u), T(alpha_v)};
  }
};
const Surface kSurfaces[] = {
    {kBeckmann, 0.001, 0.001}, {kBeckmann, 0.1, 0.1}, {kBeckmann, 0.05, 0.3}, {kBeckmann, 1, 1},
    {kGgx, 0.001, 0.001},      {kGgx, 0.1, 0.1},      {kGgx, 0.05, 0.3},      {kGgx, 1, 1}};
const Direction kViews[] = {direction(1, 0), direction(0.8, 0.7), direction(0.3, 2.5),
                            direction(0.05, -1), direction(0.002, 1.4)};

/// The integral over all normals of g(m) D(m) dm, in slopes with the roughness taken out: a grid in
/// the radius (compactified) and the angle.
template <class G> double over_normals(const Microfacet<double>& s, G g) {
  int rings = 300, sectors = 120;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    double t = (i + 0.5) / rings, radius = t / (1 - t), d_radius = 1 / sqr(1 - t) / rings;
    for (int j = 0; j < sectors; ++j) {
      double phi = 2 * kPi * (j + 0.5) / sectors;
      Direction m{s.alpha_u * radius * std::cos(phi), s.alpha_v * radius * std::sin(phi), 1};
      double length2 = dot(m, m);
      // dm = dslope cos^3.
      double solid_angle = s.alpha_u * s.alpha_v * radius * d_radius * (2 * kPi / sectors) /
                           (length2 * std::sqrt(length2));
      sum += g(normalize(m)) * s.density(m) * solid_angle;
    }
  }
  return sum;
}

TEST(Microfacet, NormalsProjectToOne) {
  for (const Surface& surface : kSurfaces)
    EXPECT_NEAR(over_normals(surface.make(), [](const Direction& m) { return m.z; }), 1, 2e-3);
}

TEST(Microfacet, DensityIgnoresLength) {
  for (const Surface& surface : kSurfaces)
    for (double scale : {0.01, 3.0}) {
      Direction m{0.1 * surface.alpha_u, 0.7 * surface.alpha_v, 1};
      EXPECT_NEAR(surface.make().density(m * scale) / surface.make().density(m), 1, 1e-12);
    }
}

TEST(Microfacet, BeckmannIsTheCoursesFormula) {
  double alpha = 0.3;
  Microfacet<double> s = Surface{kBeckmann, alpha, alpha}.make();
  for (double c : {1.0, 0.95, 0.7, 0.3}) {
    double tan2 = (1 - c * c) / (c * c);
    double expected = std::exp(-tan2 / (alpha * alpha)) / (kPi * alpha * alpha * c * c * c * c);
    EXPECT_NEAR(s.density(direction(c, 0.3)) / expected, 1, 1e-10);
    if (c == 1)
      continue;
    double a = 1 / (alpha * std::sqrt(tan2));
    double g = a < 1.6 ? (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a) : 1;
    EXPECT_NEAR(s.masking(direction(c, 0.3)), g, 1e-12);
  }
}

// The projected area of the visible normals is known in closed form; the masked area must be cos.
TEST(Microfacet, ProjectedArea) {
  for (const Surface& surface : kSurfaces) {
    Microfacet<double> s = surface.make();
    for (const Direction& w : kViews) {
      double area = over_normals(s, [&](const Direction& m) { return max(dot(w, m), 0.0); });
      EXPECT_NEAR(s.projected_area(w) / area, 1, 3e-3) << surface.alpha_u << " " << w.z;
      EXPECT_NEAR(surface.make<float>().projected_area({float(w.x), float(w.y), float(w.z)}) /
                      s.projected_area(w),
                  1, 2e-6);
      // The rational fit of Beckmann's masking is off by at most 0.35 %.
      EXPECT_NEAR(s.masking(w) * s.projected_area(w) / w.z, 1, 3.6e-3);
    }
  }
}

// Heitz 2014, "Understanding the Masking-Shadowing Function": with masking only, all light of a
// white surface goes somewhere: the integral of D G1(wo) / (4 cos theta_o) over all wi is 1 (wi may
// point down). Over a grid of directions, with the exact masking.
TEST(Microfacet, WeakWhiteFurnace) {
  const Surface rough[] = {
      {kBeckmann, 0.3, 0.3}, {kBeckmann, 0.4, 0.9}, {kGgx, 0.3, 0.6}, {kGgx, 0.6, 0.6}};
  for (const Surface& surface : rough)
    for (double cosine : {0.95, 0.5, 0.1}) {
      Microfacet<double> s = surface.make();
      Direction wo = direction(cosine, 0.7);
      double masking = wo.z / s.projected_area(wo), sum = 0;
      int n = 300;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
          double theta = kPi * (i + 0.5) / n;
          Direction m = wo + direction(std::cos(theta), kPi * (j + 0.5) / n);
          if (m.z > 0)
            sum += s.density(m) * masking / (4 * wo.z) * std::sin(theta) * sqr(kPi / n);
        }
      // GGX ends abruptly at m.z = 0, across the cells.
      EXPECT_NEAR(sum, 1, 4e-3) << surface.distribution << " " << surface.alpha_v << " " << cosine;
    }
}

/// Distribution function of Beckmann's visible slope along the view, by the definition: the
/// normalised integral of (a + x) exp(-x^2) from -a on.
double slope_distribution(double a, double x) {
  auto antiderivative = [&](double t) {
    return 0.5 * a * std::sqrt(kPi) * std::erf(t) - 0.5 * std::exp(-t * t);
  };
  double low = antiderivative(-a);
  return (antiderivative(x) - low) / (0.5 * a * std::sqrt(kPi) - low);
}

template <class T> std::vector<Vec2<double>> visible_slopes(double a, int count, bool three) {
  std::mt19937_64 engine(three ? 7 : 8);
  std::uniform_real_distribution<double> uniform;
  double r = 1 / std::sqrt(1 + a * a);
  std::vector<Vec2<double>> slopes;
  for (int i = 0; i < count; ++i) {
    // 24 bits, below 1 in float as well.
    T u = T(std::floor(uniform(engine) * 0x1p24) * 0x1p-24);
    T v = T(std::floor(uniform(engine) * 0x1p24) * 0x1p-24);
    BeckmannSlopes<T> magnitude(T(a * r), T(r * r), u);
    Vec2<T> s = three ? magnitude.draw(v, T(std::floor(uniform(engine) * 0x1p24) * 0x1p-24))
                      : magnitude.draw(v);
    slopes.push_back({double(s.x), double(s.y)});
  }
  return slopes;
}

/// Kolmogorov and Smirnov's statistic of values in [0, 1] that should be uniform, times sqrt(n).
double kolmogorov(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  double n = double(values.size()), largest = 0;
  for (size_t i = 0; i < values.size(); ++i)
    largest = std::max({largest, std::abs(values[i] - i / n), std::abs(values[i] - (i + 1) / n)});
  return largest * std::sqrt(n);
}

TEST(Microfacet, BeckmannVisibleSlopesHaveTheirDistribution) {
  int count = 40000;
  for (double a : {1e-3, 0.05, 0.4, 1.0, 2.0, 5.0, 1000.0})
    for (int rule = 0; rule < 4; ++rule) {
      bool single = rule % 2, three = rule / 2;
      auto slopes =
          single ? visible_slopes<float>(a, count, three) : visible_slopes<double>(a, count, three);
      std::vector<double> along, across, product;
      double correlation = 0;
      for (auto& s : slopes) {
        ASSERT_TRUE(std::isfinite(s.x) && std::isfinite(s.y));
        along.push_back(slope_distribution(a, s.x));
        across.push_back(0.5 + 0.5 * std::erf(s.y));
        correlation += (along.back() - 0.5) * (across.back() - 0.5) * 12 / count;
      }
      // 2.23: exceeded by chance once in 10^4.
      EXPECT_LT(kolmogorov(along), 2.23) << a << " " << single;
      EXPECT_LT(kolmogorov(across), 2.23) << a << " " << single;
      // Independent: the correlation's deviation is 1 / sqrt(count).
      EXPECT_LT(std::abs(correlation), 4 / std::sqrt(double(count))) << a << " " << single;
    }
}

TEST(Microfacet, BeckmannSlopeInverts) {
  for (double a : {0.01, 0.3, 1.0, 3.0, 100.0})
    for (double u : {1e-4, 0.1, 0.5, 0.9, 0.9999})
      EXPECT_NEAR(slope_distribution(a, beckmann_visible_slope(a, u)), u, 1e-9) << a << " " << u;
}

/// chi^2 of the sampled normals' stretched azimuth and radius against the density, by cells.
TEST(Microfacet, VisibleNormalsHaveTheirDensity) {
  for (const Surface& surface : kSurfaces)
    for (double cosine : {0.9, 0.3, 0.05}) {
      Microfacet<double> s = surface.make();
      Direction wo = direction(cosine, 0.6);
      const int rings = 8, sectors = 8, count = 30000, fine = 16;
      std::vector<double> seen(rings * sectors), expected(rings * sectors);
      // Cells in t = radius / (1 + radius) and phi of the stretched slope.
      for (int i = 0; i < rings * fine; ++i)
        for (int j = 0; j < sectors * fine; ++j) {
          double t = (i + 0.5) / (rings * fine), radius = t / (1 - t);
          double phi = 2 * kPi * (j + 0.5) / (sectors * fine);
          Direction m{s.alpha_u * radius * std::cos(phi), s.alpha_v * radius * std::sin(phi), 1};
          double cos_m = 1 / length(m);
          double area = radius / sqr(1 - t) / (rings * fine) * 2 * kPi / (sectors * fine);
          expected[i / fine * sectors + j / fine] +=
              count * s.pdf_visible(wo, m) * s.alpha_u * s.alpha_v * cos_m * cos_m * cos_m * area;
        }
      std::mt19937_64 engine(3);
      std::uniform_real_distribution<double> uniform;
      for (int k = 0; k < count; ++k) {
        double u = uniform(engine), v = uniform(engine);
        Direction m = s.sample_visible(wo, {u, v});
        double x = m.x / (m.z * s.alpha_u), y = m.y / (m.z * s.alpha_v);
        double radius = std::hypot(x, y), phi = std::atan2(y, x);
        int i = std::min(int(radius / (1 + radius) * rings), rings - 1);
        int j = std::min(int((phi < 0 ? phi + 2 * kPi : phi) / (2 * kPi) * sectors), sectors - 1);
        ++seen[i * sectors + j];
      }
      double chi2 = 0, cells = 0;
      for (size_t i = 0; i < seen.size(); ++i)
        if (expected[i] > 10) {
          chi2 += sqr(seen[i] - expected[i]) / expected[i];
          ++cells;
        }
      EXPECT_LT((chi2 - cells) / std::sqrt(2 * cells), 5)
          << surface.distribution << " " << surface.alpha_u << " " << cosine;
    }
}

TEST(Microfacet, BoundedCapsReflectMoreOften) {
  Surface surface{kGgx, 0.5, 0.5};
  Direction wo = direction(0.9, 0.3);
  auto failures = [&](int bounded) {
    Microfacet<double> s = surface.make({.bounded = bounded});
    int n = 200, below = 0;
    for (int i = 0; i < n * n; ++i)
      below += s.sample_reflection(wo, {(i / n + 0.5) / n, (i % n + 0.5) / n}).z <= 0;
    return below / double(n * n);
  };
  EXPECT_LT(failures(1), 0.5 * failures(0));
  // Eto and Tokuyoshi: the density grows by at most 1.25 at alpha = 0.5, at normal incidence.
  Direction normal{0, 0, 1}, wi = direction(0.8, 0);
  double ratio = surface.make().reflection(normal, wi).pdf /
                 surface.make({.bounded = 0}).reflection(normal, wi).pdf;
  EXPECT_NEAR(ratio, 1.25, 1e-12);
}

TEST(Microfacet, ReflectionIsItsFactors) {
  for (const Surface& surface : kSurfaces)
    for (int correlated : {0, 1}) {
      Microfacet<double> s = surface.make({.height_correlated = correlated, .bounded = 0});
      Direction wo = direction(0.7, 0.2), wi = direction(0.65, 3.3);
      Direction h = normalize(wo + wi);
      MicrofacetReflection<double> r = s.reflection(wo, wi);
      double g = s.masking_shadowing(wo, wi);
      EXPECT_NEAR(r.value, s.density(h) * g / (4 * wo.z), 1e-9 * r.value);
      EXPECT_NEAR(r.pdf, s.pdf_visible(wo, h) / (4 * dot(wo, h)), 1e-9 * r.pdf);
      EXPECT_NEAR(r.cos_h(), dot(wo, h), 1e-12);
      double lo = s.projected_area(wo) / wo.z - 1, li = s.projected_area(wi) / wi.z - 1;
      if (correlated)
        EXPECT_NEAR(g, 1 / (1 + lo + li), 1e-12);
      else
        EXPECT_NEAR(g, s.masking(wo) * s.masking(wi), 1e-12);
      EXPECT_EQ(s.reflection(wo, direction(-0.5, 1)).value, 0);
      EXPECT_EQ(s.reflection(direction(-0.5, 1), wi).pdf, 0);
    }
}

// Smooth, grazing, in single precision: where tan^2 and cos^4 computed from rounded cosines fail.
TEST(Microfacet, AlmostSmoothSurfacesStayFinite) {
  for (int distribution : {kBeckmann, kGgx})
    for (float alpha : {1e-4f, 0.001f, 0.01f})
      for (double cosine : {1.0, 0.5, 0.01, 1e-4, 1e-6}) {
        Microfacet<float> s({.distribution = distribution}, alpha, alpha);
        Direction d = direction(cosine, 0.9);
        Vec3<float> wo{float(d.x), float(d.y), float(d.z)};
        for (int i = 0; i < 1024; ++i) {
          Vec2<float> u{(i / 32) / 32.f, (i % 32) / 32.f};
          Vec3<float> wi = s.sample_reflection(wo, u);
          ASSERT_TRUE(is_finite(wi.x) && is_finite(wi.y) && is_finite(wi.z)) << alpha << cosine;
          EXPECT_NEAR(dot(wi, wi), 1, 2e-6);
          MicrofacetReflection<float> r = s.reflection(wo, wi);
          ASSERT_TRUE(is_finite(r.value) && is_finite(r.pdf)) << alpha << " " << cosine;
          if (wi.z > 0) {
            EXPECT_GT(r.pdf, 0) << alpha << " " << cosine << " " << u.x << " " << u.y;
            EXPECT_LT(r.value / r.pdf, 1.01f); // the weight is a masking term, never a firefly
          }
        }
      }
}

TEST(Microfacet, RoughnessIsClamped) {
  Microfacet<double> s({}, 0, 1e-6);
  EXPECT_EQ(s.alpha_u, 1e-4);
  EXPECT_EQ(s.alpha_v, 1e-4);
}

// A view so near the normal that the stretched direction has no azimuth left in float.
TEST(BeckmannSlopes, SeenFromAlmostStraightAboveTheyKeepTheirSpread) {
  const float alpha = 1e-4f;
  Microfacet<float> surface({.distribution = kBeckmann}, alpha, alpha);
  for (float x : {0.0f, 1e-12f, 1e-9f, 1e-7f, 1e-5f}) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> uniform;
    auto number = [&] { return float(std::floor(uniform(engine) * 0x1p24) * 0x1p-24); };
    double along = 0, across = 0;
    const int kCount = 40000;
    for (int i = 0; i < kCount; ++i) {
      Vec2<float> u{number(), number()};
      Vec3<float> m = surface.sample_visible({x, 0, 1}, u);
      along += std::pow(m.x / alpha, 2) / kCount;
      across += std::pow(m.y / alpha, 2) / kCount;
    }
    // Variance 1/2, that of its estimate 1/2 / kCount.
    EXPECT_NEAR(along, 0.5, 4 * std::sqrt(0.5 / kCount)) << x;
    EXPECT_NEAR(across, 0.5, 4 * std::sqrt(0.5 / kCount)) << x;
  }
}

} // namespace
} // namespace faceta
