#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace faceta {

/// A file written piece by piece under a temporary name beside its target, which it gets only at
/// the end: a failure leaves neither half a file nor a lost old one behind. The name "-" is the
/// standard output; it and targets that are no regular files (a pipe, /dev/null) are written to
/// directly.
class OutputFile {
public:
  /// Error if the file cannot be made.
  explicit OutputFile(const std::string& target);
  /// Removes what was written unless commit() was called.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Error if the device is full, the pipe closed...
  void write(std::string_view bytes);
  /// Gives the file its name. Error as for write().
  void commit();

private:
  [[noreturn]] void fail(const char* what) const;

  std::string target_, temporary_; ///< temporary_ is empty where the target is written directly
  int descriptor_ = -1;
};

} // namespace faceta
