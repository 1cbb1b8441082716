// Textures of scene files. Numbers called Mitsuba's were read off Mitsuba 3.9.1 (scalar_rgb).
#include "image/io.h"
#include "mitsuba_test_tools.h"

namespace faceta {
namespace {

/// Two by two grey texels: 10, 200, 100, 50 of 255.
class MitsubaTexture : public testing::Test {
protected:
  MitsubaTexture() {
    // A PNG written from linear light comes back as the same bytes.
    Image image(2, 2);
    const double codes[] = {10, 200, 100, 50};
    for (int i = 0; i < 4; ++i)
      for (int c = 0; c < 3; ++c) {
        double s = codes[i] / 255;
        image.at(i % 2, i / 2, c) =
            static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
      }
    file_ = (folder_ / "t.png").string();
    write_image(file_, image);
    write_image(folder_ / "t.exr", image);
  }

  /// A bitmap as the reflectance of a diffuse sphere.
  std::string bitmap(const std::string& properties, const std::string& name = "reflectance") const {
    return "<texture type='bitmap' name='" + name + "'><string name='filename' value='" + file_ +
           "'/>" + properties + "</texture>";
  }
  static std::string sphere(const std::string& texture) {
    return "<shape type='sphere'><bsdf type='diffuse'>" + texture + "</bsdf></shape>";
  }
  std::unique_ptr<Scene> built(const std::string& objects) const {
    auto scene = read_objects(objects);
    scene->build(Isa::scalar);
    return scene;
  }
  const TextureView& view(const std::string& texture) {
    scenes_.push_back(built(sphere(texture)));
    return scenes_.back()->view().textures[scenes_.back()->statistics().textures - 1];
  }
  std::string error(const std::string& texture) const { return objects_error(sphere(texture)); }

