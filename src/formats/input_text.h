#pragma once

#include "base/error.h"

#include <string>
#include <string_view>

namespace faceta {

/// The bytes of a regular file. Throws Error if it is missing, no regular file or unreadable.
std::string read_whole_file(const std::string& path);

/// The bytes of a regular file, mapped into memory: pages are read when they are looked at, and
/// given back when memory runs short. Errors as of read_whole_file. The file must not shrink while
/// it is looked at.
class MappedFile {
public:
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view bytes() const { return {data_, size_}; }

private:
  const char* data_ = nullptr;
  size_t size_ = 0;
};

/// Text of a file with its name, for errors that know their line and column. The position is
/// counted out only when an error is made, so that parsing pays nothing for it.
struct InputText {
  std::string_view text;
  std::string name;

  /// An error at the byte `at` points to (inside text, or its end).
  Error error(const char* at, const std::string& message, const std::string& hint = {}) const;
  /// The same for binary data: the message names the byte offset instead of a line.
  Error error_at_byte(const char* at, const std::string& message) const;
};

enum class NumberStatus { kOk, kMalformed, kNotFinite };

/// Reads a decimal number at p, moves p behind it. Accepts a leading '+'; what underflows becomes
/// 0; overflow, nan and inf are kNotFinite. The nearest float is taken, whatever the locale.
NumberStatus parse_float(const char*& p, const char* end, float& value);

/// A short printable excerpt of the word at p, for messages.
std::string word_at(const char* p, const char* end);

} // namespace faceta
