#pragma once

#include "formats/material_xml.h"
#include "formats/mitsuba_scene.h"
#include "xml_test_tools.h"

#include <gtest/gtest.h>

namespace faceta {

inline const std::string kRenderable = "<integrator type='path'/><sensor type='perspective'/>";

inline std::unique_ptr<Scene> read_text(const std::string& body, const ReadOptions& options = {}) {
  return read_mitsuba_scene_string(xml::scene(body), "s.xml", options);
}

/// A scene of these objects, with an integrator and a sensor behind them (so that columns count
/// from `<scene version="3.0.0">`, 23 characters).
inline std::unique_ptr<Scene> read_objects(const std::string& body,
                                           const ReadOptions& options = {}) {
  return read_text(body + kRenderable, options);
}

/// what() of the Error that reading these objects throws; a test failure if there is none.
inline std::string objects_error(const std::string& body) {
  return xml::error_in([&] { read_objects(body); });
}

/// The bsdf with the attributes and children in `text`, as in `type='diffuse'>...`.
inline std::shared_ptr<MaterialNode> read_bsdf(const std::string& text) {
  return find_material(*read_objects("<bsdf id='m' " + text + "</bsdf>"), "m");
}

inline std::string bsdf_error(const std::string& text) {
  return objects_error("<bsdf id='m' " + text + "</bsdf>");
}

/// The numbers of a parameter: one, or three for a colour.
inline std::vector<double> numbers(const MaterialNode& material, const std::string& name) {
  const Parameters& p = *material.parameters;
  const ParamInfo& info = *p.descriptor().find(name);
  return {p.slots().begin() + info.slot, p.slots().begin() + info.slot + info.slots};
}

inline void expect_near(const std::vector<double>& actual, const std::vector<double>& expected,
                        double relative = 2e-6) {
  ASSERT_EQ(actual.size(), expected.size());
  for (size_t i = 0; i < actual.size(); ++i)
    EXPECT_NEAR(actual[i], expected[i], relative * (std::abs(expected[i]) + 1e-3)) << i;
}

inline bool shared_data_is_here() {
  return std::filesystem::exists(FACETA_SHARED_DATA);
}

} // namespace faceta
