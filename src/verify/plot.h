#pragma once

/// Plots of materials: what `faceta plot` writes and reports embed.
///
///   std::vector<PlotMaterial> gold = {{Subject(model, parameters), "roughconductor"}};
///   html += to_svg(draw_plot(PlotKind::polar, gold, {}), "gold-polar");

#include "verify/plot_data.h"
#include "verify/plot_drawing.h"

#include <optional>

namespace faceta {

enum class PlotKind { polar, albedo, slices, density, weight, reciprocity };

/// A kind of plot as the command line offers it.
struct PlotKindInfo {
  PlotKind kind;
  const char* name;
  const char* summary;              ///< one line
  std::vector<std::string> options; ///< fields of PlotOptions that it looks at
};
const std::vector<PlotKindInfo>& plot_kinds();
/// Error with a suggestion if there is none of this name.
const PlotKindInfo& plot_kind(const std::string& name);

struct PlotMaterial {
  Subject subject;
  std::string label;      ///< in legends and titles, say the model's name
  std::string parameters; ///< in the caption; empty: nothing is said
};
/// Label: the model's name; parameters: those that were given, "name=value name=value".
PlotMaterial plot_material(const Parameters& parameters);

/// What of a colour is shown: one number, or red, green and blue beside each other.
enum class PlotColour { luminance, red, green, blue, all };

struct PlotOptions {
  std::vector<double> thetas;      ///< degrees from the normal; empty: the kind's own
  double phi = 0;                  ///< azimuth of the plane of incidence (slices: of h), degrees
  std::optional<bool> logarithmic; ///< radius or colours; nothing: the kind's own
  PlotColour colour = PlotColour::luminance;
  bool inside = false;     ///< the viewer below the surface
  double width = 480;      ///< of the drawing in CSS pixels, text keeps its size; 300 to 4000
  double height = 0;       ///< 0: what suits the kind
  long samples = 1 << 19;  ///< for density, at each angle
  bool caption = true;     ///< how to read it, and the parameters, below
  bool explanation = true; ///< in the caption: how to read it, not only figures and parameters
};

/// At most this many materials in one plot.
inline constexpr int kMostPlotMaterials = 7;

/// Draws one kind of plot for one or more materials.
/// Error: no material or too many; angles out of range (0 to 90, for models that scatter below the
/// surface to 180), a view from inside of a model that has none, too small a size.
Drawing draw_plot(PlotKind kind, const std::vector<PlotMaterial>& materials,
                  const PlotOptions& options);

} // namespace faceta
