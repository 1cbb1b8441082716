#pragma once

/// The results of the verification suite as one page that anyone can read.

#include "verify/subject_plots.h"
#include "verify/suite.h"

namespace faceta {

struct PageOptions {
  std::string version;     ///< of the program
  bool of_this_run = true; ///< say how long it took, and on which instruction set
  std::string remark{};    ///< HTML below the verdict
};

/// A complete, self-contained HTML file: verdict and counts, models by properties, failures,
/// excuses, and for every model its subjects, each folded, with properties, figures and plots.
/// \param plots one for each subject of the report, or none at all
std::string suite_html(const SuiteReport& report, const std::vector<SubjectPlots>& plots,
                       const PageOptions& options);

} // namespace faceta
