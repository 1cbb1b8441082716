#include "formats/mesh_ply.h"
#include "mesh_checks.h"

#include <cstring>

using namespace faceta;

namespace {

using Indices = std::vector<uint32_t>;

Mesh parse(const std::string& bytes, const MeshOptions& options = {}) {
  return parse_ply(bytes, "test.ply", options);
}

std::string refusal(const std::string& bytes) {
  return error_of([&] { parse(bytes); });
}

const std::string kVertexXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "property list uchar int vertex_indices\n";
const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 1\n";

std::string ascii_square(const std::string& face_count, const std::string& faces) {
  return "ply\nformat ascii 1.0\nelement vertex 4\n" + kVertexXyz + "element face " + face_count +
         "\n" + kFaces + "end_header\n" + kSquare + faces;
}

const std::string kFullVertex = kVertexXyz +
                                "property float nx\nproperty float ny\nproperty float nz\n"
                                "property float s\nproperty float t\nproperty uchar red\n"
                                "property float r\nproperty float g\nproperty float b\n";
const std::string kFull = "ply\nformat ascii 1.0\ncomment made by hand\nobj_info none\n"
                          "element vertex 3\n" +
                          kFullVertex + "element face 1\n" + kFaces +
                          "end_header\n"
                          "0 0 0 0 0 2 .1 .2 255 .1 .2 .3\n1 0 0 0 0 1 .3 .4 3 .1 .2 .3\n"
                          "1 1 0 0 1 1 .5 .6 3 .1 .2 .3\n3 0 1 2\n";

template <class T> void put(std::string& out, T value, bool big_endian) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big_endian)
    std::reverse(bytes, bytes + sizeof(T));
  out.append(bytes, sizeof(T));
}

// Odd types and order, faces before vertices, lists and elements to be skipped.
std::string binary_file(bool big) {
  std::string out = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                    "_endian 1.0\r\nelement face 3\r\nproperty float32 quality\r\n"
                    "property list ushort int16 vertex_index\r\n"
                    "property list uint8 float64 texcoord\r\nelement edge 2\r\n"
                    "property int a\r\nproperty list char short b\r\nelement vertex 4\r\n"
                    "property uint8 red\r\nproperty double z\r\nproperty short y\r\n"
                    "property list int8 int32 neighbours\r\nproperty float16 x\r\n"
                    "property float v\r\nproperty half u\r\nend_header\r\n";
  for (std::vector<int16_t> face : {std::vector<int16_t>{0, 1, 2, 3}, {3, 2, 1}, {1, 2}}) {
    put(out, 0.5f, big);
    put(out, static_cast<uint16_t>(face.size()), big);
    for (int16_t index : face)
      put(out, index, big);
    put(out, uint8_t{1}, big);
    put(out, 0.25, big);
  }
  for (int i = 0; i < 2; ++i) {
    put(out, int32_t{7}, big);
    put(out, static_cast<int8_t>(i), big);
    for (int k = 0; k < i; ++k)
      put(out, int16_t{9}, big);
  }
  const uint16_t half_x[4] = {0x0000, 0x3c00, 0xc100, 0x3555}; // 0, 1, -2.5, 0.333251953125
  for (int i = 0; i < 4; ++i) {
    put(out, uint8_t{200}, big);
    put(out, 0.1 * i, big);
    put(out, static_cast<int16_t>(-300 * i), big);
    put(out, int8_t{2}, big);
    put(out, int32_t{1}, big);
    put(out, int32_t{2}, big);
    put(out, half_x[i], big);
    put(out, 0.25f * i, big);
    put(out, uint16_t{0x0001}, big); // the smallest subnormal, 2^-24
  }
  return out;
}

