// Twelve faults planted in real materials: each is caught by the property named here, which the
// material as it is passes.

#include "bsdf/registry.h"
#include "verify/properties.h"

#include <gtest/gtest.h>

namespace faceta::faulty {
std::vector<Model> faulty_models();
}

namespace {

using namespace faceta;

const Registry& faults() {
  static const Registry registry = [] {
    Registry r;
    r.add(faulty::faulty_models(), FACETA_TEST_MODULES, "faulty");
    return r;
  }();
  return registry;
}

struct Fault {
  const char* model;    ///< with the fault
  const char* original; ///< without
  const char* exemplar;
  const char* property; ///< that finds it
};
const Fault kFaults[] = {
    {"wrong_cosine", "diffuse", "grey", "chi2"},
    {"no_jacobian", "roughconductor", "gold of the course", "chi2"},
    {"eta_upside_down", "roughdielectric", "frosted glass", "density"},
    {"no_eta_squared", "roughdielectric", "frosted glass", "modes"},
    {"one_masking_missing", "roughconductor", "very rough", "reciprocity"},
    {"unnormalised", "roughconductor", "very rough", "density"},
    {"alpha_squared", "roughconductor", "gold of the course", "albedos"},
    {"half_vector_sign", "roughdielectric", "frosted glass", "limits"},
    {"one_way_tint", "phong", "default", "reciprocity"},
    {"rougher_sampling", "roughconductor", "gold of the course", "chi2"},
    {"lane_rounding", "roughconductor", "gold of the course", "lanes"},
    {"ignored_parameter", "roughconductor", "gold of the course", "parameters"},
};

Outcome ask(const Model& model, const Fault& fault) {
  for (const Exemplar& exemplar : model.descriptor.exemplars)
    if (exemplar.name == fault.exemplar)
      for (const Property& p : subject_properties())
        if (std::string(fault.property) == p.name)
          return p.check(Subject(model, exemplar), Effort::quick, 1e-7);
  for (const ModelProperty& p : model_properties())
    if (std::string(fault.property) == p.name)
      return p.check(model);
  throw Error("no such exemplar or property");
}

void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.model << " of " << fault.original << " / " << fault.exemplar;
}

class Planted : public ::testing::TestWithParam<Fault> {};

TEST_P(Planted, IsCaught) {
  if (std::string(GetParam().property) == "lanes" && !isa_supported(Isa::v3))
    GTEST_SKIP() << "this CPU has no eight lanes";
  Outcome outcome = ask(faults().get(GetParam().model), GetParam());
  EXPECT_TRUE(outcome.applicable);
  EXPECT_FALSE(outcome.passed);
  EXPECT_GT(outcome.message.size(), 20u) << "a failure must say where";
}

TEST_P(Planted, IsNotInTheOriginal) {
  Outcome outcome = ask(Registry::global().get(GetParam().original), GetParam());
  EXPECT_TRUE(outcome.applicable);
  EXPECT_TRUE(outcome.passed) << outcome.message;
}

INSTANTIATE_TEST_SUITE_P(Fault, Planted, ::testing::ValuesIn(kFaults), [](const auto& info) {
  return std::string(info.param.model) + "_by_" + info.param.property;
});

} // namespace
