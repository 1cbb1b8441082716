#pragma once

#include "base/error.h"
#include "image/codecs.h"
#include "image/io.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <random>
#include <unistd.h>

namespace faceta::test {

/// A fresh folder, removed at the end of the test.
class TempDir {
public:
  TempDir() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("faceta-image-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TempDir() { std::filesystem::remove_all(path_); }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

/// Values over eight powers of two, positive, exactly representable as half.
inline Image half_noise(int width, int height, std::vector<std::string> channels = {"R", "G", "B"},
                        unsigned seed = 1) {
  Image out(width, height, std::move(channels));
  std::mt19937 random(seed);
  for (float& v : out.data) {
    const float mantissa = static_cast<float>(random() % 1024 + 1024) / 1024.0f;
    v = mantissa * static_cast<float>(1 << (random() % 8)) / 16.0f;
  }
  return out;
}

inline void write_bytes(const std::filesystem::path& path, const std::string& text) {
  codec::write_file(path,
                    codec::View(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

/// The text of the Error that reading a file ends in; empty if it is read.
inline std::string read_error(const std::filesystem::path& path) {
  try {
    read_image(path);
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

#define EXPECT_CONTAINS(text, part)                                                                \
  EXPECT_NE(std::string(text).find(part), std::string::npos) << "in: " << (text)

} // namespace faceta::test
