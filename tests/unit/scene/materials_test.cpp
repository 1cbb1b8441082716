#include "base/error.h"
#include "test_models.h"

#include <gtest/gtest.h>

using namespace faceta;
using Kind = MaterialNode::Kind;
using test::leaf;
using test::Node;
using test::tree;

namespace {

constexpr int32_t kBoth = kFrontSide | kBackSide;

struct Flattened {
  explicit Flattened(const std::vector<Node>& roots) {
    for (const Node& node : roots)
      numbers.push_back(scene.add_material(node));
    // A triangle each tells which final root a material became.
    for (int number : numbers) {
      ShapeDesc shape;
      shape.material = number;
      scene.add_mesh(make_rectangle(), shape);
    }
    scene.build(Isa::scalar);
    view = &scene.view();
  }
  int root_of(int material) const { return view->triangles[2 * material].material; }
  const RootView& root(int material) const { return view->roots[root_of(material)]; }
  const ClassView& class_of(int material) const {
    return view->classes[root(material).class_index];
  }
  const LeafView& leaf(int material, int i) const {
    return view->leaves[root(material).first_leaf + i];
  }
  /// What the kernels make of the weights of a leaf, constants only.
  double weight(int material, int i) const {
    const LeafView& l = leaf(material, i);
    double product = 1;
    for (int k = 0; k < l.weights; ++k) {
      const WeightView& w = view->weights[l.first_weight + k];
      product *= w.complement ? 1 - w.constant : w.constant;
    }
    return product;
  }

