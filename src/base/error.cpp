#include "base/error.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace faceta {

Error::Error(std::string message, SourcePosition where, std::string hint)
    : message_(std::move(message)), hint_(std::move(hint)), where_(std::move(where)) {
  if (!where_.file.empty()) {
    text_ = where_.file + ":";
    if (where_.line > 0)
      text_ += std::to_string(where_.line) + ":" + std::to_string(std::max(1, where_.column)) + ":";
    text_ += " ";
  }
  text_ += "error: " + message_;
  if (!hint_.empty())
    text_ += " (" + hint_ + ")";
}

namespace {

size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      size_t above = row[j];
      bool same = std::tolower(static_cast<unsigned char>(a[i - 1])) ==
                  std::tolower(static_cast<unsigned char>(b[j - 1]));
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (same ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

} // namespace

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  if (candidates.empty())
    return {};
  const std::string* best = nullptr;
  size_t best_distance = std::max<size_t>(2, name.size() / 3) + 1;
  if (name.size() <= 256)
    for (const std::string& candidate : candidates) {
      size_t distance = edit_distance(name, candidate);
      if (distance < best_distance) {
        best_distance = distance;
        best = &candidate;
      }
    }
  std::string text;
  if (best)
    text = "did you mean '" + *best + "'? ";
  text += "known: ";
  size_t shown = std::min<size_t>(candidates.size(), 40);
  for (size_t i = 0; i < shown; ++i)
    text += (i ? ", " : "") + candidates[i];
  if (shown < candidates.size())
    text += ", ...";
  return text;
}

} // namespace faceta
