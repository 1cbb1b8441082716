// What models become at the ends of their ranges, beyond the limits that they name themselves (the
// property "limits" proves those).

#include "bsdf/energy.h"
#include "bsdf/fresnel.h"
#include "materials/builtin.h"
#include "model_checks.h"
#include "sampling/quadrature.h"

namespace faceta {
namespace {

// The albedo of the single scattering by quadrature over its normals, and what the model's value
// adds to it integrated over directions: cosines crowd at grazing angles, where much of it goes.
TEST(Limits, CompensationMakesWhiteMetalWhite) {
  const Quadrature q = gauss_legendre(64);
  for (int distribution : {kBeckmann, kGgx})
    for (int correlated : {0, 1})
      for (const char* alpha : {"0.001", "0.01", "0.05", "0.15", "0.3", "0.5", "0.75", "1"}) {
        Settings settings = {{"distribution", distribution == kGgx ? "ggx" : "beckmann"},
                             {"height_correlated", correlated ? "true" : "false"},
                             {"alpha", alpha}};
        Parameters plain = make_parameters("roughconductor", settings);
        settings.emplace_back("energy_compensation", "true");
        Parameters full = make_parameters("roughconductor", settings);
        Record plain_record = plain.record(), full_record = full.record();
        const Model& model = plain.model();
        MicrofacetOptions o{.distribution = distribution, .height_correlated = correlated};
        for (double cosine : {1.0, 0.8, 0.5, 0.3, 0.1, 0.03, 0.01}) {
          Direction wo = direction(cosine);
          double albedo = microfacet_albedo(o, std::stod(alpha), std::stod(alpha), wo, 128);
          for (size_t i = 0; i < q.nodes.size(); ++i) {
            double z = q.nodes[i] * q.nodes[i] * q.nodes[i];
            ReferenceQuery query{wo, direction(z)};
            double added =
                model.eval(full_record, query).value[1] - model.eval(plain_record, query).value[1];
            albedo += 2 * kPi * added * 3 * q.nodes[i] * q.nodes[i] * q.weights[i];
          }
          EXPECT_NEAR(albedo, 1, 1e-3)
              << settings[0].second << " " << settings[1].second << " " << alpha << " " << cosine;
        }
      }
}

TEST(Limits, PhongWithoutExponentIsLambertNearTheMirror) {
  Parameters p = make_parameters(
      "phong",
      {{"exponent", "0"}, {"diffuse_reflectance", "0.3"}, {"specular_reflectance", "0.5"}});
  Record record = p.record();
  for (double cosine : {1.0, 0.8, 0.2})
    for (double wi_cosine : {0.9, 0.5, 0.1})
      for (double azimuth : {0.4, 1.5, 3.0, 5.0}) {
        Direction wo = direction(cosine), wi = direction(wi_cosine, azimuth);
        double near = dot(wi, reflect(wo)) > 0 ? 1 : 0; // the lobe ends 90 degrees away
        double value = p.model().eval(record, {wo, wi}).value[0];
        EXPECT_NEAR(value, (0.3 + 0.5 * near) / kPi * wi_cosine, 1e-7) << cosine << wi_cosine;
      }
}

TEST(Limits, AConductorThatDoesNotAbsorbIsADielectric) {
  for (double eta : {1.0, 1.2, 1.5, 2.42, 0.9, 0.5})
    for (double cosine : {1.0, 0.9, 0.6, 0.3, 0.05, 0.001}) {
      DielectricFresnel<double> f = fresnel_dielectric(cosine, eta);
      double absorbing = fresnel_conductor(cosine, eta, 1e-9),
             clear = fresnel_conductor(cosine, eta, 0.0);
      EXPECT_NEAR(clear, f.reflectance, 1e-9) << eta << " " << cosine;
      EXPECT_NEAR(absorbing, f.reflectance, 1e-6) << eta << " " << cosine;
    }
}

// The identities of tests/unit/bsdf walk these distributions; a third one must be added there.
TEST(Limits, EveryDistributionIsOneThatIsProved) {
  int models = 0;
  for (const auto& model : Registry::global().models())
    if (const ParamInfo* p = model->descriptor.find("distribution")) {
      EXPECT_EQ(p->choices, (std::vector<std::string>{"beckmann", "ggx"})) << model->name();
      ++models;
    }
  EXPECT_GE(models, 3);
}

} // namespace
} // namespace faceta
