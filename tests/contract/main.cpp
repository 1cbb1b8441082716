// Registers one test for every material, exemplar and property; the materials come from the
// registry.

#include "formats/material_json.h"
#include "formats/material_xml.h"
#include "formats/measured_loader.h"
#include "verify/suite.h"

#include <cctype>
#include <cstdlib>
#include <gtest/gtest.h>

namespace faceta::newcomers {
std::vector<Model> newcomers_models();
}

namespace {

using namespace faceta;

Effort effort() {
  const char* tier = std::getenv("FACETA_TIER");
  return tier && std::string(tier) == "full" ? Effort::full : Effort::quick;
}

double test_level() {
  static const double level = [] {
    size_t subjects = 0;
    for (const auto& model : Registry::global().models())
      subjects += model->descriptor.exemplars.size();
    for (const SceneNode& node : scene_nodes())
      subjects += node.exemplars.size();
    return suite_level(subjects, effort());
  }();
  return level;
}

// A verdict as GoogleTest's; what a model is known to break is shown as skipped, with the reason.
void report(const Outcome& outcome, const Descriptor& descriptor, const std::string& property) {
  switch (judge(outcome, descriptor, property)) {
  case Verdict::passed:
  case Verdict::not_applicable:
    if (outcome.figure != 0)
      ::testing::Test::RecordProperty("figure", std::to_string(outcome.figure));
    return;
  case Verdict::excused:
    GTEST_SKIP() << "excused: " << find_excuse(descriptor, property)->reason << "\n"
                 << outcome.message;
  case Verdict::failed:
    FAIL() << outcome.message;
  }
}

class SubjectTest : public ::testing::Test {
public:
  using MakeSubject = std::function<Subject()>;
  SubjectTest(const MakeSubject& make, const Property& p) : make_subject_(make), property_(p) {}
  void TestBody() override {
    Subject subject = make_subject_(); // here: a program that runs one test makes one subject
    report(property_.check(subject, effort(), test_level()), subject.descriptor(), property_.name);
  }

private:
  const MakeSubject make_subject_;
  const Property& property_;
};

class ModelTest : public ::testing::Test {
public:
  ModelTest(const Model& m, const ModelProperty& p) : model_(m), property_(p) {}
  void TestBody() override { report(property_.check(model_), model_.descriptor, property_.name); }

private:
  const Model& model_;
  const ModelProperty& property_;
};

std::string slug(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)))
      c = '_';
  return name;
}

void register_subject(const std::string& type, const std::string& exemplar,
                      const SubjectTest::MakeSubject& make) {
  for (const Property& property : subject_properties())
    ::testing::RegisterTest(
        (type + "/" + slug(exemplar)).c_str(), property.name, nullptr, nullptr, __FILE__, __LINE__,
        [make, &property]() -> ::testing::Test* { return new SubjectTest(make, property); });
}

void register_model(const Model& model) {
  for (const ModelProperty& property : model_properties())
    ::testing::RegisterTest(
        model.name().c_str(), property.name, nullptr, nullptr, __FILE__, __LINE__,
        [&model, &property]() -> ::testing::Test* { return new ModelTest(model, property); });
  for (const Exemplar& exemplar : model.descriptor.exemplars)
    register_subject(model.name(), exemplar.name,
                     [&model, &exemplar] { return Subject(model, exemplar); });
}

} // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  load_measured_files();
  Registry::global().add(newcomers::newcomers_models(), FACETA_TEST_MODULES, "newcomers");
  round_trips().emplace_back("xml", through_xml);
  round_trips().emplace_back("json", through_json);
  tree_round_trips().emplace_back(
      "xml", [](const MaterialNode& tree) { return parse_material(write_material(tree)); });
  for (const auto& model : Registry::global().models())
    register_model(*model);
  for (const SceneNode& node : scene_nodes())
    for (const auto& [name, xml] : node.exemplars)
      register_subject(node.descriptor.name, name, [text = xml] {
        return Subject(std::make_shared<MaterialTree>(*parse_material(text)));
      });
  return RUN_ALL_TESTS();
}
