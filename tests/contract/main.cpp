// Registers one test for every material, exemplar and property; the materials come from the
// registry.

#include "formats/material_xml.h"
#include "verify/properties.h"
#include "verify/statistics.h"

#include <cctype>
#include <cstdlib>
#include <gtest/gtest.h>

namespace faceta::newcomers {
std::vector<Model> newcomers_models();
}

namespace {

using namespace faceta;

// The chance that anything in the whole suite fails although all is right.
constexpr double kFamilyLevel = 1e-4;

Effort effort() {
  const char* tier = std::getenv("FACETA_TIER");
  return tier && std::string(tier) == "full" ? Effort::full : Effort::quick;
}

double test_level() {
  static const double level = [] {
    double count = 0;
    for (const auto& model : Registry::global().models())
      count += double(model->descriptor.exemplars.size());
    int modes = effort() == Effort::full ? 2 : 1;
    return sidak(kFamilyLevel, count * most_viewers(effort()) * modes);
  }();
  return level;
}

// A verdict as GoogleTest's; what a model is known to break is shown as skipped, with the reason.
void report(const Outcome& outcome, const Model& model, const std::string& property) {
  if (outcome.passed) {
    if (outcome.figure != 0)
      ::testing::Test::RecordProperty("figure", std::to_string(outcome.figure));
    return;
  }
  if (const Excuse* excuse = find_excuse(model, property))
    GTEST_SKIP() << "excused: " << excuse->reason << "\n" << outcome.message;
  FAIL() << outcome.message;
}

class SubjectTest : public ::testing::Test {
public:
  SubjectTest(const Model& m, const Exemplar& e, const Property& p)
      : model_(m), exemplar_(e), property_(p) {}
  void TestBody() override {
    Subject subject(model_, exemplar_);
    report(property_.check(subject, effort(), test_level()), model_, property_.name);
  }

private:
  const Model& model_;
  const Exemplar& exemplar_;
  const Property& property_;
};

class ModelTest : public ::testing::Test {
public:
  ModelTest(const Model& m, const ModelProperty& p) : model_(m), property_(p) {}
  void TestBody() override { report(property_.check(model_), model_, property_.name); }

private:
  const Model& model_;
  const ModelProperty& property_;
};

Parameters through_xml(const Parameters& p) {
  return *parse_material(write_material(p))->parameters;
}

std::string slug(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)))
      c = '_';
  return name;
}

void register_model(const Model& model) {
  for (const ModelProperty& property : model_properties())
    ::testing::RegisterTest(
        model.name().c_str(), property.name, nullptr, nullptr, __FILE__, __LINE__,
        [&model, &property]() -> ::testing::Test* { return new ModelTest(model, property); });
  for (const Exemplar& exemplar : model.descriptor.exemplars)
    for (const Property& property : subject_properties())
      ::testing::RegisterTest((model.name() + "/" + slug(exemplar.name)).c_str(), property.name,
                              nullptr, nullptr, __FILE__, __LINE__,
                              [&model, &exemplar, &property]() -> ::testing::Test* {
                                return new SubjectTest(model, exemplar, property);
                              });
}

} // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  Registry::global().add(newcomers::newcomers_models(), FACETA_TEST_MODULES, "newcomers");
  round_trips().emplace_back("xml", through_xml);
  for (const auto& model : Registry::global().models())
    register_model(*model);
  return RUN_ALL_TESTS();
}
