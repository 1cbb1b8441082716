// Trees of materials: the definition in double, and a proof that fails on trees put together
// wrongly.

#include "verify/properties.h"

#include <gtest/gtest.h>

namespace {

using namespace faceta;
using Kind = MaterialNode::Kind;
using NodePtr = std::shared_ptr<MaterialNode>;

NodePtr leaf(const std::string& model, const Settings& settings = {}) {
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(make_parameters(model, settings));
  return node;
}

NodePtr tree(Kind kind, const std::vector<NodePtr>& children, double weight = 0) {
  auto node = std::make_shared<MaterialNode>();
  node->kind = kind;
  node->children = children;
  node->weight.value.fill(weight);
  return node;
}

const Vec3<double> kAbove{0.48, 0.36, 0.8}, kOther{-0.6, 0, 0.8};
const Vec3<double> kBelow{0.48, 0.36, -0.8}, kOtherBelow{-0.6, 0, -0.8};

Eval<double> eval(const NodePtr& root, const Vec3<double>& wo, const Vec3<double>& wi) {
  return MaterialTree(*root).reference({wo, wi});
}

double lambert(double reflectance) {
  return reflectance / kPi * 0.8;
}

TEST(MaterialTree, ABlendIsTheMeanOfItsChildren) {
  NodePtr blend = tree(
      Kind::blend,
      {leaf("diffuse", {{"reflectance", "0.2"}}), leaf("diffuse", {{"reflectance", "1,0,0.6"}})},
      0.25);
  Eval<double> e = eval(blend, kAbove, kOther);
  const double expected[] = {0.75 * 0.2 + 0.25, 0.75 * 0.2, 0.75 * 0.2 + 0.25 * 0.6};
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(e.value[k], lambert(expected[k]), 1e-7);
  EXPECT_NEAR(e.pdf, 0.8 / kPi, 1e-12);
  EXPECT_EQ(eval(blend, kBelow, kOtherBelow).pdf, 0);
}

TEST(MaterialTree, AMaskLetsTheRestPass) {
  NodePtr mask = tree(Kind::mask, {leaf("diffuse", {{"reflectance", "0.8"}})}, 0.75);
  MaterialTree t(*mask);
  EXPECT_NEAR(t.reference({kAbove, kOther}).value[0], lambert(0.6), 1e-7);
  EXPECT_NEAR(t.reference({kAbove, kOther}).pdf, 0.75 * 0.8 / kPi, 1e-12);
  Sample<double> hole = t.reference_sample(kBelow, {{0.5, 0.5}, 0.76}, TransportMode::radiance);
  EXPECT_TRUE(hole.valid && hole.delta);
  EXPECT_EQ(hole.wi.z, 0.8);
  EXPECT_EQ(hole.pdf, 0.25);
  EXPECT_EQ(hole.weight[0], 1);
  EXPECT_FALSE(t.reference_sample(kBelow, {{0.5, 0.5}, 0.74}, TransportMode::radiance).valid);
  EXPECT_TRUE(t.descriptor().traits.two_sided);
  EXPECT_TRUE(t.descriptor().traits.has_delta);
  EXPECT_EQ(t.descriptor().traits.lobes, uint32_t(kReflection | kNullLobe));
}

TEST(MaterialTree, BothSidesOfATwosidedReflect) {
  NodePtr front = leaf("diffuse", {{"reflectance", "0.8"}});
  NodePtr back = leaf("diffuse", {{"reflectance", "0.4"}});
  EXPECT_NEAR(eval(tree(Kind::twosided, {front}), kBelow, kOtherBelow).value[0], lambert(0.8),
              1e-7);
  NodePtr both = tree(Kind::twosided, {front, back});
  EXPECT_NEAR(eval(both, kAbove, kOther).value[0], lambert(0.8), 1e-7);
  EXPECT_NEAR(eval(both, kBelow, kOtherBelow).value[0], lambert(0.4), 1e-7);
  EXPECT_EQ(eval(both, kAbove, kOtherBelow).value[0], 0);
  // A two-sided material inside shows its front to either side of the outer one.
  NodePtr nested = tree(Kind::twosided, {both});
  EXPECT_NEAR(eval(nested, kBelow, kOtherBelow).value[0], lambert(0.8), 1e-7);
}

TEST(MaterialTree, WhatHasNoShareHasNoSay) {
  NodePtr glass = leaf("dielectric"), white = leaf("diffuse");
  MaterialTree t(*tree(Kind::blend, {glass, white}, 1));
  EXPECT_EQ(t.descriptor().traits.lobes, uint32_t(kReflection));
  EXPECT_FALSE(t.descriptor().traits.two_sided);
  EXPECT_EQ(t.text(), "blendbsdf(weight=1; null, diffuse)");
  EXPECT_EQ(t.models().size(), 1u);
}

TEST(MaterialTree, NumbersMoveTheReference) {
  MaterialTree t(*tree(Kind::blend,
                       {leaf("diffuse", {{"reflectance", "0.2"}}),
                        tree(Kind::twosided, {leaf("diffuse", {{"reflectance", "1"}})})},
                       0.25));
  std::vector<double> numbers = t.numbers();
  ASSERT_EQ(numbers.size(), 7u);
  EXPECT_EQ(t.parameter_numbers(), (std::vector<int>{0, 1, 2, 3, 4, 5, 6}));
  numbers[0] = 0.5, numbers[4] = 0.4;
  EXPECT_NEAR(t.reference({kAbove, kOther}, numbers).value[0], lambert(0.5 * 0.2 + 0.5 * 0.4),
              1e-7);
}

// The samples of the kernels are those of the definition, number by number.
TEST(MaterialTree, SamplesAreThoseOfTheDefinition) {
  NodePtr inner = tree(Kind::blend, {leaf("phong"), tree(Kind::null, {})}, 0.3);
  NodePtr outer = tree(Kind::twosided, {leaf("plastic"), leaf("roughconductor")});
  auto t = std::make_shared<MaterialTree>(*tree(Kind::blend, {inner, outer}, 0.6));
  SampleBatch batch(4096);
  RandomStream random(3);
  batch.draw(random);
  for (int i = 0; i < batch.n; ++i)
    batch.set_viewer(i, to_single(i % 2 ? kAbove : kBelow));
  Subject(t).run(batch, TransportMode::radiance);
  int deltas = 0;
  for (int i = 0; i < batch.n; ++i) {
    Sample<double> s =
        t->reference_sample(to_double(batch.viewer(i)),
                            {{batch.u[0][i], batch.u[1][i]}, batch.uc[i]}, TransportMode::radiance);
    ASSERT_EQ(s.valid, batch.valid(i)) << i;
    if (!s.valid)
      continue;
    ASSERT_EQ(s.delta, batch.delta(i)) << i;
    deltas += s.delta;
    EXPECT_NEAR(dot(s.wi, to_double(batch.light(i))), 1, 1e-5) << i;
    EXPECT_NEAR(s.pdf, batch.pdf[i], 1e-3 * s.pdf) << i;
    EXPECT_NEAR(s.weight[0], batch.weight[0][i], 1e-3 * s.weight[0]) << i;
  }
  EXPECT_GT(deltas, 100);
}

// --- The proof can fail ---

struct Fault {
  const char* name;
  NodePtr drawn, defined;
  const char* property;
};

std::vector<Fault> faults() {
  NodePtr metal = leaf("roughconductor", {{"alpha", "0.3"}}), matte = leaf("diffuse"),
          glass = leaf("dielectric");
  return {
      {"children_swapped", tree(Kind::blend, {matte, metal}, 0.3),
       tree(Kind::blend, {metal, matte}, 0.3), "chi2"},
      {"weight_a_hair_off", tree(Kind::blend, {metal, matte}, 0.3003),
       tree(Kind::blend, {metal, matte}, 0.3), "precision"},
      {"hole_too_large", tree(Kind::mask, {metal}, 0.69), tree(Kind::mask, {metal}, 0.7), "chi2"},
      {"no_back", tree(Kind::twosided, {metal, matte}), tree(Kind::twosided, {metal}), "chi2"},
      {"sides_swapped", tree(Kind::twosided, {metal, matte}), tree(Kind::twosided, {matte, metal}),
       "precision"},
      {"delta_too_likely", tree(Kind::blend, {matte, glass}, 0.31),
       tree(Kind::blend, {matte, glass}, 0.3), "density"},
  };
}

Outcome ask(const MaterialNode& drawn, const MaterialNode& defined, const std::string& property) {
  Subject subject(std::make_shared<MaterialTree>(drawn, defined));
  for (const Property& p : subject_properties())
    if (property == p.name)
      return p.check(subject, Effort::quick, 1e-7);
  throw Error("no property " + property);
}

TEST(MaterialTree, TreesPutTogetherWronglyAreCaught) {
  for (const Fault& f : faults()) {
    Outcome wrong = ask(*f.drawn, *f.defined, f.property);
    EXPECT_FALSE(wrong.passed) << f.name;
    EXPECT_GT(wrong.message.size(), 20u) << f.name;
    Outcome right = ask(*f.defined, *f.defined, f.property);
    EXPECT_TRUE(right.passed && right.applicable) << f.name << ": " << right.message;
  }
}

TEST(MaterialTree, AFormatThatLosesTheTreeIsCaught) {
  Subject subject(std::make_shared<MaterialTree>(*tree(Kind::mask, {leaf("phong")}, 0.123456)));
  EXPECT_TRUE(check_round_trip(subject, Effort::quick, 1e-7).passed);
  tree_round_trips().emplace_back("short", [](const MaterialNode& root) {
    auto copy = std::make_shared<MaterialNode>(root);
    copy->weight.value.fill(0.1234);
    return copy;
  });
  Outcome outcome = check_round_trip(subject, Effort::quick, 1e-7);
  tree_round_trips().pop_back();
  EXPECT_FALSE(outcome.passed);
}

} // namespace
