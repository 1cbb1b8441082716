#include "formats/mesh_obj.h"
#include "mesh_checks.h"

using namespace faceta;

namespace {

using Indices = std::vector<uint32_t>;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string kFull = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nvn 0 1 1\nvt 0 0.25\nvt 1 0\n"
                          "f 1/1/1 2/2/2 3/1/2\n";
const std::string kFivePoints = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nv -1 .5 0\n";

Mesh parse(const std::string& text, const MeshOptions& options = kObjDefaults) {
  return parse_obj(text, "test.obj", options);
}

std::string refusal(const std::string& text) {
  return error_of([&] { parse(text); });
}

TEST(Obj, ReadsWhatMitsubaReads) {
  // Arrays of mi.traverse() of the same text, Mitsuba 3.9.1.
  Mesh mesh = parse(kFull);
  expect_list(mesh.positions, {0, 0, 0, 1, 0, 0, 0, 1, 0});
  expect_list(mesh.normals, {0, 0, 1, 0, 0.7071070, 0.7071070, 0, 0.7071070, 0.7071070});
  expect_list(mesh.uvs, {0, 0.75, 1, 1, 0, 0.75});
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
}

TEST(Obj, SplitsPolygonsAsMitsubaDoes) {
  // faces and vertex_normals in Mitsuba 3.9.1
  Mesh quad = parse(kFivePoints + "f 1 2 3 4\n");
  EXPECT_EQ(quad.indices, (Indices{0, 1, 2, 0, 2, 3}));
  EXPECT_TRUE(quad.normals.empty());
  place(quad, kIdentityToWorld);
  expect_list(quad.normals, {0.370483, -0.370483, 0.851754, 0, 0, 1, 0.370483, -0.370483, 0.851754,
                             0.577350, -0.577350, 0.577350});
  Mesh pentagon = parse(kFivePoints + "f 1 2 3 4 5\n");
  EXPECT_EQ(pentagon.indices, (Indices{0, 1, 2, 0, 2, 3, 0, 3, 4}));
  place(pentagon, kIdentityToWorld);
  expect_list(pentagon.normals,
              {0.0709420, -0.541639, 0.837612, 0, 0, 1, 0.370483, -0.370483, 0.851754, 0.210059,
               -0.691330, 0.691330, -0.333333, -0.666667, 0.666667});
}

TEST(Obj, NonUniformScaleTurnsNormalsAsInMitsuba) {
  Mesh mesh = parse(kFull);
  place(mesh, {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1});
  // vertex_normals with to_world = scale(1, 2, 3), Mitsuba 3.9.1
  expect_list(mesh.normals, {0, 0, 1, 0, 0.832050, 0.554700, 0, 0.832050, 0.554700});
}

TEST(Obj, MergesEqualCornersOnly) {
  // v, v/vt, v//vn and v/vt/vn of one position are four vertices.
  Mesh mesh = parse(kFull + "f 1 2/1 3//2\nf 1/1/1 2/2/2 3//2\n");
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 3, 4, 5, 0, 1, 5}));
  ASSERT_EQ(mesh.uvs.size(), 12u);
  EXPECT_EQ(mesh.uvs[6], 0.0f); // without vt: (0, 0)
  EXPECT_EQ(mesh.uvs[7], 0.0f);
  EXPECT_EQ(mesh.uvs[9], 0.75f);
  // Without vn: marked by a zero normal until place() computes one.
  expect_list({mesh.normals.begin() + 9, mesh.normals.begin() + 12}, {0, 0, 0});
  place(mesh, kIdentityToWorld);
  expect_list({mesh.normals.begin() + 9, mesh.normals.begin() + 12}, {0, 0, 1});
}

TEST(Obj, UnusedDataIsLeftOut) {
  Mesh mesh = parse(kFivePoints + "vt 0 0\nvn 0 0 1\nf 2 3 4\n");
  expect_list(mesh.positions, {1, 0, 0, 1, 1, 0, 0, 1, 1});
  EXPECT_TRUE(mesh.uvs.empty());
  EXPECT_TRUE(mesh.normals.empty());
}

TEST(Obj, NegativeAndForwardIndices) {
  EXPECT_EQ(parse(kFivePoints + "f -3 -2 -1\n").positions,
            parse(kFivePoints + "f 3 4 5\n").positions);
  EXPECT_EQ(parse("f 1/1 2/2 3/2\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 1\n").indices,
            (Indices{0, 1, 2}));
  // Negative indices count from where they stand, not from the end of the file.
  Mesh mesh = parse("v 7 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 9 9 9\n");
  EXPECT_EQ(mesh.positions[0], 7.0f);
}

