#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <vector>

namespace faceta {

/// A place in an input file. Lines and columns count from 1; 0 means unknown.
struct SourcePosition {
  std::string file;
  int line = 0;
  int column = 0;
};

/// Bad input or failed I/O, with the place it was found at and what would have been right.
/// what() reads "file:line:column: error: message (hint)". The command line turns it into exit
/// code 3. Bugs of our own are assertions, never an Error.
class Error : public std::exception {
public:
  explicit Error(std::string message, SourcePosition where = {}, std::string hint = {});

  const char* what() const noexcept override { return text_.c_str(); }
  const std::string& message() const { return message_; }
  const SourcePosition& where() const { return where_; }
  const std::string& hint() const { return hint_; }

private:
  std::string message_, hint_, text_;
  SourcePosition where_;
};

/// "did you mean 'x'? known: a, b, c": the nearest candidate by edit distance (if near enough) and
/// the list of all (shortened past 40 names). Empty if there are no candidates.
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);

} // namespace faceta