TEST(Ply, ReadsWhatMitsubaReads) {
  // Arrays of mi.traverse() of the same text (less obj_info), Mitsuba 3.9.1.
  Mesh mesh = parse(kFull);
  expect_list(mesh.positions, {0, 0, 0, 1, 0, 0, 1, 1, 0});
  expect_list(mesh.normals, {0, 0, 1, 0, 0, 1, 0, 0.7071070, 0.7071070});
  expect_list(mesh.uvs, {.1, .2, .3, .4, .5, .6});
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
  EXPECT_EQ(mesh.ignored_attributes,
            (std::vector<std::string>{"vertex_red", "vertex_r", "vertex_g", "vertex_b"}));
  MeshOptions flipped{.flip_tex_coords = true};
  expect_list(parse(kFull, flipped).uvs, {.1, .8, .3, .6, .5, .4});
  place(mesh, {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1});
  // vertex_normals with to_world = scale(-1, 1, 2), Mitsuba 3.9.1
  expect_list(mesh.normals, {0, 0, 1, 0, 0, 1, 0, 0.894427, 0.447214});
}

TEST(Ply, UnreferencedVerticesGetMitsubasNormal) {
  Mesh mesh = parse(ascii_square("1", "3 0 1 2\n"));
  place(mesh, kIdentityToWorld);
  // vertex_normals in Mitsuba 3.9.1
  expect_list(mesh.normals, {0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0});
}

TEST(Ply, PolygonsBecomeFans) {
  Mesh mesh = parse(ascii_square("4", "3 0 1 2\n4 0 1 2 3\n2 0 1\n5 3 2 1 0 1"));
  EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 1, 2, 0, 2, 3, 3, 2, 1, 3, 1, 0, 3, 0, 1}));
}

TEST(Ply, BinaryOfBothOrders) {
  for (bool big : {false, true}) {
    SCOPED_TRACE(big);
    Mesh mesh = parse(binary_file(big));
    expect_list(mesh.positions, {0, 0, 0, 1, -300, .1, -2.5, -600, .2, 0.333251953125, -900, .3},
                1e-7);
    expect_list(mesh.uvs, {0x1p-24, 0, 0x1p-24, .25, 0x1p-24, .5, 0x1p-24, .75}, 0);
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 2, 3, 3, 2, 1}));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_EQ(mesh.ignored_attributes,
              (std::vector<std::string>{"face_quality", "face_texcoord", "edge", "vertex_red",
                                        "vertex_neighbours"}));
  }
}

TEST(Ply, NamesOfTextureCoordinates) {
  auto with = [](const std::string& u, const std::string& v) {
    std::string text = kFull;
    text.replace(text.find("float t"), 7, "float " + v);
    text.replace(text.find("float s"), 7, "float " + u);
    return parse(text).uvs.size();
  };
  // has vertex_texcoords, Mitsuba 3.9.1
  EXPECT_EQ(with("s", "t"), 6u);
  EXPECT_EQ(with("u", "v"), 6u);
  EXPECT_EQ(with("texture_u", "texture_v"), 6u);
  EXPECT_EQ(with("texture_s", "texture_t"), 0u);
  EXPECT_EQ(with("u", "w"), 0u);
}

TEST(Ply, EmptyMeshesAreAllowed) {
  EXPECT_EQ(parse(ascii_square("0", "")).triangle_count(), 0u);
  EXPECT_EQ(
      parse("ply\nformat ascii 1.0\nelement vertex 0\n" + kVertexXyz + "end_header").vertex_count(),
      0u);
}

TEST(Ply, ZeroNormalsAreComputed) {
  std::string text = kFull;
  text.replace(text.find("0 0 2"), 5, "0 0 0");
  Mesh mesh = parse(text);
  place(mesh, kIdentityToWorld);
  expect_list({mesh.normals.begin(), mesh.normals.begin() + 3}, {0, 0, 1});
}

