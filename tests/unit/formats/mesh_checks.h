#pragma once

#include "base/error.h"
#include "scene/mesh.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <string>

inline void expect_list(const std::vector<float>& ours, const std::vector<double>& theirs,
                        double tolerance = 2e-6) {
  ASSERT_EQ(ours.size(), theirs.size());
  for (size_t i = 0; i < ours.size(); ++i)
    EXPECT_NEAR(ours[i], theirs[i], tolerance) << i;
}

// The text of the Error that `action` throws; a failure if it throws none.
inline std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const faceta::Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no Error was thrown";
  return {};
}

// What every mesh promises, whatever the file was.
inline void expect_sound(const faceta::Mesh& mesh, size_t file_size) {
  size_t vertices = mesh.vertex_count();
  ASSERT_EQ(mesh.positions.size(), 3 * vertices);
  ASSERT_TRUE(mesh.normals.empty() || mesh.normals.size() == 3 * vertices);
  ASSERT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == 2 * vertices);
  ASSERT_EQ(mesh.indices.size() % 3, 0u);
  ASSERT_LE(vertices, file_size);
  ASSERT_LE(mesh.triangle_count(), file_size);
  for (uint32_t index : mesh.indices)
    ASSERT_LT(index, vertices);
  for (const std::vector<float>* list : {&mesh.positions, &mesh.normals, &mesh.uvs})
    for (float x : *list)
      ASSERT_TRUE(std::isfinite(x));
}

// Truncations at every byte, and thousands of damaged copies: each reads well or ends in an Error.
inline void mutate(const std::string& bytes,
                   const std::function<faceta::Mesh(const std::string&)>& parse) {
  int read = 0, refused = 0;
  auto attempt = [&](const std::string& damaged) {
    try {
      faceta::Mesh mesh = parse(damaged);
      expect_sound(mesh, damaged.size());
      faceta::place(mesh, faceta::kIdentityToWorld);
      expect_sound(mesh, damaged.size());
      ++read;
    } catch (const faceta::Error& error) {
      EXPECT_FALSE(error.message().empty());
      ++refused;
    }
  };
  for (size_t n = 0; n < bytes.size(); ++n)
    attempt(bytes.substr(0, n));
  std::mt19937 random(12345);
  static const std::string kAlphabet = "0123456789 -+./#\\\n\rvnfetx\0\xff\x80";
  for (int i = 0; i < 4000; ++i) {
    std::string damaged = bytes;
    for (unsigned k = random() % 4 + 1; k > 0 && !damaged.empty(); --k) {
      size_t at = random() % damaged.size();
      switch (random() % 4) {
      case 0:
        damaged[at] = static_cast<char>(random());
        break;
      case 1:
        damaged[at] = kAlphabet[random() % kAlphabet.size()];
        break;
      case 2:
        damaged.erase(at, random() % 5);
        break;
      default:
        damaged.insert(at, 1, kAlphabet[random() % kAlphabet.size()]);
      }
    }
    attempt(damaged);
  }
  EXPECT_GT(read, 0);
  EXPECT_GT(refused, 0);
}

// A fresh folder that goes away with the test.
class TemporaryFolder {
public:
  TemporaryFolder() {
    std::random_device random;
    path_ = std::filesystem::temp_directory_path() / ("faceta_mesh_" + std::to_string(random()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code code;
    std::filesystem::remove_all(path_, code);
  }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::string path = (path_ / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  std::string folder() const { return path_.string(); }

private:
  std::filesystem::path path_;
};
