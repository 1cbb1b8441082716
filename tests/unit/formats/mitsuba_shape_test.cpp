// Shapes and emitters of scene files. What is accepted and refused, and numbers called Mitsuba's,
// were read off Mitsuba 3.9.1 (scalar_rgb).
#include "image/io.h"
#include "mitsuba_test_tools.h"

namespace faceta {
namespace {

const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 .25\nf 1/1 2/2 3/3\n";
const char* kTrianglePly = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty "
                           "float y\nproperty float z\nproperty float u\nproperty float v\nelement "
                           "face 1\nproperty list uchar int vertex_indices\nend_header\n"
                           "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 .25\n3 0 1 2\n";

std::unique_ptr<Scene> build(const std::string& objects) {
  auto scene = read_objects(objects);
  scene->build(Isa::scalar);
  return scene;
}

TEST(MitsubaShape, MeshFiles) {
  xml::TemporaryFolder folder;
  std::string obj = folder.write("t.obj", kTriangle).string();
  std::string ply = folder.write("t.ply", kTrianglePly).string();
  auto third_v = [&](const std::string& type, const std::string& file, const std::string& more) {
    auto scene = build("<shape type='" + type + "'><string name='filename' value='" + file + "'/>" +
                       more + "</shape>");
    EXPECT_EQ(scene->statistics().triangles, 1u);
    return scene->view().triangles[0].uv2[1];
  };
  EXPECT_EQ(third_v("obj", obj, ""), 0.75f); // flipped by default
  EXPECT_EQ(third_v("obj", obj, "<boolean name='flip_tex_coords' value='false'/>"), 0.25f);
  EXPECT_EQ(third_v("ply", ply, ""), 0.25f);
  EXPECT_EQ(third_v("ply", ply, "<boolean name='flip_tex_coords' value='true'/>"), 0.75f);
  EXPECT_EQ(third_v("obj", obj, "<boolean name='face_normals' value='true'/>"), 0.75f);
  auto moved = build("<shape type='obj'><string name='filename' value='" + obj +
                     "'/><transform name='to_world'><scale value='2'/><translate x='5'/>"
                     "</transform></shape>");
  EXPECT_EQ(moved->view().triangles[0].v0[0], 5);
  EXPECT_EQ(moved->view().triangles[0].e1[0], 2);
}

TEST(MitsubaShape, MeshFileErrors) {
  EXPECT_EQ(objects_error("<shape type='obj'><string name='filename' value='nope.obj'/></shape>")
                .find("s.xml:1:42: error: file 'nope.obj' was not found"),
            0u);
  EXPECT_EQ(objects_error("<shape type='ply'/>"),
            "s.xml:1:24: error: shape of type 'ply' needs a string 'filename' (<string "
            "name=\"filename\" value=\"...\"/>)");
  xml::TemporaryFolder folder;
  std::string bad = folder.write("bad.obj", "v 0 0 0\nv 1 x 0\n").string();
  EXPECT_HAS(
      objects_error("<shape type='obj'><string name='filename' value='" + bad + "'/></shape>"),
      "bad.obj:2:5: error: ");
  // The first in the file counts, although files are read side by side.
  std::string good = folder.write("good.obj", kTriangle).string();
  std::string worse = folder.write("worse.obj", "f 1 2 3\n").string();
  std::string shapes;
  for (const std::string& file : {good, good, bad, worse, worse})
    shapes += "<shape type='obj'><string name='filename' value='" + file + "'/></shape>";
  for (int i = 0; i < 10; ++i)
    EXPECT_HAS(objects_error(shapes), "bad.obj:2:5: error: ");
}

TEST(MitsubaShape, Primitives) {
  auto scene = build("<shape type='sphere'><point name='center' value='1'/><float name='radius' "
                     "value='2'/></shape><shape type='rectangle'/><shape type='cube'>"
                     "<boolean name='face_normals' value='true'/></shape>"
                     "<shape type='disk'><boolean name='flip_normals' value='true'/></shape>"
                     "<shape type='cylinder'><point name='p1' z='2' x='0' y='0'/>"
                     "<integer name='radius' value='3'/></shape>");
  EXPECT_EQ(scene->statistics().triangles, 14u);
  ASSERT_EQ(scene->statistics().quadrics, 3u);
  const QuadricRecord* q = scene->view().quadrics;
  const float sphere[] = {2, 0, 0, 1, 0, 2, 0, 1, 0, 0, 2, 1}; // Mitsuba's to_world
  for (int i = 0; i < 12; ++i)
    EXPECT_EQ(q[0].to_world[i], sphere[i]);
  EXPECT_EQ(q[0].shape, 0);
  EXPECT_EQ(q[1].type, static_cast<int>(QuadricType::disk));
  EXPECT_EQ(q[1].flip, -1);
  EXPECT_EQ(q[1].shape, 3);
  EXPECT_EQ(q[2].shape, 4);
  EXPECT_EQ(q[2].to_world[10], 2); // along z
}

TEST(MitsubaShape, PropertiesThatDoNotFit) {
  EXPECT_EQ(objects_error("<shape type='rectangle'><float name='radius' value='1'/></shape>"),
            "s.xml:1:48: error: unexpected property 'radius' in shape of type 'rectangle' (known: "
            "face_normals, to_world, flip_normals, silhouette_sampling_weight)");
  for (const char* type : {"sphere", "disk", "cylinder"})
    EXPECT_HAS(objects_error(std::string("<shape type='") + type +
                             "'><boolean name='face_normals' value='true'/></shape>"),
               "unexpected property 'face_normals'");
  for (const char* type : {"rectangle", "cube"})
    EXPECT_HAS(objects_error(std::string("<shape type='") + type +
                             "'><boolean name='flip_tex_coords' value='true'/></shape>"),
               "unexpected property 'flip_tex_coords'");
  EXPECT_HAS(objects_error("<shape type='sphere'><float name='radius' value='0'/></shape>"),
             "s.xml:1:24: error: ");
  EXPECT_HAS(objects_error("<shape type='cylinder'><point name='p1' value='0'/></shape>"),
             "s.xml:1:24: error: ");
  EXPECT_HAS(objects_error("<shape type='sphere'><transform name='to_world'><scale value='inf'/>"
                           "</transform></shape>"),
             "s.xml:1:45: error: ");
  EXPECT_HAS(objects_error("<shape type='sphere'><transform name='to_world'><scale x='0'/>"
                           "</transform></shape>"),
             "s.xml:1:24: error: ");
}

TEST(MitsubaShape, Children) {
  EXPECT_EQ(objects_error("<shape type='sphere'><bsdf type='diffuse'/><bsdf type='null'/></shape>"),
            "s.xml:1:67: error: shape of type 'sphere' has more than one bsdf");
  EXPECT_HAS(objects_error("<shape type='sphere'><emitter type='area'/><emitter type='area'/>"
                           "</shape>"),
             "more than one emitter");
  EXPECT_HAS(objects_error("<shape type='sphere'><emitter type='constant'/></shape>"),
             "an emitter 'constant' cannot belong to a shape");
  EXPECT_HAS(objects_error("<shape type='sphere'><emitter type='directionalarea'/></shape>"),
             "emitter 'directionalarea' is not supported yet");
  EXPECT_HAS(objects_error("<shape type='sphere'><emitter type='area' id='e'/></shape>"
                           "<shape type='cube'><ref id='e'/></shape>"),
             "belongs to more than one shape");
  EXPECT_EQ(objects_error("<shape type='sphere'><medium type='homogeneous' name='interior'/>"
                          "</shape>"),
            "s.xml:1:45: error: medium 'homogeneous' in a shape is not supported yet");
  EXPECT_HAS(objects_error("<shape type='sphere'><texture type='checkerboard' name='vertex_a'/>"
                           "</shape>"),
             "texture 'checkerboard' as an attribute of a shape is not supported yet");
  EXPECT_HAS(objects_error("<shape type='sphere'><sensor type='irradiancemeter'/></shape>"),
             "sensor 'irradiancemeter' in a shape is not supported yet");
  EXPECT_HAS(objects_error("<shape type='sphere'><shape type='cube'/></shape>"),
             "unexpected shape of type 'cube' in shape of type 'sphere'");
}

/// Radiance of the light of a sphere whose emitter holds this.
std::vector<double> radiance(const std::string& property) {
  auto scene =
      build("<shape type='sphere'><emitter type='area'>" + property + "</emitter></shape>");
  EXPECT_EQ(scene->view().light_count, 1);
  const float* r = scene->view().lights[0].radiance;
  return {r[0], r[1], r[2]};
}

TEST(MitsubaEmitter, RadianceFollowsTheColourRules) {
  expect_near(radiance(""), {1, 1, 1});
  expect_near(radiance("<float name='radiance' value='2'/>"), {2, 2, 2});
  expect_near(radiance("<rgb name='radiance' value='20,1,3'/>"), {20, 1, 3});
  // Mitsuba's: equal energy is not grey, pairs are not lit by D65
  expect_near(radiance("<spectrum name='radiance' value='2'/>"), {2.40959, 1.89658, 1.81783}, 5e-6);
  expect_near(radiance("<spectrum name='radiance' value='400:0, 500:8, 600:15.6, 700:18.4'/>"),
              {20.7108, 10.8546, 2.77115}, 5e-6);
  expect_near(radiance("<spectrum type='uniform' name='radiance'><float name='value' value='3'/>"
                       "</spectrum>"),
              {3, 3, 3});
  expect_near(radiance("<spectrum type='d65' name='radiance'><rgb name='color' value='3,2,1'/>"
                       "<float name='scale' value='2'/></spectrum>"),
              {6, 4, 2});
  expect_near(radiance("<spectrum type='d65' name='radiance'/>"), {1, 1, 1});
  EXPECT_HAS(xml::error_in([] {
               radiance("<spectrum type='srgb' name='radiance'>"
                        "<rgb name='color' value='3,2,1'/></spectrum>");
             }),
             "is no reflectance"); // as in Mitsuba, unless 'unbounded'
  EXPECT_HAS(xml::error_in([] { radiance("<vector name='radiance' value='1'/>"); }),
             "not of type vector");
  EXPECT_HAS(xml::error_in([] { radiance("<rgb name='radiance' value='1,1,-1'/>"); }),
             "not negative");
}

TEST(MitsubaEmitter, AreaEmittersMayBeTextured) {
  auto scene = build("<shape type='rectangle'><emitter type='area'><texture type='checkerboard' "
                     "name='radiance'/></emitter></shape>");
  ASSERT_EQ(scene->view().light_count, 1);
  EXPECT_EQ(scene->view().lights[0].type, static_cast<int>(LightType::rectangle));
  ASSERT_EQ(scene->view().lights[0].texture, 0);
  EXPECT_EQ(scene->view().textures[0].color[0][0], 0.4f); // a colour use: not swapped
  EXPECT_HAS(objects_error("<shape type='rectangle'><emitter type='area'><spectrum type='d65' "
                           "name='radiance'><float name='scale' value='3'/><texture "
                           "type='checkerboard'/></spectrum></emitter></shape>"),
             "a 'scale' other than 1 on a texture is not supported yet");
}

TEST(MitsubaEmitter, AreaErrors) {
  EXPECT_EQ(objects_error("<shape type='sphere'><emitter type='area'><transform name='to_world'/>"
                          "</emitter></shape>"),
            "s.xml:1:66: error: an area emitter has no 'to_world' (it lies where its shape lies)");
  EXPECT_HAS(objects_error("<shape type='sphere'><emitter type='area'>"
                           "<float name='sampling_weight' value='-1'/></emitter></shape>"),
             "'sampling_weight' of emitter of type 'area' is -1, but must be finite and not");
  std::vector<std::string> warnings;
  ReadOptions options;
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  read_objects("<emitter type='area'/><emitter type='area' id='e'/><shape type='sphere'>"
               "<ref id='e'/></shape>",
               options);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_HAS(warnings[0], "s.xml:1:24: warning: emitter of type 'area' belongs to no shape");
}

TEST(MitsubaEmitter, ShapesWithoutBsdf) {
  // diffuse 0.5; black if the shape emits
  auto albedo = [](const std::string& inside) {
    auto scene = build("<shape type='sphere'>" + inside + "</shape>");
    const SceneView& v = scene->view();
    EXPECT_EQ(v.root_count, 1);
    return v.programs[0].records[0];
  };
  EXPECT_EQ(albedo(""), 0.5f);
  EXPECT_EQ(albedo("<emitter type='area'/>"), 0.0f);
  std::string plain = "<shape type='sphere'/>";
  std::string light = "<shape type='sphere'><emitter type='area'/></shape>";
  auto scene = build(plain + light + plain + light + plain);
  const SceneView& v = scene->view();
  for (int i = 0; i < 5; ++i) {
    const RootView& root = v.roots[v.quadrics[i].material];
    EXPECT_EQ(v.programs[0].records[root.row * v.programs[0].stride], i % 2 ? 0.0f : 0.5f) << i;
  }
}

TEST(MitsubaEmitter, Point) {
  auto position = [](const std::string& properties) {
    auto scene = build("<emitter type='point'>" + properties + "</emitter>");
    const LightRecord& light = scene->view().lights[0];
    EXPECT_EQ(light.type, static_cast<int>(LightType::point));
    return std::array<float, 3>{light.p[0], light.p[1], light.p[2]};
  };
  EXPECT_EQ(position(""), (std::array<float, 3>{0, 0, 0}));
  EXPECT_EQ(position("<point name='position' x='1' y='2' z='3'/>"),
            (std::array<float, 3>{1, 2, 3}));
  EXPECT_EQ(position("<transform name='to_world'><scale value='2'/><translate z='10'/>"
                     "</transform>"),
            (std::array<float, 3>{0, 0, 10}));
  EXPECT_HAS(objects_error("<emitter type='point'><point name='position' value='1'/>"
                           "<transform name='to_world'/></emitter>"),
             "a 'position' or a 'to_world', not both");
  EXPECT_HAS(objects_error("<emitter type='point'><texture type='checkerboard' name='intensity'/>"
                           "</emitter>"),
             "cannot be a texture that varies in space");
  EXPECT_HAS(objects_error("<emitter type='point'><medium type='homogeneous'/></emitter>"),
             "medium 'homogeneous' in an emitter is not supported yet");
  EXPECT_HAS(objects_error("<emitter type='point'><point name='position' value='inf'/></emitter>"),
             "is not finite");
  auto lit = build("<emitter type='point'><spectrum name='intensity' value='3'/></emitter>");
  const float* i = lit->view().lights[0].radiance;
  expect_near({i[0], i[1], i[2]}, {3.61438, 2.84487, 2.72675}, 5e-6); // Mitsuba's
}

TEST(MitsubaEmitter, Environments) {
  auto scene = build("<emitter type='constant'><rgb name='radiance' value='1,2,3'/>"
                     "<transform name='to_world'/></emitter>");
  EXPECT_EQ(scene->view().environment.present, 1);
  EXPECT_EQ(scene->view().environment.columns, 0);
  EXPECT_EQ(scene->view().environment.radiance[2], 3);
  EXPECT_EQ(objects_error("<emitter type='constant'/><emitter type='constant' id='b'/>"),
            "s.xml:1:50: error: a second environment: emitter of type 'constant' (id 'b') beside "
            "emitter of type 'constant'");
  EXPECT_HAS(objects_error("<emitter type='constant'><float name='scale' value='2'/></emitter>"),
             "unexpected property 'scale'");
  EXPECT_HAS(objects_error("<emitter type='constant'><texture type='checkerboard' "
                           "name='radiance'/></emitter>"),
             "varies in space");
  xml::TemporaryFolder folder;
  write_image(folder / "e.exr", Image(8, 4, {"R", "G", "B"}, 2));
  std::string file = "<string name='filename' value='" + (folder / "e.exr").string() + "'/>";
  // The renderer's frame of the map is turned about y by half a texel; to_world comes on top.
  auto plain = build("<emitter type='envmap'>" + file + "</emitter>");
  auto map = build("<emitter type='envmap'>" + file +
                   "<float name='scale' value='3'/><transform name='to_world'>"
                   "<rotate x='1' angle='90'/></transform></emitter>");
  EXPECT_GT(map->view().environment.columns, 0);
  EXPECT_EQ(map->view().environment.radiance[1], 3);
  const float* turned = map->view().environment.to_world;
  const float* straight = plain->view().environment.to_world;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(turned[i], straight[i], 1e-6);
    EXPECT_NEAR(turned[3 + i], -straight[6 + i], 1e-6);
    EXPECT_NEAR(turned[6 + i], straight[3 + i], 1e-6);
  }
  EXPECT_EQ(objects_error("<emitter type='envmap'/>"),
            "s.xml:1:24: error: emitter of type 'envmap' needs a string 'filename' (<string "
            "name=\"filename\" value=\"...\"/>)");
  EXPECT_HAS(objects_error("<emitter type='envmap'>" + file +
                           "<boolean name='mis_compensation' value='true'/></emitter>"),
             "'mis_compensation' of emitter 'envmap' is not supported yet");
  EXPECT_HAS(objects_error("<emitter type='envmap'>" + file +
                           "<transform name='to_world'><scale x='0'/></transform></emitter>"),
             "s.xml:1:");
  EXPECT_HAS(objects_error("<emitter type='envmap'>" + file +
                           "<float name='scale' value='-3'/></emitter>"),
             "not negative");
  std::string broken = folder.write("b.exr", "not a picture").string();
  EXPECT_HAS(objects_error("<emitter type='envmap'><string name='filename' value='" + broken +
                           "'/></emitter>"),
             "b.exr");
}

} // namespace
} // namespace faceta