  Scene scene;
  std::vector<int> numbers;
  const SceneView* view;
};

TEST(Materials, SimpleLeafScattersOnBothSidesUnmirrored) {
  Flattened f({leaf(test::glass())});
  EXPECT_EQ(f.root(0).leaves, 1);
  EXPECT_EQ(f.leaf(0, 0).sides, kBoth);
  EXPECT_EQ(f.leaf(0, 0).mirrored, 0);
  EXPECT_EQ(f.class_of(0).single, 1);
  EXPECT_EQ(f.view->programs[f.leaf(0, 0).program].delta_only, 1);
}

TEST(Materials, TwosidedMirrorsOneChildAndSplitsTwo) {
  Flattened f({tree(Kind::twosided, {leaf(test::glossy())}),
               tree(Kind::twosided, {leaf(test::glossy()), leaf(test::mirror())})});
  EXPECT_EQ(f.root(0).leaves, 1);
  EXPECT_EQ(f.leaf(0, 0).sides, kBoth);
  EXPECT_EQ(f.leaf(0, 0).mirrored, 1);
  ASSERT_EQ(f.root(1).leaves, 2);
  EXPECT_EQ(f.leaf(1, 0).sides, kFrontSide);
  EXPECT_EQ(f.leaf(1, 0).mirrored, 0);
  EXPECT_EQ(f.leaf(1, 1).sides, kBackSide);
  EXPECT_EQ(f.leaf(1, 1).mirrored, 1);
  EXPECT_EQ(f.view->programs[f.leaf(1, 1).program].delta_only, 1);
}

TEST(Materials, TwosidedInsideTwosidedShowsItsFront) {
  Node inner = tree(Kind::twosided, {leaf(test::glossy()), leaf(test::mirror())});
  Flattened f({tree(Kind::twosided, {inner})});
  ASSERT_EQ(f.root(0).leaves, 1);
  EXPECT_EQ(f.leaf(0, 0).sides, kBoth);
  EXPECT_EQ(f.leaf(0, 0).mirrored, 1);
  EXPECT_EQ(f.view->programs[f.leaf(0, 0).program].delta_only, 0);
}

TEST(Materials, WeightsMultiplyAlongTheTree) {
  Node blend = tree(Kind::blend, {leaf(test::glossy()), leaf(test::mirror())}, 0.3);
  Flattened f({tree(Kind::mask, {blend}, 0.6)});
  ASSERT_EQ(f.root(0).leaves, 3);
  EXPECT_NEAR(f.weight(0, 0), 0.6 * 0.7, 1e-6);
  EXPECT_NEAR(f.weight(0, 1), 0.6 * 0.3, 1e-6);
  EXPECT_NEAR(f.weight(0, 2), 0.4, 1e-6);
  EXPECT_EQ(f.leaf(0, 2).program, -1);
  EXPECT_EQ(f.leaf(0, 2).sides, kBoth);
  EXPECT_EQ(f.class_of(0).single, 0);
}

TEST(Materials, SharesOfNothingVanish) {
  Flattened f({tree(Kind::mask, {leaf(test::glossy())}, 1.5), // clamped, as in Mitsuba
               tree(Kind::mask, {leaf(test::glossy())}, 0),
               tree(Kind::blend, {leaf(test::glossy()), leaf(test::mirror())}, 1)});
  EXPECT_EQ(f.class_of(0).single, 1);
  EXPECT_GE(f.leaf(0, 0).program, 0);
  EXPECT_EQ(f.class_of(1).single, 1);
  EXPECT_EQ(f.leaf(1, 0).program, -1);
  EXPECT_EQ(f.view->programs[f.leaf(2, 0).program].delta_only, 1);
}

TEST(Materials, RootsOfAClassAreAdjacent) {
  Node two = leaf(test::glossy());
  two->parameters->set("kind", "two");
  Node big = leaf(test::glossy());
  big->parameters->set("size", "3");
  Node blend = tree(Kind::blend, {leaf(test::glossy()), leaf(test::mirror())});
  Flattened f({leaf(test::glossy()), blend, two, leaf(test::glass()),
               tree(Kind::twosided, {leaf(test::glossy())}), big, blend, leaf(test::glossy())});
  EXPECT_EQ(f.view->root_count, 8);
  int next = 0;
  for (int c = 0; c < f.view->class_count; ++c) {
    EXPECT_EQ(f.view->classes[c].first_root, next);
    for (int i = 0; i < f.view->classes[c].roots; ++i)
      EXPECT_EQ(f.view->roots[next++].class_index, c);
  }
  EXPECT_EQ(next, 8);
  // glossy "one" thrice, "two", glass, twosided, and each tree for itself.
  EXPECT_EQ(f.view->class_count, 6);
  EXPECT_EQ(f.class_of(0).roots, 3);
  EXPECT_EQ(f.root(0).class_index, f.root(5).class_index);
  EXPECT_EQ(f.root(0).class_index, f.root(7).class_index);
  EXPECT_NE(f.root_of(0), f.root_of(7));
  EXPECT_NE(f.root(1).class_index, f.root(6).class_index);
  EXPECT_EQ(f.root(5).row, f.leaf(5, 0).row);
}

TEST(Materials, RecordsHoldParametersAndRebasedTables) {
  Node big = leaf(test::glossy());
  big->parameters->set("size", "3");
  big->parameters->set("tint", "0.1,0.2,0.6");
  Flattened f({leaf(test::glossy()), big});
  const Descriptor& d = test::glossy().descriptor;
  ASSERT_EQ(d.table_slots, std::vector<int>{3});
  const ProgramView& p = f.view->programs[f.leaf(1, 0).program];
  const float* record = p.records + f.leaf(1, 0).row * p.stride;
  EXPECT_EQ(p.stride, d.slots);
  EXPECT_FLOAT_EQ(record[2], 0.6f);
  EXPECT_FLOAT_EQ(record[d.find("size")->slot], 3);
  EXPECT_FLOAT_EQ(record[d.slots - 1], 0.3f);
  EXPECT_FLOAT_EQ(p.tables[int(record[3])], 3);
  EXPECT_FLOAT_EQ(p.tables[int(record[3]) + 1], 4);
  EXPECT_NE(record[3], p.records[f.leaf(0, 0).row * p.stride + 3]);
}

TEST(Materials, TexturesMakeProgramsOfTheirOwn) {
  Scene scene;
  TextureDesc desc;
  desc.color[0] = {0.9, 0.3, 0.3};
  int red = scene.add_texture(desc);
  Node a = leaf(test::glossy()), b = leaf(test::glossy());
  a->textures = {{"alpha", red}, {"tint", red}};
  b->textures = {{"size", red}};
  ShapeDesc shape;
  shape.material = scene.add_material(a);
  scene.add_mesh(make_rectangle(), shape);
  shape.material = scene.add_material(b);
  scene.add_mesh(make_rectangle(), shape);
  scene.build(Isa::scalar);
  const SceneView& view = scene.view();
  const RootView& root = view.roots[view.triangles[0].material];
  const ProgramView& p = view.programs[view.leaves[root.first_leaf].program];
  const Descriptor& d = test::glossy().descriptor;
  int alpha = d.find("alpha")->slot;
  ASSERT_EQ(p.texture_slots, 3);
  EXPECT_EQ(p.slots[0].slot, 0);
  EXPECT_EQ(p.slots[0].count, 3);
  EXPECT_EQ(p.slots[1].slot, alpha);
  EXPECT_EQ(p.slots[1].count, 1);
  EXPECT_EQ(p.slots[2].slot, alpha + 1);
  EXPECT_EQ(p.textured, uint64_t(7) | uint64_t(3) << alpha);
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(p.textures[root.row * 3 + k], red);
  // Derived numbers come from the mean; scalars take its luminance.
  EXPECT_FLOAT_EQ(p.records[root.row * p.stride + d.slots - 1], 0.5f);
  EXPECT_NEAR(p.records[root.row * p.stride + alpha], 0.3 + 0.6 * 0.212671, 1e-4);
  EXPECT_NE(view.triangles[2].material, view.triangles[0].material);
}

TEST(Materials, RefuseWhatCannotBe) {
  Scene scene;
  auto add = [&](const Node& node) { scene.add_material(node); };
  EXPECT_THROW(add(tree(Kind::twosided, {leaf(test::glass())})), Error);
  EXPECT_THROW(add(tree(Kind::twosided, {tree(Kind::mask, {leaf(test::glossy())})})), Error);
  EXPECT_THROW(add(tree(Kind::twosided, {tree(Kind::null, {})})), Error);
  EXPECT_THROW(add(tree(Kind::twosided, {})), Error);
  EXPECT_THROW(add(tree(Kind::blend, {leaf(test::glossy())})), Error);
  EXPECT_THROW(add(tree(Kind::blend, {leaf(test::glossy()), nullptr})), Error);
  EXPECT_THROW(add(tree(Kind::model, {})), Error);
  Node textured = leaf(test::glass());
  textured->textures = {{"eta", 0}};
  EXPECT_THROW(add(textured), Error); // no such texture
  scene.add_texture({});
  EXPECT_THROW(add(textured), Error); // not a parameter for textures
  // 2^20 leaves from 20 shared nodes: an error, and at once.
  Node node = leaf(test::glossy());
  for (int i = 0; i < 20; ++i)
    node = tree(Kind::blend, {node, node});
  EXPECT_THROW(add(node), Error);
  node = leaf(test::glossy());
  for (int i = 0; i < 40; ++i)
    node = tree(Kind::twosided, {node});
  EXPECT_THROW(add(node), Error);
}

TEST(Materials, NeedKernelsOfTheInstructionSet) {
  Scene scene;
  scene.add_material(leaf(test::glossy()));
  EXPECT_THROW(scene.build(Isa::v4), Error); // the test models have none
  Scene shapeless;
  EXPECT_THROW(shapeless.add_mesh(make_rectangle(), {}), Error);
}

} // namespace
