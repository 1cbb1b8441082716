#include "bsdf/fresnel.h"
#include "bsdf/registry.h"
#include "materials/builtin.h"
#include "materials/roughconductor.h"

#include <gtest/gtest.h>
#include <random>

namespace faceta {
namespace {

using Direction = Vec3<double>;

Direction direction(double cosine, double azimuth = 0.4) {
  double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

/// A model by name with "key=value;key=value", in double.
struct Material {
  const Model* model;
  Record record;

  Material(const std::string& name, const std::string& settings) : model(find(name)) {
    Parameters p(*model);
    for (size_t begin = 0; begin < settings.size();) {
      size_t end = std::min(settings.find(';', begin), settings.size());
      std::string entry = settings.substr(begin, end - begin);
      size_t equals = entry.find('=');
      p.set(entry.substr(0, equals), entry.substr(equals + 1));
      begin = end + 1;
    }
    p.check();
    record = p.record();
  }
  static const Model* find(const std::string& name) {
    static const std::vector<Model> models = builtin_models();
    for (const Model& m : models)
      if (m.descriptor.name == name)
        return &m;
    throw Error("no model " + name);
  }
  Eval<double> eval(const Direction& wo, const Direction& wi,
                    TransportMode mode = TransportMode::radiance) const {
    return model->eval(record, {wo, wi, mode, {0.5, 0.5}});
  }
  Sample<double> sample(const Direction& wo, double uc, double u = 0.3, double v = 0.6,
                        TransportMode mode = TransportMode::radiance) const {
    return model->sample(record, wo, {{u, v}, uc}, mode, {0.5, 0.5});
  }
  /// Mean weight over n^3 strata of the three numbers, one jittered sample each.
  Color<double> mean_weight(const Direction& wo, int n, int choices,
                            TransportMode mode = TransportMode::radiance) const {
    Color<double> sum;
    std::mt19937_64 engine(5);
    std::uniform_real_distribution<double> jitter;
    for (int i = 0; i < n * n * choices; ++i) {
      double u = (i % n + jitter(engine)) / n, v = (i / n % n + jitter(engine)) / n;
      sum += sample(wo, (i / n / n + jitter(engine)) / choices, u, v, mode).weight;
    }
    return sum * (1.0 / (double(n) * n * choices));
  }
};

struct Row {
  const char *model, *settings;
  int importance;
  double wo[3], wi[3], value[3];
};
const Row kRows[] = {
#include "mitsuba_metals_glass.inc"
};

TEST(MetalsGlass, ValuesAreMitsubas) {
  for (const Row& row : kRows) {
    Material m(row.model, row.settings);
    Direction wo{row.wo[0], row.wo[1], row.wo[2]}, wi{row.wi[0], row.wi[1], row.wi[2]};
    TransportMode mode = row.importance ? TransportMode::importance : TransportMode::radiance;
    Color<double> value = m.eval(wo, wi, mode).value;
    // Theirs are single precision: allow what one ulp of a component does to ours.
    Color<double> tolerance = value * 1e-4;
    for (int k = 0; k < 6; ++k) {
      Direction o = wo, i = wi;
      double* component = k < 3 ? &(&o.x)[k] : &(&i.x)[k - 3];
      *component *= 1 + 0x1p-23;
      Color<double> moved = m.eval(o, i, mode).value;
      for (int c = 0; c < 3; ++c)
        tolerance[c] += 2 * std::abs(moved[c] - value[c]);
    }
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(value[c], row.value[c], tolerance[c])
          << row.model << " " << row.settings << " wo " << wo.z << " wi " << wi.z;
  }
}

TEST(MetalsGlass, MeanWeightsOfRoughGlassAreMitsubas) {
  struct Mean {
    const char* settings;
    double cosine, radiance, importance;
  };
  // mitsuba 3.9.1: mean weight of BSDF.sample over 60 000 random triples; deviation <= 0.003.
  const Mean means[] = {
      {"alpha=0.3", 0.8, 0.46707, 0.99800},
      {"alpha=0.3", -0.8, 1.72726, 0.98105},
      {"alpha=0.3", 0.2, 0.51298, 0.94868},
      {"alpha=0.3;distribution=ggx;int_ior=1;ext_ior=1.5", 0.8, 1.54366, 0.85002},
      {"alpha=0.3;distribution=ggx;int_ior=1;ext_ior=1.5", -0.8, 0.45634, 0.97923},
      {"alpha=0.3;distribution=ggx;int_ior=1;ext_ior=1.5", 0.2, 0.79066, 0.74040}};
  for (const Mean& mean : means)
    for (const char* rule : {"", ";sample_visible=false"}) {
      Material m("roughdielectric", std::string(mean.settings) + rule);
      Direction wo = direction(mean.cosine, 0);
      double radiance = m.mean_weight(wo, 32, 16)[0];
      double importance = m.mean_weight(wo, 32, 16, TransportMode::importance)[0];
      EXPECT_NEAR(radiance, mean.radiance, 0.011) << mean.settings << rule << mean.cosine;
      EXPECT_NEAR(importance, mean.importance, 0.006) << mean.settings << rule << mean.cosine;
    }
}

// --- Smooth metal ---

TEST(Conductor, ReflectsLikeItsFresnel) {
  Material m("conductor", "material=gold;specular_reflectance=1,0.5,0.25");
  Direction wo = direction(0.7);
  Sample<double> s = m.sample(wo, 0.9);
  EXPECT_TRUE(s.valid && s.delta);
  EXPECT_EQ(s.lobe, int(kReflection));
  EXPECT_EQ(s.pdf, 1);
  EXPECT_EQ(s.eta, 1);
  EXPECT_EQ(s.wi.x, -wo.x);
  EXPECT_EQ(s.wi.y, -wo.y);
  EXPECT_EQ(s.wi.z, wo.z);
  // The course's gold.
  const double eta[] = {0.143245, 0.377423, 1.43919}, k[] = {3.98479, 2.3847, 1.60434};
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(s.weight[c], fresnel_conductor(0.7, eta[c], k[c]) / (1 << c), 1e-6);
  EXPECT_EQ(m.eval(wo, s.wi).value[0], 0); // a delta
  EXPECT_EQ(m.eval(wo, s.wi).pdf, 0);
  EXPECT_FALSE(m.sample(direction(-0.7), 0.9).valid);
  EXPECT_EQ(m.sample(direction(-0.7), 0.9).weight[0], 0);
  // mitsuba 3.9.1, conductor Au, cos theta = 0.8: (0.966069, 0.801277, 0.329045).
  Color<double> au = Material("conductor", "material=Au").sample(direction(0.8), 0).weight;
  EXPECT_NEAR(au[0], 0.966069, 1e-5);
  EXPECT_NEAR(au[1], 0.801277, 1e-5);
  EXPECT_NEAR(au[2], 0.329045, 1e-5);
}

TEST(Conductor, DefaultIsThePerfectMirror) {
  for (double c : {1.0, 0.5, 1e-3})
    EXPECT_EQ(Material("conductor", "").sample(direction(c), 0).weight[1], 1);
}

// --- Smooth glass ---

TEST(Dielectric, FollowsSnellAndChoosesByFresnel) {
  Material m("dielectric", "int_ior=1.5;ext_ior=1;specular_reflectance=0.9,0.5,0.2;"
                           "specular_transmittance=0.3,0.6,0.8");
  for (double cosine : {0.8, 0.2, -0.9, -0.8})
    for (TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
      Direction wo = direction(cosine);
      double eta = cosine > 0 ? 1.5 : 1 / 1.5, f = fresnel_dielectric(cosine, 1.5).reflectance;
      Sample<double> r = m.sample(wo, f - 1e-6, 0.3, 0.6, mode);
      EXPECT_EQ(r.lobe, int(kReflection));
      EXPECT_NEAR(r.pdf, f, 1e-7);
      EXPECT_EQ(r.eta, 1);
      EXPECT_NEAR(r.weight[1], 0.5, 1e-7);
      EXPECT_EQ(r.wi.z, wo.z);
      Sample<double> t = m.sample(wo, f + 1e-6, 0.3, 0.6, mode);
      EXPECT_EQ(t.lobe, int(kTransmission));
      EXPECT_NEAR(t.pdf, 1 - f, 1e-7);
      EXPECT_NEAR(t.eta, eta, 1e-6);
      EXPECT_NEAR(length(t.wi), 1, 1e-12);
      EXPECT_NEAR(std::hypot(t.wi.x, t.wi.y) * eta, std::hypot(wo.x, wo.y), 1e-6);
      // Radiance is compressed by the squared ratio, importance is not.
      double scale = mode == TransportMode::radiance ? 1 / (eta * eta) : 1;
      EXPECT_NEAR(t.weight[2], 0.8 * scale, 1e-6);
    }
}

TEST(Dielectric, ReflectsAllBeyondTheCriticalAngle) {
  Material m("dielectric", "int_ior=1.5;ext_ior=1");
  for (double uc : {0.0, 0.5, double(kOneMinusEpsilon)}) {
    Sample<double> s = m.sample(direction(-0.5), uc);
    EXPECT_EQ(s.lobe, int(kReflection));
    EXPECT_EQ(s.pdf, 1);
    EXPECT_EQ(s.weight[0], 1);
  }
}

// Light through a pane of glass, in and out again: the eta^2 factors cancel.
TEST(Dielectric, RadianceReturnsToItsScale) {
  Material m("dielectric", "int_ior=1.5;ext_ior=1");
  Sample<double> in = m.sample(direction(0.6), 0.9);
  // The other face looks down: its frame has z and the inside turned over.
  Sample<double> out = m.sample({-in.wi.x, -in.wi.y, in.wi.z}, 0.9);
  EXPECT_NEAR(in.weight[0], 1 / 2.25, 1e-6);
  EXPECT_NEAR(in.weight[0] * out.weight[0], 1, 1e-6);
  Direction onward{-direction(0.6).x, -direction(0.6).y, 0.6};
  EXPECT_NEAR(dot(out.wi, onward), 1, 1e-9);
}

TEST(ThinDielectric, SumsAllOrders) {
  Material m("thindielectric", "int_ior=1.5;ext_ior=1");
  for (double cosine : {1.0, 0.4, -0.4}) {
    Direction wo = direction(cosine);
    double r = fresnel_dielectric(std::abs(cosine), 1.5).reflectance, sum = r,
           pass = (1 - r) * (1 - r);
    for (int bounce = 0; bounce < 40; ++bounce) { // R + T R T + T R^3 T + ...
      sum += pass * r;
      pass *= r * r;
    }
    Sample<double> s = m.sample(wo, 0);
    EXPECT_NEAR(s.pdf, sum, 1e-7);
    EXPECT_EQ(s.wi.z, wo.z);
    Sample<double> t = m.sample(wo, 0.99);
    EXPECT_EQ(t.lobe, int(kNullLobe));
    EXPECT_NEAR(t.pdf, 1 - sum, 1e-7);
    EXPECT_EQ(t.wi.x, -wo.x);
    EXPECT_EQ(t.wi.z, -wo.z);
    EXPECT_EQ(t.weight[0], 1);
    EXPECT_EQ(t.eta, 1);
  }
}

// --- Rough ---

TEST(RoughConductor, TendsToTheMirror) {
  Material rough("roughconductor", "material=gold;alpha=0.001");
  Material smooth("conductor", "material=gold");
  for (double cosine : {0.95, 0.5, 0.2}) {
    Direction wo = direction(cosine);
    Color<double> a = rough.mean_weight(wo, 48, 1), b = smooth.sample(wo, 0).weight;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(a[c], b[c], 2e-3) << cosine;
    Sample<double> s = rough.sample(wo, 0);
    EXPECT_NEAR(dot(s.wi, reflect(wo)), 1, 1e-4);
  }
}

TEST(RoughDielectric, TendsToGlass) {
  Material rough("roughdielectric", "alpha=0.001"), smooth("dielectric", "");
  for (double cosine : {0.9, 0.4, -0.9}) {
    Direction wo = direction(cosine);
    Sample<double> t = smooth.sample(wo, 0.999), s = rough.sample(wo, 0.999);
    EXPECT_EQ(s.lobe, int(kTransmission));
    EXPECT_GT(dot(s.wi, t.wi), 0.9999);
    EXPECT_NEAR(s.weight[0], t.weight[0], 0.01 * t.weight[0]);
    EXPECT_NEAR(s.eta, t.eta, 1e-12);
  }
}

TEST(RoughDielectric, IsReciprocalUpToTheSquaredIndex) {
  Material m("roughdielectric", "int_ior=1.5;ext_ior=1;alpha_u=0.3;alpha_v=0.6;distribution=ggx");
  Direction a = direction(0.7, 0.2), b = direction(-0.8, 3.6);
  EXPECT_GT(m.eval(a, b).value[0], 0);
  double importance = m.eval(a, b, TransportMode::importance).value[0];
  EXPECT_NEAR(importance / m.eval(a, b).value[0], 2.25, 1e-5);
  // Radiance one way is importance the other way.
  EXPECT_NEAR(importance / 0.8, m.eval(b, a).value[0] / 0.7, 1e-5 * importance);
}

TEST(RoughDielectric, EqualIndicesAreAnError) {
  try {
    Material("roughdielectric", "int_ior=1.5;ext_ior=1.5");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("int_ior and ext_ior"), std::string::npos);
  }
}

// The weight of a visible-normal sample of a mirror is a masking term.
TEST(RoughConductor, WeightsStayBelowOne) {
  for (const char* settings : {"alpha=0.001", "alpha=0.3", "alpha_u=0.05;alpha_v=0.3",
                               "alpha=1;distribution=ggx", "alpha=0.001;distribution=ggx"}) {
    Material m("roughconductor", settings);
    for (double cosine : {1.0, 0.5, 0.05, 1e-3})
      for (int i = 0; i < 400; ++i) {
        Sample<double> s = m.sample(direction(cosine), 0, (i / 20 + 0.5) / 20, (i % 20 + 0.5) / 20);
        EXPECT_LE(s.weight[0], 1.004) << settings; // 0.004: Beckmann's rational masking
        EXPECT_EQ(s.valid, s.wi.z > 0);
      }
  }
}

TEST(RoughConductor, CompensationMakesTheFurnaceWhite) {
  for (const char* surface :
       {"distribution=ggx;alpha=1", "alpha=1", "alpha=0.001", "distribution=ggx;alpha=0.3",
        "alpha=0.5;height_correlated=true", "distribution=ggx;alpha_u=0.05;alpha_v=0.3"}) {
    Material m("roughconductor", std::string("energy_compensation=true;") + surface);
    for (double cosine : {1.0, 0.5, 0.1}) {
      double albedo = m.mean_weight(direction(cosine, 0.8), 32, 24)[0];
      EXPECT_NEAR(albedo, 1, 3e-3) << surface << " " << cosine; // sampling noise included
    }
  }
  // It is reciprocal, and gold stays below white.
  Material gold("roughconductor", "energy_compensation=true;material=gold;alpha=0.7");
  Direction a = direction(0.8, 0.1), b = direction(0.3, 2);
  EXPECT_NEAR(gold.eval(a, b).value[1] / 0.3, gold.eval(b, a).value[1] / 0.8, 1e-6);
  Material plain("roughconductor", "material=gold;alpha=0.7");
  Color<double> gold_albedo = gold.mean_weight(a, 32, 16);
  for (int c = 0; c < 3; ++c) {
    EXPECT_GT(gold_albedo[c], plain.mean_weight(a, 32, 1)[c]);
    EXPECT_LT(gold_albedo[c], 1);
  }
}

TEST(RoughConductor, MaterialAndEtaExcludeEachOther) {
  EXPECT_THROW(Material("roughconductor", "material=gold;eta=1;k=1"), Error);
  EXPECT_THROW(Material("roughconductor", "eta=1"), Error);
  EXPECT_THROW(Material("roughconductor", "alpha=0.1;alpha_u=0.1;alpha_v=0.1"), Error);
  EXPECT_NO_THROW(Material("roughconductor", "material=none;eta=1;k=1"));
}

} // namespace
} // namespace faceta
