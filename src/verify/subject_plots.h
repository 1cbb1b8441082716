#pragma once

/// The plots that the report shows of each subject.

#include "verify/plot_drawing.h"
#include "verify/suite.h"

namespace faceta {

/// How well directions are sampled, for one angle of the viewer.
struct SamplingFigure {
  double theta;     ///< degrees from the normal; above 90: from inside
  double mean;      ///< of the weights of samples: the albedo
  double variation; ///< standard deviation over mean; NaN if all are 0
};

struct SubjectPlots {
  std::vector<Drawing> drawings;        ///< narrow, for PlotTheme::page
  std::vector<SamplingFigure> sampling; ///< by kSamplingSamples samples each
};
inline constexpr int kSamplingSamples = 1 << 16;

/// What the drawings show and how to read them: a heading and a paragraph for each kind.
struct PlotHelp {
  std::string heading, text;
};
const std::vector<PlotHelp>& plot_help();

/// Draws lobes, density beside samples, albedo, weights and reciprocity of each subject, from
/// inside too where it scatters there, on all processors. The same drawings whatever their number.
/// \param progress as in SuiteOptions; `done` counts drawings. May be empty.
std::vector<SubjectPlots>
draw_subject_plots(const std::vector<SubjectReport>& subjects,
                   const std::function<void(const SuiteProgress&)>& progress);

} // namespace faceta