TEST(Ply, HeaderErrorsNameTheirPlace) {
  EXPECT_NE(refusal("").find("not a PLY file"), std::string::npos);
  EXPECT_NE(refusal("plyx\n").find("not a PLY file"), std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\n").find("no end_header"), std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 2.0\nend_header\n")
                .find("test.ply:2:14: error: unknown PLY version '2.0'"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat text 1.0\nend_header\n").find("unknown PLY format 'text'"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nend_header\n").find("no format"), std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nproperty float x\n").find("before the first element"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nelement vertex -1\n").find("'-1' is not a count"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty number x\n")
                .find("test.ply:4:10: error: unknown PLY type 'number'"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n")
                .find("cannot be a fraction"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nelement v 1\nproperty int x\nproperty int x\n")
                .find("declared twice"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nelements\n").find("known: format, element"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nend_header\n").find("no element 'vertex'"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nend_header\n1\n")
                .find("lacks x, y or z"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nelement vertex 0\n" + kVertexXyz +
                    "element face 1\nend_header\n")
                .find("no list of corners"),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nelement vertex 0\n" + kVertexXyz +
                    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n1 0\n")
                .find("triangle strips"),
            std::string::npos);
}

TEST(Ply, CountsBeyondTheFileAreRefused) {
  for (const char* count : {"1000000000", "18446744073709551615"}) {
    EXPECT_NE(refusal(ascii_square(count, "3 0 1 2\n")).find("more rows than the file can hold"),
              std::string::npos);
    std::string binary = std::string("ply\nformat binary_little_endian 1.0\nelement vertex ") +
                         count + "\n" + kVertexXyz + "end_header\nabcdefgh";
    EXPECT_NE(refusal(binary).find("test.ply:3:16: error: element 'vertex' claims more rows"),
              std::string::npos);
  }
  // Nothing can be skipped by the billion, either.
  std::string text = ascii_square("1", "3 0 1 2\n");
  text.replace(text.find("element face"), 0, "element ghost 18446744073709551615\n");
  EXPECT_EQ(parse(text).triangle_count(), 1u);
  // A list that claims to be longer than the rest of the file.
  std::string list = "ply\nformat binary_little_endian 1.0\nelement vertex 0\n" + kVertexXyz +
                     "element face 1\nproperty list uint int vertex_indices\n"
                     "property list ulong double more\nend_header\n";
  put(list, uint32_t{0}, false);
  put(list, uint64_t{1} << 62, false);
  EXPECT_NE(refusal(list).find("the file ends before property 'more', at byte "),
            std::string::npos);
}

TEST(Ply, DataErrorsNameTheirPlace) {
  EXPECT_NE(refusal(ascii_square("1", "3 0 1 7\n")).find("test.ply:14:7: error: vertex index 7"),
            std::string::npos);
  EXPECT_NE(refusal(ascii_square("1", "3 0 1 -1\n")).find("vertex index -1 is out of range"),
            std::string::npos);
  EXPECT_NE(refusal(ascii_square("1", "3 0 1 x\n")).find("'x' is not an integer"),
            std::string::npos);
  EXPECT_NE(refusal(ascii_square("1", "-3 0 1 2\n")).find("negative number of corners"),
            std::string::npos);
  EXPECT_NE(refusal(ascii_square("1", "3 0 1")).find("the file ends before"), std::string::npos);
  EXPECT_NE(refusal(ascii_square("1", "3 0 1 2\n5 6\n")).find("goes on after its last element"),
            std::string::npos);
  for (const char* bad : {"nan", "inf", "1e39"}) {
    std::string text = ascii_square("1", "3 0 1 2\n");
    text.replace(text.find("1 1 0\n"), 1, bad);
    EXPECT_NE(refusal(text).find("test.ply:12:1: error: property 'x' is not finite"),
              std::string::npos);
  }
  std::string text = ascii_square("1", "3 0 1 2\n");
  text.replace(text.find("1 1 0\n"), 1, "1,5");
  EXPECT_NE(refusal(text).find("'1,5' is not a number"), std::string::npos);
  std::string binary = binary_file(false);
  EXPECT_NE(
      refusal(binary.substr(0, binary.size() - 1))
          .find("the file ends before property 'u', at byte " + std::to_string(binary.size() - 2)),
      std::string::npos);
  EXPECT_NE(refusal(binary + "x").find("goes on after"), std::string::npos);
}

TEST(Ply, ReadsFiles) {
  TemporaryFolder folder;
  EXPECT_EQ(read_ply(folder.write("a.ply", kFull)).indices, (Indices{0, 1, 2}));
  EXPECT_NE(error_of([&] { read_ply(folder.folder() + "/none.ply"); }).find("file not found"),
            std::string::npos);
}

TEST(Ply, DamagedFilesEndInAnErrorOrAMesh) {
  for (const std::string& bytes :
       {kFull, ascii_square("2", "3 0 1 2\n4 0 1 2 3\n"), binary_file(false), binary_file(true)})
    mutate(bytes, [](const std::string& damaged) { return parse(damaged); });
}

} // namespace
