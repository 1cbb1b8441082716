#pragma once

#include "formats/xml_tree.h"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

namespace faceta::xml {

inline std::string scene(const std::string& body, const std::string& version = "3.0.0") {
  return "<scene version=\"" + version + "\">" + body + "</scene>";
}

/// A scene with one bsdf that holds `body`.
inline std::string bsdf(const std::string& body) {
  return scene("<bsdf type=\"x\">" + body + "</bsdf>");
}

inline NodePtr parse(const std::string& text, const ParseOptions& options = {}) {
  return parse_scene_string(text, "s.xml", options);
}

/// The single nested object of the root.
inline NodePtr parse_bsdf(const std::string& body, const ParseOptions& options = {}) {
  return parse(bsdf(body), options)->objects().at(0);
}

/// what() of the Error that parsing throws; a test failure if there is none.
inline std::string error_of(const std::string& text, const ParseOptions& options = {}) {
  try {
    parse(text, options);
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error for: " << text.substr(0, 300);
  return "no error";
}

template <class Function> std::string error_in(Function function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "no error";
}

/// A fresh folder, removed at the end of its scope.
class TemporaryFolder {
public:
  TemporaryFolder() {
    static std::atomic<int> count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("faceta_xml_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code code;
    std::filesystem::remove_all(path_, code);
  }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
  std::filesystem::path path_;
};

#define EXPECT_HAS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << (text)

} // namespace faceta::xml
