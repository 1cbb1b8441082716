// Materials to JSON and back: the same numbers bit for bit, the same names; everything else is
// refused with a reason.
#include "formats/material_json.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace faceta {
namespace {

std::string refusal(const std::string& text) {
  try {
    parse_material_json(text, "m.json");
  } catch (const Error& e) {
    return e.what();
  }
  return "accepted";
}

TEST(MaterialJson, EveryModelAndExemplarComesBack) {
  size_t count = 0;
  for (const auto& model : Registry::global().models())
    for (const Exemplar& exemplar : model->descriptor.exemplars) {
      SCOPED_TRACE(model->name() + " / " + exemplar.name);
      Parameters given = make_parameters(model->name(), exemplar.settings);
      Parameters back = through_json(given);
      EXPECT_EQ(&given.model(), &back.model());
      EXPECT_EQ(given.slots(), back.slots());
      EXPECT_EQ(given.choices(), back.choices());
      for (const ParamInfo& p : model->descriptor.params) {
        EXPECT_EQ(given.was_set(p.name), back.was_set(p.name)) << p.name;
        EXPECT_EQ(given.given_name(p.name), back.given_name(p.name)) << p.name;
      }
      ++count;
    }
  EXPECT_GT(count, 30u);
}

TEST(MaterialJson, HasTheFormThatIsDocumented) {
  Parameters p = make_parameters("roughconductor", {{"material", "Au"},
                                                    {"alpha", "0.15"},
                                                    {"specular_reflectance", "1,0.5,0.25"},
                                                    {"distribution", "ggx"},
                                                    {"energy_compensation", "true"}});
  EXPECT_EQ(nlohmann::json::parse(write_material_json(p)), nlohmann::json::parse(R"({
    "model": "roughconductor", "parameters": {"material": "Au", "alpha": 0.15,
    "specular_reflectance": [1, 0.5, 0.25], "distribution": "ggx", "energy_compensation": true}})"));
  Parameters grey =
      parse_material_json(R"({"model": "diffuse", "parameters": {"reflectance": 0.3}})");
  EXPECT_EQ(grey.slots(), (std::vector<double>{0.3, 0.3, 0.3}));
  EXPECT_EQ(parse_material_json(R"({"model": "diffuse"})").text("reflectance"), "0.5,0.5,0.5");
}

TEST(MaterialJson, NumbersKeepEveryBit) {
  Parameters p = make_parameters("roughconductor", {});
  for (double value : {0.1, 1.0 / 3, 5e-324, 0x1.fffffffffffffp-1}) {
    p.set_color("specular_reflectance", {value, 1 - value, 0.7});
    EXPECT_EQ(through_json(p).slots(), p.slots());
  }
  p.set_color("specular_reflectance", {1.5, 2, 0}, {}, AboveRange::keep); // a scene may
  EXPECT_EQ(through_json(p).slots(), p.slots());
}

TEST(MaterialJson, WhatIsWrongIsSaid) {
  auto has = [](const std::string& text, const std::string& words) {
    std::string said = refusal(text);
    EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
  };
  has("{\n  \"model\": \"diffuse\",\n  oh}", "m.json:3:3: error: not JSON");
  has("", "m.json:1:1: error: not JSON");
  has("[1]", "no material");
  has(R"({"model": 3})", "no material");
  has(R"({"model": "difuse"})", "did you mean 'diffuse'");
  has(R"({"model": "diffuse", "reflectance": 1})", "unknown key 'reflectance'");
  has(R"({"model": "diffuse", "parameters": []})", "'parameters' is no object");
  has(R"({"model": "diffuse", "parameters": {"reflectance": 1, "reflectance": 0.5}})",
      "'reflectance' is given twice");
  has(R"({"model": "diffuse", "parameters": {"reflectanse": 1}})", "did you mean 'reflectance'");
  has(R"({"model": "diffuse", "parameters": {"reflectance": [1, 2]}})", "has 2 numbers");
  has(R"({"model": "diffuse", "parameters": {"reflectance": [1, 0, null]}})", "null");
  has(R"({"model": "diffuse", "parameters": {"reflectance": -0.5}})", "outside its range");
  has(R"({"model": "diffuse", "parameters": {"reflectance": true}})", "no flag");
  has(R"({"model": "diffuse", "parameters": {"reflectance": {}}})", "{}");
  has(R"({"model": "roughconductor", "parameters": {"alpha": 1e999}})", "not JSON");
  has(R"({"model": "roughconductor", "parameters": {"alpha": [1, 1, 1]}})", "not a colour");
  has(R"({"model": "roughconductor", "parameters": {"sample_visible": 1}})", "true or false");
  has(R"({"model": "roughconductor", "parameters": {"distribution": "gxx"}})",
      "did you mean 'ggx'");
  has(R"({"model": "roughconductor", "parameters": {"alpha": 1, "alpha_u": 1, "alpha_v": 1}})",
      "exclude each other");
  EXPECT_NE(refusal(std::string(100000, '[')), "accepted");
}

} // namespace
} // namespace faceta
