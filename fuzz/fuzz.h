#pragma once

/// What the fuzz targets share. Bad input has one right answer, a faceta::Error with a place and a
/// message; any other exception, a failed require() and what the sanitizers see end the process.

#include "base/error.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <sys/mman.h>
#include <unistd.h>

namespace faceta::fuzz {

inline void require(bool holds, const char* what) {
  if (holds)
    return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

inline std::string_view text_of(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Runs a reader. True if it took the input, false if it refused it by an Error that says where and
/// why.
template <class F> bool accepts(F read) {
  try {
    read();
    return true;
  } catch (const Error& error) {
    require(!error.message().empty(), "an error has a message");
    require(!error.where().file.empty(), "an error names the file");
    require(error.where().line >= 0 && error.where().column >= 0, "lines and columns count up");
    return false;
  }
}

/// A file that is in memory only, for readers that want a path.
class MemoryFile {
public:
  explicit MemoryFile(std::string_view bytes) : descriptor_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    require(descriptor_ >= 0, "a file in memory can be made");
    require(::write(descriptor_, bytes.data(), bytes.size()) == ssize_t(bytes.size()),
            "a file in memory can be written");
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

private:
  int descriptor_;
};

/// A folder of this process, removed at its orderly end.
class Folder {
public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              ("faceta-fuzz-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  void write(const std::string& name, std::string_view bytes) const {
    std::FILE* file = std::fopen((path_ / name).c_str(), "wb");
    require(file != nullptr, "a temporary file can be made");
    require(std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() &&
                std::fclose(file) == 0,
            "a temporary file can be written");
  }

private:
  std::filesystem::path path_;
};

/// Whether XML could name a file outside of the folders it is given: by a slash that is not part of
/// a tag, or by a character reference that stands for one.
inline bool leaves_its_folder(std::string_view xml) {
  if (xml.find("&#") != xml.npos || xml.find("..") != xml.npos)
    return true;
  for (size_t i = xml.find('/'); i != xml.npos; i = xml.find('/', i + 1))
    if (!(i > 0 && xml[i - 1] == '<') && !(i + 1 < xml.size() && xml[i + 1] == '>'))
      return true;
  return false;
}

} // namespace faceta::fuzz
