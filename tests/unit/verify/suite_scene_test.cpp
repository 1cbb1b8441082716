#include "verify/suite_scene.h"

#include <gtest/gtest.h>

namespace {

using namespace faceta;
using Kind = MaterialNode::Kind;
using NodePtr = std::shared_ptr<MaterialNode>;

NodePtr leaf(const std::string& model, const Settings& settings, int line) {
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(make_parameters(model, settings));
  node->where = {"s.xml", line, 3};
  return node;
}

NodePtr tree(Kind kind, const std::vector<NodePtr>& children, int line) {
  auto node = std::make_shared<MaterialNode>();
  node->kind = kind;
  node->children = children;
  node->where = {"s.xml", line, 3};
  return node;
}

struct Collected {
  std::vector<SuiteSubject> subjects;
  std::vector<std::string> notes, names;
  explicit Collected(const std::vector<std::pair<std::string, NodePtr>>& materials) {
    Scene scene;
    add_scene_subjects(materials, scene, subjects, notes);
    for (const SuiteSubject& s : subjects)
      names.push_back(s.name);
  }
  bool tells(const std::string& words) const {
    for (const std::string& note : notes)
      if (note.find(words) != std::string::npos)
        return true;
    return false;
  }
};

using Names = std::vector<std::string>;

TEST(SceneSubjects, AreNamedById) {
  NodePtr wall = leaf("diffuse", {{"reflectance", "0.2"}}, 4);
  NodePtr inner = leaf("phong", {}, 8);
  NodePtr floor = tree(Kind::twosided, {inner}, 7);
  NodePtr nameless = leaf("conductor", {}, 12);
  Collected c({{"wall", wall}, {"floor", floor}, {"", inner}, {"", nameless}});
  EXPECT_EQ(c.names, (Names{"wall", "floor", "floor/phong", "conductor:12"}));
  EXPECT_EQ(c.subjects[0].where, "s.xml:4:3");
  EXPECT_EQ(c.subjects[0].origin, Origin::scene);
  EXPECT_EQ(c.subjects[0].subject.parameters->slots()[0], 0.2);
  EXPECT_TRUE(c.notes.empty());
}

TEST(SceneSubjects, ATreeGivesItselfAndEachOfItsModelsOnce) {
  NodePtr a = leaf("diffuse", {{"reflectance", "0.2"}}, 4);
  NodePtr b = leaf("diffuse", {{"reflectance", "0.3"}}, 5);
  NodePtr blend = tree(Kind::blend, {a, b}, 3), hole = tree(Kind::mask, {blend}, 2);
  blend->weight.value = {0.5, 0.5, 0.5};
  hole->weight.value = {0.75, 0.75, 0.75};
  Collected c({{"", hole}, {"", blend}, {"", a}, {"", b}, {"air", tree(Kind::null, {}, 9)}});
  EXPECT_EQ(c.names, (Names{"mask:2", "blendbsdf:3", "diffuse:4", "diffuse:5", "air"}));
  EXPECT_EQ(c.subjects[0].subject.tree->text(),
            "mask(opacity=0.75; blendbsdf(weight=0.5; diffuse reflectance=0.2,0.2,0.2, "
            "diffuse reflectance=0.3,0.3,0.3))");
  Collected named({{"mix", blend}, {"", a}, {"", b}});
  EXPECT_EQ(named.names, (Names{"mix", "mix/diffuse", "mix/diffuse:5"}));
}

TEST(SceneSubjects, EqualParametersAreVerifiedOnce) {
  Collected c({{"a", leaf("phong", {{"exponent", "9"}}, 1)},
               {"b", leaf("phong", {{"exponent", "9"}}, 2)},
               {"c", leaf("phong", {{"exponent", "8"}}, 3)},
               {"d", leaf("blinnphong", {{"exponent", "9"}}, 4)}});
  EXPECT_EQ(c.names, (Names{"a", "c", "d"}));
  ASSERT_EQ(c.notes.size(), 1u);
  EXPECT_EQ(c.notes[0], "a stands for equal parameters: b");
}

TEST(SceneSubjects, EqualTreesAreVerifiedOnce) {
  auto holes = [](double opacity, int line) {
    NodePtr mask = tree(Kind::mask, {leaf("phong", {{"exponent", "9"}}, line + 1)}, line);
    mask->weight.value.fill(opacity);
    return mask;
  };
  Collected c({{"a", holes(0.5, 1)}, {"b", holes(0.5, 3)}, {"c", holes(0.25, 5)}});
  EXPECT_EQ(c.names, (Names{"a", "a/phong", "c"}));
  EXPECT_TRUE(c.tells("a stands for equal parameters: b"));
  EXPECT_TRUE(c.tells("a/phong stands for equal parameters: b/phong, c/phong"));
}

TEST(SceneSubjects, WhatTheRendererWouldRefuseIsRefused) {
  NodePtr glass = tree(Kind::twosided, {leaf("dielectric", {}, 8)}, 7);
  try {
    Collected c({{"pane", glass}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.where().line, 8);
  }
}

TEST(SceneSubjects, TexturesAreToldWithTheirMeans) {
  NodePtr paper = leaf("diffuse", {}, 1);
  paper->parameters->set_texture("reflectance", {0.25, 0.5, 0.75});
  paper->textures = {{"reflectance", 0}};
  Collected c({{"paper", paper}});
  EXPECT_EQ(c.names, Names{"paper"});
  EXPECT_TRUE(c.tells("paper: reflectance is a texture; verified with its mean, 0.25,0.5,0.75"));
}

TEST(SceneSubjects, NumbersThatOnlyScenesMayGiveGoThroughNoText) {
  NodePtr bright = leaf("diffuse", {}, 1);
  bright->parameters->set_number("reflectance", 1.5, {}, AboveRange::keep);
  Collected c({{"bright", bright}});
  ASSERT_EQ(c.subjects[0].idle.size(), 1u);
  EXPECT_EQ(c.subjects[0].idle[0].property, "round_trip");
  SuiteOptions options;
  options.only = {"round_trip", "energy"};
  SuiteReport report = run_suite(c.subjects, {}, options);
  EXPECT_EQ(report.count(Verdict::not_applicable), 1u);
  EXPECT_EQ(report.count(Verdict::failed), 1u); // it does give back more than it gets
}

} // namespace
