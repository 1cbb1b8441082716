// Includes, search paths, encodings, and what a hostile or broken file may not do.
#include "xml_test_tools.h"

#include <algorithm>
#include <random>
#include <sys/stat.h>

namespace faceta::xml {
namespace {

namespace fs = std::filesystem;

TEST(XmlInclude, SceneIsSplicedIntoItsParent) {
  TemporaryFolder folder;
  folder.write("sub/i.xml", scene("<bsdf type='i' id='i'/><bsdf type='p$q'/><ref id='m'/>"
                                  "<bsdf type='n' name='named'/>"));
  fs::path main = folder.write("main.xml", scene("<bsdf type='m' id='m'/>\n<include "
                                                 "filename='sub/i.xml'/><bsdf type='m2'/>"));
  ParseOptions options;
  options.defines = {{"q", "1"}};
  NodePtr root = parse_scene_file(main, options);
  EXPECT_EQ(root->names(),
            (std::vector<std::string>{"_arg_0", "_arg_1", "_arg_2", "_arg_3", "named", "_arg_4"}));
  std::vector<NodePtr> all = root->objects();
  EXPECT_EQ(all[1]->where.file, (folder / "sub/i.xml").string());
  EXPECT_EQ(all[1]->where.column, 24);
  EXPECT_EQ(all[2]->type, "p1");
  EXPECT_EQ(all[3], all[0]);
}

TEST(XmlInclude, OtherRootsBecomeOneChildWithTheNameOfTheInclude) {
  TemporaryFolder folder;
  folder.write("b.xml", "<bsdf version='1.0.0' type='b' name='zz' id='bb'><float name='fooBar' "
                        "value='1'/></bsdf>");
  fs::path main =
      folder.write("main.xml", scene("<include filename='b.xml' name='foo'/><bsdf type='x'><float "
                                     "name='fooBar' value='1'/><ref id='bb'/></bsdf>"));
  NodePtr root = parse_scene_file(main);
  EXPECT_EQ(root->names(), (std::vector<std::string>{"foo", "_arg_0"}));
  EXPECT_TRUE(root->get_object("foo")->has("foo_bar")) << "each file has its own version";
  EXPECT_TRUE(root->get_object("_arg_0")->has("fooBar"));

  folder.write("main.xml", scene("<include filename='b.xml'/>\n<include filename='b.xml'/>"));
  std::string file = (folder / "b.xml").string(), outer = main.string();
  EXPECT_EQ(error_in([&] { parse_scene_file(main); }),
            file + ":1:1: error: id 'bb' is used twice: before at " + file +
                ":1:1 (included from " + outer + ":2:1)");
}

TEST(XmlInclude, DefaultsFlowOut) {
  TemporaryFolder folder;
  folder.write("d.xml", scene("<default name='dd' value='5'/>"));
  fs::path main = folder.write("main.xml", scene("<include filename='d.xml'/><bsdf type='$dd'/>"));
  EXPECT_EQ(parse_scene_file(main)->objects()[0]->type, "5");
}

TEST(XmlInclude, Errors) {
  TemporaryFolder folder;
  fs::path main = folder.write("main.xml", scene("<include filename='main.xml'/>"));
  EXPECT_HAS(error_in([&] { parse_scene_file(main); }), "includes itself");
  folder.write("other.xml", scene("<include filename='main.xml'/>"));
  folder.write("main.xml", scene("<include filename='other.xml'/>"));
  EXPECT_HAS(error_in([&] { parse_scene_file(main); }), "main.xml' includes itself");
  folder.write("main.xml", scene("<include filename='nofile.xml'/>"));
  EXPECT_EQ(error_in([&] { parse_scene_file(main); }),
            main.string() + ":1:43: error: file 'nofile.xml' was not found (looked in '" +
                main.parent_path().string() + "', and the working folder)");
  folder.write("sub/x", "");
  folder.write("main.xml", scene("<include filename='sub'/>"));
  EXPECT_HAS(error_in([&] { parse_scene_file(main); }), "is a folder, not a file");
  folder.write("bad.xml", "<scene version='3.0.0'>\n<bsdf></scene>");
  folder.write("main.xml", scene("<include filename='bad.xml'/>"));
  EXPECT_HAS(error_in([&] { parse_scene_file(main); }), "bad.xml:2:");
  folder.write("bad.xml", "<scene/>");
  EXPECT_HAS(error_in([&] { parse_scene_file(main); }), "has no version");
}

TEST(XmlInclude, DepthIsLimitedAsInMitsuba) {
  TemporaryFolder folder;
  for (int i = 0; i < 20; ++i)
    folder.write(std::to_string(i) + ".xml",
                 scene("<include filename='" + std::to_string(i + 1) + ".xml'/>"));
  folder.write("20.xml", scene(""));
  EXPECT_NO_THROW(parse_scene_file(folder / "6.xml")) << "15 files";
  EXPECT_HAS(error_in([&] { parse_scene_file(folder / "5.xml"); }), "nested deeper than 15");
}

TEST(XmlInclude, ManyIncludesAreNoBomb) {
  TemporaryFolder folder;
  for (int i = 0; i < 14; ++i) {
    std::string include = "<include filename='" + std::to_string(i + 1) + ".xml'/>", body;
    for (int k = 0; k < 10; ++k)
      body += include;
    folder.write(std::to_string(i) + ".xml", scene(body));
  }
  folder.write("14.xml", scene(""));
  EXPECT_HAS(error_in([&] { parse_scene_file(folder / "0.xml"); }), "files are included");
}

TEST(XmlPath, SearchOrder) {
  TemporaryFolder folder;
  for (const char* place : {"a/f", "b/f", "b/g", "sub/h", "sub/g", "f", "free/k"})
    folder.write(place, "");
  folder.write("sub/i.xml", scene("<bsdf type='inner'><string name='file' value='f'/></bsdf>"));
  fs::path main = folder.write(
      "main.xml", scene("<bsdf type='m'><string name='file' value='f'/></bsdf><path value='b'/>"
                        "<include filename='sub/i.xml'/><path value='a'/>"));
  ParseOptions options;
  options.search_paths = {folder / "free"};
  NodePtr root = parse_scene_file(main, options);
  NodePtr outer = root->objects()[0], inner = root->objects()[1];
  // Mitsuba 3.9.1: the latest <path> counts most, for all nodes; then the root file's folder
  EXPECT_EQ(outer->get_file("file"), folder / "a/f");
  EXPECT_EQ(inner->get_file("file"), folder / "a/f");
  EXPECT_EQ(inner->resolve("g"), folder / "b/g");
  EXPECT_EQ(inner->resolve("main.xml"), main);
  EXPECT_EQ(outer->resolve("k"), folder / "free/k");
  EXPECT_EQ(inner->resolve((folder / "b/g").string()), folder / "b/g");
  // beyond Mitsuba: the folder of the included file
  EXPECT_EQ(inner->resolve("h"), folder / "sub/h");
  EXPECT_HAS(error_in([&] { outer->resolve("h"); }),
             "file 'h' was not found (looked in '" + (folder / "a").string() + "', '" +
                 (folder / "b").string() + "', '" + main.parent_path().string() + "', '" +
                 (folder / "free").string() + "'");
  EXPECT_HAS(error_in([&] { outer->resolve("/no/such/file"); }), "does not exist");
  EXPECT_HAS(error_in([&] { outer->get_file("nofile"); }), "needs a string 'nofile'");
  fs::remove(folder / "a/f"), fs::remove(folder / "b/f"), fs::remove(folder / "f");
  EXPECT_HAS(error_in([&] { outer->get_file("file"); }), "main.xml:1:39: error: file 'f'");
}

TEST(XmlPath, HoldsForIncludesAndSpectraBelowIt) {
  TemporaryFolder folder;
  folder.write("tex/s.spd", "400 2\n500 2\n");
  folder.write("sub/s.spd", "400 1\n500 1\n");
  folder.write("s.spd", "400 3\n500 3\n");
  std::string spectrum = "<bsdf type='x'><spectrum name='s' filename='s.spd'/></bsdf>";
  folder.write("sub/i.xml", scene(spectrum));
  fs::path main = folder.write("main.xml", scene(spectrum + "<path value='tex'/>" + spectrum +
                                                 "<path value='sub'/><include filename='i.xml'/>"));
  std::vector<double> values;
  for (const NodePtr& node : parse_scene_file(main)->objects())
    values.push_back(node->get_spectrum("s").values[0]);
  EXPECT_EQ(values, (std::vector<double>{3, 2, 1}));
  EXPECT_HAS(error_of(scene("<path value='/no/such/folder'/>")), "does not exist");
  EXPECT_HAS(error_of(bsdf("<path value='/'/>")), "directly in the root element");
}

TEST(XmlSource, SyntaxErrorsHavePlacesAndPlainWords) {
  auto refused = [](const std::string& text) { return error_of(text); };
  EXPECT_EQ(refused(""), "s.xml:1:1: error: no XML element found");
  EXPECT_HAS(refused("garbage"), "no XML element found");
  EXPECT_HAS(refused("<scene version='3.0.0'>\n<a"), "s.xml:2:2: error: malformed start tag");
  EXPECT_HAS(refused("<scene version='3.0.0'>\r\n \xC3\xA9</scen>"),
             "s.xml:2:5: error: an element is not closed by its own end tag");
  EXPECT_HAS(refused("<scene version='3.0.0' x></scene>"), "malformed attribute: write name=");
  EXPECT_HAS(refused("<scene version=3></scene>"), "malformed attribute");
  EXPECT_HAS(refused("<!-- "), "comment without an end");
  EXPECT_HAS(refused("<scene version='3.0.0'/><"), "s.xml:1:25");
  // Mitsuba does not look behind the root or a zero byte
  EXPECT_HAS(refused(scene("") + "\n" + scene("")), "s.xml:2:1: error: second root element");
  EXPECT_HAS(refused(scene("") + std::string("\0<a>", 4)), "zero byte in the file");
}

std::string utf16(const std::u16string& text, bool big, bool mark) {
  std::string bytes;
  auto put = [&](char16_t c) {
    char low = static_cast<char>(c & 0xFF), high = static_cast<char>(c >> 8);
    bytes += big ? high : low;
    bytes += big ? low : high;
  };
  if (mark)
    put(0xFEFF);
  for (char16_t c : text)
    put(c);
  return bytes;
}

TEST(XmlSource, Encodings) {
  std::string text = "<bsdf version='3.0.0' type='\xC3\xA9\xF0\x9F\x98\x80'/>";
  std::string type = "\xC3\xA9\xF0\x9F\x98\x80";
  EXPECT_EQ(parse(text)->type, type);
  EXPECT_EQ(parse("\xEF\xBB\xBF" + text)->type, type);
  EXPECT_EQ(parse("\xEF\xBB\xBF" + text)->where.column, 1);
  for (bool big : {false, true})
    for (bool mark : {false, true}) {
      std::u16string wide = u"<bsdf version='3.0.0' type='\u00e9\U0001F600'/>";
      EXPECT_EQ(parse(utf16(wide, big, mark))->type, type) << big << mark;
    }
  EXPECT_EQ(parse("<?xml version='1.0' encoding='ISO-8859-1'?><bsdf version='3.0.0' "
                  "type='\xE9'/>")
                ->type,
            "\xC3\xA9");
  EXPECT_HAS(error_of(utf16(u"<bsdf/>\xD800", false, true)), "half a surrogate pair");
  EXPECT_HAS(error_of(std::string("\xFF\xFE<", 3)), "middle of a character");
  EXPECT_HAS(error_of(std::string("\xFF\xFE\0\0<\0\0\0", 8)), "UTF-32");
}

TEST(XmlSource, ThingsThatAreNoSceneFile) {
  TemporaryFolder folder;
  folder.write("sub/x", "");
  EXPECT_HAS(error_in([&] { parse_scene_file(folder / "no.xml"); }), "no.xml' does not exist");
  EXPECT_HAS(error_in([&] { parse_scene_file(folder / "sub"); }), "is a folder, not a file");
  folder.write("empty.xml", "");
  EXPECT_HAS(error_in([&] { parse_scene_file(folder / "empty.xml"); }), "no XML element");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_HAS(error_in([&] { parse_scene_file(folder / "pipe"); }), "not a regular file");
  fs::path huge = folder.write("huge.xml", "<scene");
  fs::resize_file(huge, kMaxXmlBytes + 1); // sparse
  EXPECT_HAS(error_in([&] { parse_scene_file(huge); }), "the most for this kind of file");
}

TEST(XmlHostile, DeepNesting) {
  auto nested = [](int depth) {
    std::string text = "<bsdf version='3.0.0' type='x'>", end = "</bsdf>";
    for (int i = 1; i < depth; ++i)
      text += "<bsdf type='x'>", end += "</bsdf>";
    return text + end;
  };
  EXPECT_NO_THROW(parse(nested(kMaxDepth)));
  EXPECT_NO_THROW(write_xml(*parse(nested(kMaxDepth))));
  EXPECT_HAS(error_of(nested(kMaxDepth + 1)), "nested deeper than 256");
  EXPECT_HAS(error_of(nested(200'000)), "nested deeper than 256");
}

TEST(XmlHostile, LongChainsOfReferences) {
  auto chain = [](int length, bool forward) {
    std::string body;
    for (int i = 0; i < length; ++i)
      body += "<bsdf type='x' id='" + std::to_string(i) + "'><ref id='" +
              std::to_string(forward ? i + 1 : i - 1) + "'/></bsdf>";
    return scene(body + "<bsdf type='y' id='" + std::to_string(forward ? length : -1) + "'/>");
  };
  for (bool forward : {false, true}) {
    EXPECT_NO_THROW(parse(chain(200, forward)));
    EXPECT_HAS(error_of(chain(100'000, forward)), "nested deeper than 256");
  }
}

TEST(XmlHostile, SharedReferencesDoNotMultiply) {
  std::string body = "<bsdf type='x' id='0'/>";
  for (int i = 1; i < 200; ++i) {
    std::string ref = "<ref id='" + std::to_string(i - 1) + "'/>";
    body += "<bsdf type='x' id='" + std::to_string(i) + "'>" + ref + ref + "</bsdf>";
  }
  NodePtr root = parse(scene(body));
  EXPECT_EQ(root->objects().size(), 200u);
  EXPECT_LT(write_xml(*root).size(), 40'000u);
}

TEST(XmlHostile, SubstitutionDoesNotExplode) {
  std::string body = "<default name='a0' value='aaaaaaaaaaaaaaaa'/>";
  for (int i = 1; i < 60; ++i) {
    std::string before = "$a" + std::to_string(i - 1) + ".";
    body += "<default name='a" + std::to_string(i) + "' value='" + before + before + "'/>";
  }
  // '.' ends no name: a1. is a1 followed by a dot
  EXPECT_HAS(error_of(scene(body)), "makes the text too long");
  // entities of a DOCTYPE are never expanded
  NodePtr node = parse("<!DOCTYPE l [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;'>]>"
                       "<bsdf version='3.0.0' type='&b;'/>");
  EXPECT_EQ(node->type, "&b;");
}

TEST(XmlHostile, ManyPropertiesAreReadInLinearTime) {
  std::string body;
  for (int i = 0; i < 100'000; ++i)
    body += "<bsdf type='x' name='n" + std::to_string(i) + "'/>";
  EXPECT_EQ(parse(scene(body))->properties.size(), 100'000u);
}

const char* kSeed = R"(<?xml version="1.0" encoding="utf-8"?>
<!-- seed -->
<scene version="1.0.0">
  <default name="spp" value="16"/><default name="r" value="0.5"/>
  <integrator type="path"><integer name="maxDepth" value="8"/></integrator>
  <sensor type="perspective"><float name="fov" value="45"/>
    <transform name="toWorld"><lookat origin="1, 2, 3" target="0 0 0" up="0 1 0"/>
      <scale x="2"/><rotate y="1" angle="30"/><translate value="1 2 3"/>
      <matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/></transform>
    <sampler type="independent"><integer name="sampleCount" value="$spp"/></sampler></sensor>
  <bsdf type="diffuse" id="mat"><rgb name="reflectance" value="$r, 0.5, 0.25"/></bsdf>
  <alias id="mat" as="matte"/>
  <bsdf type="twosided" id="two"><bsdf type="conductor"><spectrum name="eta" value="400:1, 700:2"/>
    <string name="material" value="\$Cu &lt;&#65;"/><boolean name="b" value="true"/></bsdf></bsdf>
  <shape type="sphere"><point name="center" x="1" y="2" z="3"/><vector name="v" value="1"/>
    <texture type="bitmap" name="t"><float name="uoffset" value="1"/></texture>
    <ref id="matte"/><emitter type="area"><spectrum type="d65" name="radiance"/></emitter></shape>
  <shape type="cube"><ref id="two" name="bsdf"/></shape>
</scene>
)";

struct Outcome {
  int good = 0, bad = 0;
};

/// Truncates, flips, erases, doubles and inserts bytes of `seed`, and reads the result.
Outcome read_mutations(const std::string& seed, int rounds) {
  const std::string bytes = "<>\"'/= $\\&;!-[]?0195.eE+:,\n\t\xC3\xFFxyz_";
  std::mt19937 random(7);
  auto below = [&](size_t n) { return static_cast<size_t>(random() % n); };
  Outcome outcome;
  for (int round = 0; round < rounds; ++round) {
    std::string text = seed;
    if (round % 4 == 0)
      text.resize(below(text.size()));
    for (size_t change = below(4) + (round % 4 != 0); change > 0 && !text.empty(); --change) {
      size_t at = below(text.size()), length = std::min(text.size() - at, below(40));
      switch (below(5)) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text[at] = bytes[below(bytes.size())];
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(below(text.size()), text.substr(at, length));
        break;
      default:
        text.insert(at, 1, bytes[below(bytes.size())]);
      }
    }
    try {
      std::string written = write_xml(*parse(text));
      EXPECT_EQ(write_xml(*parse(written)), written);
      ++outcome.good;
    } catch (const Error& error) {
      EXPECT_FALSE(error.message().empty());
      EXPECT_EQ(error.where().file, "s.xml");
      EXPECT_GE(error.where().line, 1) << error.what();
      ++outcome.bad;
    }
  }
  return outcome;
}

TEST(XmlHostile, MutatedScenesEndInSuccessOrAnError) {
  ASSERT_NO_THROW(parse(kSeed));
  Outcome outcome = read_mutations(kSeed, 6000);
  EXPECT_GT(outcome.good, 100);
  EXPECT_GT(outcome.bad, 1000);
}

TEST(XmlSharedData, MutatedSceneEndsInSuccessOrAnError) {
  std::ifstream file(fs::path(FACETA_SHARED_DATA) / "scenes/rgl-teapot/scene_v3.xml");
  if (!file)
    GTEST_SKIP() << "no scene collection beside the repository";
  std::string seed((std::istreambuf_iterator<char>(file)), {});
  Outcome outcome = read_mutations(seed, 2000);
  EXPECT_GT(outcome.good, 50);
  EXPECT_GT(outcome.bad, 500);
}

// Refused by Mitsuba 3.9.1 as well: fragments to be included, files in need of a -D, one that is
// no scene, one of an older version.
const char* const kRefused[] = {"measured/radiance-xml/aerc6216_kf.xml",
                                "docs/scenes/include/emitter_scene.xml",
                                "docs/scenes/include/integrator_scene.xml",
                                "docs/scenes/include/matpreview.xml",
                                "docs/scenes/include/matpreview_no_rr.xml",
                                "docs/scenes/include/matpreview_stokes.xml",
                                "docs/scenes/include/sampler_scene.xml",
                                "docs/scenes/sensor_orthographic.xml",
                                "docs/scenes/sensor_perspective.xml",
                                "docs/scenes/sensor_perspective_large_fov.xml",
                                "docs/scenes/sensor_thinlens.xml",
                                "docs/scenes/sensor_thinlens_small_aperture.xml",
                                "scenes/cbox/fragments/shapes.xml",
                                "participating_media/include/test-scene-base-no-bg.xml",
                                "participating_media/include/test-scene-base.xml",
                                "scenes/dppm-box/scene.xml",
                                "scenes/restir-ashtray/scene.xml",
                                "scenes/restir-tire/scene.xml"};

TEST(XmlSharedData, ScenesParseWhereMitsubaParsesThem) {
  fs::path data = FACETA_SHARED_DATA;
  if (!fs::exists(data / "scenes"))
    GTEST_SKIP() << "no scene collection beside the repository";
  int read = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(data)) {
    std::string path = entry.path().string();
    if (entry.path().extension() != ".xml")
      continue;
    bool refused = std::any_of(std::begin(kRefused), std::end(kRefused),
                               [&](const char* end) { return path.ends_with(end); });
    try {
      NodePtr root = parse_scene_file(path);
      EXPECT_FALSE(refused) << path;
      std::string written = write_xml(*root);
      EXPECT_EQ(write_xml(*parse_scene_string(written)), written) << path;
      ++read;
    } catch (const Error& error) {
      EXPECT_TRUE(refused) << error.what();
    }
  }
  EXPECT_GT(read, 10);
}

} // namespace
} // namespace faceta::xml
