#include "formats/input_text.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <limits>
#include <memory>
#include <sys/mman.h>
#include <unistd.h>

namespace faceta {

namespace {

constexpr const char* kCannotOpen = "file cannot be opened for reading";

size_t size_of_regular_file(const std::string& path) {
  std::error_code code;
  auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status))
    throw Error("file not found", {path});
  if (!std::filesystem::is_regular_file(status))
    throw Error("not a regular file", {path});
  auto size = std::filesystem::file_size(path, code);
  if (code)
    throw Error(kCannotOpen, {path});
  return static_cast<size_t>(size);
}

} // namespace

std::string read_whole_file(const std::string& path) {
  std::string bytes(size_of_regular_file(path), '\0');
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                       &std::fclose);
  if (!file)
    throw Error(kCannotOpen, {path});
  if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
    throw Error("file cannot be read to its end", {path});
  return bytes;
}

MappedFile::MappedFile(const std::string& path) : size_(size_of_regular_file(path)) {
  int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    throw Error(kCannotOpen, {path});
  void* memory = nullptr; // nothing can be mapped of an empty file
  if (size_ > 0)
    memory = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
  ::close(descriptor);
  if (memory == MAP_FAILED)
    throw Error("file cannot be mapped into memory", {path});
  data_ = static_cast<const char*>(memory);
}

MappedFile::~MappedFile() {
  if (data_)
    ::munmap(const_cast<char*>(data_), size_);
}

Error InputText::error(const char* at, const std::string& message, const std::string& hint) const {
  int line = 1, column = 1;
  for (const char* p = text.data(); p != at; ++p) {
    bool newline = *p == '\n' || (*p == '\r' && p + 1 != at && p[1] != '\n');
    line += newline;
    column = newline ? 1 : column + 1;
  }
  return Error(message, {name, line, column}, hint);
}

Error InputText::error_at_byte(const char* at, const std::string& message) const {
  return Error(message + ", at byte " + std::to_string(at - text.data()), {name});
}

NumberStatus parse_float(const char*& p, const char* end, float& value) {
  const char* start = p;
  if (start != end && *start == '+' && start + 1 != end && start[1] != '-')
    ++start;
  auto result = std::from_chars(start, end, value);
  if (result.ec == std::errc::invalid_argument)
    return NumberStatus::kMalformed;
  p = result.ptr;
  if (result.ec == std::errc::result_out_of_range) {
    // Too small for a float is 0 or a subnormal; double tells the two ends of the range apart.
    double wide = 0;
    auto wide_result = std::from_chars(start, end, wide);
    if (wide_result.ec == std::errc::result_out_of_range) {
      std::string_view digits(start, static_cast<size_t>(p - start));
      size_t exponent = digits.find_first_of("eE");
      bool tiny =
          exponent != digits.npos && exponent + 1 < digits.size() && digits[exponent + 1] == '-';
      wide = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    }
    value = static_cast<float>(wide);
  }
  return std::isfinite(value) ? NumberStatus::kOk : NumberStatus::kNotFinite;
}

std::string word_at(const char* p, const char* end) {
  std::string word;
  for (; p != end && word.size() < 40; ++p) {
    if (*p == ' ' || *p == '\t' || *p == '\r' || *p == '\n')
      break;
    word += (*p > ' ' && *p < 127) ? *p : '?';
  }
  return word;
}

} // namespace faceta