TEST(Obj, LayoutDoesNotMatter) {
  Mesh plain = parse(kFull);
  std::string crlf = kFull, cr = kFull;
  for (size_t i = 0; (i = crlf.find('\n', i)) != crlf.npos; i += 2)
    crlf.insert(i, "\r");
  std::replace(cr.begin(), cr.end(), '\n', '\r');
  std::string wild = "\xef\xbb\xbf# comment with f 9 9 9\nmtllib C:\\dir\\\no thing\n\n"
                     "v\t0 0 0 1.0 # weight\n  v 1 0 \\\n 0 .5 .5 .5\nv 0 +1 0e0\ng a b\ns off\n"
                     "vn 0 0 2\nvn 0 1 1\nusemtl x\nvt 0 0.25 0\nvt 1\nl 1 2\n"
                     "f 1/1/1 2/2/2 \\\r\n 3/1/2# end\nf 1 2\nf 1";
  for (const std::string& text : {crlf, cr, wild}) {
    Mesh mesh = parse(text);
    EXPECT_EQ(mesh.positions, plain.positions);
    EXPECT_EQ(mesh.normals, plain.normals);
    EXPECT_EQ(mesh.uvs, plain.uvs);
    EXPECT_EQ(mesh.indices, plain.indices);
  }
}

TEST(Obj, Options) {
  MeshOptions options{.flip_tex_coords = false, .face_normals = true, .flip_normals = true};
  Mesh mesh = parse(kFull, options);
  expect_list(mesh.uvs, {0, 0.25, 1, 0, 0, 0.25});
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.face_normals);
  EXPECT_TRUE(mesh.flip_normals);
}

TEST(Obj, NumbersAreTheNearestFloats) {
  Mesh mesh = parse("v 0.1 1e-50 -1e-400\nv 16777217 3.4028235e38 1e-40\nv .5 5. -0\nf 1 2 3\n");
  EXPECT_EQ(mesh.positions, (std::vector<float>{0.1f, 0, -0.0f, 16777217.f, 3.4028235e38f, 1e-40f,
                                                .5f, 5.f, -0.f}));
}

TEST(Obj, ErrorsNameTheirPlace) {
  EXPECT_NE(refusal(kTriangle + "v a b c\n").find("test.obj:5:3: error: 'a' is not a number"),
            std::string::npos);
  EXPECT_NE(refusal("v 1 2\n" + kTriangle).find("test.obj:1:6: error: the vertex has too few"),
            std::string::npos);
  EXPECT_NE(refusal("v 1 2 3f\n").find("'3f' is not a number"), std::string::npos);
  EXPECT_NE(refusal("v nan 0 0\n").find("not finite"), std::string::npos);
  EXPECT_NE(refusal("v 0 1e39 0\n").find("not finite"), std::string::npos);
  EXPECT_NE(refusal("v 0 1e999 0\n").find("not finite"), std::string::npos);
  EXPECT_NE(refusal("vt inf 0\n").find("not finite"), std::string::npos);
  EXPECT_NE(refusal(kTriangle + "\r\nf 1 2 4\n")
                .find("test.obj:6:7: error: vertex index 4 is out of range (indices run from 1"),
            std::string::npos);
  EXPECT_NE(refusal(kTriangle + "f 0 1 2\n").find("5:3: error: vertex index 0"), std::string::npos);
  EXPECT_NE(refusal(kTriangle + "f 1 2 -4\n").find("vertex index -4"), std::string::npos);
  EXPECT_NE(refusal(kTriangle + "f 1/1 2 3\n").find("texture coordinate index 1 is out of range"),
            std::string::npos);
  EXPECT_NE(refusal(kTriangle + "f 1//9 2 3\n").find("normal index 9"), std::string::npos);
  EXPECT_NE(refusal(kTriangle + "f 1 2 99999999999999999999\n").find("out of range"),
            std::string::npos);
  EXPECT_NE(refusal(kTriangle + "f 1 2 3/1/1/1\n").find("does not belong to a face"),
            std::string::npos);
  EXPECT_NE(refusal(kTriangle + "f 1 2 x\n").find("'x' is not an index"), std::string::npos);
  EXPECT_NE(refusal("# nothing\n").find("no faces"), std::string::npos);
  EXPECT_NE(refusal("").find("no faces"), std::string::npos);
}

TEST(Obj, ReadsFiles) {
  TemporaryFolder folder;
  EXPECT_EQ(read_obj(folder.write("a.obj", kTriangle)).indices, (Indices{0, 1, 2}));
  EXPECT_NE(error_of([&] { read_obj(folder.folder() + "/none.obj"); }).find("file not found"),
            std::string::npos);
  EXPECT_NE(error_of([&] { read_obj(folder.folder()); }).find("not a regular file"),
            std::string::npos);
}

TEST(Obj, ManyCornersOfOnePositionStayFast) {
  // A chain per position would need 10^10 steps here.
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  constexpr int kCorners = 150000;
  for (int i = 0; i < kCorners; ++i)
    text += "vt 0 0\n";
  for (int i = 1; i <= kCorners; ++i)
    text += "f 1/" + std::to_string(i) + " 2 3\n";
  EXPECT_EQ(parse(text).vertex_count(), kCorners + 2u);
}

TEST(Obj, DamagedFilesEndInAnErrorOrAMesh) {
  mutate(kFull + "f -3//-1 -2//-1 -1//-2\n# c\ng x\nf 1/1 2/2 3/1 1/2\n",
         [](const std::string& bytes) { return parse(bytes); });
}

} // namespace
