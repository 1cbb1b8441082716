#pragma once

#include "render/render.h"

#include <chrono>

namespace faceta::cli {

/// Shows a render's progress on the standard error: one line redrawn on a terminal, a plain line
/// for every tenth elsewhere, nothing if quiet.
class ProgressLine {
public:
  explicit ProgressLine(bool quiet);
  void update(const Progress& progress);
  /// Ends the line. Safe to call twice.
  void finish();

private:
  bool quiet_, terminal_, open_ = false;
  int shown_tenths_ = 0;
};

/// Sets a flag at the first Ctrl-C while it lives; the second ends the program.
class InterruptFlag {
public:
  InterruptFlag();
  ~InterruptFlag();
  const std::atomic<bool>& flag() const;
};

} // namespace faceta::cli
