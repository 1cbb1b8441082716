// The tests of the tests: a sound material passes every property, and each property fails on a
// material with the defect that it is there to find.

#include "defective_registry.h"
#include "verify/properties.h"

#include <gtest/gtest.h>

namespace {

using namespace faceta;

const Registry& registry() {
  return defective::registry();
}

Outcome run(const std::string& model_name, const std::string& property) {
  const Model& model = registry().get(model_name);
  for (const Property& p : subject_properties())
    if (property == p.name)
      return p.check(Subject(model, model.descriptor.exemplars[0]), Effort::quick, 1e-7);
  for (const ModelProperty& p : model_properties())
    if (property == p.name)
      return p.check(model);
  throw Error("no property '" + property + "'");
}

struct Case {
  const char* model;
  const char* property;
};
std::string name_of(const ::testing::TestParamInfo<Case>& info) {
  return std::string(info.param.model) + "_" + info.param.property;
}

class Finds : public ::testing::TestWithParam<Case> {};
TEST_P(Finds, Defect) {
  Outcome outcome = run(GetParam().model, GetParam().property);
  EXPECT_FALSE(outcome.passed);
  EXPECT_GT(outcome.message.size(), 20u) << "a failure must say where";
}
INSTANTIATE_TEST_SUITE_P(
    Property, Finds,
    ::testing::Values(Case{"wrong_density", "chi2"}, Case{"wrong_density", "density"},
                      Case{"wrong_sampling", "chi2"}, Case{"hidden_peak", "chi2"},
                      Case{"hidden_peak", "density"}, Case{"wrong_delta", "chi2"},
                      Case{"wrong_weight", "consistency"}, Case{"wrong_sample", "consistency"},
                      Case{"hidden_peak", "consistency"}, Case{"wrong_side", "consistency"},
                      Case{"too_bright", "energy"}, Case{"lossy", "energy"},
                      Case{"one_way", "reciprocity"}, Case{"not_a_number", "finite"},
                      Case{"negative", "finite"}, Case{"lane_drift", "lanes"},
                      Case{"lane_texture", "lanes"}, Case{"imprecise", "precision"},
                      Case{"wrong_slope", "derivatives"}, Case{"dead_parameter", "parameters"},
                      Case{"wrong_mode", "modes"}, Case{"wrong_width", "channels"},
                      Case{"lane_texture", "textures"}, Case{"dead_parameter", "textures"},
                      Case{"lossy", "limits"}, Case{"lossy", "albedos"}),
    name_of);

class Passes : public ::testing::TestWithParam<Case> {};
TEST_P(Passes, Sound) {
  Outcome outcome = run(GetParam().model, GetParam().property);
  EXPECT_TRUE(outcome.passed) << outcome.message;
}
std::vector<Case> all_properties() {
  std::vector<Case> cases;
  for (const char* model : {"none", "none_mirror"}) {
    for (const Property& p : subject_properties())
      cases.push_back({model, p.name});
    for (const ModelProperty& p : model_properties())
      cases.push_back({model, p.name});
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Property, Passes, ::testing::ValuesIn(all_properties()), name_of);

TEST(RoundTrip, FindsAFormatThatLosesDigits) {
  round_trips().emplace_back("short decimals", [](const Parameters& p) {
    Parameters result(p.model());
    for (const ParamInfo& info : p.descriptor().params)
      if (p.was_set(info.name))
        result.set(info.name, p.text(info.name).substr(0, 8));
    return result;
  });
  const Model& model = registry().get("none");
  Parameters given(model);
  given.set("gain", "0.123456789");
  EXPECT_FALSE(check_round_trip(Subject(model, given), Effort::quick, 1e-7).passed);
  round_trips().pop_back();
  EXPECT_TRUE(check_round_trip(Subject(model, given), Effort::quick, 1e-7).passed);
}

TEST(Excuses, AreFoundByTheNameOfTheProperty) {
  Model model;
  model.descriptor.excuses.push_back({"energy", "because"});
  ASSERT_NE(find_excuse(model.descriptor, "energy"), nullptr);
  EXPECT_EQ(find_excuse(model.descriptor, "energy")->reason, "because");
  EXPECT_EQ(find_excuse(model.descriptor, "chi2"), nullptr);
}

} // namespace
