#include "support.h"

using namespace faceta;
using namespace faceta::test;

namespace {

/// Decodes a damaged file. True if it was read, false if it ended in an Error that names it; any
/// other exception fails the test, a crash ends it.
bool survives(codec::View file) {
  try {
    const Bitmap bitmap = codec::decode(file, "damaged").bitmap;
    EXPECT_EQ(bitmap.bytes.size(), std::size_t(bitmap.width) * std::size_t(bitmap.height) *
                                       std::size_t(bitmap.channels) *
                                       std::size_t(Bitmap::size_of(bitmap.type)));
    return true;
  } catch (const Error& e) {
    EXPECT_EQ(e.where().file, "damaged") << e.what();
    return false;
  }
}

codec::Bytes encoded(const std::string& ending) {
  const TempDir dir;
  write_image(dir / ("a" + ending), half_noise(31, 23));
  return codec::read_file(dir / ("a" + ending));
}

} // namespace

TEST(Io, FormatsAreToldApartByContent) {
  const TempDir dir;
  const Image image = half_noise(12, 7);
  for (const char* ending : {".exr", ".png", ".hdr", ".pfm"}) {
    const auto path = dir / (std::string("a") + ending);
    write_image(path, image);
    std::filesystem::rename(path, dir / "b.jpg");
    EXPECT_EQ(read_image(dir / "b.jpg").width, 12) << ending;
    EXPECT_TRUE(can_write_image(path));
  }
  EXPECT_FALSE(can_write_image("a.jpg"));
  EXPECT_TRUE(can_write_image("a.EXR"));
}

TEST(Io, ErrorsNameTheFile) {
  const TempDir dir;
  EXPECT_CONTAINS(read_error(dir / "none.exr"), "no such file");
  EXPECT_CONTAINS(read_error(dir / "none.exr"), "none.exr");
  EXPECT_CONTAINS(read_error(dir.path()), "not a regular file");
  write_bytes(dir / "text.png", "hello");
  EXPECT_CONTAINS(read_error(dir / "text.png"), "known by their first bytes");
  write_bytes(dir / "empty.png", "");
  EXPECT_CONTAINS(read_error(dir / "empty.png"), "empty");
  EXPECT_THROW(write_image(dir / "a.jpg", half_noise(2, 2)), Error);
  EXPECT_THROW(write_image(dir / "no folder/a.png", half_noise(2, 2)), Error);
  Image broken = half_noise(2, 2);
  broken.data.pop_back();
  EXPECT_THROW(write_image(dir / "a.png", broken), Error);
}

TEST(Io, WritingReplacesAndLeavesNoTemporaryFile) {
  const TempDir dir;
  write_bytes(dir / "a.pfm", "old");
  write_image(dir / "a.pfm", half_noise(2, 2));
  EXPECT_EQ(read_image(dir / "a.pfm").width, 2);
  std::filesystem::create_directory(dir / "d.pfm");
  EXPECT_THROW(write_image(dir / "d.pfm", half_noise(2, 2)), Error);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir.path()), {}), 2);
}

TEST(Io, TruncatedFilesAreErrors) {
  for (const char* ending : {".exr", ".png", ".hdr", ".pfm"}) {
    const codec::Bytes bytes = encoded(ending);
    for (std::size_t size = 0; size < bytes.size(); size += size < 500 ? 1 : 29)
      ASSERT_FALSE(survives(codec::View(bytes).first(size)))
          << ending << " cut to " << size << " of " << bytes.size();
    ASSERT_FALSE(survives(codec::View(bytes).first(bytes.size() - 1))) << ending;
  }
}

TEST(Io, DamagedFilesEndInAnErrorOrAPicture) {
  std::mt19937 random(5);
  for (const char* ending : {".exr", ".png", ".hdr", ".pfm"}) {
    const codec::Bytes bytes = encoded(ending);
    int errors = 0;
    for (std::size_t i = 0; i < 2000; ++i) {
      codec::Bytes damaged = bytes;
      // The header at every byte in turn, the rest at random places.
      std::uint8_t& byte = damaged[(i < 1000 ? i / 2 : random()) % bytes.size()];
      byte = std::uint8_t(i % 2 ? random() : byte ^ 0x80u);
      errors += !survives(damaged);
    }
    EXPECT_GT(errors, 0) << ending;
  }
}
