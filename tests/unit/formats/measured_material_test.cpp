// Measured files as materials of scenes: names, errors with their place, one table in memory.

#include "formats/measured_loader.h"
#include "formats/measured_merl.h"
#include "formats/mitsuba_scene.h"
#include "materials/measured_demo.h"
#include "scene/materials.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

namespace faceta {
namespace {

namespace fs = std::filesystem;

/// A MERL file of a grey Lambertian surface in a folder of its own.
class MeasuredMaterial : public ::testing::Test {
protected:
  void SetUp() override {
    load_measured_files();
    folder_ = fs::temp_directory_path() / ("faceta-measured-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("grey.binary", 0.5 / kPi);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, double value) {
    std::ofstream out(folder_ / name, std::ios::binary);
    const int32_t dims[3] = {9, 9, 18};
    out.write(reinterpret_cast<const char*>(dims), sizeof dims);
    for (double scale : {1.0, 1.15, 1.66})
      for (int k = 0; k < 9 * 9 * 18; ++k) {
        double raw = value * 1500 / scale;
        out.write(reinterpret_cast<const char*>(&raw), sizeof raw);
      }
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::shared_ptr<MaterialNode> read(const std::string& bsdf, Scene* scene = nullptr) {
    std::string text = "<scene version='3.0.0'>\n" + bsdf + "\n</scene>";
    std::ofstream(folder_ / "s.xml") << text;
    Scene own;
    auto materials = read_mitsuba_materials(path("s.xml"), scene ? *scene : own, {});
    return materials.at(0).second;
  }
  std::string error_of(const std::string& bsdf) {
    try {
      read(bsdf);
    } catch (const Error& error) {
      std::string text = error.what();
      return text.substr(text.find("s.xml"));
    }
    return "no error";
  }

  fs::path folder_;
};

double value_of(const Parameters& p) {
  return p.model().eval(p.record(), {{0, 0, 1}, {0.6, 0, 0.8}}).value[1];
}

TEST_F(MeasuredMaterial, NamesOfScenes) {
  for (const char* type : {"measured", "merl"}) {
    auto node = read(std::string("<bsdf id='a' type='") + type +
                     "'><string name='filename' value='grey.binary'/></bsdf>");
    EXPECT_EQ(node->parameters->model().name(), "measured");
    EXPECT_NEAR(value_of(*node->parameters), 0.5 / kPi * 0.8, 1e-6) << type;
  }
  EXPECT_EQ(error_of("<bsdf id='a' type='rgl'><string name='filename' value='grey.binary'/></bsdf>")
                .find("s.xml:2:25: error: "),
            0u);
  EXPECT_NE(error_of("<bsdf id='a' type='rgl'><string name='filename' value='grey.binary'/></bsdf>")
                .find("the file is of format 'merl', not 'rgl'"),
            std::string::npos);
  auto polarized = read("<bsdf id='a' type='measured_polarized'><string name='filename' "
                        "value='grey.binary'/><float name='alpha_sample' value='.2'/></bsdf>");
  EXPECT_NEAR(value_of(*polarized->parameters), 0.5 / kPi * 0.8, 1e-6);
  EXPECT_NE(error_of("<bsdf id='a' type='measured_polarized'><string name='filename' "
                     "value='grey.binary'/><string name='alpha_sample' value='x'/></bsdf>")
                .find("'alpha_sample'"),
            std::string::npos);
}

TEST_F(MeasuredMaterial, TintAndScale) {
  auto node = read("<bsdf id='a' type='measured'><string name='filename' value='grey.binary'/>"
                   "<rgb name='tint' value='1,.5,.25'/><float name='scale' value='.5'/></bsdf>");
  EXPECT_NEAR(value_of(*node->parameters), 0.25 * 0.5 / kPi * 0.8, 1e-6);
  Scene scene;
  auto textured = read("<bsdf id='a' type='twosided'><bsdf type='measured'>"
                       "<string name='filename' value='grey.binary'/>"
                       "<texture type='checkerboard' name='tint'/>"
                       "<texture type='checkerboard' name='scale'/></bsdf></bsdf>",
                       &scene);
  EXPECT_EQ(textured->children[0]->textures.size(), 2u);
  EXPECT_NO_THROW(scene.add_material(textured));
}

TEST_F(MeasuredMaterial, ErrorsHaveTheirPlace) {
  EXPECT_EQ(error_of("<bsdf id='a' type='measured'/>").find("s.xml:2:1: error: 'measured' needs"),
            0u);
  EXPECT_EQ(
      error_of("<bsdf id='a' type='measured'><string name='filename' value='no.file'/></bsdf>")
          .find("s.xml:2:30: error: file 'no.file' was not found"),
      0u);
  std::ofstream(folder_ / "bad.txt") << "words\n";
  EXPECT_NE(
      error_of("<bsdf id='a' type='measured'><string name='filename' value='bad.txt'/></bsdf>")
          .find("not a file of measured reflectance"),
      std::string::npos);
  // Cut short: an error that says so, not a crash.
  fs::resize_file(folder_ / "grey.binary", 20000);
  EXPECT_EQ(
      error_of("<bsdf id='a' type='merl'><string name='filename' value='grey.binary'/></bsdf>")
          .find("s.xml:2:26: error: "),
      0u);
}

TEST_F(MeasuredMaterial, OneTableInMemory) {
  auto tables = [&](const Settings& settings) {
    return make_parameters("measured", settings).record().file;
  };
  auto first = tables({{"filename", path("grey.binary")}});
  EXPECT_EQ(first, tables({{"filename", path("grey.binary")}, {"scale", "0.5"}}));
  EXPECT_EQ(first, tables({{"filename", (folder_ / "." / "grey.binary").string()}}));
  EXPECT_NE(first, tables({{"filename", path("grey.binary")}, {"merl_nodes", "edges"}}));
  // A thousand materials of one file are one table in a scene too.
  TextureStore textures;
  MaterialStore store;
  for (int k = 0; k < 1000; ++k) {
    MaterialNode node;
    node.kind = MaterialNode::Kind::model;
    node.parameters = std::make_shared<Parameters>(make_parameters(
        "measured", {{"filename", path("grey.binary")}, {"scale", std::to_string(k * 1e-3)}}));
    store.add(node, textures);
  }
  store.build(best_isa());
  EXPECT_EQ(store.programs().size(), 1u);
  EXPECT_EQ(store.programs()[0].tables, first->values.data());
  EXPECT_LT(store.bytes(), first->values.size() * 4 + 300000);
  // A file that has changed is read again.
  write("grey.binary", 0.25 / kPi);
  fs::last_write_time(folder_ / "grey.binary",
                      fs::last_write_time(folder_ / "grey.binary") + std::chrono::seconds(2));
  Parameters again = make_parameters("measured", {{"filename", path("grey.binary")}});
  EXPECT_NEAR(value_of(again), 0.25 / kPi * 0.8, 1e-6);
}

TEST_F(MeasuredMaterial, NamesOfTheCommandLine) {
  NamedModel file = model_or_file(path("grey.binary"), {{"scale", "2"}});
  EXPECT_EQ(file.model->name(), "measured");
  EXPECT_NEAR(value_of(parameters_of(file)), 1 / kPi * 0.8, 1e-5);
  EXPECT_EQ(model_or_file("demo:shade", {}).model->name(), "measuredwindow");
  EXPECT_EQ(model_or_file("diffuse", {}).model->name(), "diffuse");
  EXPECT_THROW(model_or_file(path("nothing"), {}), Error);
}

} // namespace
} // namespace faceta
