#include "verify/subject_plots.h"

#include "verify/in_order.h"
#include "verify/plot.h"

#include <chrono>
#include <mutex>

namespace faceta {

namespace {

constexpr double kWidth = 350; // a phone's, upright
constexpr long kSamples = 1 << 18;

struct Wish {
  PlotKind kind;
  bool inside;
};

std::vector<Wish> wishes(const Subject& subject) {
  std::vector<Wish> list;
  bool both = subject.traits().two_sided;
  for (PlotKind kind : {PlotKind::polar, PlotKind::density, PlotKind::albedo, PlotKind::weight}) {
    list.push_back({kind, false});
    if (both)
      list.push_back({kind, true});
  }
  list.push_back({PlotKind::reciprocity, false});
  return list;
}

Drawing draw(const SuiteSubject& s, const Wish& wish) {
  PlotOptions options;
  options.width = kWidth;
  options.samples = kSamples;
  options.explanation = false;
  if (wish.kind == PlotKind::albedo || wish.kind == PlotKind::weight)
    options.inside = wish.inside;
  else if (wish.inside)
    options.thetas = wish.kind == PlotKind::polar ? std::vector<double>{180, 150, 120, 100}
                                                  : std::vector<double>{150};
  return draw_plot(wish.kind, {{s.subject, s.name + (wish.inside ? ", from inside" : ""), {}}},
                   options);
}

std::vector<SamplingFigure> sampling_figures(const Subject& subject) {
  std::vector<SamplingFigure> figures;
  std::vector<double> thetas = {0, 30, 60, 80, 89};
  if (subject.traits().two_sided)
    thetas.insert(thetas.end(), {100, 120, 150, 180});
  for (double theta : thetas) {
    WeightStudy study =
        study_weights(subject, plot_viewer(theta, 0), PlotChannel::luminance, kSamplingSamples, 1);
    figures.push_back({theta, study.mean, study.variation});
  }
  return figures;
}

} // namespace

const std::vector<PlotHelp>& plot_help() {
  static const std::vector<PlotHelp> help = {
      {"Scattering lobes",
       "The value (BSDF times cosine) in the plane of incidence as a distance from the centre, for "
       "several viewers: short arrows at the rim come from them. The surface is the level line; "
       "what lies below it is transmitted. Long arrows are delta lobes (mirrors, clear glass), as "
       "long as their weight. A radius marked with powers of ten is logarithmic. Values are "
       "without "
       "the factor 1/η² that radiance takes on across an interface, so that energy can be read "
       "off."},
      {"Sampling density",
       "Left: the density that the model reports for its own samples, integrated over each cell. "
       "Right: how many of 262144 samples came. Both have the same colours and should look alike; "
       "the χ² test says whether they are. Hemispheres in an equal-area projection with the normal "
       "in the middle; ring: viewer, cross: mirror direction, dots: delta lobes with their "
       "probability."},
      {"Directional albedo", "The share of a white sphere's light that reaches the viewer. More "
                             "than 1 (the line) would be "
                             "energy out of nothing."},
      {"Weights of samples",
       "Above: the coefficient of variation of the weight, its standard deviation over its mean; 0 "
       "would be perfect, and 1 means noise as large as the signal from one sample. Below: the "
       "weights themselves: half of them lie in the dark band, 98 % in the pale one. 65536 samples "
       "at each angle."},
      {"Reciprocity",
       "How far the value changes when viewer and light change places, relative to it, largest "
       "over "
       "azimuths and colours. Rounding leaves up to about 1e-12; only what is far above is a fault "
       "or a trait of the model."}};
  return help;
}

std::vector<SubjectPlots>
draw_subject_plots(const std::vector<SubjectReport>& subjects,
                   const std::function<void(const SuiteProgress&)>& progress) {
  struct Task {
    size_t subject, drawing;
    Wish wish;
  };
  std::vector<SubjectPlots> plots(subjects.size());
  std::vector<Task> tasks;
  for (size_t i = 0; i < subjects.size(); ++i) {
    for (const Wish& wish : wishes(subjects[i].subject.subject))
      tasks.push_back({i, plots[i].drawings.size(), wish}), plots[i].drawings.emplace_back();
  }
  auto start = std::chrono::steady_clock::now();
  std::mutex mutex;
  SuiteProgress state{0, tasks.size(), 0, {}};
  run_in_order(tasks.size(), [&](size_t i) {
    const Task& task = tasks[i];
    const SuiteSubject& s = subjects[task.subject].subject;
    if (task.drawing == 0)
      plots[task.subject].sampling = sampling_figures(s.subject);
    plots[task.subject].drawings[task.drawing] = draw(s, task.wish);
    std::scoped_lock lock(mutex);
    ++state.done;
    state.name = s.name;
    state.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (progress)
      progress(state);
  });
  return plots;
}

} // namespace faceta
