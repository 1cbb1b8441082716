#include "support.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <cmath>
#include <limits>

using namespace faceta;
using namespace faceta::test;

namespace {

struct Kind {
  Imf::Compression compression;
  Imf::PixelType type;
  bool tiled;
};

std::string name_of(const testing::TestParamInfo<Kind>& info) {
  static const char* const kNames[] = {"none",  "rle", "zips", "zip",  "piz",
                                       "pxr24", "b44", "b44a", "dwaa", "dwab"};
  static const char* const kTypes[] = {"uint", "half", "float"};
  return std::string(kNames[info.param.compression]) + "_" + kTypes[info.param.type] +
         (info.param.tiled ? "_tiled" : "_lines");
}

std::vector<Kind> kinds() {
  std::vector<Kind> out;
  for (int c = Imf::NO_COMPRESSION; c < Imf::NUM_COMPRESSION_METHODS; ++c)
    for (auto type : {Imf::UINT, Imf::HALF, Imf::FLOAT})
      for (bool tiled : {false, true})
        out.push_back({Imf::Compression(c), type, tiled});
  return out;
}

/// Writes an image with OpenEXR itself.
void write_kind(const std::string& path, const Image& image, const Kind& kind) {
  Imf::Header header(image.width, image.height);
  header.compression() = kind.compression;
  std::vector<std::uint32_t> ints(image.data.begin(), image.data.end());
  std::vector<half> halves(image.data.begin(), image.data.end());
  const void* values[] = {ints.data(), halves.data(), image.data.data()};
  const std::size_t size = kind.type == Imf::HALF ? 2 : 4, pixel = size * image.channels.size();
  const char* base = static_cast<const char*>(values[kind.type]);
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    header.channels().insert(image.channels[c], Imf::Channel(kind.type));
    frame.insert(image.channels[c], Imf::Slice(kind.type, const_cast<char*>(base + c * size), pixel,
                                               pixel * std::size_t(image.width)));
  }
  if (kind.tiled) {
    header.setTileDescription(Imf::TileDescription(16, 8, Imf::ONE_LEVEL));
    Imf::TiledOutputFile out(path.c_str(), header, 0);
    out.setFrameBuffer(frame);
    out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
  } else {
    Imf::OutputFile out(path.c_str(), header, 0);
    out.setFrameBuffer(frame);
    out.writePixels(image.height);
  }
}

class ExrKind : public testing::TestWithParam<Kind> {};

} // namespace

TEST_P(ExrKind, IsReadAsOpenExrWroteIt) {
  const TempDir dir;
  // Smooth, because the lossy compressions assume so; whole numbers for uint.
  Image image(45, 37, {"B", "G", "R"});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = static_cast<float>(64 + x + 2 * y + 16 * c);
  write_kind((dir / "a.exr").string(), image, GetParam());
  const Image back = read_image(dir / "a.exr");
  ASSERT_EQ(back.channels, (std::vector<std::string>{"R", "G", "B"}));
  ASSERT_EQ(back.width, 45);
  ASSERT_EQ(back.height, 37);
  const auto [compression, type, tiled] = GetParam();
  const bool lossy = type == Imf::HALF && compression >= Imf::B44_COMPRESSION;
  const bool dwa_float = type == Imf::FLOAT && compression >= Imf::DWAA_COMPRESSION;
  const double tolerance = lossy || dwa_float ? 0.05 : 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const float want = image.at(x, y, 2 - c);
        ASSERT_NEAR(back.at(x, y, c), want, tolerance * double(want)) << x << " " << y << " " << c;
      }
  const Bitmap bitmap = read_bitmap(dir / "a.exr");
  EXPECT_EQ(bitmap.type, type == Imf::HALF ? Bitmap::Type::f16 : Bitmap::Type::f32);
  EXPECT_FALSE(bitmap.srgb_encoded);
  EXPECT_EQ(bitmap.linear(44, 36, 1), back.at(44, 36, 1));
}