  xml::TemporaryFolder folder_;
  std::string file_;
  std::vector<std::unique_ptr<Scene>> scenes_;
};

TEST_F(MitsubaTexture, BitmapDefaults) {
  const TextureView& t = view(bitmap(""));
  EXPECT_EQ(t.type, TextureType::bitmap8);
  EXPECT_EQ(t.width, 2);
  EXPECT_EQ(t.height, 2);
  EXPECT_EQ(t.wrap, WrapMode::repeat);
  EXPECT_EQ(t.nearest, 0);
  EXPECT_EQ(t.srgb, 1);
  EXPECT_EQ(t.texels8[0] & 255, 10u);
  EXPECT_EQ(t.texels8[1] & 255, 200u); // row 0 is v = 0, no flip
  EXPECT_EQ(t.texels8[4] & 255, 100u);
  const float identity[] = {1, 0, 0, 0, 1, 0};
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(t.to_uv[i], identity[i]);
}

TEST_F(MitsubaTexture, BitmapOptions) {
  EXPECT_EQ(view(bitmap("<string name='wrap_mode' value='mirror'/>")).wrap, WrapMode::mirror);
  EXPECT_EQ(view(bitmap("<string name='wrap_mode' value='clamp'/>")).wrap, WrapMode::clamp);
  EXPECT_EQ(view(bitmap("<string name='filter_type' value='nearest'/>")).nearest, 1);
  EXPECT_EQ(view(bitmap("<boolean name='raw' value='true'/>")).srgb, 0);
  for (const char* format : {"auto", "variant", "float16", "fp16", "uint8"})
    EXPECT_EQ(view(bitmap(std::string("<boolean name='accel' value='false'/>"
                                      "<string name='format' value='") +
                          format + "'/>"))
                  .width,
              2);
  EXPECT_HAS(error(bitmap("<string name='wrap_mode' value='Clamp'/>")),
             "'wrap_mode' of texture of type 'bitmap' cannot be 'Clamp' (did you mean 'clamp'?");
  EXPECT_HAS(error(bitmap("<string name='filter_type' value='trilinear'/>")),
             "cannot be 'trilinear'");
  EXPECT_HAS(error(bitmap("<string name='format' value='foo'/>")), "cannot be 'foo'");
  EXPECT_HAS(error(bitmap("<float name='gamma' value='1'/>")), "unexpected property 'gamma'");
  EXPECT_HAS(error("<texture type='bitmap' name='reflectance'/>"), "needs a string 'filename'");
  EXPECT_HAS(error("<texture type='bitmap' name='reflectance'>"
                   "<string name='filename' value='nope.png'/></texture>"),
             "s.xml:1:108: error: file 'nope.png' was not found");
  file_ = (folder_ / "t.exr").string();
  EXPECT_EQ(view(bitmap("")).type, TextureType::bitmap_float);
  EXPECT_HAS(error(bitmap("<string name='format' value='uint8'/>")), "not supported yet");
}

TEST_F(MitsubaTexture, PlacementIsTheMatrixItself) {
  // Mitsuba's to_uv for these transforms
  const TextureView& a =
      view(bitmap("<transform name='to_uv'><scale value='2'/><translate value='-.5,-.5,0'/>"
                  "</transform>"));
  const float expected[] = {2, 0, -0.5f, 0, 2, -0.5f};
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(a.to_uv[i], expected[i]);
  const TextureView& b = view(bitmap("<transform name='to_uv'><matrix value='1 2 3 4 5 6 7 8 9 10 "
                                     "11 12 0 0 0 1'/></transform>"));
  const float rows[] = {1, 2, 4, 5, 6, 8};
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(b.to_uv[i], rows[i]);
  EXPECT_HAS(error(bitmap("<transform name='to_uv'><scale value='inf'/></transform>")),
             "'to_uv' of texture of type 'bitmap' is not finite");
}

TEST_F(MitsubaTexture, Checkerboard) {
  const TextureView& t = view("<texture type='checkerboard' name='reflectance'/>");
  EXPECT_EQ(t.type, TextureType::checkerboard);
  EXPECT_EQ(t.color[0][0], 0.4f);
  EXPECT_EQ(t.color[1][2], 0.2f);
  EXPECT_EQ(t.child[0], -1);
  const TextureView& nested =
      view("<texture type='checkerboard' name='reflectance'><rgb name='color0' value='.1,.2,.3'/>" +
           bitmap("", "color1") + "</texture>");
  EXPECT_EQ(nested.color[0][2], 0.3f);
  EXPECT_EQ(nested.child[0], -1);
  EXPECT_EQ(nested.child[1], 0);
  EXPECT_EQ(view("<texture type='checkerboard' name='reflectance'>"
                 "<float name='color0' value='2'/></texture>")
                .color[0][0],
            2.0f); // a float is kept, as in Mitsuba
  EXPECT_HAS(error("<texture type='checkerboard' name='reflectance'>"
                   "<rgb name='color0' value='2'/></texture>"),
             "is no reflectance");
}

TEST_F(MitsubaTexture, CheckerboardOfNumbersSwapsItsColours) {
  // Mitsuba 3.9.1 at uv (.1, .1): eval 0.4, eval_1 (what alpha and opacity use) 0.2; colours
  // .1,.2,.3 and .2 give an eval_1 of 0.2 at both places (the mean).
  auto scene = built("<shape type='sphere'><bsdf type='roughconductor'>"
                     "<texture id='t' type='checkerboard' name='alpha'/>"
                     "<ref id='t' name='specular_reflectance'/></bsdf></shape>"
                     "<shape type='sphere'><bsdf type='mask'><texture type='checkerboard' "
                     "name='opacity'><rgb name='color0' value='.1,.2,.3'/></texture>"
                     "<bsdf type='diffuse'/></bsdf></shape>");
  ASSERT_EQ(scene->statistics().textures, 3u);
  const TextureView *colour = nullptr, *alpha = nullptr, *opacity = nullptr;
  for (int i = 0; i < 3; ++i) {
    const TextureView& t = scene->view().textures[i];
    if (t.color[0][0] == 0.4f && t.color[1][0] == 0.2f)
      colour = &t;
    if (t.color[0][0] == 0.2f && t.color[1][0] == 0.4f)
      alpha = &t;
    if (t.color[0][0] == 0.2f && std::abs(t.color[1][0] - 0.2f) < 1e-6f)
      opacity = &t;
  }
  ASSERT_TRUE(colour && alpha && opacity);
  EXPECT_EQ(opacity->color[1][0], opacity->color[1][2]);
}

TEST_F(MitsubaTexture, EqualTexturesAreOne) {
  auto scene = read_objects(sphere(bitmap("")) + sphere(bitmap("")) +
                            sphere(bitmap("<boolean name='raw' value='true'/>")) +
                            sphere(bitmap("<string name='format' value='variant'/>")) +
                            "<texture type='checkerboard' id='c'/>" +
                            sphere("<ref id='c' name='reflectance'/>"));
  scene->build(Isa::scalar);
  EXPECT_EQ(scene->statistics().textures, 3u);
  EXPECT_EQ(scene->statistics().materials, 3u);
}

TEST_F(MitsubaTexture, SpectraThatDoNotFit) {
  auto spectrum = [&](const std::string& text) {
    return error("<spectrum name='reflectance' " + text + "</spectrum>");
  };
  EXPECT_HAS(spectrum("type='blackbody'><float name='temperature' value='3000'/>"),
             "spectrum 'blackbody' is not supported yet");
  EXPECT_HAS(spectrum("type='unifrom'>"), "unknown spectrum 'unifrom' (did you mean 'uniform'?");
  EXPECT_HAS(spectrum("type='d65'><float name='value' value='2'/>"), "unexpected property 'value'");
  EXPECT_HAS(spectrum("type='uniform'>"), "needs a float 'value'");
  EXPECT_HAS(spectrum("type='irregular'><string name='wavelengths' value='400,500'/>"
                      "<string name='values' value='1'/>"),
             "as many values as wavelengths, and at least 2; there are 1 and 2");
  EXPECT_HAS(spectrum("type='irregular'><string name='wavelengths' value='500,400'/>"
                      "<string name='values' value='1,1'/>"),
             "s.xml:1:");
  EXPECT_HAS(spectrum("type='regular'><float name='wavelength_min' value='400'/>"
                      "<float name='wavelength_max' value='700'/>"
                      "<string name='values' value='1'/>"),
             "at least 2");
  EXPECT_HAS(spectrum("type='rawconstant'><rgb name='value' value='1'/>"), "must be a float");
  EXPECT_HAS(error("<spectrum name='reflectance' value='400:-1, 500:inf'/>"), "s.xml:1:");
  EXPECT_HAS(xml::error_in([] {
               parse_material("<bsdf version='3.0.0' type='diffuse'><texture "
                              "type='checkerboard' name='reflectance'/></bsdf>");
             }),
             "without a scene");
}

} // namespace
} // namespace faceta
