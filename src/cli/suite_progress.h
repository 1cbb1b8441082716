#pragma once

#include "verify/suite.h"

namespace faceta::cli {

/// Shows the suite's progress on the standard error: one line redrawn on a terminal, a plain line
/// for every tenth elsewhere, nothing if quiet.
class SuiteProgressLine {
public:
  /// \param what is counted
  explicit SuiteProgressLine(bool quiet, const char* what = "checks");
  /// Removes the line from the terminal.
  ~SuiteProgressLine();
  SuiteProgressLine(const SuiteProgressLine&) = delete;
  SuiteProgressLine& operator=(const SuiteProgressLine&) = delete;
  void update(const SuiteProgress& progress);

private:
  bool quiet_, terminal_, open_ = false;
  size_t shown_tenths_ = 0;
  const char* what_;
};

} // namespace faceta::cli
