// Elements, attributes, references, parameters and versions; outcomes as in Mitsuba 3.9.1 unless a
// comment says that we differ.
#include "xml_test_tools.h"

#include <algorithm>

namespace faceta::xml {
namespace {

const std::string kA = "<bsdf type='diffuse' id='a'/>";

TEST(XmlStructure, ObjectsKeepOrderNamesAndPositions) {
  NodePtr root = parse("<?xml version='1.0'?>\r\n<!-- \xC3\xA9 -->\r\n<scene version='3.0.0'>\r\n"
                       "\t<shape type='sphere' id='\xC3\xA9t\xC3\xA9'>\r\n\t\t<bsdf type='b'/>"
                       "<string name='n' value='\xC3\xA9'/><float\n  name='r' value='2'/>\r\n"
                       "<texture type='t' name='x'/><emitter type='e'/></shape></scene>");
  EXPECT_EQ(root->tag, "scene");
  EXPECT_EQ(root->type, "scene");
  EXPECT_EQ(root->where.line, 3);
  EXPECT_EQ(root->where.column, 1);
  NodePtr shape = root->objects("shape").at(0);
  EXPECT_EQ(shape->id, "\xC3\xA9t\xC3\xA9");
  EXPECT_EQ(shape->where.file, "s.xml");
  EXPECT_EQ(shape->where.line, 4);
  EXPECT_EQ(shape->where.column, 2);
  EXPECT_EQ(shape->names(), (std::vector<std::string>{"_arg_0", "n", "r", "x", "_arg_1"}));
  EXPECT_EQ(shape->get_string("n"), "\xC3\xA9");
  EXPECT_EQ(shape->find("r")->where.line, 5);
  EXPECT_EQ(shape->find("r")->where.column, 2 + 16 + 28 + 1) << "columns count characters";
  EXPECT_EQ(shape->find("_arg_1")->where.line, 7);
  EXPECT_EQ(shape->find("_arg_1")->where.column, 29);
  EXPECT_EQ(shape->objects("texture").at(0)->type, "t");
  EXPECT_EQ(shape->object_properties("emitter").at(0)->name, "_arg_1");
}

TEST(XmlStructure, SpectrumWithTypeIsAnObjectAndATexture) {
  NodePtr node = parse_bsdf("<spectrum type='blackbody' name='a'><float name='temperature' "
                            "value='5000'/></spectrum><spectrum name='b' value='1'/>");
  EXPECT_EQ(node->get_object("a")->tag, "spectrum");
  EXPECT_EQ(node->objects("texture").size(), 1u);
  EXPECT_EQ(node->type_of("b"), Type::spectrum);
}

TEST(XmlStructure, RootMayBeAnyObjectAndNeedsAVersion) {
  EXPECT_EQ(parse("<bsdf type='x' version='3.0.0'/>")->type, "x");
  EXPECT_HAS(error_of("<scene/>"), "s.xml:1:1: error: the root element <scene> has no version");
  EXPECT_HAS(error_of("<rgb name='x' value='1'/>"), "has no version");
  EXPECT_HAS(error_of("<float version='3.0.0' name='x' value='1'/>"), "must be an object");
  for (const char* version : {"3", "3.0", "3.0.0.0", "abc", "", "3.0.", "-1.0.0", "3.0.0x"})
    EXPECT_HAS(error_of(scene("", version)), "is not a version");
  for (const char* version : {"3.0.0", "4.0.0", "0.6.0", " 3.0.0", "03.0.0"})
    EXPECT_NO_THROW(parse(scene("", version)));
  EXPECT_HAS(error_of(scene("<bsdf type='x' version='3.0.0'/>")), "unexpected attribute 'version'");
  // Mitsuba takes a root without a type for a scene, whatever its tag
  EXPECT_HAS(error_of("<bsdf version='3.0.0'/>"), "<bsdf> needs the attribute 'type'");
}

TEST(XmlStructure, UnknownElementsAndAttributes) {
  EXPECT_HAS(error_of(scene("<Bsdf type='x'/>")),
             "s.xml:1:24: error: unknown element <Bsdf> (did you mean 'bsdf'?");
  EXPECT_HAS(error_of(bsdf("<srgb name='a' value='1'/>")), "unknown element <srgb> (use <rgb>)");
  EXPECT_HAS(error_of(bsdf("<blackbody name='a'/>")), "<spectrum type=\"blackbody\">");
  EXPECT_HAS(error_of(scene("<subsurface type='x'/>")), "unknown element <subsurface>");
  EXPECT_HAS(error_of(scene("<bsdf typ='x'/>")),
             "s.xml:1:30: error: unexpected attribute 'typ' in <bsdf> (did you mean 'type'? known: "
             "type, id, name)");
  EXPECT_HAS(error_of(bsdf("<float name='a' value='1' unit='m'/>")), "unexpected attribute 'unit'");
  EXPECT_HAS(error_of(bsdf("<float value='1'/>")), "<float> needs the attribute 'name'");
  EXPECT_HAS(error_of(bsdf("<string name='a'/>")), "<string> needs the attribute 'value'");
  EXPECT_HAS(error_of(scene("<bsdf/>")), "<bsdf> needs the attribute 'type'");
  EXPECT_HAS(error_of(scene("<scene/>")), "<scene> needs the attribute 'type'");
  EXPECT_HAS(error_of(bsdf("<transform name='a' id='x'/>")), "unexpected attribute 'id'");
  EXPECT_HAS(error_of(bsdf("<float name='a' value='1'><float name='c' value='1'/></float>")),
             "<float> cannot stand inside <float>");
  EXPECT_HAS(error_of(bsdf("<ref id='a'><float name='c' value='1'/></ref>")),
             "<float> cannot stand inside <ref>");
  // Mitsuba keeps the first of two
  EXPECT_HAS(error_of(bsdf("<float name='a' name='b' value='1'/>")), "is given twice");
  // Mitsuba calls the plugin ''
  EXPECT_HAS(error_of(scene("<bsdf type=''/>")), "type of <bsdf> is empty");
}

TEST(XmlStructure, PropertySetTwice) {
  EXPECT_EQ(error_of(bsdf("<float name='a' value='1'/>\n <float name='a' value='2'/>")),
            "s.xml:2:2: error: property 'a' of bsdf of type 'x' is set twice: before at "
            "s.xml:1:39");
  EXPECT_HAS(error_of(bsdf("<texture type='x' name='a'/><float name='a' value='1'/>")),
             "is set twice");
  // Mitsuba lets a nested object replace what was there
  std::string twice = bsdf("<texture type='x' name='a'/><texture type='y' name='a'/>");
  EXPECT_HAS(error_of(twice), "is set twice");
  ParseOptions options;
  options.permissive = true;
  int warnings = 0;
  options.warn = [&](const std::string&) { ++warnings; };
  NodePtr node = parse(twice, options)->objects().at(0);
  EXPECT_EQ(node->get_object("a")->type, "y");
  EXPECT_EQ(node->properties.size(), 1u);
  EXPECT_EQ(warnings, 1);
}

TEST(XmlStructure, TextIsIgnoredWithAWarning) {
  ParseOptions options;
  std::vector<std::string> warnings;
  options.warn = [&](const std::string& w) { warnings.push_back(w); };
  NodePtr root = parse("<?p?><!DOCTYPE s [<!ENTITY a \"b\">]>\n" +
                           scene("hello<bsdf type='x'>&a;</bsdf><!-- c --><![CDATA[d]]>"),
                       options);
  EXPECT_EQ(root->properties.size(), 1u);
  ASSERT_EQ(warnings.size(), 3u);
  EXPECT_EQ(warnings[0], "s.xml:2:24: warning: text between elements is ignored");
}

TEST(XmlReference, SharesOneNodeForwardAndBackward) {
  for (const std::string& text : {scene(kA + "<bsdf type='t'><ref id='a'/></bsdf>"),
                                  scene("<bsdf type='t'><ref id='a'/></bsdf>" + kA),
                                  scene("<bsdf type='t'><ref id='a' name=''/></bsdf>" + kA),
                                  scene("<bsdf type='t'>" + kA + "</bsdf><ref id='a'/>")}) {
    NodePtr root = parse(text);
    NodePtr outer, direct;
    for (const NodePtr& node : root->objects())
      (node->type == "t" ? outer : direct) = node;
    ASSERT_TRUE(outer && direct);
    EXPECT_EQ(outer->get_object("_arg_0"), direct);
    EXPECT_EQ(direct->id, "a");
  }
  NodePtr named = parse(scene("<bsdf type='t'><ref id='a' name='q'/></bsdf>" + kA))->objects()[0];
  EXPECT_EQ(named->get_object("q")->type, "diffuse");
  EXPECT_EQ(named->find("q")->where.column, 39) << "of the <ref>";
}

TEST(XmlReference, AutomaticNamesCountNestedAndReferredObjects) {
  NodePtr node = parse_bsdf("<bsdf type='a' id='1'/><texture type='b' name='n'/><ref id='1'/>"
                            "<bsdf type='c'/>");
  EXPECT_EQ(node->names(), (std::vector<std::string>{"_arg_0", "n", "_arg_1", "_arg_2"}));
}

TEST(XmlReference, Errors) {
  EXPECT_EQ(error_of(scene("<bsdf type='t'><ref id='b'/></bsdf>" + kA)),
            "s.xml:1:39: error: reference to unknown id 'b' in bsdf of type 't' (did you mean 'a'? "
            "known: a)");
  EXPECT_HAS(error_of(scene("<ref id='b'/>")), "no object of the scene has an id");
  EXPECT_EQ(error_of(scene(kA + kA)),
            "s.xml:1:53: error: id 'a' is used twice: before at s.xml:1:24");
  EXPECT_NO_THROW(parse(scene("<bsdf type='x' id=''/><bsdf type='x' id=''/>")));
  EXPECT_HAS(error_of(scene("<bsdf type='t' id='b'><ref id='b'/></bsdf>")),
             "references form a circle: 'b' -> 'b'");
  EXPECT_HAS(error_of(scene("<bsdf type='t' id='b'><ref id='c'/></bsdf>"
                            "<bsdf type='t' id='c'><ref id='b'/></bsdf>")),
             "s.xml:1:88: error: references form a circle: 'b' -> 'c' -> 'b'");
  EXPECT_HAS(error_of("<scene version='3.0.0' id='r'><bsdf type='x'><ref id='r'/></bsdf></scene>"),
             "references form a circle: 'r' -> <bsdf> -> 'r'");
}

TEST(XmlAlias, NamesAnExistingObject) {
  NodePtr root = parse(scene(kA + "<alias id='a' as='b'/><bsdf type='t'><ref id='b'/></bsdf>"));
  EXPECT_EQ(root->objects()[1]->objects()[0], root->objects()[0]);
  EXPECT_NO_THROW(parse(scene(kA + "<alias id='a' as='b'/><alias id='b' as='c'/><ref id='c'/>")));
  EXPECT_HAS(error_of(scene("<alias id='a' as='b'/>" + kA)), "<alias> of unknown id 'a'");
  EXPECT_HAS(error_of(scene(kA + "<alias id='a' as='a'/>")), "is taken: s.xml:1:24");
  EXPECT_HAS(error_of(scene(kA + "<alias id='a' as='b'/><bsdf type='x' id='b'/>")), "used twice");
  EXPECT_HAS(error_of(scene(kA + "<alias id='a' as='b'/><alias id='b' as='a'/>")), "is taken");
}

std::string expand(const std::string& text,
                   std::vector<std::pair<std::string, std::string>> defines = {}) {
  ParseOptions options;
  options.defines = std::move(defines);
  return parse_bsdf("<string name='s' value='" + text + "'/>", options)->get_string("s");
}

TEST(XmlParameter, Substitution) {
  EXPECT_EQ(expand("$a", {{"a", "1"}}), "1");
  EXPECT_EQ(expand("x$ab$a", {{"a", "1"}}), "x1b1");
  EXPECT_EQ(expand("$ab$a", {{"a", "1"}, {"ab", "2"}}), "21") << "longest name first";
  EXPECT_EQ(expand("$abd$abc$abe", {{"a", "1"}, {"abc", "2"}, {"abe", "4"}}), "1bd24");
  EXPECT_EQ(expand("\\$a"), "$a");
  EXPECT_EQ(expand("\\\\$a"), "\\$a");
  EXPECT_EQ(expand("$a\\$", {{"a", "1\\$"}}), "1$$");
  EXPECT_EQ(expand("$ab", {{"ab", "$b"}, {"b", "2"}}), "2");
  EXPECT_EQ(expand("a\\b"), "a\\b");
  for (const char* text : {"$", "a$", "$a"})
    EXPECT_HAS(error_of(bsdf(std::string("<string name='s' value='") + text + "'/>")),
               "undefined parameter");
  ParseOptions options;
  options.defines = {{"spp", "1"}};
  EXPECT_EQ(error_of(bsdf("<string name='s' value='$sp'/>"), options),
            "s.xml:1:63: error: undefined parameter '$sp' (did you mean 'spp'? known: spp)");
  options.defines = {{"a", "$a"}};
  EXPECT_HAS(error_of(bsdf("<string name='s' value='$a'/>"), options), "refers to itself");
}

TEST(XmlParameter, EveryAttributeAndInsideTransforms) {
  ParseOptions options;
  options.defines = {{"p", "2"}};
  NodePtr node = parse(scene("<bsdf type='t$p' id='i$p'><float name='n$p' value='$p'/><transform "
                             "name='$p'><scale value='$p, 1, 1'/></transform></bsdf>"),
                       options)
                     ->objects()[0];
  EXPECT_EQ(node->type, "t2");
  EXPECT_EQ(node->id, "i2");
  EXPECT_EQ(node->get_float("n2"), 2);
  EXPECT_EQ(node->get_transform("2")[0], 2);
}

TEST(XmlParameter, Defaults) {
  auto value = [](const std::string& defaults,
                  std::vector<std::pair<std::string, std::string>> defines = {}) {
    ParseOptions options;
    options.defines = std::move(defines);
    return parse(scene(defaults + "<bsdf type='$a'/>"), options)->objects()[0]->type;
  };
  EXPECT_EQ(value("<default name='a' value='1'/>"), "1");
  EXPECT_EQ(value("<default name='a' value='1'/><default name='a' value='2'/>"), "1");
  EXPECT_EQ(value("<default name='a' value='1'/>", {{"a", "9"}}), "9");
  EXPECT_EQ(value("<default name='b' value='1'/><default name='a' value='$b$b'/>"), "11");
  EXPECT_EQ(value("<bsdf type='x'><default name='a' value='1'/></bsdf>").size(), 1u)
      << "of the first object, but the default holds for the second";
  EXPECT_NO_THROW(parse(scene("<default name='a' value='1'/>")));
  EXPECT_HAS(error_of(scene("<bsdf type='$a'/><default name='a' value='1'/>")), "undefined");
  EXPECT_HAS(error_of(scene("<default name='a' value='\\$5'/><bsdf type='$a'/>")),
             "undefined parameter '$5'");
  EXPECT_HAS(error_of(scene("<default name='' value='5'/>")), "must have 1 to 256 characters");
  EXPECT_HAS(error_of(scene("<default name='a' value='5'><bsdf type='x'/></default>")),
             "<bsdf> cannot stand inside <default>");
  EXPECT_HAS(error_of(bsdf("<transform name='t'><default name='a' value='5'/></transform>")),
             "<default> cannot stand inside <transform>");
}

TEST(XmlParameter, UnusedDefinesAreErrors) {
  ParseOptions options;
  options.defines = {{"spq", "4"}};
  std::string text = scene("<default name='spp' value='1'/>");
  EXPECT_EQ(error_of(text, options), "error: the scene does not use the parameter -D spq=4 (did "
                                     "you mean 'spp'? known: spp)");
  options.defines = {{"spp", "4"}};
  EXPECT_HAS(error_of(text, options), "does not use the parameter -D spp=4");
  options.permissive = true;
  std::string warning;
  options.warn = [&](const std::string& w) { warning = w; };
  EXPECT_NO_THROW(parse(text, options));
  EXPECT_HAS(warning, "does not use the parameter -D spp=4");
  options.defines = {{"a", "1"}, {"a", "2"}};
  EXPECT_HAS(error_of(scene("<bsdf type='$a'/>"), options), "defined twice");
}

TEST(XmlVersion, NamesOfVersionOneBecomeSnakeCase) {
  std::string body =
      "<bsdf type='diffuse'><rgb name='diffuseReflectance' value='1'/><float name='intIOR' "
      "value='1'/><transform name='toWorld'/><float name='ABCd' value='1'/><float name='aBCD' "
      "value='1'/><float name='a1B' value='1'/><texture type='y' name='fooBar'/></bsdf>";
  std::vector<std::string> upgraded = {"reflectance", "int_ior", "to_world", "ABCd",
                                       "a_bcd",       "a1B",     "foo_bar"};
  for (const char* version : {"0.6.0", "1.9.9"})
    EXPECT_EQ(parse(scene(body, version))->objects()[0]->names(), upgraded);
  std::vector<std::string> kept = {
      "diffuseReflectance", "intIOR", "toWorld", "ABCd", "aBCD", "a1B", "fooBar"};
  for (const char* version : {"2.0.0", "3.0.0"})
    EXPECT_EQ(parse(scene(body, version))->objects()[0]->names(), kept);
  // Mitsuba keeps the old name in this case
  EXPECT_HAS(error_of(scene("<bsdf type='d'><rgb name='fooBar' value='1'/><float name='foo_bar' "
                            "value='1'/></bsdf>",
                            "1.0.0")),
             "is set twice");
}

TEST(XmlVersion, TexturePlacementOfVersionOne) {
  std::string parts = "<float name='uoffset' value='0.25'/><float name='voffset' value='0.5'/>"
                      "<integer name='uscale' value='2'/><float name='vscale' value='4'/>";
  NodePtr node = parse(scene("<texture type='y'>" + parts + "</texture>", "1.0.0"))->objects()[0];
  EXPECT_EQ(node->names(), std::vector<std::string>{"to_uv"});
  EXPECT_EQ(node->get_transform("to_uv"),
            (Matrix4{2, 0, 0, 0.5, 0, 4, 0, 2, 0, 0, 1, 0, 0, 0, 0, 1}));
  EXPECT_HAS(error_of(scene("<texture type='y'><float name='uoffset' value='1'/><transform "
                            "name='toUV'/></texture>",
                            "1.0.0")),
             "both 'to_uv' and uoffset");
  EXPECT_HAS(
      error_of(scene("<texture type='y'><string name='uoffset' value='1'/></texture>", "1.0.0")),
      "must be a float, not a string");
  EXPECT_EQ(parse(scene("<texture type='y'>" + parts + "</texture>"))->objects()[0]->names().size(),
            4u);
}

TEST(XmlWriter, ReadsBackTheSame) {
  std::string text = scene(
      "<bsdf type='t' id='shared'><float name='f' value='0.1'/><float name='inf' value='inf'/>"
      "<integer name='i' value='-7'/><boolean name='b' value='true'/><string name='s' "
      "value='a&lt;&amp;&quot;\\$x&#10;&#9;\xC3\xA9'/></bsdf><shape type='u'><ref id='shared'/>"
      "<ref id='shared' name='again'/><vector name='v' value='1e-7, 2, 0.30000000000000004'/>"
      "<point name='p' value='1'/><rgb name='c' value='0.2'/><spectrum name='u' value='0.5'/>"
      "<spectrum name='w' value='400:1, 500.5:2'/><transform name='t'><rotate angle='33' x='1'/>"
      "</transform><transform name='id'/><texture type='bitmap' name='tex'/></shape>");
  NodePtr root = parse(text);
  std::string written = write_xml(*root);
  NodePtr again = parse(written);
  EXPECT_EQ(write_xml(*again), written);
  NodePtr a = root->objects("bsdf")[0], b = again->objects("bsdf")[0];
  EXPECT_EQ(b->id, "shared");
  EXPECT_EQ(b->get_string("s"), "a<&\"$x\n\t\xC3\xA9");
  EXPECT_EQ(a->get_float("f"), b->get_float("f"));
  EXPECT_EQ(b->get_float("inf"), a->get_float("inf"));
  EXPECT_EQ(b->get_integer("i"), -7);
  EXPECT_TRUE(b->get_boolean("b"));
  NodePtr u = root->objects("shape")[0], v = again->objects("shape")[0];
  EXPECT_EQ(u->names(), v->names());
  EXPECT_EQ(v->get_object("again"), b);
  EXPECT_EQ(u->get_vector("v"), v->get_vector("v"));
  EXPECT_EQ(v->type_of("p"), Type::point);
  EXPECT_EQ(u->get_rgb("c"), v->get_rgb("c"));
  EXPECT_TRUE(v->get_spectrum("u").is_uniform());
  EXPECT_EQ(u->get_spectrum("w").wavelengths, v->get_spectrum("w").wavelengths);
  EXPECT_EQ(u->get_spectrum("w").values, v->get_spectrum("w").values);
  EXPECT_EQ(u->get_transform("t"), v->get_transform("t"));
  EXPECT_EQ(v->get_transform("id"), kIdentity);
  EXPECT_HAS(written, "<scene version=\"3.0.0\">\n    <bsdf type=\"t\" id=\"shared\">\n        "
                      "<float name=\"f\" value=\"0.1\"/>\n");
  EXPECT_HAS(written, "<ref id=\"shared\"/>");
}

TEST(XmlWriter, BuildsTreesByHand) {
  auto root = std::make_shared<Node>(Node{"scene", "scene", "", {}, {}, {}});
  auto bsdf = std::make_shared<Node>(Node{"bsdf", "diffuse", "", {}, {}, {}});
  bsdf->set("reflectance", Type::rgb, Numbers3{0.1, 0.2, 0.3});
  bsdf->set("reflectance", Type::rgb, Numbers3{0.5, 0.2, 0.3});
  root->add_object(bsdf);
  root->add_object(bsdf);
  EXPECT_EQ(write_xml(*root), "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\n"
                              "<scene version=\"3.0.0\">\n"
                              "    <bsdf type=\"diffuse\" id=\"bsdf_1\">\n"
                              "        <rgb name=\"reflectance\" value=\"0.5, 0.2, 0.3\"/>\n"
                              "    </bsdf>\n"
                              "    <ref id=\"bsdf_1\"/>\n"
                              "</scene>\n");
  EXPECT_EQ(write_xml(*bsdf).find("<bsdf version=\"3.0.0\" type=\"diffuse\">"), 40u);
  bsdf->set("bad", Type::float_, std::string("text"));
  EXPECT_HAS(error_in([&] { write_xml(*root); }), "holds something else");
  bsdf->set("bad", Type::object, root);
  EXPECT_HAS(error_in([&] { write_xml(*root); }), "circle");
  bsdf->properties.clear();
}

} // namespace
} // namespace faceta::xml
