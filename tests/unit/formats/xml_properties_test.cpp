// Values of properties. Accepted and refused spellings, and the matrices, were read off Mitsuba
// 3.9.1 (its parser keeps doubles), unless a comment says that we differ.
#include "xml_test_tools.h"

#include <cmath>
#include <limits>

namespace faceta::xml {
namespace {

double parse_float(const std::string& text) {
  return parse_bsdf("<float name=\"a\" value=\"" + text + "\"/>")->get_float("a");
}

TEST(XmlFloat, AcceptedSpellings) {
  EXPECT_EQ(parse_float("1.5"), 1.5);
  EXPECT_EQ(parse_float("+1.5"), 1.5);
  EXPECT_EQ(parse_float(".5"), 0.5);
  EXPECT_EQ(parse_float("5."), 5.0);
  EXPECT_EQ(parse_float("1e3"), 1000.0);
  EXPECT_EQ(parse_float(" 1&#10;"), 1.0);
  EXPECT_EQ(parse_float("0.1"), 0.1);
  EXPECT_TRUE(std::signbit(parse_float("-0")));
  EXPECT_EQ(parse_float("1e400"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_float("-1e400"), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_float("1e-400"), 0.0);
  EXPECT_EQ(parse_float("4.9406564584124654e-324"), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(parse_float("inf"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_float("-Infinity"), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(parse_float("NaN")));
}

TEST(XmlFloat, RefusedSpellings) {
  for (const char* text : {"1 2", "1x", "0x10", "1,", "1f", "1e", "--1", "nan(1)"})
    EXPECT_HAS(error_of(bsdf(std::string("<float name='a' value='") + text + "'/>")),
               std::string("'") + text + "' is not a number");
  // Mitsuba reads these as 0 and -1
  EXPECT_HAS(error_of(bsdf("<float name='a' value=''/>")), "'' is not a number");
  EXPECT_HAS(error_of(bsdf("<float name='a' value='+-1'/>")), "is not a number");
}

TEST(XmlInteger, StrictAndRanged) {
  auto read = [](const std::string& text) {
    return parse_bsdf("<integer name=\"a\" value=\"" + text + "\"/>")
        ->get_integer64("a", 0, INT64_MIN, INT64_MAX);
  };
  EXPECT_EQ(read("-1"), -1);
  EXPECT_EQ(read(" 007 "), 7);
  EXPECT_EQ(read("9223372036854775807"), INT64_MAX);
  EXPECT_EQ(read("-9223372036854775808"), INT64_MIN);
  for (const char* text : {"+1", "1.0", "1e3", "0x10", "", "9223372036854775808", "1 2"})
    EXPECT_HAS(error_of(bsdf(std::string("<integer name='a' value='") + text + "'/>")),
               "is not an integer");

  NodePtr node = parse_bsdf("<integer name='big' value='9999999999'/>"
                            "<integer name='a' value='-3'/><float name='f' value='2'/>");
  EXPECT_EQ(node->get_integer("a"), -3);
  EXPECT_EQ(node->get_integer("none", 8), 8);
  EXPECT_HAS(error_in([&] { node->get_integer("big"); }),
             "s.xml:1:39: error: 'big' of bsdf of type 'x' is 9999999999, but must lie between "
             "-2147483648 and 2147483647");
  EXPECT_HAS(error_in([&] { node->get_integer("a", 0, 1); }), "must lie between 1 and");
  EXPECT_HAS(error_in([&] { node->get_integer("f"); }),
             "property 'f' of bsdf of type 'x' must be an integer, not a float");
}

TEST(XmlBoolean, TrueAndFalseInAnyCase) {
  for (const char* text : {"true", "TRUE", "True"})
    EXPECT_TRUE(
        parse_bsdf(std::string("<boolean name='a' value='") + text + "'/>")->get_boolean("a"));
  EXPECT_FALSE(parse_bsdf("<boolean name='a' value='falsE'/>")->get_boolean("a", true));
  for (const char* text : {"1", "yes", " true", ""})
    EXPECT_HAS(error_of(bsdf(std::string("<boolean name='a' value='") + text + "'/>")),
               "is not a boolean");
}

TEST(XmlVector, ListsSplitOnCommaAndSpace) {
  const Numbers3 expected = {1, 2, 3};
  for (const char* text : {"1,2,3", "1 2 3", "1, 2, 3", ",1,,2,3,", "1\t2\n3"}) {
    std::string value = std::string(" name=\"a\" value=\"") + text + "\"/>";
    EXPECT_EQ(parse_bsdf("<vector" + value)->get_vector("a"), expected) << text;
    EXPECT_EQ(parse_bsdf("<point" + value)->get_point("a"), expected) << text;
    EXPECT_EQ(parse_bsdf("<rgb" + value)->get_rgb("a"), expected) << text;
  }
  EXPECT_EQ(parse_bsdf("<vector name='a' value='2'/>")->get_vector("a"), (Numbers3{2, 2, 2}));
  EXPECT_EQ(parse_bsdf("<rgb name='a' value='2'/>")->get_rgb("a"), (Numbers3{2, 2, 2}));
  EXPECT_EQ(parse_bsdf("<point name='a' x='1' y='2' z='3'/>")->get_point("a"), expected);
  // literal tabs and line ends become spaces in attributes, character references do not
  for (const char* text : {"1&#10;2&#9;3", "1;2;3"})
    for (const char* tag : {"vector", "rgb"})
      EXPECT_HAS(error_of(bsdf(std::string("<") + tag + " name='a' value='" + text + "'/>")),
                 "is not a number");
  for (const char* text : {"1,2", "1,2,3,4", ""})
    for (const char* tag : {"vector", "point", "rgb"})
      EXPECT_HAS(error_of(bsdf(std::string("<") + tag + " name='a' value='" + text + "'/>")),
                 "needs 1 or 3 numbers");
  EXPECT_HAS(error_of(bsdf("<vector name='a' x='1' y='2'/>")), "needs the attribute 'z'");
  EXPECT_HAS(error_of(bsdf("<vector name='a' x='1' y='2' z='3' value='1'/>")),
             "both 'value' and 'x'");
  EXPECT_HAS(error_of(bsdf("<point x='1' y='2' z='3'/>")), "needs the attribute 'name'");
  EXPECT_HAS(error_of(bsdf("<rgb name='a' value='#ff0000'/>")), "hexadecimal");
}

TEST(XmlSpectrum, Values) {
  auto read = [](const std::string& text) {
    return parse_bsdf("<spectrum name=\"a\" value=\"" + text + "\"/>")->get_spectrum("a");
  };
  EXPECT_TRUE(read(" 0.5 ").is_uniform());
  EXPECT_EQ(read("0.5").values, std::vector<double>{0.5});
  for (const char* text : {"400:0.1, 700:0.2", "400:0.1,700:0.2", "400:0.1 700:0.2"}) {
    EXPECT_EQ(read(text).wavelengths, (std::vector<double>{400, 700}));
    EXPECT_EQ(read(text).values, (std::vector<double>{0.1, 0.2}));
    EXPECT_TRUE(read(text).is_regular());
  }
  EXPECT_TRUE(read("400:1 500:2 600.05:3").is_regular());
  EXPECT_FALSE(read("400:1 500:2 600.2:3").is_regular());
  for (const char* text : {"400:1", "400:1,", "inf:1"})
    EXPECT_HAS(error_of(bsdf(std::string("<spectrum name='a' value='") + text + "'/>")),
               "needs at least 2");
  for (const char* text : {"400:1 400:2", "500:1 400:2"})
    EXPECT_HAS(error_of(bsdf(std::string("<spectrum name='a' value='") + text + "'/>")),
               "must increase");
  for (const char* text : {"400:1 500", "400:1:2 500:3", "400 : 1, 500 : 2", "1 2", "400:1, 500:x",
                           "400:", "400:1;500:2"})
    EXPECT_HAS(error_of(bsdf(std::string("<spectrum name='a' value='") + text + "'/>")),
               "not a wavelength:value pair");
  EXPECT_HAS(error_of(bsdf("<spectrum name='a' value='a'/>")), "'a' is not a number");
  for (const char* text : {"", "value=''", "value='1' filename='f'"})
    EXPECT_HAS(error_of(bsdf(std::string("<spectrum name='a' ") + text + "/>")),
               "either 'value' or 'filename'");
}

TEST(XmlSpectrum, Files) {
  TemporaryFolder folder;
  ParseOptions options;
  options.search_paths = {folder / ""};
  std::vector<std::string> warnings;
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  auto read = [&](const std::string& text) {
    folder.write("s.spd", text);
    return parse_bsdf("<spectrum name='a' filename='s.spd'/>", options)->get_spectrum("a");
  };
  EXPECT_EQ(read("# c\n\n 400 1 # foo\n500\t2\r\n").values, (std::vector<double>{1, 2}));
  EXPECT_EQ(read("400 1\n500 2").wavelengths, (std::vector<double>{400, 500}));
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(read("400 1 3\n500 2\n").values, (std::vector<double>{1, 2}));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_HAS(warnings[0], "s.spd:1:1: warning: only the first two columns");
  auto refused = [&](const std::string& text) { return error_in([&] { read(text); }); };
  EXPECT_HAS(refused("400 1\n400,1\n"), "s.spd:2:1: error: not a line of a spectrum");
  EXPECT_HAS(refused("400\n500 2\n"), "s.spd:1:1");
  EXPECT_HAS(refused("abc\n"), "not a line of a spectrum");
  EXPECT_HAS(refused(""), "needs at least 2");
  EXPECT_HAS(refused("500 1\n400 2\n"), "must increase");
  EXPECT_HAS(error_of(bsdf("<spectrum name='a' filename='nofile.spd'/>"), options), "not found");
  EXPECT_HAS(error_of(bsdf("<spectrum name='a' filename='.'/>"), options), "is a folder");
}

void expect_transform(const std::string& operations, const Matrix4& expected) {
  Matrix4 read =
      parse_bsdf("<transform name='t'>" + operations + "</transform>")->get_transform("t");
  for (int i = 0; i < 16; ++i)
    EXPECT_NEAR(read[i], expected[i], 4e-15 * std::max(1.0, std::abs(expected[i])))
        << operations << " element " << i;
}

TEST(XmlTransform, Operations) {
  expect_transform("", kIdentity);
  expect_transform("<translate/><scale/>", kIdentity);
  expect_transform("<translate x='1'/>", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  expect_transform("<translate value='1 2 3'/>", {1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1});
  expect_transform("<translate value='2'/>", {1, 0, 0, 2, 0, 1, 0, 2, 0, 0, 1, 2, 0, 0, 0, 1});
  expect_transform("<scale x='2'/>", {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  expect_transform("<scale value='2'/>", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1});
  expect_transform("<rotate angle='90' z='1'/>", {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  expect_transform("<rotate angle='-115.5' y='1'/>",
                   {-0.43051109680829497, 0, -0.9025852843498607, 0, 0, 1, 0, 0, 0.9025852843498607,
                    0, -0.43051109680829497, 0, 0, 0, 0, 1});
  expect_transform("<matrix value='1 2 3 4 5 6 7 8 9'/>",
                   {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0, 0, 0, 0, 1});
  expect_transform("<matrix value='1 2 3 4 5 6 7 8 9 10 11 12 0 0 0 1'/>",
                   {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 0, 0, 1});
}

TEST(XmlTransform, RotationAxisIsNotNormalizedAsInMitsuba) {
  expect_transform("<rotate angle='30' x='1' y='2' z='3'/>",
                   {1, -1.2320508075688772, 1.4019237886466838, 0, 1.7679491924311224,
                    1.401923788646684, 0.3038475772933678, 0, -0.598076211353316,
                    1.3038475772933678, 2.0717967697244903, 0, 0, 0, 0, 1});
  ParseOptions options;
  std::string warning;
  options.warn = [&](const std::string& text) { warning = text; };
  parse_bsdf("<transform name='t'><rotate angle='1' z='2'/></transform>", options);
  EXPECT_HAS(warning, "s.xml:1:59: warning: the axis of <rotate> has not length 1");
}

TEST(XmlTransform, LookAt) {
  // columns left, up, direction, origin; without up some perpendicular
  expect_transform("<lookat origin='1 2 3' target='4 4 -4' up='0.1 1 0'/>",
                   {-0.9245003270420487, -0.011741165894605776, 0.38100038100057154, 1,
                    0.09245003270420486, 0.9627756033576743, 0.254000254000381, 2,
                    -0.36980013081681945, 0.270046815575933, -0.8890008890013336, 3, 0, 0, 0, 1});
  for (const char* up : {"", " up=''", " up='0 0 0'"}) {
    expect_transform(std::string("<lookat origin='1 2 3' target='4 4 4'") + up + "/>",
                     {0.3381871191173426, 0.49271932132398616, 0.8017837257372732, 1,
                      -0.7745419205884383, -0.3381871191173426, 0.5345224838248488, 2,
                      0.5345224838248488, -0.8017837257372732, 0.2672612419124244, 3, 0, 0, 0, 1});
    expect_transform(std::string("<lookat origin='1 2 3' target='0 4 -4'") + up + "/>",
                     {0.018968262233727856, 0.9905158688831363, -0.13608276348795434, 1,
                      0.9620634755325445, 0.018968262233727853, 0.2721655269759087, 2,
                      0.27216552697590873, -0.13608276348795437, -0.9525793444156804, 3, 0, 0, 0,
                      1});
  }
}

TEST(XmlTransform, EachOperationMultipliesFromTheLeft) {
  expect_transform("<translate x='1'/><scale value='2 3 4'/><rotate z='1' angle='33'/>"
                   "<lookat origin='1 2 3' target='4 4 4' up='0 1 0'/>"
                   "<matrix value='1 2 3 4 5 6 7 8 9'/>",
                   {-3.5068883256325725, 5.834654045036016, 10.690449676496977, 10.493111674367427,
                    -6.137054569857002, 10.210644578813028, 29.933259094191534, 25.862945430142997,
                    -8.767220814081432, 14.58663511259004, 49.176068511886086, 41.23277918591857, 0,
                    0, 0, 1});
}

TEST(XmlTransform, PlanarPart) {
  Matrix3 m = parse_bsdf("<transform name='t'><matrix value='1 2 3 4 5 6 7 8 9 10 11 12 0 0 0 1'/>"
                         "</transform>")
                  ->get_transform_2d("t");
  EXPECT_EQ(m, (Matrix3{1, 2, 4, 5, 6, 8, 0, 0, 1}));
}

TEST(XmlTransform, Errors) {
  auto refused = [](const std::string& body) {
    return error_of(bsdf("<transform name='t'>" + body + "</transform>"));
  };
  EXPECT_HAS(refused("<scale value='2' x='1'/>"), "both 'value' and 'x'");
  EXPECT_HAS(refused("<rotate angle='30'/>"), "axis of <rotate> is zero");
  EXPECT_HAS(refused("<rotate x='1'/>"), "<rotate> needs the attribute 'angle'");
  EXPECT_HAS(refused("<rotate x='1' angle='a'/>"), "'a' is not a number");
  EXPECT_HAS(refused("<lookat origin='1 2 3' target='1 2 3' up='0 1 0'/>"), "gives no frame");
  EXPECT_HAS(refused("<lookat origin='0 0 0' target='0 1 0' up='0 1 0'/>"), "gives no frame");
  EXPECT_HAS(refused("<lookat origin='1' target='0 1 0'/>"), "'origin' of <lookat> needs 3");
  EXPECT_HAS(refused("<lookat target='0 1 0'/>"), "needs the attribute 'origin'");
  EXPECT_HAS(refused("<matrix value='1 2 3'/>"), "needs 9 or 16 numbers, not 3");
  EXPECT_HAS(refused("<float name='a' value='1'/>"), "<float> cannot stand inside <transform>");
  EXPECT_HAS(refused("<translate name='a' x='1'/>"), "unexpected attribute 'name' in <translate>");
  EXPECT_HAS(refused("<translate x='1'><scale/></translate>"), "cannot stand inside <translate>");
  EXPECT_HAS(error_of(bsdf("<transform><scale/></transform>")), "needs the attribute 'name'");
  EXPECT_HAS(error_of(bsdf("<translate x='1'/>")), "can only stand inside a <transform>");
}

TEST(XmlQuery, ConversionsAndTheirErrors) {
  NodePtr node = parse_bsdf(
      "<integer name='i' value='2'/><float name='f' value='1.5'/><string name='s' value='2'/>"
      "<vector name='v' value='1 2 3'/><point name='p' value='4'/><rgb name='c' value='5'/>"
      "<boolean name='b' value='true'/><transform name='t'/><spectrum name='sp' value='1'/>"
      "<texture type='y' name='o'/>");
  EXPECT_EQ(node->get_float("i"), 2.0);
  EXPECT_EQ(node->get_float("f", 7), 1.5);
  EXPECT_EQ(node->get_float("none", 7), 7);
  EXPECT_EQ(node->get_string("s"), "2");
  EXPECT_EQ(node->get_point("v"), (Numbers3{1, 2, 3}));
  EXPECT_EQ(node->get_vector("p"), (Numbers3{4, 4, 4}));
  EXPECT_EQ(node->get_rgb("v"), (Numbers3{1, 2, 3}));
  EXPECT_EQ(node->get_transform("t"), kIdentity);
  EXPECT_EQ(node->get_object("o")->type, "y");
  EXPECT_EQ(node->get_object("none"), nullptr);
  EXPECT_EQ(node->type_of("c"), Type::rgb);
  EXPECT_FALSE(node->type_of("none"));
  auto wrong = [&](auto function) { return error_in([&] { function(*node); }); };
  EXPECT_HAS(wrong([](Node& n) { n.get_float("s"); }), "must be a float, not a string");
  EXPECT_HAS(wrong([](Node& n) { n.get_float("b"); }), "must be a float, not a boolean");
  EXPECT_HAS(wrong([](Node& n) { n.get_boolean("i"); }), "must be a boolean, not an integer");
  EXPECT_HAS(wrong([](Node& n) { n.get_point("c"); }), "must be a point, not an rgb colour");
  EXPECT_HAS(wrong([](Node& n) { n.get_point("f"); }), "must be a point, not a float");
  EXPECT_HAS(wrong([](Node& n) { n.get_rgb("f"); }), "must be an rgb colour, not a float");
  EXPECT_HAS(wrong([](Node& n) { n.get_string("o"); }), "must be a string, not a nested object");
  EXPECT_HAS(wrong([](Node& n) { n.get_object("f"); }), "must be a nested object, not a float");
  EXPECT_HAS(wrong([](Node& n) { n.get_choice("s", "a", {"1", "3"}); }),
             "'s' of bsdf of type 'x' cannot be '2' (did you mean '1'? known: 1, 3)");
  EXPECT_EQ(wrong([](Node& n) { n.get_float("alpha"); }),
            "s.xml:1:24: error: bsdf of type 'x' needs a float 'alpha' "
            "(<float name=\"alpha\" value=\"...\"/>)");
}

TEST(XmlQuery, UnqueriedPropertiesAreErrors) {
  NodePtr node = parse(scene("\n  <bsdf type='roughplastic' id='p'>\n    <float name='eta' "
                             "value='1'/>\n    <bsdf type='y'/></bsdf>"))
                     ->objects("bsdf")
                     .at(0);
  EXPECT_EQ(error_in([&] { check_all_queried(*node, false, {"alpha", "int_ior", "beta"}); }),
            "s.xml:3:5: error: unexpected property 'eta' in bsdf of type 'roughplastic' (id 'p') "
            "(did you mean 'beta'? known: alpha, int_ior, beta)");
  std::vector<std::string> warnings;
  check_all_queried(*node, true, {}, [&](const std::string& w) { warnings.push_back(w); });
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0], "s.xml:3:5: warning: unexpected property 'eta' in bsdf of type "
                         "'roughplastic' (id 'p')");
  EXPECT_EQ(warnings[1], "s.xml:4:5: warning: unexpected bsdf of type 'y' in bsdf of type "
                         "'roughplastic' (id 'p')");
  EXPECT_TRUE(node->has("eta"));
  EXPECT_TRUE(node->type_of("eta"));
  EXPECT_THROW(check_all_queried(*node), Error);
  node->get_float("eta");
  EXPECT_HAS(error_in([&] { check_all_queried(*node); }), "unexpected bsdf of type 'y'");
  node->objects();
  check_all_queried(*node);
}

} // namespace
} // namespace faceta::xml