INSTANTIATE_TEST_SUITE_P(All, ExrKind, testing::ValuesIn(kinds()), name_of);

TEST(Exr, RoundTripKeepsValuesChannelsMetadataAndPlace) {
  const TempDir dir;
  Image image = half_noise(9, 6, {"R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B", "z"});
  image.data[0] = std::numeric_limits<float>::infinity();
  image.metadata = {{"spp", 128},
                    {"time", 1.25},
                    {"scene", std::string("cornell-box.xml")},
                    {"eye", V3f{1, 2, 3}},
                    {"to_world", M44f{{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}}},
                    {"chromaticities", Chromaticities{}}};
  image.x = 3, image.y = 2, image.full_width = 20, image.full_height = 10;
  for (bool half : {true, false}) {
    write_image(dir / "a.exr", image, {.half = half});
    const Image back = read_image(dir / "a.exr");
    EXPECT_EQ(back.channels, (std::vector<std::string>{"R", "G", "B", "A", "z", "albedo.R",
                                                       "albedo.G", "albedo.B"}));
    EXPECT_EQ(back.select(image.channels).data, image.data);
    EXPECT_EQ(back.metadata, image.metadata);
    EXPECT_EQ(back.x, 3);
    EXPECT_EQ(back.y, 2);
    EXPECT_EQ(back.full_width, 20);
    EXPECT_EQ(back.full_height, 10);
    EXPECT_EQ(read_bitmap(dir / "a.exr").type, half ? Bitmap::Type::f16 : Bitmap::Type::f32);
  }
}

TEST(Exr, FloatsSurviveExactlyAndHalvesAreClampedNotInfinite) {
  const TempDir dir;
  Image image(3, 1, {"Y"});
  image.data = {1.0f / 3, 1e6f, -3e38f};
  write_image(dir / "f.exr", image, {.half = false});
  EXPECT_EQ(read_image(dir / "f.exr").data, image.data);
  write_image(dir / "h.exr", image);
  EXPECT_EQ(read_image(dir / "h.exr").data, (std::vector<float>{0.333251953125f, 65504, -65504}));
}

TEST(Exr, PartsBecomeChannels) {
  const TempDir dir;
  std::vector<Imf::Header> headers;
  for (const char* part : {"left", "right"}) {
    Imf::Header header(4, 3);
    if (std::string(part) == "right")
      header.dataWindow().min.x = 2;
    header.setName(part);
    header.setType(Imf::SCANLINEIMAGE);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    headers.push_back(header);
  }
  const std::vector<float> values{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  {
    Imf::MultiPartOutputFile out((dir / "m.exr").c_str(), headers.data(), 2, false, 0);
    for (int part = 0; part < 2; ++part) {
      Imf::OutputPart writer(out, part);
      Imf::FrameBuffer frame;
      frame.insert("Y", Imf::Slice(Imf::FLOAT,
                                   const_cast<char*>(reinterpret_cast<const char*>(values.data())),
                                   4, 16));
      writer.setFrameBuffer(frame);
      writer.writePixels(3);
    }
  }
  const Image image = read_image(dir / "m.exr");
  ASSERT_EQ(image.channels, (std::vector<std::string>{"Y", "right.Y"}));
  EXPECT_EQ(image.at(1, 1, 0), 5);
  EXPECT_EQ(image.at(1, 1, 1), 0); // outside the second part's window
  EXPECT_EQ(image.at(2, 1, 1), 6);
}

TEST(Exr, SubsampledChannelsAreRefused) {
  const TempDir dir;
  {
    Imf::Header header(4, 4);
    header.channels().insert("R", Imf::Channel(Imf::HALF, 2, 2));
    Imf::OutputFile out((dir / "s.exr").c_str(), header, 0);
    std::vector<half> values(4);
    Imf::FrameBuffer frame;
    frame.insert("R", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(values.data()), 2, 4, 2, 2));
    out.setFrameBuffer(frame);
    out.writePixels(4);
  }
  EXPECT_CONTAINS(read_error(dir / "s.exr"), "'R' is sub-sampled");
}

