// The suite: levels, verdicts and reports, on materials that are known to be right or wrong.

#include "defective_registry.h"
#include "verify/statistics.h"
#include "verify/suite_report.h"

#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tbb/global_control.h>

namespace {

using namespace faceta;
using Json = nlohmann::json;

const Model& model(const std::string& name) {
  return defective::registry().get(name);
}

SuiteReport run(const std::vector<SuiteSubject>& subjects, const std::vector<std::string>& only,
                uint64_t seed = 0) {
  SuiteOptions options;
  options.only = only;
  options.seed = seed;
  return run_suite(subjects, {}, options);
}

SuiteReport run(const Model& m, const std::vector<std::string>& only, uint64_t seed = 0) {
  return run(exemplar_subjects(m), only, seed);
}

/// The only result of one subject and one property.
PropertyResult ask(const Model& m, const std::string& property) {
  SuiteReport report = run(m, {property});
  EXPECT_EQ(report.subjects.size(), 1u);
  EXPECT_EQ(report.subjects.at(0).results.size(), 1u);
  return report.subjects.at(0).results.at(0);
}

TEST(SuiteLevel, IsSidaksOverAllTests) {
  // Of a subject: a chi-square and a density for each of 26 viewers, 54 albedos; full effort: 92
  // viewers in two modes.
  for (size_t n : {size_t(1), size_t(73)}) {
    EXPECT_NEAR(std::pow(1 - suite_level(n, Effort::quick), 106.0 * double(n)), 1 - 1e-4, 1e-9);
    EXPECT_NEAR(std::pow(1 - suite_level(n, Effort::full), 422.0 * double(n)), 1 - 1e-4, 1e-9);
  }
  EXPECT_NEAR(std::pow(1 - suite_level(2, Effort::quick, 0.01), 212), 0.99, 1e-9);
  EXPECT_EQ(run(model("none"), {"modes"}).test_level, suite_level(1, Effort::quick));
}

TEST(Suite, FindsAPlantedFailure) {
  SuiteReport report = run(model("too_bright"), {"energy", "finite"});
  EXPECT_FALSE(report.passed());
  EXPECT_EQ(report.count(Verdict::failed), 1u);
  EXPECT_EQ(report.count(Verdict::passed), 1u);
  std::string text = suite_text(report, false);
  EXPECT_NE(text.find("FAILED too_bright/white: energy"), std::string::npos) << text;
  EXPECT_NE(text.find("1 failed"), std::string::npos) << text;
  EXPECT_EQ(Json::parse(suite_json(report, "1"))["passed"], false);
}

TEST(Suite, ASoundMaterialPassesAsAWhole) {
  SuiteOptions options;
  std::vector<size_t> done;
  size_t total = 0;
  options.progress = [&](const SuiteProgress& p) {
    done.push_back(p.done);
    total = p.total;
  };
  const Model& m = model("none_mirror");
  SuiteReport report = run_suite(exemplar_subjects(m), {&m}, options);
  EXPECT_TRUE(report.passed()) << suite_text(report, false);
  EXPECT_EQ(total, subject_properties().size() + model_properties().size());
  EXPECT_EQ(report.count(Verdict::passed), total);
  ASSERT_EQ(done.size(), total);
  for (size_t i = 0; i < total; ++i)
    EXPECT_EQ(done[i], i + 1);
  EXPECT_EQ(report.models.at(0).results.size(), model_properties().size());
}

TEST(Suite, AModelsOwnPropertiesFailToo) {
  SuiteOptions options;
  options.only = {"parameters"};
  const Model& m = model("dead_parameter");
  SuiteReport report = run_suite({}, {&m}, options);
  EXPECT_FALSE(report.passed());
  EXPECT_NE(suite_text(report, false).find("FAILED dead_parameter: parameters"), std::string::npos);
}

TEST(Suite, WhatAModelExcusesIsExcusedWithItsReason) {
  EXPECT_EQ(ask(model("one_way"), "reciprocity").verdict, Verdict::failed);
  Model m = model("one_way");
  m.descriptor.excuses.push_back({"reciprocity", "light is not asked"});
  PropertyResult result = ask(m, "reciprocity");
  EXPECT_EQ(result.verdict, Verdict::excused);
  EXPECT_EQ(result.reason, "light is not asked");
  EXPECT_GT(result.figure, 1e-3);
  SuiteReport report = run(m, {"reciprocity"});
  EXPECT_TRUE(report.passed());
  EXPECT_NE(suite_text(report, false).find("light is not asked"), std::string::npos);
  // Nothing is excused that holds.
  m = model("none");
  m.descriptor.excuses.push_back({"reciprocity", "light is not asked"});
  EXPECT_EQ(ask(m, "reciprocity").verdict, Verdict::passed);
}

TEST(Suite, EnergyIsExcusedUpToTheBoundOnly) {
  Model m = model("too_bright"); // albedo 1.01
  m.descriptor.traits.albedo_bound = 1.02;
  EXPECT_EQ(ask(m, "energy").verdict, Verdict::passed);
  m.descriptor.excuses.push_back({"energy", "a fit"});
  PropertyResult result = ask(m, "energy");
  EXPECT_EQ(result.verdict, Verdict::excused);
  EXPECT_NEAR(result.figure, 1.01, 1e-4);
  m.descriptor.traits.albedo_bound = 1.005;
  result = ask(m, "energy");
  EXPECT_EQ(result.verdict, Verdict::failed);
  EXPECT_NE(result.text.find("above the bound 1.005"), std::string::npos) << result.text;
  // Nor does an excuse cover a subject that claims to lose nothing.
  m = model("lossy");
  m.descriptor.excuses.push_back({"energy", "a fit"});
  EXPECT_EQ(ask(m, "energy").verdict, Verdict::failed);
}

TEST(Suite, WhatCannotBeAskedIsNotApplicable) {
  Model m = model("one_way");
  m.descriptor.traits.reciprocal = false;
  EXPECT_EQ(ask(m, "reciprocity").verdict, Verdict::not_applicable);
  std::vector<SuiteSubject> subjects = exemplar_subjects(model("one_way"));
  subjects[0].idle.push_back({"reciprocity", "not today"});
  PropertyResult result = run(subjects, {"reciprocity"}).subjects[0].results[0];
  EXPECT_EQ(result.verdict, Verdict::not_applicable);
  EXPECT_EQ(result.text, "not today");
}

TEST(Suite, AnExceptionIsAFailure) {
  round_trips().emplace_back("broken", [](const Parameters&) -> Parameters { throw Error("oh"); });
  PropertyResult result = ask(model("none"), "round_trip");
  round_trips().pop_back();
  EXPECT_EQ(result.verdict, Verdict::failed);
  EXPECT_NE(result.text.find("exception: error: oh"), std::string::npos) << result.text;
  EXPECT_EQ(ask(model("none"), "round_trip").verdict, Verdict::passed);
}

TEST(Suite, AnUnknownPropertyIsRefusedWithASuggestion) {
  try {
    run(model("none"), {"enerjy"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'energy'"), std::string::npos);
  }
}

TEST(Suite, ResultsDependOnTheSeedAndNotOnThreads) {
  auto figures = [](uint64_t seed) {
    std::vector<double> all;
    for (const SubjectReport& s :
         run({settings_subject(model("none"), {}), settings_subject(model("none_mirror"), {})},
             {"chi2", "density", "energy"}, seed)
             .subjects)
      for (const PropertyResult& r : s.results)
        all.push_back(r.figure);
    return all;
  };
  std::vector<double> first = figures(0);
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(figures(0), first);
  std::vector<double> other = figures(1);
  EXPECT_NE(other[0], first[0]); // the smallest of 26 p-values
}

TEST(SuiteSubjects, AreNamedByWhatTheyAre) {
  SuiteSubject s = settings_subject(model("none"), {{"gain", "0.5"}, {"reflectance", "1,0,0"}});
  EXPECT_EQ(s.name, "none gain=0.5 reflectance=1,0,0");
  EXPECT_EQ(s.subject.parameters->text("gain"), "0.5");
  EXPECT_THROW(settings_subject(model("none"), {{"gain", "2"}}), Error);
  EXPECT_THROW(settings_subject(model("none"), {{"gaim", "1"}}), Error);
  EXPECT_EQ(exemplar_subjects(model("none"))[0].name, "none/white");
}

std::vector<std::string> keys(const nlohmann::ordered_json& object) {
  std::vector<std::string> names;
  for (const auto& [key, value] : object.items())
    names.push_back(key);
  return names;
}

TEST(SuiteJson, HasTheFieldsThatAreDocumented) {
  Model m = model("one_way");
  m.descriptor.excuses.push_back({"reciprocity", "why"});
  std::vector<SuiteSubject> subjects = exemplar_subjects(m);
  subjects.push_back(settings_subject(model("none"), {{"gain", "0.5"}}));
  SuiteOptions options;
  options.only = {"reciprocity", "parameters"};
  options.seed = 18446744073709551615u;
  auto json = nlohmann::ordered_json::parse(suite_json(run_suite(subjects, {&m}, options), "9.9"));
  using Words = std::vector<std::string>;
  EXPECT_EQ(keys(json),
            (Words{"version", "passed", "effort", "seed", "isa", "family_level", "test_level",
                   "seconds", "counts", "properties", "models", "subjects", "notes"}));
  EXPECT_EQ(json["version"], "9.9");
  EXPECT_EQ(json["effort"], "fast");
  EXPECT_EQ(json["seed"], 18446744073709551615u);
  EXPECT_EQ(keys(json["counts"]), (Words{"passed", "failed", "excused", "not_applicable"}));
  EXPECT_EQ(json["counts"]["excused"], 1);
  EXPECT_EQ(json["counts"]["passed"], 2);
  EXPECT_EQ(json["properties"][0]["name"], "reciprocity");
  EXPECT_EQ(json["properties"][1]["of"], "model");
  EXPECT_EQ(keys(json["models"][0]), (Words{"name", "title", "results"}));
  const auto& given = json["subjects"][1];
  EXPECT_EQ(keys(given),
            (Words{"name", "model", "origin", "lossless", "parameters", "seconds", "results"}));
  EXPECT_EQ(given["origin"], "settings");
  EXPECT_EQ(given["parameters"], (Json{{"gain", "0.5"}}));
  EXPECT_EQ(keys(given["results"][0]), (Words{"property", "verdict", "figure", "text", "seconds"}));
  const auto& excused = json["subjects"][0];
  EXPECT_EQ(excused["exemplar"], "white");
  EXPECT_EQ(excused["results"][0]["verdict"], "excused");
  EXPECT_EQ(excused["results"][0]["reason"], "why");
}

TEST(SuiteText, FitsAHundredColumns) {
  std::vector<SuiteSubject> subjects = exemplar_subjects(model("too_bright"));
  for (SuiteSubject& s : exemplar_subjects(model("none")))
    subjects.push_back(std::move(s));
  subjects[1].name += std::string(80, 'x');
  SuiteOptions options;
  SuiteReport report = run_suite(subjects, {&model("none")}, options);
  report.notes = {"a word " + std::string(40, 'a') + " " + std::string(50, 'b') + " and more"};
  std::istringstream lines(suite_text(report, false));
  for (std::string line; std::getline(lines, line);)
    EXPECT_LE(line.size(), 100u) << line;
  EXPECT_EQ(suite_text(report, false).find('\x1b'), std::string::npos);
  EXPECT_NE(suite_text(report, true).find("\x1b[1;31mFAIL"), std::string::npos);
}

} // namespace
