#include "verify/plot.h"

#include "base/error.h"
#include "verify/plot_kinds.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace faceta {

const std::vector<PlotKindInfo>& plot_kinds() {
  static const std::vector<PlotKindInfo> kinds = {
      {PlotKind::polar,
       "polar",
       "lobes in the plane of incidence, reflected and transmitted",
       {"theta", "phi", "log", "channel"}},
      {PlotKind::albedo,
       "albedo",
       "share of light that is scattered, over the viewing angle",
       {"phi", "channel", "inside"}},
      {PlotKind::slices,
       "slices",
       "reflection over half and difference angle (Burley 2012)",
       {"phi", "log", "channel"}},
      {PlotKind::density,
       "density",
       "density of sampled directions beside a histogram of samples",
       {"theta", "phi", "log", "samples"}},
      {PlotKind::weight,
       "weight",
       "spread of the weights of samples, over the viewing angle",
       {"phi", "channel", "inside"}},
      {PlotKind::reciprocity,
       "reciprocity",
       "how far values change when the directions change places",
       {}},
  };
  return kinds;
}

const PlotKindInfo& plot_kind(const std::string& name) {
  std::vector<std::string> names;
  for (const PlotKindInfo& info : plot_kinds()) {
    if (info.name == name)
      return info;
    names.push_back(info.name);
  }
  throw Error("there is no plot of the kind '" + name + "'", {}, suggestion(name, names));
}

namespace {

/// "0.5" for "0.5,0.5,0.5".
std::string without_repeats(const std::string& text) {
  size_t first = text.find(',');
  std::string one = text.substr(0, first);
  return text == one + "," + one + "," + one ? one : text;
}

} // namespace

PlotMaterial plot_material(const Parameters& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters.given())
    text += (text.empty() ? "" : " ") + name + "=" + without_repeats(value);
  return {Subject(parameters.model(), parameters), parameters.model().name(),
          text.empty() ? "default parameters" : text};
}

namespace {

void check(const std::vector<PlotMaterial>& materials, const PlotOptions& options) {
  if (materials.empty())
    throw Error("a plot needs a material");
  if (materials.size() > kMostPlotMaterials)
    throw Error(fmt::format("{} materials are too many for one plot", materials.size()), {},
                fmt::format("at most {}", kMostPlotMaterials));
  if (!(options.width >= 300 && options.width <= 4000 && options.height >= 0 &&
        options.height <= 4000))
    throw Error(
        fmt::format("a drawing of {} x {} cannot be laid out", options.width, options.height), {},
        "300 to 4000 wide, at most 4000 high");
  if (!std::isfinite(options.phi))
    throw Error("the azimuth is no finite number");
  if (options.thetas.size() > 7)
    throw Error(fmt::format("{} angles are too many for one plot", options.thetas.size()), {},
                "at most 7");
  for (const PlotMaterial& m : materials) {
    bool below = m.subject.traits().two_sided;
    for (double theta : options.thetas)
      if (!(theta >= 0 && theta <= (below ? 180 : 90)) || theta == 90)
        throw Error(
            fmt::format("the angle {} makes no plot of '{}'", theta, m.subject.descriptor().name),
            {},
            below ? "degrees from the normal, 0 to 180 but not 90"
                  : "degrees from the normal, 0 to less than 90: it scatters on one side");
    if (options.inside && !below)
      throw Error("'" + m.subject.descriptor().name + "' cannot be seen from inside", {},
                  "it scatters above the surface only");
  }
}

} // namespace

Drawing draw_plot(PlotKind kind, const std::vector<PlotMaterial>& materials,
                  const PlotOptions& options) {
  check(materials, options);
  switch (kind) {
  case PlotKind::polar:
    return plots::draw_polar(materials, options);
  case PlotKind::albedo:
    return plots::draw_albedo(materials, options);
  case PlotKind::slices:
    return plots::draw_slices(materials, options);
  case PlotKind::density:
    return plots::draw_density(materials, options);
  case PlotKind::weight:
    return plots::draw_weight(materials, options);
  case PlotKind::reciprocity:
    return plots::draw_reciprocity(materials, options);
  }
  throw Error("no such kind of plot");
}

namespace plots {

namespace {

/// A letter in front of materials whose label others bear as well: "A roughconductor".
std::string name_of(const Materials& materials, size_t i) {
  std::set<std::string> labels;
  for (const PlotMaterial& m : materials)
    labels.insert(m.label);
  if (labels.size() == materials.size())
    return materials[i].label;
  return std::string(1, char('A' + i)) + " " + materials[i].label;
}

} // namespace

std::vector<Series> series_of(const Materials& materials, const PlotOptions& options) {
  struct Channel {
    PlotChannel channel;
    const char* name;
    int ink, dash;
  };
  // Series inks that look red, green and blue enough, and are told apart by everyone.
  static const Channel channels[] = {{PlotChannel::red, "red", 1, 0},
                                     {PlotChannel::green, "green", 2, 1},
                                     {PlotChannel::blue, "blue", 0, 2}};
  std::vector<Series> result;
  for (size_t i = 0; i < materials.size(); ++i) {
    std::string name = name_of(materials, i);
    Series one{&materials[i], PlotChannel::luminance, name, series_ink(int(i)), 0};
    if (options.colour == PlotColour::all) {
      for (const Channel& c : channels) {
        one.channel = c.channel;
        one.label = materials.size() == 1 ? c.name : name + ", " + c.name;
        one.ink = materials.size() == 1 ? series_ink(c.ink) : series_ink(int(i));
        one.dash = c.dash;
        result.push_back(one);
      }
      continue;
    }
    if (options.colour != PlotColour::luminance)
      one.channel = channels[int(options.colour) - int(PlotColour::red)].channel;
    result.push_back(one);
  }
  return result;
}

PlotPage begin_text(const std::string& title, const Materials& materials,
                    const PlotOptions& options) {
  PlotPage page;
  page.title = title;
  for (size_t i = 0; i < materials.size(); ++i)
    page.subtitle += (i ? ", " : "") + name_of(materials, i);
  if (options.caption)
    for (size_t i = 0; i < materials.size(); ++i)
      if (!materials[i].parameters.empty())
        page.caption.push_back(name_of(materials, i) + ": " + materials[i].parameters + ".");
  const char* colours[] = {"luminance", "red", "green", "blue"};
  bool coloured = options.colour != PlotColour::luminance && options.colour != PlotColour::all;
  if (coloured)
    page.subtitle += std::string(", ") + colours[int(options.colour)];
  return page;
}

void explain(PlotPage& page, const PlotOptions& options, const std::string& text) {
  if (options.caption && options.explanation)
    page.caption.insert(page.caption.begin(), text);
}

PanelGrid::PanelGrid(int count, double width, double smallest) {
  columns = std::clamp(int(width / smallest), 1, count);
  rows = (count + columns - 1) / columns;
  columns = (count + rows - 1) / rows;
}

PlotBox PanelGrid::cell(const PlotBox& box, int i) const {
  constexpr double kGap = 14;
  double width = (box.width - kGap * (columns - 1)) / columns;
  double height = (box.height - kGap * (rows - 1)) / rows;
  int column = i % columns, row = i / columns;
  return {box.x + column * (width + kGap), box.y + row * (height + kGap), width, height};
}

} // namespace plots

} // namespace faceta