TEST(Exr, NamesThatTheFormatUsesAreRefused) {
  const TempDir dir;
  Image image = half_noise(2, 2);
  image.metadata["dataWindow"] = 1;
  EXPECT_THROW(write_image(dir / "a.exr", image), Error);
  image.metadata.clear();
  image.channels = {"R", "R", "B"};
  EXPECT_THROW(write_image(dir / "a.exr", image), Error);
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

TEST(Exr, SmallFilesCannotClaimMuch) {
  const TempDir dir;
  write_image(dir / "a.exr", half_noise(8, 8));
  codec::Bytes bytes = codec::read_file(dir / "a.exr");
  const auto patch = [&](const std::string& key, std::size_t skip, std::uint32_t value) {
    const std::string text(bytes.begin(), bytes.end());
    const std::size_t at = text.find(key) + key.size() + skip;
    for (std::size_t i = 0; i < 4; ++i)
      bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
    codec::write_file(dir / "b.exr", bytes);
    bytes.assign(text.begin(), text.end());
    return read_error(dir / "b.exr");
  };
  // Right of "dataWindow\0box2i\0": the size, then x0, y0, x1, y1.
  EXPECT_CONTAINS(patch("dataWindow", 1 + 6 + 4 + 8, 0x7fffffff), "too large");
  EXPECT_CONTAINS(patch("dataWindow", 1 + 6 + 4 + 12, 60000), "too short for its table");
  EXPECT_CONTAINS(patch("chromaticities", 1 + 15, 0x7fffffff), "more than the file has");
  EXPECT_CONTAINS(patch("channels", 1 + 7, 0xffffffff), "more than the file has");
}

// OpenEXR reads a value as its type wants and goes on from there, whatever size the header says:
// what hides in the difference must not be taken for attributes, which may claim gigabytes.
TEST(Exr, AttributesOfAnotherSizeThanTheirTypeAreRefused) {
  const TempDir dir;
  Image image = half_noise(8, 8);
  image.metadata = {{"eye", V3f{1, 2, 3}}};
  write_image(dir / "a.exr", image);
  const codec::Bytes bytes = codec::read_file(dir / "a.exr");
  const std::string text(bytes.begin(), bytes.end());
  const std::string hidden("a\0zzz\0\0\0\0\x70", 10);
  const auto hide = [&](const std::string& key, const std::string& type) {
    const std::size_t at = text.find(key + '\0' + type + '\0') + key.size() + type.size() + 2;
    const auto size = static_cast<std::uint8_t>(text[at]);
    std::string longer = text;
    longer.insert(at + 4 + size, hidden);
    longer[at] = static_cast<char>(size + hidden.size());
    write_bytes(dir / "b.exr", longer);
    return read_error(dir / "b.exr");
  };
  EXPECT_CONTAINS(hide("channels", "chlist"), "'channels' of type chlist claims 65 bytes");
  EXPECT_CONTAINS(hide("dataWindow", "box2i"), "'dataWindow' of type box2i claims 26 bytes");
  EXPECT_CONTAINS(hide("eye", "v3f"), "'eye' of type v3f claims 22 bytes, but has 12");
}

// A file of scan lines may carry a description of tiles, whose sizes must not overflow anything.
TEST(Exr, TilesOfAbsurdSizeAreRefusedInScanLinesToo) {
  const TempDir dir;
  write_image(dir / "a.exr", half_noise(8, 8));
  const codec::Bytes bytes = codec::read_file(dir / "a.exr");
  std::string text(bytes.begin(), bytes.end());
  text.insert(8, std::string("tiles\0tiledesc\0\x09\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff\0", 28));
  write_bytes(dir / "b.exr", text);
  EXPECT_CONTAINS(read_error(dir / "b.exr"), "tiles of 4294967295 x 4294967295 pixels");
}
